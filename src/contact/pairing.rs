//! From a contact of the model to a pair of the interface: look up, search, choose the laws.

use super::interface::{ContactPoint, Interface, Kind, Pair, Statistics};
use super::law::{self, Tangential};
use super::motion::{Motion, sliding};
use super::search::{Found, FoundPoint, Options, find};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, Surface};
use crate::model::{Contact, Model};
use std::collections::BTreeSet;

/// A point touches where its gap is below this fraction of the slave's facet size. It decides only where the settling
/// starts from, so it is generous to meshes with few digits.
const TOUCH: f64 = 1e-6;

/// Appends the points of a contact to the interface.
pub(super) fn add_pair(interface: &mut Interface, model: &Model, mesh: &Mesh, contact: &Contact) -> Result<()> {
    let site = Site::new(model, mesh, contact)?;
    let found = site.search()?;
    let laws = site.laws(&found)?;
    let first = interface.points.len();
    for (point, law) in found.points.iter().zip(&laws) {
        let facet = &site.master.facets[point.facet];
        interface.trace.push_projection(point.node, facet, &point.shape);
        interface.points.push(ContactPoint {
            pair: interface.pairs.len(),
            node: point.node,
            position: point.position,
            law: *law,
        });
    }
    let kind = kind_of(&laws);
    interface.pairs.push(Pair {
        name: contact.name.clone(),
        slave: contact.slave.clone(),
        master: contact.master.clone(),
        law: contact.law,
        friction: contact.friction,
        kind,
        separation: contact.separation,
        swept: if model.swept.is_empty() { kind == Kind::Sliding } else { model.swept.contains(&contact.name) },
        points: first..interface.points.len(),
        statistics: statistics(found, &laws),
    });
    Ok(())
}

/// A contact with what its names stand for.
struct Site<'a> {
    model: &'a Model,
    mesh: &'a Mesh,
    contact: &'a Contact,
    slave: &'a Surface,
    master: &'a Surface,
    /// Imposed motion of the slave's and of the master's part.
    motions: [Motion; 2],
}

impl<'a> Site<'a> {
    fn new(model: &'a Model, mesh: &'a Mesh, contact: &'a Contact) -> Result<Self> {
        let refuse = |reason: String| refusal(model, contact, &reason);
        let slave = surface(mesh, &contact.slave).map_err(refuse)?;
        let master = surface(mesh, &contact.master).map_err(refuse)?;
        let motions = [
            motion(model, mesh, &contact.slave, slave).map_err(refuse)?,
            motion(model, mesh, &contact.master, master).map_err(refuse)?,
        ];
        Ok(Site { model, mesh, contact, slave, master, motions })
    }

    /// An input error that says which contact it is about.
    fn refuse(&self, reason: &str) -> Error {
        refusal(self.model, self.contact, reason)
    }

    /// The contact points; an error where there are none, or where the surfaces share nodes.
    fn search(&self) -> Result<Found> {
        let search = |search_distance| {
            let options = Options { search_distance };
            find(self.slave, self.master, &self.mesh.nodes, &options)
        };
        let found = search(self.contact.search_distance);
        if found.points.is_empty() {
            return Err(self.nothing_found(&found, &search(Some(f64::INFINITY))));
        }
        let masters: BTreeSet<u32> = self.master.facets.iter().flatten().copied().collect();
        let is_shared = |point: &&FoundPoint| masters.contains(&point.node);
        match found.points.iter().filter(is_shared).count() {
            0 => Ok(found),
            shared => Err(self.refuse(&format!(
                "{shared} nodes belong to both surfaces, so nothing can move there. Mesh the two parts \
                 separately (in Gmsh: no fragment or duplicate removal across the contact)"
            ))),
        }
    }

    /// Says how far away the master is from a slave of which no point was found.
    fn nothing_found(&self, found: &Found, anywhere: &Found) -> Error {
        let (slave, master) = (&self.contact.slave, &self.contact.master);
        let distances = anywhere.points.iter().map(|p| p.distance);
        let closest = distances.fold(f64::INFINITY, f64::min);
        if closest.is_infinite() {
            return self.refuse(&format!(
                "no facet of \"{master}\" faces \"{slave}\": nowhere do their outward normals oppose each other. \
                 Check that these are the surfaces that meet"
            ));
        }
        let limit = self.contact.search_distance.map_or_else(
            || "half an edge of the slave's facets".to_owned(),
            |distance| format!("the search distance of {distance:.3e} m"),
        );
        self.refuse(&format!(
            "none of the {} points of \"{slave}\" lies within {limit} of \"{master}\"; the closest is {closest:.3e} m \
             away. Set `search` above that if the surfaces are to touch, else check the mesh's unit and the names",
            found.dropped.len()
        ))
    }

