//! Equilibria and modes as VTU files: volumes and contact surfaces of full models, outer surfaces of super-elements.

use crate::Result;
use crate::assembly::System;
use crate::contact::Response;
use crate::equilibrium::Equilibrium;
use crate::native::Vector;
use crate::results::Shape;
use crate::stability::Mode;
use crate::structure::contact_surface::{ContactSurface, Fields};
use crate::structure::{FullModel, ReducedModel, Structure, coordinates};

use super::folder::Folder;
use super::volume::Volume;
use super::vtu::{Array, Cells, Grid, Values};

/// Name, without its ending, of the file of the displacement at which a solve gave up.
const LAST_STATE: &str = "last_state";

/// Writes fields of one system into a folder, which the root has; without a folder nothing is written. All methods are
/// collective.
#[derive(Clone, Copy)]
pub struct FieldWriter<'a> {
    /// What was analysed.
    pub structure: &'a Structure,
    /// Its dofs.
    pub system: &'a System,
    /// The root's folder.
    pub folder: Option<&'a Folder>,
}

impl FieldWriter<'_> {
    /// Writes displacements, stresses and contact results of an equilibrium: `equilibrium_muMU.vtu`,
    /// `contact_muMU.vtu`.
    ///
    /// # Errors
    /// The system's, with the file's path; PETSc's.
    pub fn equilibrium(&self, equilibrium: &Equilibrium) -> Result<()> {
        let name = format!("equilibrium_mu{}", friction_name(equilibrium.friction));
        match self.structure {
            Structure::Full(full) => self.full_equilibrium(full, &name, equilibrium),
            Structure::Reduced(reduced) => self.outer_displacement(reduced, &name, &equilibrium.u),
        }
    }

    /// Writes the real and imaginary part of a mode, given with its number in the band (from 1) and its shape on the
    /// outer surface.
    ///
    /// # Errors
    /// The system's, with the file's path; PETSc's.
    pub fn mode(&self, friction: f64, number: usize, mode: &Mode, shape: &Shape) -> Result<()> {
        let name = mode_name(friction, number, mode);
        match self.structure {
            Structure::Full(full) => {
                let (vectors, volume) = (self.system.nodal(&[&mode.re, &mode.im])?, Volume::new(full));
                let [re, im] = [0, 1].map(|i| volume.at_nodes(&vectors[i]));
                let fields = vec![("real", Values::Vectors(&re)), ("imaginary", Values::Vectors(&im))];
                let parts = volume.at_elements(|e| full.mesh.elements.get(e).part as i32);
                self.volume(&volume, &name, fields, vec![("part", Values::Integers(&parts))])
            }
            Structure::Reduced(reduced) => {
                let double = |part: &[[f32; 3]]| part.iter().map(|u| u.map(f64::from)).collect::<Vec<_>>();
                let (re, im) = (double(&shape.re), double(&shape.im));
                self.outer_surface(reduced, &name, || vec![("real", re), ("imaginary", im)])
            }
        }
    }

    /// Writes the displacement at which a solve gave up; gives the file's name.
    ///
    /// # Errors
    /// The system's, with the file's path; PETSc's.
    pub fn last_state(&self, u: &Vector) -> Result<String> {
        match self.structure {
            Structure::Full(full) => {
                let volume = Volume::new(full);
                let u = volume.at_nodes(&full.displacements(self.system, u)?);
                self.volume(&volume, LAST_STATE, vec![("displacement", Values::Vectors(&u))], vec![])?;
            }
            Structure::Reduced(reduced) => self.outer_displacement(reduced, LAST_STATE, u)?,
        }
        let ending = if self.system.k.comm().size() == 1 { "vtu" } else { "pvtu" };
        Ok(format!("{LAST_STATE}.{ending}"))
    }

    fn full_equilibrium(&self, full: &FullModel, name: &str, equilibrium: &Equilibrium) -> Result<()> {
        let u = full.displacements(self.system, &equilibrium.u)?;
        let surface = ContactSurface::new(&full.mesh, &full.interface, &equilibrium.responses);
        let (volume, solids) = (Volume::new(full), full.families()?.solids);
        let contact = surface.on_mesh(full.mesh.nodes.len()).at(volume.nodes());
        let displacement = volume.at_nodes(&u);
        let von_mises = volume.at_elements(|e| solids.von_mises(e, &u));
        let parts = volume.at_elements(|e| full.mesh.elements.get(e).part as i32);
        let displacement = [("displacement", Values::Vectors(&displacement))];
        let point_data = displacement.into_iter().chain(contact_arrays(&contact)).collect();
        let cell_data = vec![("part", Values::Integers(&parts)), ("von_mises", Values::Scalars(&von_mises))];
        self.volume(&volume, name, point_data, cell_data)?;
        let contact = format!("contact_mu{}", friction_name(equilibrium.friction));
        let write = |folder| write_contact(folder, full, &surface, &u, &contact);
        self.system.k.comm().agree(self.folder.map_or(Ok(()), write))
    }

    fn volume(&self, volume: &Volume, name: &str, point_data: Vec<Array>, cell_data: Vec<Array>) -> Result<()> {
        volume.write(self.system.k.comm(), self.folder, name, point_data, cell_data)
    }

    fn outer_displacement(&self, reduced: &ReducedModel, name: &str, u: &Vector) -> Result<()> {
        let q = coordinates(self.system, &[u])?;
        self.outer_surface(reduced, name, || {
            vec![("displacement", reduced.surface.displacements(&[&q[0]]).swap_remove(0))]
        })
    }

    /// Writes a super-element's outer surface with displacements of its nodes.
    fn outer_surface(
        &self,
        reduced: &ReducedModel,
        name: &str,
        fields: impl FnOnce() -> Vec<(&'static str, Vec<[f64; 3]>)>,
    ) -> Result<()> {
        let write = |folder: &Folder| {
            let (surface, fields) = (&reduced.surface, fields());
            let grid = Grid {
                points: &surface.nodes,
                cells: Cells::Patches(&surface.triangles),
                point_data: fields.iter().map(|(name, values)| (*name, Values::Vectors(values))).collect(),
                cell_data: vec![("part", Values::Integers(&surface.part))],
            };
            folder.write(&format!("{name}.vtu"), |mut out| grid.write(&mut out))
        };
        self.system.k.comm().agree(self.folder.map_or(Ok(()), write))
    }
}

