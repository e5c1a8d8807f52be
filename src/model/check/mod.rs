//! Whether model file and mesh go together.

mod joints;
mod rotations;

use super::{Contact, Load, LoadKind, Model, Place, ROUGH, Rotation, names};
use crate::algebra::{cross, sub};
use crate::mesh::Mesh;
use crate::{Error, Result};

impl Model {
    /// Checks everything that takes the mesh: names, parts, surfaces, and what each contact pair needs.
    ///
    /// # Errors
    /// [`Error::Input`] with a line `file:line: what (item). what to do` for each thing that is wrong.
    pub fn check_against(&self, mesh: &Mesh) -> Result<()> {
        let mut check = ModelCheck { model: self, mesh, messages: Vec::new() };
        check.parts();
        check.names();
        check.joints();
        check.rotations();
        check.loads();
        self.contacts.iter().for_each(|contact| check.contact(contact));
        check.sweep();
        if check.messages.is_empty() { Ok(()) } else { Err(Error::Input(check.messages.join("\n"))) }
    }
}

struct ModelCheck<'a> {
    model: &'a Model,
    mesh: &'a Mesh,
    messages: Vec<String>,
}

impl ModelCheck<'_> {
    fn complain(&mut self, place: Place, message: String) {
        self.messages.push(place.message(&self.model.files, message));
    }

    /// Parts of the file and physical volumes are the same.
    fn parts(&mut self) {
        let (model, mesh) = (self.model, self.mesh);
        let volumes = || mesh.parts.iter().map(String::as_str);
        for part in model.parts.iter().filter(|part| !mesh.parts.contains(&part.name)) {
            let advice = names::advice(&part.name, volumes());
            self.complain(part.place, format!("the mesh has no physical volume (part {:?}). {advice}", part.name));
        }
        for (i, part) in model.parts.iter().enumerate() {
            if model.parts[..i].iter().any(|other| other.name == part.name) {
                self.complain(part.place, format!("the part is there twice (part {:?}). Keep one of them", part.name));
            }
        }
        for volume in volumes().filter(|volume| !model.parts.iter().any(|part| part.name == *volume)) {
            let advice = format!("Add [part.{volume:?}] with a material");
            self.complain(
                model.mesh_place,
                format!("a physical volume of the mesh is no part (volume {volume:?}). {advice}"),
            );
        }
    }

    /// Names of surfaces and node sets exist.
    fn names(&mut self) {
        for fix in &self.model.fixes {
            self.node_set(&fix.nodes, fix.place, "fix");
        }
    }

    /// Whether a surface or node set exists; complains where it does not.
    fn node_set(&mut self, name: &str, place: Place, item: &str) -> bool {
        let mesh = self.mesh;
        if mesh.surfaces.contains_key(name) || mesh.node_sets.contains_key(name) {
            return true;
        }
        let all = mesh.surfaces.keys().chain(mesh.node_sets.keys()).map(String::as_str);
        let advice = names::advice(name, all);
        self.complain(place, format!("the mesh has no surface or node set {name:?} ({item}). {advice}"));
        false
    }

    /// Whether a surface exists; complains where it does not, or is a curve or point.
    fn surface(&mut self, name: &str, place: Place, item: &str) -> bool {
        let mesh = self.mesh;
        if mesh.surfaces.contains_key(name) {
            return true;
        }
        let what = if mesh.node_sets.contains_key(name) {
            format!("{name:?} is a physical curve or point, not a surface ({item})")
        } else {
            format!("the mesh has no physical surface {name:?} ({item})")
        };
        let advice = names::advice(name, mesh.surfaces.keys().map(String::as_str));
        self.complain(place, format!("{what}. {advice}"));
        false
    }

    /// Loads act on something; those by area on surfaces.
    fn loads(&mut self) {
        let model = self.model;
        for load in &model.loads {
            let item = format!("load {:?}", load.name);
            match load.kind {
                LoadKind::ForceByNode(_) | LoadKind::ForceAt { .. } => self.node_set(&load.on, load.place, &item),
                LoadKind::ForceByArea(_) | LoadKind::Pressure(_) => self.surface(&load.on, load.place, &item),
                LoadKind::Gravity(_) => self.gravity(load, &item),
            };
        }
    }

    /// Gravity acts on parts with a density, or on a point mass.
    fn gravity(&mut self, load: &Load, item: &str) -> bool {
        let model = self.model;
        if let Some(part) =
            model.parts.iter().find(|part| load.is_gravity_on(&part.name) && part.material.density == 0.0)
        {
            let what = format!("the material of the part {:?} has no density, so that it has no weight", part.name);
            self.complain(load.place, format!("{what} ({item}). Give its density"));
        }
        let is_part = model.parts.iter().any(|part| part.name == load.on);
        if is_part && model.masses.iter().any(|mass| mass.name == load.on) {
            let what = format!("{:?} is a part and a [[mass]] ({item})", load.on);
            self.complain(load.place, format!("{what}. Give the mass another name"));
        }
        let names = || {
            let masses = model.masses.iter().map(|mass| mass.name.as_str());
            model.parts.iter().map(|part| part.name.as_str()).chain(masses)
        };
        let is_there = names().any(|name| load.is_gravity_on(name));
        if !is_there {
            let what = format!("there is no part or [[mass]] {:?} ({item})", load.on);
            self.complain(load.place, format!("{what}. {}", names::advice(&load.on, names())));
        }
        is_there
    }

    /// Both surfaces lie on one part each, not the same; then what the pair's motion asks for.
    fn contact(&mut self, contact: &Contact) {
        let (place, item) = (contact.place, format!("contact {:?}", contact.name));
        let slave = self.contact_surface(&contact.slave, place, &item);
        let master = self.contact_surface(&contact.master, place, &item);
        let (Some(slave), Some(master)) = (slave, master) else {
            return;
        };
        if slave == master {
            let part = &self.mesh.parts[slave as usize];
            self.complain(
                place,
                format!("slave and master both lie on the part {part:?} ({item}). Name surfaces of two parts"),
            );
            return;
        }
        self.motion(contact, &item);
    }

    /// The one part that a contact surface lies on; complains where there is no such part.
    fn contact_surface(&mut self, name: &str, place: Place, item: &str) -> Option<u32> {
        if !self.skin(name, place, item) {
            return None;
        }
        let mesh = self.mesh;
        let parts = mesh.parts_of_surface(name)?;
        if let [part] = parts[..] {
            return Some(part);
        }
        let on: Vec<&str> = parts.iter().map(|&part| mesh.parts[part as usize].as_str()).collect();
        let what = format!("the surface {name:?} lies on several parts: {} ({item})", on.join(", "));
        self.complain(place, format!("{what}. Make a physical surface for each part, and a contact for each"));
        None
    }

    /// Whether a surface exists and lies on the skin of the parts; complains where it does not.
    fn skin(&mut self, name: &str, place: Place, item: &str) -> bool {
        if !self.surface(name, place, item) {
            return false;
        }
        let (inner, all) = (self.mesh.surfaces[name].inner.len(), self.mesh.surfaces[name].facets.len());
        if inner > 0 {
            let what =
                format!("{inner} of {all} facets of {name:?} lie between two elements, not on the skin ({item})");
            self.complain(place, format!("{what}. Mesh the two parts apart, without common nodes"));
        }
        inner == 0
    }

    /// A pair slides where the master alone turns; all others stick, and need `stick` where they have friction.
    fn motion(&mut self, contact: &Contact, item: &str) {
        let (model, place) = (self.model, contact.place);
        let slave = model.turning(&contact.slave, self.mesh);
        let master = model.turning(&contact.master, self.mesh);
        let message = match (slave, master) {
            (Some(slave), None) => format!(
                "the slave's part {:?} turns, but the turning side must be the master ({item}). Swap slave and master",
                slave.part
            ),
            (Some(slave), Some(master)) if !turn_together(slave, master) => format!(
                "the parts {:?} and {:?} turn differently ({item}). Let one of the two stand still",
                slave.part, master.part
            ),
            (None, Some(master)) if contact.stick.is_some() => format!(
                "the pair slides for ever, as its master's part {:?} turns and its slave does not ({item}). Leave stick out",
                master.part
            ),
            (None, Some(_)) if contact.friction == ROUGH => {
                format!("the pair slides and is rough ({item}). Rough surfaces never slip: give a friction coefficient")
            }
            (None, Some(_)) => return,
            _ if self.model.stick(contact, self.mesh).is_none() && self.model.has_friction(contact) => format!(
                "the pair does not slide and has friction, but no stick ({item}). \
                 Add stick in N/m3, such as half the normal stiffness, or set friction = 0"
            ),
            _ => return,
        };
        self.complain(place, message);
    }

    /// A sweep changes something.
    fn sweep(&mut self) {
        let model = self.model;
        if !model.frictions.is_empty() && model.swept_contacts(self.mesh).is_empty() {
            let what = "no contact slides, so there is none to sweep (sweep)";
            let advice = "Name contacts in it, or add a [[rotation]] of the disc";
            self.complain(model.sweep_place, format!("{what}. {advice}"));
        }
    }
}

/// Whether two rotations give the same velocity field: the same angular velocity, and axes through the same points.
fn turn_together(a: &Rotation, b: &Rotation) -> bool {
    let omega = |r: &Rotation| r.axis.map(|x| x * r.speed);
    let (omega_a, omega_b) = (omega(a), omega(b));
    // The axes coincide where (x_a - x_b) x omega = 0.
    let arm = cross(sub(a.through, b.through), a.axis);
    let same_omega = (0..3).all(|i| (omega_a[i] - omega_b[i]).abs() <= 1e-9 * a.speed.abs());
    same_omega && arm.iter().all(|x| x.abs() <= 1e-9)
}

#[cfg(test)]
mod tests;