    /// The law of every point found.
    fn laws(&self, found: &Found) -> Result<Vec<law::Point>> {
        let [slave, master] = &self.motions;
        let directions: Vec<_> =
            found.points.iter().map(|p| sliding(slave, master, p.position, p.normal, p.size)).collect();
        let slides = directions.iter().any(Option::is_some);
        let resting = self.resting(slides)?;
        let laws = found.points.iter().zip(&directions);
        Ok(laws
            .map(|(point, direction)| law::Point {
                weight: point.weight,
                normal: point.normal,
                gap: point.gap,
                touching: point.gap <= TOUCH * point.size,
                separation: self.contact.separation,
                normal_law: self.contact.law,
                tangential: direction.map_or(resting, |(direction, speed)| Tangential::Sliding { direction, speed }),
            })
            .collect())
    }

    /// The tangential law of points that do not slide.
    fn resting(&self, slides: bool) -> Result<Tangential> {
        match (slides, self.contact.stick) {
            (true, None) => Ok(Tangential::Frictionless),
            (true, Some(_)) => Err(self.refuse(
                "the pair slides for ever, because one of its parts has a rotation, and cannot stick. Remove `stick`",
            )),
            (false, Some(stick)) => Ok(Tangential::StickSlip { stick }),
            (false, None) if self.contact.friction == 0.0 => Ok(Tangential::Frictionless),
            (false, None) => Err(self.refuse(
                "the pair has friction but neither slides (no part has a rotation) nor has a `stick` stiffness. \
                 Give stick in N/m3, such as half the normal stiffness, or friction = 0",
            )),
        }
    }
}

/// An input error with the contact's file, line and name.
fn refusal(model: &Model, contact: &Contact, reason: &str) -> Error {
    let (file, line, name) = (model.file.display(), contact.line, &contact.name);
    Error::input(format!("{file}:{line}: contact \"{name}\": {reason}."))
}

/// A surface by its name.
fn surface<'a>(mesh: &'a Mesh, name: &str) -> std::result::Result<&'a Surface, String> {
    match mesh.surfaces.get(name) {
        Some(surface) if !surface.facets.is_empty() => Ok(surface),
        Some(_) => Err(format!("the surface \"{name}\" has no facets")),
        None => {
            let known: Vec<_> = mesh.surfaces.keys().map(|k| format!("\"{k}\"")).collect();
            Err(format!("the mesh has no surface \"{name}\"; it has {}", known.join(", ")))
        }
    }
}

/// The motion of the parts under a surface, which must be one and the same.
fn motion(model: &Model, mesh: &Mesh, name: &str, surface: &Surface) -> std::result::Result<Motion, String> {
    let parts: BTreeSet<u32> = surface.tets.iter().map(|&tet| mesh.tet_part[tet as usize]).collect();
    let mut motions = parts.iter().map(|&part| Motion::of(model, &mesh.parts[part as usize]));
    let first = motions.next().ok_or_else(|| format!("the facets of \"{name}\" belong to no part"))?;
    if motions.all(|other| other == first) {
        Ok(first)
    } else {
        Err(format!("\"{name}\" lies on parts that turn differently. Split the surface by parts"))
    }
}

/// The kind of a pair: that of its points, of which some on the axis of a sliding pair are frictionless.
fn kind_of(laws: &[law::Point]) -> Kind {
    let kind = |law: &law::Point| match law.tangential {
        Tangential::Frictionless => Kind::Frictionless,
        Tangential::Sliding { .. } => Kind::Sliding,
        Tangential::StickSlip { .. } => Kind::StickSlip,
        Tangential::Stick { .. } => Kind::Stick,
    };
    let mut kinds = laws.iter().map(kind);
    kinds.find(|k| *k != Kind::Frictionless).unwrap_or(Kind::Frictionless)
}

/// Sums up what the search found; there is at least one point.
fn statistics(found: Found, laws: &[law::Point]) -> Statistics {
    let gaps = found.points.iter().map(|p| p.gap);
    Statistics {
        area: found.area,
        weight: found.points.iter().map(|p| p.weight).sum(),
        gap: [gaps.clone().fold(f64::INFINITY, f64::min), gaps.fold(f64::NEG_INFINITY, f64::max)],
        touching: laws.iter().filter(|law| law.touching).count(),
        dropped: found.dropped,
    }
}
