//! What the computing commands are run on: a model, or the super-element of one.
//!
//! The two differ in how they are read and assembled, and in what can be drawn of an equilibrium or a mode.

use num_complex::Complex64;

use crate::assembly::System;
use crate::contact::{Interface, Response};
use crate::equilibrium::{Equilibrium, PairForces};
use crate::hdf::is_hdf5;
use crate::model::NormalLaw;
use crate::native::{Comm, Vector};
use crate::output::folder::Folder;
use crate::results::{About, ContactFaces, Pair, Shape};
use crate::stability::{Complex, Mode};
use crate::sweep::{Brake, Source, Sweep};
use crate::{Error, Result};

use super::Run;
use super::motion::Motion;
use super::reduced::ReducedBrake;

/// What is told of an equilibrium.
pub struct Told {
    /// Forces of the pairs, in the interface's order.
    pub pairs: Vec<PairForces>,
    /// Checks in words, a line each.
    pub checks: String,
}

/// A brake in whatever form.
pub trait Subject {
    /// What is known of it before anything is computed: title, files, sizes, parts and pairs. Collective.
    fn about(&self, comm: &Comm) -> Result<About>;
    fn interface(&self) -> &Interface;
    /// The band to analyse (Hz), given the one asked for.
    fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2]>;
    fn friction_damping(&self) -> bool;
    fn frictions(&self, asked: Option<&[f64]>) -> Result<Vec<f64>>;
    /// Collective.
    fn assemble(&self, comm: &Comm) -> Result<System>;
    /// How its outer surface moves. Collective.
    fn motion<'s>(&'s self, system: &'s System) -> Result<Box<dyn Motion + 's>>;
    /// Where contact is known.
    fn contact_faces(&self) -> ContactFaces;
    /// Pressure (Pa) and status there.
    fn contact_fields(&self, responses: &[Response]) -> (Vec<f64>, Vec<i32>);
    /// Tells an equilibrium, and draws it where there is a folder. Collective.
    fn tell(&self, folder: Option<&Folder>, system: &System, equilibrium: &Equilibrium) -> Result<Told>;
    /// Draws a mode. Collective.
    fn draw(&self, folder: Option<&Folder>, system: &System, friction: f64, mode: &Drawn) -> Result<()>;
    /// Explains a mode, given by its eigenvalue and right vector, and its left vector. Collective.
    fn explain(
        &self,
        sweep: &mut Sweep,
        equilibrium: &Equilibrium,
        mode: (Complex64, Complex),
        left: Complex,
    ) -> Result<Vec<Source>>;
    /// The super-element that this is about an equilibrium. Collective.
    fn reduce(&self, system: &System, equilibrium: &Equilibrium) -> Result<Box<dyn Subject>>;
    /// A line for each of this rank's equations: `kind,node,axis,x,y,z`. Not collective.
    fn rows(&self, system: &System) -> Vec<String>;
    /// Draws the displacement at which a solve gave up, and gives the file's name. Collective.
    fn draw_last(&self, folder: Option<&Folder>, system: &System, u: &Vector) -> Result<String>;
}

/// A mode to be drawn.
pub struct Drawn<'a> {
    /// Its number in the band, from 1.
    pub number: usize,
    pub mode: &'a Mode,
    /// On the outer surface; only the root has it.
    pub shape: &'a Shape,
}

/// Reads and checks what a command is run on. Collective.
pub fn read(comm: &Comm, run: &Run) -> Result<Box<dyn Subject>> {
    if is_hdf5(&run.model) {
        return Ok(Box::new(ReducedBrake::read(comm, run)?));
    }
    if run.law.is_some() || run.pressure != 1.0 {
        let what = "--law and --pressure are for super-elements";
        return Err(Error::input(format!("{what}; {} is a model, which has both in its file", run.model.display())));
    }
    let brake = Brake::read_reduced(comm, &run.model, run.contacts)?;
    brake.require_held(comm)?;
    Ok(Box::new(brake))
}

/// The pairs of an interface, as results know them.
pub fn pairs(interface: &Interface) -> Vec<Pair> {
    let of = |pair: &crate::contact::ContactPair| Pair {
        name: pair.name.clone(),
        sliding: pair.is_sliding(),
        swept: pair.swept,
        n_points: pair.points.len(),
    };
    interface.pairs.iter().map(of).collect()
}

/// `linear:K` or `cubic:K1,K3`, of node-to-node contacts, in N/m and N/m3.
pub fn law(text: &str) -> std::result::Result<NormalLaw, String> {
    let wanted = "give linear:K in N/m, or cubic:K1,K3 in N/m and N/m3";
    let (kind, numbers) = text.split_once(':').ok_or_else(|| format!("the law has no coefficients: {wanted}"))?;
    let values: Vec<f64> = numbers.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let are_good = values.len() == numbers.split(',').count() && values.iter().all(|k| *k > 0.0 && k.is_finite());
    match (kind, &values[..]) {
        ("linear", &[stiffness]) if are_good => Ok(NormalLaw::Linear { stiffness }),
        ("cubic", &[k1, k3]) if are_good => Ok(NormalLaw::Cubic { k1, k3 }),
        ("linear", _) => Err(format!("a linear law needs one coefficient above 0: {wanted}")),
        ("cubic", _) => Err(format!("a cubic law needs two coefficients above 0: {wanted}")),
        _ => Err(format!("unknown law {kind:?}: {wanted}")),
    }
}

/// A factor on the loads.
pub fn pressure(text: &str) -> std::result::Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
        _ => Err(format!("{text:?} is not a number above 0: give the loads as a multiple of the model's")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_need_their_coefficients() {
        assert_eq!(law("cubic:1e8,2e18").unwrap(), NormalLaw::Cubic { k1: 1e8, k3: 2e18 });
        assert_eq!(law("linear:3").unwrap(), NormalLaw::Linear { stiffness: 3.0 });
        for (text, reason) in [
            ("cubic", "no coefficients"),
            ("cubic:1e8", "two coefficients"),
            ("cubic:1e8,x", "two coefficients"),
            ("cubic:1e8,-1", "two coefficients"),
            ("linear:1,2", "one coefficient"),
            ("square:1", "unknown law"),
        ] {
            assert!(law(text).unwrap_err().contains(reason), "{text}");
        }
        assert!(pressure("0").is_err() && pressure("nan").is_err());
        assert_eq!(pressure("1.5"), Ok(1.5));
    }
}