/// Writes the shape of a free mode, given with its number from 1. Collective; the root has the folder.
///
/// # Errors
/// The system's, with the file's path; PETSc's.
pub fn write_free_mode(
    folder: Option<&Folder>,
    part: &FullModel,
    system: &System,
    number: usize,
    mode: &Mode,
) -> Result<()> {
    let volume = Volume::new(part);
    let shape = volume.at_nodes(&system.nodal(&[&mode.re])?[0]);
    let name = format!("mode_{number:03}_{:.0}Hz", mode.frequency());
    volume.write(system.k.comm(), folder, &name, vec![("real", Values::Vectors(&shape))], Vec::new())
}

/// Writes the contact surfaces of an equilibrium, given by its displacements and responses. Collective; the root has
/// the folder.
///
/// # Errors
/// The system's, with the file's path; PETSc's.
pub fn write_contact_state(
    folder: Option<&Folder>,
    full: &FullModel,
    system: &System,
    (u, responses): (&Vector, &[Response]),
    name: &str,
) -> Result<()> {
    let u = full.displacements(system, u)?;
    let surface = ContactSurface::new(&full.mesh, &full.interface, responses);
    let write = |folder| write_contact(folder, full, &surface, &u, name);
    system.k.comm().agree(folder.map_or(Ok(()), write))
}

/// Writes the contact surfaces alone.
fn write_contact(
    folder: &Folder,
    full: &FullModel,
    surface: &ContactSurface,
    u: &[[f64; 3]],
    name: &str,
) -> Result<()> {
    let of = |values: &[[f64; 3]]| surface.nodes.iter().map(|&n| values[n as usize]).collect::<Vec<_>>();
    let (points, u) = (of(&full.mesh.nodes), of(u));
    let displacement = [("displacement", Values::Vectors(&u))];
    let grid = Grid {
        points: &points,
        cells: Cells::Facets(&surface.facets),
        point_data: displacement.into_iter().chain(contact_arrays(&surface.fields)).collect(),
        cell_data: vec![("pair", Values::Integers(&surface.pairs))],
    };
    folder.write(&format!("{name}.vtu"), |mut out| grid.write(&mut out))
}

fn contact_arrays(fields: &Fields) -> [Array<'_>; 3] {
    [
        ("contact_pressure", Values::Scalars(&fields.pressure)),
        ("contact_traction", Values::Vectors(&fields.traction)),
        ("contact_status", Values::Integers(&fields.status)),
    ]
}

/// A friction coefficient as file names have it: three digits, more where those would make two values one.
fn friction_name(friction: f64) -> String {
    let short = format!("{friction:.3}");
    if short.parse() == Ok(friction) { short } else { friction.to_string() }
}

/// Name, without its ending, of a mode's file. The number keeps modes apart whose frequencies are nearly the same.
fn mode_name(friction: f64, number: usize, mode: &Mode) -> String {
    format!("mode_mu{}_{number:03}_{:.0}Hz", friction_name(friction), mode.frequency())
}
