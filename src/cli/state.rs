//! The equilibrium of a brake with its checks, and pictures of it and of modes.

use crate::Result;
use crate::equilibrium::{Balance, Equilibrium};
use crate::native::{Comm, Vector};
use crate::output::contact_surface::{ContactSurface, Fields};
use crate::output::folder::Folder;
use crate::output::vtu::{Cells, Grid, Values};
use crate::stability::Mode;

use super::volume::Drawing;

use crate::assembly::System;
use crate::contact::Response;
use crate::sweep::{Brake, Families};

/// An equilibrium with its balance, ready to be written.
pub struct State {
    /// Displacements of the nodes that this rank has, m.
    pub u: Vec<[f64; 3]>,
    pub balance: Balance,
    pub friction: f64,
}

impl State {
    /// Gathers displacements and adds up forces. Collective.
    pub fn new(brake: &Brake, families: &Families, system: &System, equilibrium: &Equilibrium) -> Result<State> {
        let u = system.nodal(&[&equilibrium.u])?.remove(0);
        let balance = Balance::new(
            system,
            &brake.mesh.nodes,
            &families.list(),
            &brake.loads,
            &brake.interface,
            &u,
            &equilibrium.responses,
        );
        Ok(State { u, balance, friction: equilibrium.friction })
    }

    /// The checks in words: balance of forces and moments, torque of each rotation. Collective.
    pub fn checks(&self, comm: &Comm, brake: &Brake) -> String {
        let [force, moment] = self.balance.residual();
        let clamp = self.balance.pairs.iter().map(|pair| pair.normal.abs()).fold(0.0, f64::max);
        let mut text = format!(
            "loads and supports balance to {force:.1e} N and {moment:.1e} N m (largest contact force {clamp:.1} N)\n\
             moment of contact forces across initial gaps: {:.1e} N m\n",
            crate::algebra::norm(self.balance.across_gaps.moment)
        );
        for rotation in &brake.model.rotations {
            let nodes = part_nodes(brake, &rotation.part);
            let of = |node: u32| nodes[node as usize];
            let held = self.balance.support_torque(comm, &brake.mesh.nodes, of, rotation.through, rotation.axis);
            let friction = -self.friction_torque(brake, rotation);
            text +=
                &format!("torque that holds {}: {held:.3} N m; of friction on it: {friction:.3} N m\n", rotation.part);
        }
        text
    }

    /// Moment that the sliding pairs' friction exerts on a rotating part about its axis, N m: minus that on the slaves.
    pub fn friction_torque(&self, brake: &Brake, rotation: &crate::model::Rotation) -> f64 {
        let pairs = brake.interface.pairs.iter().zip(&self.balance.pairs);
        let own =
            pairs.filter(|(pair, _)| pair.is_sliding() && master_part(brake, &pair.master) == Some(&rotation.part));
        -own.map(|(_, forces)| forces.on_slave.about(rotation.through, rotation.axis)).sum::<f64>()
    }

    /// Writes volume and contact surface as VTU. Collective; the root has the folder.
    pub fn write(&self, comm: &Comm, folder: Option<&Folder>, brake: &Brake, responses: &[Response]) -> Result<()> {
        let contact = ContactSurface::new(&brake.mesh, &brake.interface, responses);
        self.write_volume(comm, folder, brake, &contact.on_mesh(brake.mesh.nodes.len()))?;
        comm.agree(folder.map_or(Ok(()), |folder| self.write_surface(folder, brake, &contact)))
    }

