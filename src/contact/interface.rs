//! The interface: all contact pairs of a model on its mesh, ready to be evaluated point by point.

use super::gap_operator::GapOperator;
use super::law::{self, Friction, FrictionLaw, Response, Status};
use super::search::Team;
use super::surface_points::Place;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::{Model, NormalLaw, names};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Initial gaps up to this are rounding of the mesh, m.
const GAP_ROUNDING: f64 = 1e-12;

/// Contact as the equations see it: points, their laws, and the gap operator that ties them to the bodies.
#[derive(Debug, Clone, Default)]
pub struct Interface {
    /// Contact pairs, in the order of the model.
    pub pairs: Vec<ContactPair>,
    /// Contact points, pair by pair.
    pub points: Vec<ContactPoint>,
    /// `g = B u`; its point `a` is `points[a]`, its nodes are the mesh's.
    pub gap_operator: GapOperator,
}

/// A contact pair.
#[derive(Debug, Clone)]
pub struct ContactPair {
    /// Name in tables.
    pub name: String,
    /// Surface on which the contact points lie.
    pub slave: String,
    /// Surface they meet.
    pub master: String,
    /// Normal law.
    pub law: NormalLaw,
    /// Friction value in the model file: `mu_0` of the friction law.
    pub friction: f64,
    /// How the friction coefficient depends on speed and pressure.
    pub friction_law: FrictionLaw,
    /// What acts in the tangent plane.
    pub kind: TangentialKind,
    /// Whether the pair may open.
    pub separation: bool,
    /// Whether a sweep changes its friction.
    pub swept: bool,
    /// How sliding wears it; none where it does not wear.
    pub wear: Option<ArchardWear>,
    /// Its points in [`Interface::points`].
    pub points: Range<usize>,
    /// What the search found.
    pub statistics: Statistics,
}

impl ContactPair {
    /// Whether the two surfaces slide for ever.
    pub fn is_sliding(&self) -> bool {
        self.kind == TangentialKind::Sliding
    }
}

/// Wear of a pair by Archard's law, `dh/dt = k p v`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ArchardWear {
    /// k, m2/N.
    pub coefficient: f64,
    /// Density of the slave's part, kg/m3; 0 where the slave lies on several.
    pub density: f64,
}

/// What acts in the tangent plane of a pair; [`law::Tangential`] says how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TangentialKind {
    /// Nothing.
    Frictionless,
    /// Sliding for ever: the master turns.
    Sliding,
    /// Elastic stick with a Coulomb bound.
    StickSlip,
}

/// What the search found for a pair.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statistics {
    /// Number of the slave's points that are too far from the master.
    pub n_dropped: usize,
    /// Area of the slave surface, m2.
    pub area: f64,
    /// Sum of the points' weights, m2: the area in contact when all points are closed.
    pub weight: f64,
    /// Smallest and largest initial gap, m, after adjustment.
    pub gap: [f64; 2],
    /// Number of points whose gap was closed by adjustment.
    pub n_adjusted: usize,
    /// The largest gap that was closed so, m.
    pub largest_adjusted: f64,
    /// Number of points that touch before any load.
    pub touching: usize,
}

/// A contact point.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPoint {
    /// Index of its pair.
    pub pair: usize,
    /// The places on the slave surface that it stands for: its own, or the cell of a reference node.
    pub places: Vec<Place>,
    /// The slave's nodes that it moves with. They come first in its gap operator.
    pub nodes: Vec<u32>,
    /// Position of the point, m.
    pub position: [f64; 3],
    /// What a gap field has added to its gap, m.
    pub field_gap: f64,
    /// Its law, with weight, normal and gap.
    pub law: law::PointLaw,
}

impl ContactPoint {
    /// Gives the point the gap (m) of a field in place of that of the field before.
    pub fn set_field_gap(&mut self, gap: f64) {
        self.law.gap += gap - self.field_gap;
        self.field_gap = gap;
    }
}

/// Which law acts.
#[derive(Debug, Clone, PartialEq)]
pub enum Stage {
    /// While the brake is brought together: [`law::settle`].
    Settle,
    /// The true law, with a coefficient of friction for each pair: [`law::respond`].
    Solve {
        /// By pair.
        friction: Vec<f64>,
    },
}

impl Interface {
    /// Finds the contact points of every pair of a model that [`Model::check_against`] accepts; all of the team find
    /// the same.
    ///
    /// A pair slides where its master turns; t is the direction of the master's velocity `omega x (x - through)`.
    ///
    /// ```
    /// use squeal::contact::{Interface, search::Alone};
    /// use squeal::{mesh, model};
    ///
    /// let model = model::read("tests/data/pads_on_disc.toml".as_ref())?;
    /// let mesh = mesh::read(&model.mesh_file, model.mesh_unit)?;
    /// let interface = Interface::build(&model, &mesh, &Alone)?;
    /// assert_eq!(interface.points.len(), 236);
    /// // Pressed into the disc by 10 nm, a point is dragged along with mu p.
    /// let inwards = interface.points[0].law.normal.map(|n| -1e-8 * n);
    /// let answer = interface.respond(0, inwards, &interface.stage(0.4));
    /// let force = answer.force.iter().map(|f| f * f).sum::<f64>().sqrt();
    /// assert!((force / answer.normal_force - 1.0_f64.hypot(0.4)).abs() < 1e-12);
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// With the model file's line: a pair without any point (with the closest distance found), surfaces that share
    /// nodes.
    ///
    /// # Panics
    /// Where a surface is not in the mesh.
    pub fn build(model: &Model, mesh: &Mesh, team: &dyn Team) -> Result<Interface> {
        let mut interface = Interface::default();
        let swept = model.swept_contacts(mesh);
        for (i, contact) in model.contacts.iter().enumerate() {
            super::pairing::add_pair(&mut interface, model, mesh, contact, swept.contains(&i), team)?;
        }
        Ok(interface)
    }

