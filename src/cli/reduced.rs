//! A super-element as what a command is run on.

use std::path::{Path, PathBuf};

use num_complex::Complex64;

use crate::assembly::System;
use crate::contact::{Interface, Response};
use crate::equilibrium::{Equilibrium, PairForces};
use crate::model::NormalLaw;
use crate::native::{Comm, Vector};
use crate::output::contact_surface;
use crate::output::folder::Folder;
use crate::output::vtu::{Cells, Grid, Values};
use crate::reduction::file;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{Member, SuperElement};
use crate::results::{About, ContactFaces, Part};
use crate::stability::Complex;
use crate::sweep::{Kind, Source, Sweep, digest, frictions_of};
use crate::{Error, Result};

use super::Run;
use super::motion::{Motion, ReducedMotion, coordinates};
use super::state;
use super::subject::{self, Drawn, Subject, Told};

/// A super-element under a law and loads.
pub struct ReducedBrake {
    place: PathBuf,
    element: SuperElement,
    surface: OuterSurface,
    interface: Interface,
    pressure: f64,
}

impl ReducedBrake {
    /// Reads the file of a super-element. Collective.
    ///
    /// # Errors
    /// See [`file::read`]; where arguments are for models.
    pub fn read(comm: &Comm, run: &Run) -> Result<ReducedBrake> {
        if run.contacts.is_some() {
            let what = "a super-element has its contacts already; --contacts is for models";
            return Err(Error::input(format!("{}: {what}", run.model.display())));
        }
        let (element, surface) = comm.agree(file::read(&run.model))?;
        Ok(ReducedBrake::new(&run.model, element, surface, run.law, run.pressure))
    }

    /// A super-element under a law, its own if none is given, and a multiple of its loads.
    pub fn new(
        file: &Path,
        element: SuperElement,
        surface: OuterSurface,
        law: Option<NormalLaw>,
        pressure: f64,
    ) -> ReducedBrake {
        let interface = element.interface(law);
        ReducedBrake { place: file.to_owned(), element, surface, interface, pressure }
    }

    /// Draws the outer surface under a displacement. Collective; the root has the folder and writes.
    fn write_displacement(&self, system: &System, folder: Option<&Folder>, name: &str, u: &Vector) -> Result<()> {
        let q = coordinates(system, &[u])?;
        let write = |folder| {
            let displacement = self.surface.displacements(&[&q[0]]);
            self.write(folder, name, &[("displacement", &displacement[0])])
        };
        system.k.comm().agree(folder.map_or(Ok(()), write))
    }

    /// Writes the outer surface with displacements of its nodes. Not collective.
    fn write(&self, folder: &Folder, name: &str, fields: &[(&str, &[[f64; 3]])]) -> Result<()> {
        let surface = &self.surface;
        let grid = Grid {
            points: &surface.nodes,
            cells: Cells::Patches(&surface.triangles),
            point_data: fields.iter().map(|(name, values)| (*name, Values::Vectors(values))).collect(),
            cell_data: vec![("part", Values::Integers(&surface.part))],
        };
        folder.write(name, |mut out| grid.write(&mut out))
    }
}

