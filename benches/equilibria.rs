//! Equilibria at the points of a study, each from rest and from the point before: `cargo bench --bench equilibria`, or
//! `cargo bench --bench equilibria -- study.toml`. Of each it prints the steps, Newton's iterations, factorisations,
//! right-hand sides and seconds, and how far the two displacements are apart; at the end how many converged, and the
//! largest numbers.
//!
//! Not a timed test: it prints figures and judges nothing.

use std::time::Instant;

use squeal::analysis::Sweep;
use squeal::assembly::System;
use squeal::equilibrium::{Equilibrium, Step};
use squeal::explore::{self, Nominal, Template};
use squeal::native::{Session, Vector};
use squeal::structure::{ModelVariants, Structure};

/// What the equilibria from one kind of start took.
#[derive(Default)]
struct Totals {
    n: usize,
    n_converged: usize,
    n_iterations: usize,
    most_iterations: usize,
    most_factorisations: usize,
}

fn main() -> squeal::Result<()> {
    let asked = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let study = explore::read(asked.unwrap_or_else(|| "meshes/equilibria.toml".into()).as_ref())?;
    let comm = Session::start(&[])?;
    let variants = ModelVariants::read(&comm, &study.model)?;
    let nominal = Nominal { model: &variants.model, swept: &variants.swept };
    let template = Template::new(&variants.text, &study.parameters, nominal)?;
    let distributions: Vec<_> = study.parameters.iter().map(|own| &own.distribution).collect();
    println!("point   from  converged steps failed iterations factorisations columns seconds  apart");
    let (mut last, mut totals) = (None::<Vector>, [Totals::default(), Totals::default()]);
    for (number, values) in study.design.points(&distributions, &template.nominal())?.iter().enumerate() {
        let brake = variants.brake(&comm, &template.text(values, None, &variants.file)?, study.contacts)?;
        let structure = Structure::Full(Box::new(brake));
        let system = structure.assemble(&comm)?;
        let [from_rest, from_before] = &mut totals;
        let (found, text) = equilibrium(&structure, &system, None, from_rest)?;
        println!("{number:5}   rest {text}");
        if let (Some(found), Some(last)) = (&found, &last) {
            let (other, text) = equilibrium(&structure, &system, Some(last), from_before)?;
            let mut apart = found.u.duplicate()?;
            other.as_ref().map_or(Ok(()), |other| apart.axpy(-1.0, &other.u))?;
            println!("{number:5} before {text}  {:.1e}", apart.norm()? / found.u.norm()?);
        }
        last = found.map(|found| found.u);
    }
    for (Totals { n, n_converged, n_iterations, most_iterations, most_factorisations }, start) in
        totals.iter().zip(["rest", "the point before"])
    {
        let mean = *n_iterations as f64 / (*n).max(1) as f64;
        println!(
            "from {start}: {n_converged} of {n} converge, {mean:.1} iterations on average, {most_iterations} at most, \
             {most_factorisations} factorisations at most"
        );
    }
    Ok(())
}

/// The equilibrium of a structure at its own friction value, from rest or from displacements, and what it took.
fn equilibrium(
    structure: &Structure,
    system: &System,
    start: Option<&Vector>,
    totals: &mut Totals,
) -> squeal::Result<(Option<Equilibrium>, String)> {
    let friction = structure.friction_values(None).map_or(0.0, |list| list[0]);
    let mut sweep = Sweep::of(structure, system, None)?;
    let begin = Instant::now();
    if let Some(start) = start {
        sweep.restore(vec![(friction, start.duplicate()?)], None);
    }
    let found = sweep.equilibrium(friction, &mut ()).ok();
    let seconds = begin.elapsed().as_secs_f64();
    let steps: &[Step] = found.as_ref().map_or(sweep.path().steps(), |found| &found.steps);
    let n_iterations = steps.iter().map(|step| step.iterations.len().saturating_sub(1)).sum();
    let (n_failed, lu) = (steps.iter().filter(|step| !step.converged).count(), sweep.costs().lu);
    totals.n += 1;
    totals.n_converged += usize::from(found.is_some());
    totals.n_iterations += n_iterations;
    totals.most_iterations = totals.most_iterations.max(n_iterations);
    totals.most_factorisations = totals.most_factorisations.max(lu.n_factorisations);
    let text = format!(
        "{:9} {:5} {n_failed:6} {n_iterations:10} {:14} {:7} {seconds:7.2}",
        found.is_some(),
        steps.len(),
        lu.n_factorisations,
        lu.n_right_hand_sides
    );
    Ok((found, text))
}
