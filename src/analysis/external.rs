//! Modes of external matrices at the values of their parameter, followed from one to the next.

use std::f64::consts::TAU;
use std::time::Instant;

use crate::matrices::ExternalMatrices;
use crate::matrices::family::MatrixFamily;
use crate::model::InstabilityCriterion;
use crate::native::{Comm, Vector};
use crate::results::{ExternalMode, ExternalResults, ExternalValue};
use crate::stability::Mode;
use crate::{ErrorKind, Result};

use super::external_sweep::{ExternalModes, ExternalSweep, is_rigid};
use super::observer::{Event, Observer};

/// What [`external_modes`] is asked for.
#[derive(Debug, Clone)]
pub struct ExternalOptions {
    /// Frequency band, Hz.
    pub band: [f64; 2],
    /// What counts as an unstable mode.
    pub criterion: InstabilityCriterion,
    /// Values of the parameter; one where nothing depends on it.
    pub values: Vec<f64>,
    /// Whether modes are followed over the parameter.
    pub branches: bool,
    /// Whether the shapes of all modes are kept.
    pub shapes: bool,
}

/// Finds all modes of a band of `(lambda^2 M + lambda C + K + i G) x = 0` at each value of the matrices' parameter, and
/// follows them over it where M is symmetric and positive definite. Where a value does not converge, the analysis ends
/// there with a note. Shapes and names of rows are on the root alone. Collective.
///
/// # Errors
/// [`crate::Error::Input`] for matrices that cannot be read, do not fit together or are singular for every shift;
/// PETSc's and MUMPS's.
pub fn external_modes(
    comm: &Comm,
    family: &MatrixFamily,
    options: &ExternalOptions,
    observer: &mut dyn Observer,
) -> Result<ExternalResults> {
    let start = Instant::now();
    observer.event(Event::Planned(options.values.len()));
    observer.event(Event::Stage("reading"));
    let matrices = ExternalMatrices::read(comm, &family.terms, TAU * options.band[1])?;
    let mut sweep = ExternalSweep::new(&matrices, options.band);
    let mut results = empty(family, options, &matrices, &sweep);
    let mut follow = options.values.len() > 1 && options.branches;
    if let Some(reason) = if follow { sweep.cannot_follow(options.values[0])? } else { None } {
        results.notes.push(format!("modes are not followed: {reason}"));
        follow = false;
    }
    let outcome = if follow {
        let mut values = options.values.clone();
        values.sort_by(f64::total_cmp);
        let each = |value: f64, modes: &ExternalModes| match options.values.contains(&value) {
            true => add(&mut results, &matrices, options, value, modes),
            false => Ok(()),
        };
        let (diagram, outcome) = sweep.follow(&values, options.criterion, each, observer)?;
        results.diagram = Some(diagram);
        results.notes.extend(rigid_note(&results));
        outcome
    } else {
        options.values.iter().try_for_each(|&value| {
            let modes = sweep.modes(value, observer)?;
            add(&mut results, &matrices, options, value, &modes)
        })
    };
    match outcome {
        Err(error) if error.kind() == ErrorKind::NotConverged => results.notes.push(format!("not converged: {error}")),
        outcome => outcome?,
    }
    (results.seconds, results.n_ranks) = (start.elapsed().as_secs_f64(), comm.size());
    Ok(results)
}

/// How many modes are not followed because they are rigid motions at all values: real eigenvalues, which come in
/// pairs, count half.
fn rigid_note(results: &ExternalResults) -> Option<String> {
    let lambdas = results.values.first()?.modes.iter().map(|mode| mode.lambda);
    let halves = lambdas.filter(|&z| is_rigid(z, results.band)).map(|z| if z.im == 0.0 { 1 } else { 2 });
    let n = halves.sum::<usize>().div_ceil(2);
    (n > 0).then(|| format!("rigid-body modes at 0 Hz, left out of the branches: {n}"))
}

/// What is known before any mode is.
fn empty(
    family: &MatrixFamily,
    options: &ExternalOptions,
    matrices: &ExternalMatrices,
    sweep: &ExternalSweep,
) -> ExternalResults {
    let names = &matrices.names;
    let dofs = names.dofs.as_ref().map(|dofs| dofs.iter().map(|dof| (dof.node, dof.axis)).collect());
    ExternalResults {
        title: family.title.clone(),
        parameter: family.parameter.clone(),
        varies: family.terms.iter().any(|term| term.factor.varies()),
        n_dofs: matrices.n,
        n_constrained: names.n_constrained,
        symmetry: matrices.symmetry,
        is_damped: matrices.is_damped(),
        has_structural_damping: matrices.has_structural_damping(),
        band: options.band,
        criterion: options.criterion,
        evidence: sweep.evidence(),
        values: Vec::new(),
        diagram: None,
        notes: Vec::new(),
        rows: names.rows.clone(),
        names: dofs,
        seconds: 0.0,
        n_ranks: 0,
    }
}

/// Keeps the modes at a value. Collective.
fn add(
    results: &mut ExternalResults,
    matrices: &ExternalMatrices,
    options: &ExternalOptions,
    value: f64,
    found: &ExternalModes,
) -> Result<()> {
    let band = options.band;
    let is_within = |mode: &&Mode| {
        let frequency = if mode.lambda.im == 0.0 { mode.lambda.norm() / TAU } else { mode.frequency() };
        mode.frequency() >= band[0] && frequency <= band[1]
    };
    let (mut modes, mut shapes) = (Vec::new(), Vec::new());
    for mode in found.band.modes.iter().filter(is_within) {
        let shape = unscaled(matrices, mode)?;
        let (largest, row) = largest(matrices, &shape);
        modes.push(ExternalMode {
            number: modes.len() + 1,
            lambda: mode.lambda,
            backward_error: mode.backward_error,
            is_unstable: !is_rigid(mode.lambda, band) && mode.lambda.re > options.criterion.limit(mode.lambda, 0.0),
            largest_row: results.rows.get(row).map_or(0, |row| row + 1),
            largest_dof: results.names.as_ref().map(|names| names[row]),
        });
        if options.shapes {
            shapes.push(shape.map(|part| matrices.comm().join(&part).into_iter().map(|x| x / largest).collect()));
        }
    }
    let ExternalModes { band, condition, shift } = found;
    results.values.push(ExternalValue {
        value,
        modes,
        count: band.count,
        condition: *condition,
        shift: *shift,
        shapes,
    });
    Ok(())
}

/// `x = D y` on this rank's rows.
fn unscaled(matrices: &ExternalMatrices, mode: &Mode) -> Result<[Vec<f64>; 2]> {
    let times = |part: &Vector| part.local(|values| values.iter().zip(&matrices.scale).map(|(y, d)| y * d).collect());
    Ok([times(&mode.re)?, times(&mode.im)?])
}

/// The largest modulus of a shape and its row; of equal ones the first. Collective.
fn largest(matrices: &ExternalMatrices, [re, im]: &[Vec<f64>; 2]) -> (f64, usize) {
    let moduli: Vec<f64> = re.iter().zip(im).map(|(re, im)| re.hypot(*im)).collect();
    let own = moduli.iter().copied().fold(0.0, f64::max);
    let comm = matrices.comm();
    let largest = comm.max_loc(own);
    let here = moduli.iter().position(|&modulus| modulus == own).unwrap_or_default();
    (largest.value, comm.broadcast_value(largest.rank(), matrices.owned.start + here))
}
