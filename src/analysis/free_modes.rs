//! The free modes of one part: undamped, unconstrained, as a tap test has them.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::time::Instant;

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::assembly::System;
use crate::comparison::{groups_of_near, mac_with_span};
use crate::equilibrium::LabelledFactor;
use crate::native::{Comm, MaxLoc, Mck, Precision};
use crate::output::fields::write_free_mode;
use crate::output::folder::Folder;
use crate::results::{FreeMode, FreeModes, MeasuredComparison};
use crate::stability::{Band, BandRequest, BandSolver, EigenOptions, Mode, QuadraticProblem};
use crate::structure::{FullModel, RigidMotions};
use crate::{Error, Result};

use super::measured::{self, Measured};
use super::observer::{Event, Observer, warn};

/// Where the search stands, in units of the band's end: K of a free part is singular.
const SHIFT_RATIO: f64 = 0.31;
/// A mode with more of its kinetic energy in rigid motion than this is one.
const RIGID_SHARE: f64 = 0.5;
/// Frequencies closer than this, relative, are one.
const ONE_FREQUENCY: f64 = 1e-4;

/// What [`free_modes`] is asked for.
#[derive(Debug, Clone, Default)]
pub struct FreeModesOptions {
    /// Frequency band, Hz; the model's own where there is none.
    pub band: Option<[f64; 2]>,
    /// Measured modes (CSV) to compare with.
    pub measured: Option<PathBuf>,
}

/// Finds the free, undamped modes of a part that [`FullModel::read_part`] has read, and compares them with measured
/// ones. Shapes are written into the folder, which the root has. Collective.
///
/// # Errors
/// [`crate::Error::Input`] for measured modes that cannot be read; PETSc's and MUMPS's; [`crate::Error::NotConverged`].
pub fn free_modes(
    comm: &Comm,
    part: &FullModel,
    options: &FreeModesOptions,
    folder: Option<&Folder>,
    observer: &mut dyn Observer,
) -> Result<FreeModes> {
    let start = Instant::now();
    let measured = comm.agree(options.measured.as_deref().map(measured::read).transpose())?;
    require_modes(part)?;
    warn(comm, part, observer);
    observer.event(Event::Stage("assembling"));
    let system = part.assemble(comm, &part.families()?)?;
    let band = options.band.unwrap_or(part.model.band);
    let found = solve(&system, band, observer)?;
    let motions = RigidMotions::new(part, &system)?;
    let (mut elastic, mut weight, mut rigid_noise) = (Vec::new(), 0.0, 0.0_f64);
    for mode in found.modes {
        if motions.share(&system, &mode)? > RIGID_SHARE {
            // A pair of the upper half plane stands for one motion, a real eigenvalue for half of one.
            weight += if mode.lambda.im > 0.0 { 1.0 } else { 0.5 };
            rigid_noise = rigid_noise.max(mode.lambda.norm() / TAU);
        } else if mode.frequency() >= band[0] {
            elastic.push(mode);
        }
    }
    for (number, mode) in (1..).zip(&elastic) {
        write_free_mode(folder, part, &system, number, mode)?;
    }
    let measured = measured.map(|measured| compare(comm, part, &system, &measured, &elastic)).transpose()?;
    let data = |mode: &Mode| FreeMode { frequency: mode.frequency(), backward_error: mode.backward_error };
    Ok(FreeModes {
        title: part.model.title.clone(),
        part: part.mesh.parts.concat(),
        n_dofs: system.dofs.n_global(),
        band,
        n_rigid: weight as usize,
        rigid_noise,
        count: found.count,
        modes: elastic.iter().map(data).collect(),
        measured,
        seconds: start.elapsed().as_secs_f64(),
        n_ranks: comm.size(),
    })
}

/// Refuses a part without mass, and one whose stiffness depends on the frequency.
fn require_modes(part: &FullModel) -> Result<()> {
    part.require_mass()?;
    part.model.require_no_viscoelastic("free modes are those of one stiffness whatever the frequency")
}

/// All modes up to the band's end, rigid motions among them. Collective.
fn solve(system: &System, band: [f64; 2], observer: &mut dyn Observer) -> Result<Band> {
    let undamped = system.c.zeros_like()?;
    let problem = QuadraticProblem::symmetric(Mck { c: &undamped, g: None, ..system.matrices() });
    let mut factor = LabelledFactor::new(Precision::Double);
    let mut solver = BandSolver::new(EigenOptions::default(), system.dofs.labels());
    let request = BandRequest { band: [0.0, band[1]], shift: SHIFT_RATIO * TAU * band[1] };
    let mut progress = |progress| observer.event(Event::Modes(progress));
    solver.solve_band(&problem, &mut factor, &request, &mut progress)
}

