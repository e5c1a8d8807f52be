//! What a computing command can be run on: a brake with its mesh, or a super-element. Both give a system and an interface; they
//! differ in what can be told and drawn of an equilibrium or a mode.

use std::path::Path;

use num_complex::Complex64;

use crate::assembly::System;
use crate::contact::Interface;
use crate::equilibrium::{Equilibrium, PairForces};
use crate::hdf::is_hdf5;
use crate::model::NormalLaw;
use crate::petsc::{Comm, Vector};
use crate::reduction::file;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{Member, SuperElement};
use crate::report::folder::Folder;
use crate::report::vtu::{Cells, Grid, Values};
use crate::stability::{Complex, Mode};
use crate::sweep::{Brake, Kind, Source, Sweep, frictions_of};
use crate::{Error, Result};

use super::Run;
use super::results::{self, State};

/// What is told of an equilibrium.
pub struct Told {
    /// Forces of the pairs, in the interface's order.
    pub pairs: Vec<PairForces>,
    /// Checks in words, a line each.
    pub checks: String,
}

/// A brake in whatever form.
pub trait Subject {
    fn title(&self) -> &str;
    fn interface(&self) -> &Interface;
    /// The band to analyse (Hz), given the one asked for.
    fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2]>;
    fn friction_damping(&self) -> bool;
    fn frictions(&self, asked: Option<&[f64]>) -> Result<Vec<f64>>;
    /// Collective.
    fn assemble(&self, comm: &Comm) -> Result<System>;
    /// Tells an equilibrium, and draws it where there is a folder. Collective.
    fn tell(&self, folder: Option<&Folder>, system: &System, equilibrium: &Equilibrium) -> Result<Told>;
    /// Draws a mode with its number, from 1. Collective.
    fn draw(&self, folder: Option<&Folder>, system: &System, friction: f64, mode: (usize, &Mode)) -> Result<()>;
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
    /// Draws the displacement at which a solve gave up, and gives the file's name. Collective.
    fn draw_last(&self, folder: Option<&Folder>, system: &System, u: &Vector) -> Result<String>;
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

impl Subject for Brake {
    fn title(&self) -> &str {
        &self.model.title
    }

    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2]> {
        Ok(asked.unwrap_or(self.model.band))
    }

    fn friction_damping(&self) -> bool {
        self.model.friction_damping
    }

    fn frictions(&self, asked: Option<&[f64]>) -> Result<Vec<f64>> {
        Brake::frictions(self, asked)
    }

    fn assemble(&self, comm: &Comm) -> Result<System> {
        Brake::assemble(self, comm, &self.families()?)
    }

    fn tell(&self, folder: Option<&Folder>, system: &System, equilibrium: &Equilibrium) -> Result<Told> {
        let (state, comm) = (State::new(self, &self.families()?, system, equilibrium)?, system.k.comm());
        state.write(comm, folder, self, &equilibrium.responses)?;
        Ok(Told { checks: state.checks(comm, self), pairs: state.balance.pairs })
    }

    fn draw(&self, folder: Option<&Folder>, system: &System, friction: f64, mode: (usize, &Mode)) -> Result<()> {
        results::write_mode(folder, self, system, friction, mode)
    }

    fn explain(
        &self,
        sweep: &mut Sweep,
        equilibrium: &Equilibrium,
        mode: (Complex64, Complex),
        left: Complex,
    ) -> Result<Vec<Source>> {
        Brake::explain(self, sweep, equilibrium, mode, Some(left))
    }

    fn reduce(&self, system: &System, equilibrium: &Equilibrium) -> Result<Box<dyn Subject>> {
        let limit = self.reduction_limit();
        let (element, surface, _) = Brake::reduce(self, system.k.comm(), system, equilibrium, limit, &mut |_| ())?;
        Ok(Box::new(ReducedBrake::new(&self.model.file, element, surface, None, 1.0)))
    }

    fn draw_last(&self, folder: Option<&Folder>, system: &System, u: &Vector) -> Result<String> {
        results::write_last(folder, self, system, u)?;
        let ending = if system.k.comm().size() == 1 { "vtu" } else { "pvtu" };
        Ok(format!("{}.{ending}", results::LAST_STATE))
    }
}

