//! From a contact of the model to a pair of the interface: search, and choose the laws.

use super::interface::{ArchardWear, ContactPair, ContactPoint, Interface, Statistics, TangentialKind};
use super::law::{self, FrictionLaw, Tangential};
use super::motion::sliding;
use super::search::{Found, FoundPoint, Options, Team, find};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, Surface};
use crate::model::{Contact, Model, NormalLaw, Rotation};
use std::collections::BTreeSet;

/// A point touches where its gap is below this fraction of the slave's facet size. It decides only where the settling
/// starts from, so it is generous to meshes with few digits.
const TOUCH: f64 = 1e-6;

/// Appends the points of a contact to the interface.
pub(super) fn add_pair(
    interface: &mut Interface,
    model: &Model,
    mesh: &Mesh,
    contact: &Contact,
    swept: bool,
    team: &dyn Team,
) -> Result<()> {
    let (slave, master) = (&mesh.surfaces[&contact.slave], &mesh.surfaces[&contact.master]);
    let surfaces = ContactSurfaces { model, mesh, contact, slave, master, team };
    let mut found = surfaces.search()?;
    let adjusted = adjust(&mut found, contact.adjust);
    set_gaps(&mut found, contact.clearance);
    let law = PairLaw::new(model, mesh, contact);
    let first = interface.points.len();
    for point in &found.points {
        interface.gap_operator.push_projection(&point.slave, &point.master);
        interface.points.push(law.contact_point(interface.pairs.len(), point));
    }
    surfaces.add_fields(&mut interface.points[first..])?;
    interface.pairs.push(ContactPair {
        name: contact.name.clone(),
        slave: contact.slave.clone(),
        master: contact.master.clone(),
        law: law.normal_law.clone(),
        friction: contact.friction,
        friction_law: contact.friction_curve.clone().map_or(FrictionLaw::Constant, FrictionLaw::Curve),
        kind: law.kind(),
        separation: contact.separation,
        swept,
        wear: law.wear,
        points: first..interface.points.len(),
        statistics: Statistics {
            n_adjusted: adjusted.len(),
            largest_adjusted: adjusted.into_iter().fold(0.0, f64::max),
            ..statistics(found, &interface.points[first..])
        },
    });
    Ok(())
}

/// How a contact wears: by its coefficient, and the density of the part behind its slave.
fn wear(model: &Model, mesh: &Mesh, contact: &Contact) -> Option<ArchardWear> {
    let part = mesh.part_of_surface(&contact.slave).map(|part| &mesh.parts[part as usize]);
    let own = model.parts.iter().find(|own| Some(&own.name) == part);
    let density = own.map_or(0.0, |own| own.material.density);
    contact.wear.map(|coefficient| ArchardWear { coefficient, density })
}

/// What acts at all points of a pair.
struct PairLaw<'a> {
    /// That of the master, where it slides for ever.
    rotation: Option<&'a Rotation>,
    normal_law: NormalLaw,
    stick: Option<f64>,
    separation: bool,
    wear: Option<ArchardWear>,
}

impl<'a> PairLaw<'a> {
    fn new(model: &'a Model, mesh: &Mesh, contact: &Contact) -> PairLaw<'a> {
        PairLaw {
            rotation: model.sliding(contact, mesh),
            normal_law: model.normal_law(contact, mesh),
            stick: model.stick(contact, mesh),
            separation: contact.separation,
            wear: wear(model, mesh, contact),
        }
    }

    fn kind(&self) -> TangentialKind {
        match (self.rotation, self.stick) {
            (Some(_), _) => TangentialKind::Sliding,
            (None, Some(_)) => TangentialKind::StickSlip,
            (None, None) => TangentialKind::Frictionless,
        }
    }

    /// A point of the pair with this number, without the gap of a field.
    fn contact_point(&self, pair: usize, found: &FoundPoint) -> ContactPoint {
        ContactPoint {
            pair,
            places: vec![found.place],
            nodes: found.slave.nodes.clone(),
            position: found.position,
            field_gap: 0.0,
            law: self.at(found),
        }
    }

    /// The law of a point, on which the master slides with its rotation or rests.
    fn at(&self, point: &FoundPoint) -> law::PointLaw {
        let tangential = match (self.rotation, self.stick) {
            (Some(rotation), _) => sliding(rotation, point.position, point.normal, point.size),
            (None, Some(stick)) => Tangential::StickSlip { stick },
            (None, None) => Tangential::Frictionless,
        };
        law::PointLaw {
            weight: point.weight,
            normal: point.normal,
            gap: point.gap,
            correction: 0.0,
            wear: 0.0,
            touching: point.gap <= TOUCH * point.size,
            separation: self.separation,
            normal_law: self.normal_law.clone(),
            tangential,
        }
    }
}

/// A contact with the surfaces that its names stand for.
struct ContactSurfaces<'a> {
    model: &'a Model,
    mesh: &'a Mesh,
    contact: &'a Contact,
    slave: &'a Surface,
    master: &'a Surface,
    team: &'a dyn Team,
}