/// MAC of each measured mode with each computed one. Collective.
fn compare(
    comm: &Comm,
    part: &FullModel,
    system: &System,
    measured: &Measured,
    computed: &[Mode],
) -> Result<MeasuredComparison> {
    let points = Points::new(part, comm, measured);
    points.require_near(part, comm)?;
    let (n_points, n_modes) = (measured.points.len(), computed.len());
    let mut values = vec![0.0; n_points * n_modes];
    for (j, mode) in computed.iter().enumerate() {
        let shape = system.nodal(&[&mode.re])?.remove(0);
        for (k, node) in points.nodes.iter().enumerate() {
            if let Some(n) = node {
                let along = |i: usize| shape[*n as usize][i] * measured.directions[k][i];
                values[j * n_points + k] = (0..3).map(along).sum();
            }
        }
    }
    comm.sum_all(&mut values);
    let complex = |values: &[f64]| values.iter().map(|&u| Complex64::from(u)).collect::<Vec<_>>();
    let shapes: Vec<Vec<Complex64>> = values.chunks_exact(n_points).map(complex).collect();
    let lambdas: Vec<Complex64> = computed.iter().map(|mode| Complex64::new(0.0, mode.frequency())).collect();
    let groups = groups_of_near(&lambdas, ONE_FREQUENCY);
    // Modes of one frequency, as the doublets of a disc, span a plane in which their directions are arbitrary.
    let of =
        |i: usize, modes: &[usize]| mac_with_span(&complex(&measured.modes[i].1), modes.iter().map(|&j| &shapes[j]));
    let n = measured.modes.len();
    Ok(MeasuredComparison {
        frequencies: measured.modes.iter().map(|(frequency, _)| *frequency).collect(),
        single: DMatrix::from_fn(n, n_modes, |i, j| of(i, &[j])),
        grouped: DMatrix::from_fn(n, groups.len(), |i, g| of(i, &groups[g])),
        groups,
        distance: points.distance / part.model.mesh_unit,
    })
}

/// The nodes nearest to the measured points.
struct Points {
    /// For each point the node where this rank has it, in its own numbers.
    nodes: Vec<Option<u32>>,
    /// The largest distance of a point from its node, m.
    distance: f64,
}

impl Points {
    /// Collective.
    fn new(full: &FullModel, comm: &Comm, measured: &Measured) -> Points {
        let unit = full.model.mesh_unit;
        let own: Vec<u32> = full.nodes.owned().collect();
        let square = |x: &[f64; 3], n: u32| {
            let node = &full.mesh.nodes[n as usize];
            (0..3).map(|i| (unit * x[i] - node[i]).powi(2)).sum::<f64>()
        };
        let nearest = |x: &[f64; 3]| own.iter().map(|&n| (square(x, n), n)).min_by(|a, b| a.0.total_cmp(&b.0));
        let own: Vec<Option<(f64, u32)>> = measured.points.iter().map(nearest).collect();
        let closeness: Vec<f64> =
            own.iter().map(|best| best.map_or(f64::NEG_INFINITY, |(square, _)| -square)).collect();
        // Of ranks with nodes equally near the first.
        let closest = comm.max_loc_all(&closeness);
        let mine = |(best, closest): (Option<(f64, u32)>, &MaxLoc)| {
            best.filter(|_| closest.rank() == comm.rank()).map(|(_, node)| node)
        };
        let distance = closest.iter().fold(0.0, |largest: f64, closest| largest.max((-closest.value).sqrt()));
        Points { nodes: own.into_iter().zip(&closest).map(mine).collect(), distance }
    }

    /// Refuses points that are farther from the part than it is long: they are of another unit or another part.
    /// Collective.
    fn require_near(&self, part: &FullModel, comm: &Comm) -> Result<()> {
        let (length, unit) = (part.extents(comm).into_iter().fold(0.0, f64::max), part.model.mesh_unit);
        if self.distance <= length {
            return Ok(());
        }
        let [distance, length] = [self.distance, length].map(|x| x / unit);
        Err(Error::input(format!(
            "a measured point is {distance:.1} from the nearest node, and the part is {length:.1} long (unit of the mesh). \
             Give the points of this part in the unit of the mesh"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::GapOperator;
    use crate::equilibrium::testing;
    use crate::native::Session;

    #[test]
    fn a_free_chain_has_its_rigid_motions_and_its_elastic_modes() {
        let comm = Session::start(&[]).unwrap();
        // Two unit masses with a spring along each axis.
        let spring = |i: usize, j: usize| if i == j { 40.0 } else { -40.0 };
        let k = DMatrix::from_fn(6, 6, |i, j| if i % 3 == j % 3 { spring(i, j) } else { 0.0 });
        let matrices = Mck::from([DMatrix::identity(6, 6), DMatrix::zeros(6, 6), k]);
        let system = testing::system(&comm, matrices, &GapOperator::new(), &[]);
        let found = solve(&system, [1.0, 2.0], &mut ()).unwrap();
        let elastic = found.modes.iter().filter(|mode| mode.frequency() > 1.0);
        assert!(elastic.clone().all(|mode| (mode.lambda.im - 80_f64.sqrt()).abs() < 1e-6));
        assert_eq!((elastic.count(), found.count.agrees()), (3, true));
    }
}