impl Subject for ReducedBrake {
    fn about(&self, comm: &Comm) -> Result<About> {
        let origin = &self.element.origin;
        let file = if comm.is_root() && self.place.is_file() { digest(&self.place) } else { Ok(String::new()) };
        Ok(About {
            title: origin.title.clone(),
            model: self.place.display().to_string(),
            model_digest: comm.agree(file)?,
            mesh: origin.mesh.clone(),
            mesh_digest: origin.mesh_hash.clone(),
            parts: self.surface.parts.iter().map(|name| Part { name: name.clone(), ..Part::default() }).collect(),
            pairs: subject::pairs(&self.interface),
            ..About::default()
        })
    }

    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2]> {
        let band = asked.unwrap_or(self.element.origin.band);
        if let Some(warning) = self.element.require_band(band)? {
            eprintln!("warning: {}: {warning}", self.place.display());
        }
        Ok(band)
    }

    fn friction_damping(&self) -> bool {
        self.element.origin.friction_damping
    }

    fn frictions(&self, asked: Option<&[f64]>) -> Result<Vec<f64>> {
        frictions_of(asked, &[self.element.origin.friction], &self.interface, &self.place)
    }

    fn assemble(&self, comm: &Comm) -> Result<System> {
        self.element.assemble(comm, &self.interface, self.pressure)
    }

    fn motion<'s>(&'s self, system: &'s System) -> Result<Box<dyn Motion + 's>> {
        Ok(Box::new(ReducedMotion::new(&self.surface, system)))
    }

    fn contact_faces(&self) -> ContactFaces {
        let points = &self.element.contacts;
        ContactFaces {
            nodes: points.iter().map(|contact| contact.point.position).collect(),
            pair_of_node: points.iter().map(|contact| contact.point.pair as i32).collect(),
            ..ContactFaces::default()
        }
    }

    fn contact_fields(&self, responses: &[Response]) -> (Vec<f64>, Vec<i32>) {
        // Under a law of its own a contact has no area; that of the super-element has.
        let areas = self.element.contacts.iter().map(|contact| contact.point.law.weight);
        responses.iter().zip(areas).map(|(r, area)| (r.normal_force / area, contact_surface::status(r))).unzip()
    }

    fn tell(&self, folder: Option<&Folder>, system: &System, equilibrium: &Equilibrium) -> Result<Told> {
        let name = format!("equilibrium_mu{}.vtu", state::friction_name(equilibrium.friction));
        self.write_displacement(system, folder, &name, &equilibrium.u)?;
        Ok(Told { pairs: PairForces::all(&self.interface, &equilibrium.responses), checks: String::new() })
    }

    fn draw(&self, folder: Option<&Folder>, system: &System, friction: f64, drawn: &Drawn) -> Result<()> {
        let Drawn { number, mode, shape } = *drawn;
        let name = format!("{}.vtu", state::mode_name(friction, number, mode));
        let write = |folder| {
            let [re, im] = [&shape.re, &shape.im].map(|part| part.iter().map(|u| u.map(f64::from)).collect::<Vec<_>>());
            self.write(folder, &name, &[("real", &re), ("imaginary", &im)])
        };
        system.k.comm().agree(folder.map_or(Ok(()), write))
    }

    fn explain(
        &self,
        sweep: &mut Sweep,
        equilibrium: &Equilibrium,
        mode: (Complex64, Complex),
        left: Complex,
    ) -> Result<Vec<Source>> {
        let named = [(Kind::Part, "super-element".to_owned())];
        let member = Member::new(&self.element);
        sweep.explain((&[(&member, &|_| 0)], &named), equilibrium, mode, Some(left))
    }

    fn reduce(&self, _: &System, _: &Equilibrium) -> Result<Box<dyn Subject>> {
        Err(Error::input(format!("{} is a super-element; --anew makes them of a model", self.place.display())))
    }

    fn rows(&self, system: &System) -> Vec<String> {
        let points = &self.element.points;
        let n_interface = points.len() * 3 + self.element.frequencies.len();
        let coordinate = |i: usize| match points.get(i / 3) {
            Some([x, y, z]) => format!("point,{},{},{x:e},{y:e},{z:e}", i / 3 + 1, ["x", "y", "z"][i % 3]),
            None if i < n_interface => format!("fixed-interface mode,{},,,,", i + 1 - 3 * points.len()),
            None => format!("inertia mode,{},,,,", i + 1 - n_interface),
        };
        let of = |node: u32| {
            let free = (0..3).filter(move |&i| system.dofs.node_dofs(node)[i] >= 0);
            free.map(move |i| 3 * node as usize + i)
        };
        system.dofs.owned_nodes().flat_map(of).map(coordinate).collect()
    }

    fn draw_last(&self, folder: Option<&Folder>, system: &System, u: &Vector) -> Result<String> {
        let name = format!("{}.vtu", state::LAST_STATE);
        self.write_displacement(system, folder, &name, u)?;
        Ok(name)
    }
}
