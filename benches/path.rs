//! Seconds, entries and memory of the stages on the demo brake: `cargo bench`, or `cargo bench --
//! meshes/brake-full.toml`.
//!
//! The matrices factorised are those of a brake in contact with friction. With `--factors` it ends after the factors
//! and their solves, for comparing MUMPS's settings: `PETSC_OPTIONS="-mat_mumps_icntl_7 4"` asks for PORD, 3 for
//! SCOTCH. The ordering used is printed.
//!
//! Not a timed test: it prints figures and judges nothing. Under mpirun run the executable that `cargo bench --no-run`
//! names.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::time::Instant;

use squeal::analysis::Sweep;
use squeal::native::{Block, Factor, FactorKind, Matrix, Precision, Session, Vector};
use squeal::stability::QuadraticProblem;
use squeal::structure::FullModel;

/// Friction of the equilibrium whose matrices are factorised.
const FRICTION: f64 = 0.5;

fn main() -> squeal::Result<()> {
    let asked = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let path = PathBuf::from(asked.unwrap_or_else(|| "meshes/brake-medium.toml".into()));
    let comm = Session::start(&[])?;
    let tell = |text: String| {
        if comm.is_root() {
            println!("{text}");
        }
    };
    let start = Instant::now();
    let brake = FullModel::read(&comm, &path)?;
    let (nodes, elements) = (brake.nodes.n_global(), comm.sum(brake.own_elements().count()) as f64);
    tell(format!("{}: {nodes} nodes, {elements} elements, {} ranks", path.display(), comm.size()));
    tell(format!("read, checked, contact found    {:8.2} s", start.elapsed().as_secs_f64()));

    let start = Instant::now();
    let families = brake.families()?;
    let system = brake.assemble(&comm, &families)?;
    let seconds = start.elapsed().as_secs_f64();
    let (n, entries) = (system.dofs.n_global(), system.k.n_entries()?);
    let rate = elements / seconds / comm.size() as f64;
    tell(format!(
        "assembly of M, C, K             {seconds:8.2} s  {n} equations, {:.1} M entries each, {rate:.0} elements/s and rank",
        1e-6 * entries
    ));

    let block = Block::from_columns(&comm, system.load.n_local(), system.load.to_vec()?.repeat(32));
    for (name, matrix) in [("K", &system.k), ("K", &system.k), ("C", &system.c), ("M", &system.m)] {
        let start = Instant::now();
        block.multiplied_by(matrix)?;
        tell(format!("{name} times 32 columns            {:8.3} s", start.elapsed().as_secs_f64()));
    }

    let mut sweep = Sweep::new(&system, &brake.interface, false)?;
    let equilibrium = sweep.equilibrium(FRICTION, &mut ())?;
    sweep.linearise(&equilibrium, |problem| {
        let (double, single) = (Precision::Double, Precision::Single);
        for (kind, precision) in
            [(FactorKind::Unsymmetric, double), (FactorKind::Unsymmetric, single), (FactorKind::Symmetric, double)]
        {
            factor(problem, kind, precision, brake.model.band[1], &tell)?;
        }
        Ok(())
    })?;
    if std::env::args().any(|argument| argument == "--factors") {
        return Ok(());
    }

    let next = sweep.equilibrium(FRICTION + 0.1, &mut ())?;
    let band = sweep.modes(&next, brake.model.band, &mut ())?;
    let costs = sweep.costs();
    let iterations = |steps: &[squeal::equilibrium::Step]| steps.iter().map(|s| s.iterations.len() - 1).sum::<usize>();
    tell(format!(
        "equilibria at 0.5 and 0.6       {:8.2} s  {} and {} Newton steps, {} factorisations",
        costs.equilibria_seconds,
        iterations(&equilibrium.steps),
        iterations(&next.steps),
        costs.lu.n_factorisations
    ));
    tell(format!(
        "modes of the band               {:8.2} s  {} modes, {} solves",
        costs.modes_seconds,
        band.modes.len(),
        band.report.n_solves
    ));
    Ok(())
}

/// What a factor costs, and solves with it: of the stiffness with the tangent of contact and friction, or of what
/// counts the modes.
fn factor(
    problem: &QuadraticProblem,
    kind: FactorKind,
    precision: Precision,
    end: f64,
    tell: &impl Fn(String),
) -> squeal::Result<()> {
    let matrix = match kind {
        FactorKind::Unsymmetric => problem.matrices.k.duplicate()?,
        FactorKind::Symmetric => counted(problem, TAU * end)?,
    };
    let mut factor = Factor::new(kind);
    factor.set_precision(precision);
    factor.factorise(&matrix)?;
    let cost = factor.stats();
    tell(format!(
        "{:<31} {:8.2} s  analysis {:.2} s, {:.1} M entries, {:.1} GFlop, {:.0} MB of {:.0} estimated{}, ordering {}",
        format!("{kind:?}, {precision:?}"),
        cost.factorisation_seconds,
        cost.analysis_seconds,
        1e-6 * cost.entries,
        1e-9 * cost.flops,
        cost.used_mb,
        cost.estimated_mb,
        if cost.out_of_core { ", out of core" } else { "" },
        cost.ordering_name()
    ));
    let n_local = problem.matrices.k.n_local();
    let load: Vec<f64> = (0..n_local).map(|row| 1.0 + (row % 7) as f64).collect();
    let b = Vector::from_local(matrix.comm(), &load)?;
    let [mut x, mut residual] = [b.duplicate()?, b.duplicate()?];
    for _ in 0..2 {
        let start = Instant::now();
        factor.solve(&b, &mut x)?;
        let seconds = start.elapsed().as_secs_f64();
        matrix.multiply(&x, &mut residual)?;
        residual.axpy(-1.0, &b)?;
        let relative = residual.norm()? / b.norm()?;
        tell(format!("  one solve                     {seconds:8.3} s  residual {relative:.1e}"));
    }
    for n_columns in [8, 16, 24, 32, 64, 128] {
        let block = Block::from_columns(matrix.comm(), n_local, load.repeat(n_columns));
        let start = Instant::now();
        block.solved_by(&factor)?;
        let seconds = start.elapsed().as_secs_f64();
        let each = seconds / n_columns as f64;
        tell(format!("  {n_columns:3} right-hand sides at once  {seconds:8.3} s  {each:.4} s each"));
    }
    Ok(())
}

/// `S - omega^2 M`, S the stiffness with the tangent of contact without friction's coupling.
fn counted(problem: &QuadraticProblem, omega: f64) -> squeal::Result<Matrix> {
    let mut matrix = problem.symmetric_stiffness()?;
    matrix.axpy(-omega * omega, problem.matrices.m)?;
    matrix.declare_symmetric()?;
    Ok(matrix)
}