    /// The coefficient of friction of each pair as the model file has it.
    pub fn frictions(&self) -> Vec<f64> {
        self.pairs.iter().map(|pair| pair.friction).collect()
    }

    /// The coefficients of friction with those of the swept pairs at one value.
    pub fn frictions_at(&self, swept: f64) -> Vec<f64> {
        self.pairs.iter().map(|pair| if pair.swept { swept } else { pair.friction }).collect()
    }

    /// Gives a pair another friction law; its friction value stays.
    ///
    /// # Errors
    /// [`Error::Input`] where no pair has this name.
    pub fn set_friction_law(&mut self, pair: &str, law: FrictionLaw) -> Result<()> {
        if let Some(own) = self.pairs.iter_mut().find(|own| own.name == pair) {
            own.friction_law = law;
            return Ok(());
        }
        let advice = names::advice(pair, self.pairs.iter().map(|own| own.name.as_str()));
        Err(Error::input(format!("no contact pair is called {pair:?}. {advice}")))
    }

    /// Multiplies the normal laws of the swept pairs.
    pub fn scale_contact_stiffness(&mut self, factor: f64) {
        for pair in self.pairs.iter_mut().filter(|pair| pair.swept) {
            pair.law = pair.law.times(factor);
            let laws = self.points[pair.points.clone()].iter_mut().map(|point| &mut point.law.normal_law);
            laws.for_each(|law| *law = law.times(factor));
        }
    }

    /// Refuses a pair of a super-element whose friction law is in no file.
    ///
    /// # Errors
    /// [`Error::Input`] that names the pair.
    pub fn require_friction_laws(&self) -> Result<()> {
        match self.pairs.iter().find(|pair| matches!(pair.friction_law, FrictionLaw::Missing)) {
            None => Ok(()),
            Some(pair) => Err(Error::input(format!(
                "contact {:?}: its friction law was a program's own, which the file does not contain. \
                 Analyse it from a program that calls Interface::set_friction_law",
                pair.name
            ))),
        }
    }

    /// Whether forces are proportional to displacements, `f(s g) = s f(g)` for all `s > 0`, with the same status:
    /// normal laws are linear, initial gaps are zero where points may open, and friction does not depend on the
    /// pressure. Then an equilibrium without prescribed displacements is proportional to the loads, `u(s F) = s u(F)`.
    pub fn is_homogeneous(&self) -> bool {
        let has_offset = |point: &ContactPoint| point.law.penetration([0.0; 3]).abs() > GAP_ROUNDING;
        let is_linear = |point: &ContactPoint| matches!(point.law.normal_law, NormalLaw::Linear { .. });
        self.points.iter().all(|point| is_linear(point) && !has_offset(point))
            && !self.pairs.iter().any(|pair| pair.friction_law.depends_on_pressure())
    }

    /// The true laws with the swept pairs' friction at one value.
    pub fn stage(&self, swept: f64) -> Stage {
        Stage::Solve { friction: self.frictions_at(swept) }
    }

    /// What point `a` answers to its relative displacement g (m, from [`GapOperator::gap`]).
    ///
    /// # Panics
    /// Where `a` is no point or the stage has not one friction value a pair, as the methods below.
    pub fn respond(&self, a: usize, g: [f64; 3], stage: &Stage) -> Response {
        let point = &self.points[a];
        match stage {
            Stage::Settle => law::settle(&point.law, g),
            Stage::Solve { friction } => law::respond(&point.law, self.friction(point, friction), g),
        }
    }

    /// Tangent D (N/m, by rows) of point `a` for stability, its status frozen: [`law::linearise`].
    pub fn linearise(&self, a: usize, g: [f64; 3], status: Status, friction: &[f64]) -> [[f64; 3]; 3] {
        let point = &self.points[a];
        law::linearise(&point.law, self.friction(point, friction), g, status)
    }

    /// Friction damping block (N s/m, by rows) of point `a` under its normal force (N): [`law::friction_damping`].
    pub fn friction_damping(&self, a: usize, normal_force: f64, friction: &[f64]) -> [[f64; 3]; 3] {
        let point = &self.points[a];
        law::friction_damping(&point.law, self.friction(point, friction), normal_force)
    }

    /// Friction value and law of a point's pair.
    fn friction(&self, point: &ContactPoint, values: &[f64]) -> Friction<'_> {
        Friction { value: values[point.pair], law: &self.pairs[point.pair].friction_law }
    }
}

#[cfg(test)]
mod tests;
