//! Equilibria at the points of a study, each from rest and from the point before: `cargo bench --bench equilibria --
//! study.toml`. Of each it prints the steps, Newton's iterations, factorisations, right-hand sides and seconds, and how
//! far the two displacements are apart.
//!
//! Not a timed test: it prints figures and judges nothing. Under mpirun run the executable that `cargo bench --no-run`
//! names.

use std::time::Instant;

use squeal::analysis::Sweep;
use squeal::equilibrium::Equilibrium;
use squeal::explore::{self, Nominal, Template};
use squeal::native::{Session, Vector};
use squeal::structure::{ModelVariants, Structure};

/// What an equilibrium took.
struct Cost {
    equilibrium: squeal::Result<Equilibrium>,
    text: String,
}

fn main() -> squeal::Result<()> {
    let study = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).expect("the file of a study");
    let study = explore::read(study.as_ref())?;
    let comm = Session::start(&[])?;
    let variants = ModelVariants::read(&comm, &study.model)?;
    let nominal = Nominal { model: &variants.model, swept: &variants.swept };
    let template = Template::new(&variants.text, &study.parameters, nominal)?;
    let distributions: Vec<_> = study.parameters.iter().map(|own| &own.distribution).collect();
    let points = study.design.points(&distributions, &template.nominal())?;
    println!("point  start  converged steps failed iterations factorisations columns seconds");
    let mut last: Option<Vector> = None;
    for (number, values) in points.iter().enumerate() {
        let brake = variants.brake(&comm, &template.text(values, &variants.file)?, study.contacts)?;
        let structure = Structure::Full(Box::new(brake));
        let friction = structure.friction_values(None).map_or(0.0, |list| list[0]);
        let system = structure.assemble(&comm)?;
        let solve = |start: Option<&Vector>| -> squeal::Result<Cost> {
            let mut sweep = Sweep::of(&structure, &system, None)?;
            let begin = Instant::now();
            let equilibrium = match start {
                Some(start) => {
                    sweep.restore(vec![(friction, start.duplicate()?)], None);
                    sweep.equilibrium(friction, &mut ())
                }
                None => sweep.equilibrium(friction, &mut ()),
            };
            let seconds = begin.elapsed().as_secs_f64();
            let steps = match &equilibrium {
                Ok(equilibrium) => &equilibrium.steps[..],
                Err(_) => sweep.path().steps(),
            };
            let n_failed = steps.iter().filter(|step| !step.converged).count();
            let n_iterations: usize = steps.iter().map(|step| step.iterations.len().saturating_sub(1)).sum();
            let lu = sweep.costs().lu;
            let text = format!(
                "{:9} {:5} {n_failed:6} {n_iterations:10} {:14} {:7} {seconds:7.2}",
                equilibrium.is_ok(),
                steps.len(),
                lu.n_factorisations,
                lu.n_right_hand_sides
            );
            Ok(Cost { equilibrium, text })
        };
        let from_rest = solve(None)?;
        println!("{number:5}   rest {}", from_rest.text);
        let found = match from_rest.equilibrium {
            Ok(found) => found,
            Err(error) => {
                println!("      {error}");
                continue;
            }
        };
        if let Some(last) = &last {
            let from_before = solve(Some(last))?;
            let apart = match &from_before.equilibrium {
                Ok(other) => {
                    let mut difference = other.u.duplicate()?;
                    difference.axpy(-1.0, &found.u)?;
                    format!("apart {:.1e}", difference.norm()? / found.u.norm()?)
                }
                Err(error) => error.to_string(),
            };
            println!("{number:5} before {} {apart}", from_before.text);
        }
        last = Some(found.u);
    }
    Ok(())
}