impl ContactSurfaces<'_> {
    /// An input error with the contact's file, line and name.
    fn refuse(&self, reason: &str) -> Error {
        let message = format!("contact \"{}\": {reason}", self.contact.name);
        self.model.error(self.contact.place, message)
    }

    /// Adds the contact's gap field to the gaps, and multiplies the normal laws by its factors.
    fn add_fields(&self, points: &mut [ContactPoint]) -> Result<()> {
        self.add_gap_field(points)?;
        self.scale_laws(points)
    }

    /// Adds the contact's gap field to the gaps. Which points touch stays: worn surfaces are brought together by the
    /// loads.
    fn add_gap_field(&self, points: &mut [ContactPoint]) -> Result<()> {
        let Some(field) = &self.contact.gap_field else { return Ok(()) };
        let positions: Vec<[f64; 3]> = points.iter().map(|point| point.position).collect();
        let gaps = field.at(&positions).map_err(|reason| self.refuse(&reason))?;
        points.iter_mut().zip(gaps).for_each(|(point, gap)| point.set_field_gap(gap));
        Ok(())
    }

    /// Multiplies the normal laws by the contact's factors.
    fn scale_laws(&self, points: &mut [ContactPoint]) -> Result<()> {
        let Some(field) = &self.contact.stiffness_field else { return Ok(()) };
        let positions: Vec<[f64; 3]> = points.iter().map(|point| point.position).collect();
        let factors = field.at(&positions).map_err(|reason| self.refuse(&reason))?;
        points.iter_mut().zip(factors).for_each(|(point, factor)| {
            point.law.normal_law = point.law.normal_law.times(factor);
        });
        Ok(())
    }

    /// The contact points; an error where there are none, or where the surfaces share nodes.
    fn search(&self) -> Result<Found> {
        let search = |search_distance| {
            let options = Options { search_distance };
            find(self.slave, self.master, &self.mesh.nodes, &options, self.team)
        };
        let found = search(self.contact.search_distance);
        if found.points.is_empty() {
            let (Contact { slave, master, .. }, anywhere) = (self.contact, search(Some(f64::INFINITY)));
            let reason = NothingFound {
                surfaces: [slave, master],
                search_distance: self.contact.search_distance,
                mesh_unit: self.model.mesh_unit,
            };
            return Err(self.refuse(&reason.text(&anywhere)));
        }
        let masters: BTreeSet<u32> = self.master.nodes().collect();
        let slaves: BTreeSet<u32> = found.points.iter().flat_map(|point| point.slave.nodes.iter().copied()).collect();
        match slaves.intersection(&masters).count() {
            0 => Ok(found),
            shared => Err(self.refuse(&format!(
                "{shared} nodes belong to both surfaces, so nothing can move there. Mesh the two parts \
                 separately (in Gmsh: no fragment or duplicate removal across the contact)"
            ))),
        }
    }
}

/// A slave of which no point lies near enough to the master.
pub struct NothingFound<'a> {
    /// The slave and the master.
    pub surfaces: [&'a str; 2],
    /// The search distance, where one is given, m.
    pub search_distance: Option<f64>,
    /// Metres per unit of the mesh.
    pub mesh_unit: f64,
}

impl NothingFound<'_> {
    /// How far away the master is, from a search at any distance.
    pub fn text(&self, anywhere: &Found) -> String {
        let [slave, master] = self.surfaces;
        let distances = anywhere.points.iter().map(|p| p.distance);
        let closest = distances.fold(f64::INFINITY, f64::min);
        if closest.is_infinite() {
            return format!(
                "no facet of \"{master}\" faces \"{slave}\": nowhere do their outward normals oppose each other. \
                 Check that these are the surfaces that meet"
            );
        }
        // In the mesh's unit, to a few digits without the noise of the conversion.
        let length = |x: f64| format!("{:.6e}", x / self.mesh_unit).parse::<f64>().unwrap_or(x);
        let limit = self.search_distance.map_or_else(
            || "half an edge of the slave's facets".to_owned(),
            |distance| format!("the search distance {}", length(distance)),
        );
        let n_points = anywhere.points.len() + anywhere.n_dropped;
        format!(
            "none of the {n_points} points of \"{slave}\" lies within {limit} of \"{master}\"; the closest is {} away, in the mesh's \
             unit. Set search above that if the surfaces are to touch, else look at the names and the mesh",
            length(closest)
        )
    }
}

/// Closes the gaps up to `largest` (m), as if the slave lay on the master there: `gap0 = 0` where
/// `0 < gap0 <= largest`. Gives the gaps that it closed.
fn adjust(found: &mut Found, largest: f64) -> Vec<f64> {
    let gaps = found.points.iter_mut().map(|point| &mut point.gap);
    gaps.filter(|gap| (0.0..=largest).contains(*gap) && **gap > 0.0).map(std::mem::take).collect()
}

/// Gives all points one gap (m), where there is one.
fn set_gaps(found: &mut Found, gap: Option<f64>) {
    gap.into_iter().for_each(|gap| found.points.iter_mut().for_each(|point| point.gap = gap));
}

/// Sums up what the search found; there is at least one point.
fn statistics(found: Found, points: &[ContactPoint]) -> Statistics {
    let gaps = points.iter().map(|point| point.law.gap);
    Statistics {
        area: found.area,
        weight: found.points.iter().map(|p| p.weight).sum(),
        gap: [gaps.clone().fold(f64::INFINITY, f64::min), gaps.fold(f64::NEG_INFINITY, f64::max)],
        touching: points.iter().filter(|point| point.law.touching).count(),
        n_dropped: found.n_dropped,
        ..Statistics::default()
    }
}