    fn write_volume(&self, comm: &Comm, folder: Option<&Folder>, brake: &Brake, contact: &Fields) -> Result<()> {
        let (drawing, tets) = (Drawing::new(brake), brake.families()?.tets);
        let contact = contact.at(drawing.nodes());
        let u = drawing.at_nodes(&self.u);
        let von_mises = drawing.at_tets(|e| tets.von_mises(e, &self.u));
        let parts = drawing.at_tets(|e| brake.mesh.tet_part[e] as i32);
        let point_data = [("displacement", Values::Vectors(&u))].into_iter().chain(contact.arrays()).collect();
        let cell_data = vec![("part", Values::Integers(&parts)), ("von_mises", Values::Scalars(&von_mises))];
        let name = format!("equilibrium_mu{}", friction_name(self.friction));
        drawing.write(comm, folder, &name, point_data, cell_data)
    }

    fn write_surface(&self, folder: &Folder, brake: &Brake, contact: &ContactSurface) -> Result<()> {
        let of = |values: &[[f64; 3]]| contact.nodes.iter().map(|&n| values[n as usize]).collect::<Vec<_>>();
        let (points, u) = (of(&brake.mesh.nodes), of(&self.u));
        let displacement = [("displacement", Values::Vectors(&u))];
        let grid = Grid {
            points: &points,
            cells: Cells::Triangles(&contact.facets),
            point_data: displacement.into_iter().chain(contact.fields.arrays()).collect(),
            cell_data: vec![("pair", Values::Integers(&contact.pairs))],
        };
        let name = format!("contact_mu{}.vtu", friction_name(self.friction));
        folder.write(&name, |mut out| grid.write(&mut out))
    }
}

/// Name of the part that a surface lies on.
fn master_part<'a>(brake: &'a Brake, surface: &str) -> Option<&'a String> {
    brake.mesh.part_of_surface(surface).map(|part| &brake.mesh.parts[part as usize])
}

fn part_nodes(brake: &Brake, part: &str) -> Vec<bool> {
    let mut inside = vec![false; brake.mesh.nodes.len()];
    let index = brake.mesh.parts.iter().position(|name| name == part);
    for (tet, &p) in brake.mesh.tets.iter().zip(&brake.mesh.tet_part) {
        if Some(p as usize) == index {
            tet.iter().for_each(|&n| inside[n as usize] = true);
        }
    }
    inside
}

/// A friction as file names have it: three digits, more where those would make two values one.
pub fn friction_name(friction: f64) -> String {
    let short = format!("{friction:.3}");
    if short.parse() == Ok(friction) { short } else { friction.to_string() }
}

/// Writes the shape of a mode, real and imaginary part, under its number (from 1). Collective; the root has the folder.
pub fn write_mode(
    folder: Option<&Folder>,
    brake: &Brake,
    system: &System,
    friction: f64,
    (number, mode): (usize, &Mode),
) -> Result<()> {
    let (shape, drawing) = (system.nodal(&[&mode.re, &mode.im])?, Drawing::new(brake));
    let [re, im] = [0, 1].map(|i| drawing.at_nodes(&shape[i]));
    let parts = drawing.at_tets(|e| brake.mesh.tet_part[e] as i32);
    let point_data = vec![("real", Values::Vectors(&re)), ("imaginary", Values::Vectors(&im))];
    let name = mode_name(friction, number, mode);
    drawing.write(system.k.comm(), folder, &name, point_data, vec![("part", Values::Integers(&parts))])
}

/// Name, without its ending, of a mode's file. The number keeps modes apart whose frequencies are nearly the same.
pub fn mode_name(friction: f64, number: usize, mode: &Mode) -> String {
    format!("mode_mu{}_{number:03}_{:.0}Hz", friction_name(friction), mode.frequency())
}

/// Name, without its ending, of the file of the displacement at which a solve gave up.
pub const LAST_STATE: &str = "last_state";

/// Writes the displacement at which a solve gave up. Collective; the root has the folder.
pub fn write_last(folder: Option<&Folder>, brake: &Brake, system: &System, u: &Vector) -> Result<()> {
    let drawing = Drawing::new(brake);
    let u = drawing.at_nodes(&system.nodal(&[u])?[0]);
    drawing.write(system.k.comm(), folder, LAST_STATE, vec![("displacement", Values::Vectors(&u))], vec![])
}