/// A super-element under a law and loads.
struct ReducedBrake {
    place: String,
    element: SuperElement,
    surface: OuterSurface,
    interface: Interface,
    pressure: f64,
}

impl ReducedBrake {
    fn read(comm: &Comm, run: &Run) -> Result<ReducedBrake> {
        if run.contacts.is_some() {
            let what = "a super-element has its contacts already; --contacts is for models";
            return Err(Error::input(format!("{}: {what}", run.model.display())));
        }
        let (element, surface) = comm.agree(file::read(&run.model))?;
        Ok(ReducedBrake::new(&run.model, element, surface, run.law, run.pressure))
    }

    fn new(
        file: &Path,
        element: SuperElement,
        surface: OuterSurface,
        law: Option<NormalLaw>,
        pressure: f64,
    ) -> ReducedBrake {
        let interface = element.interface(law);
        ReducedBrake { place: file.display().to_string(), element, surface, interface, pressure }
    }

    /// The generalised coordinates, of which held ones are zero.
    fn coordinates(&self, system: &System, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        Ok(system.nodal(vectors)?.into_iter().map(|nodes| nodes.as_flattened().to_vec()).collect())
    }

    /// Draws the outer surface under some coordinates. Collective; the root has the folder and writes.
    fn write(&self, system: &System, folder: Option<&Folder>, name: &str, fields: &[(&str, &Vec<f64>)]) -> Result<()> {
        let written = folder.map_or(Ok(()), |folder| self.write_surface(folder, name, fields));
        system.k.comm().agree(written)
    }

    fn write_surface(&self, folder: &Folder, name: &str, fields: &[(&str, &Vec<f64>)]) -> Result<()> {
        let surface = &self.surface;
        let fields: Vec<_> = fields.iter().map(|(name, q)| (*name, surface.displacements(q))).collect();
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
    fn title(&self) -> &str {
        &self.element.origin.title
    }

    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2]> {
        let band = asked.unwrap_or(self.element.origin.band);
        if let Some(warning) = self.element.require_band(band)? {
            eprintln!("warning: {}: {warning}", self.place);
        }
        Ok(band)
    }

    fn friction_damping(&self) -> bool {
        self.element.origin.friction_damping
    }

    fn frictions(&self, asked: Option<&[f64]>) -> Result<Vec<f64>> {
        frictions_of(asked, &[self.element.origin.friction], &self.interface, Path::new(&self.place))
    }

    fn assemble(&self, comm: &Comm) -> Result<System> {
        self.element.assemble(comm, &self.interface, self.pressure)
    }

    fn tell(&self, folder: Option<&Folder>, system: &System, equilibrium: &Equilibrium) -> Result<Told> {
        let q = self.coordinates(system, &[&equilibrium.u])?;
        let name = format!("equilibrium_mu{}.vtu", results::friction_name(equilibrium.friction));
        self.write(system, folder, &name, &[("displacement", &q[0])])?;
        Ok(Told { pairs: PairForces::all(&self.interface, &equilibrium.responses), checks: String::new() })
    }

    fn draw(&self, folder: Option<&Folder>, system: &System, friction: f64, mode: (usize, &Mode)) -> Result<()> {
        let (number, mode) = mode;
        let q = self.coordinates(system, &[&mode.re, &mode.im])?;
        let name = format!("{}.vtu", results::mode_name(friction, number, mode));
        self.write(system, folder, &name, &[("real", &q[0]), ("imaginary", &q[1])])
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
        Err(Error::input(format!("{} is a super-element; --anew makes them of a model", self.place)))
    }

    fn draw_last(&self, folder: Option<&Folder>, system: &System, u: &Vector) -> Result<String> {
        let (q, name) = (self.coordinates(system, &[u])?, format!("{}.vtu", results::LAST_STATE));
        self.write(system, folder, &name, &[("displacement", &q[0])])?;
        Ok(name)
    }
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
