//! Equilibrium and modes at one point.

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::analysis::mode_data::whole_shapes;
use crate::analysis::observer::Observer;
use crate::analysis::sweep::Sweep;
use crate::equilibrium::Equilibrium;
use crate::explore::{Link, ModeProducts, PointMode, link, shaped_modes};
use crate::model::InstabilityCriterion;
use crate::native::{Block, Comm, Vector};
use crate::results::Shape;
use crate::stability::{Mode, QuadraticProblem, complex_product};
use crate::structure::Structure;
use crate::{Error, ErrorKind, Result};

use super::gradients::NominalVectors;
use super::groups::Groups;

/// What is computed at every point.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// Frequency band, Hz, which the structure covers.
    pub band: [f64; 2],
    /// What counts as an unstable mode.
    pub criterion: InstabilityCriterion,
    /// How often the line to the nominal point is bisected where modes are not recognised without doubt; none where
    /// modes are not followed.
    pub follow: Option<usize>,
    /// Whether the modes' vectors serve derivatives: those of the nominal point, and no others.
    pub gradients: bool,
    /// Whether shapes are kept.
    pub shapes: bool,
}

/// The modes of a point with its M, by which those of other points are recognised.
pub struct WeightedModes {
    /// `M y`, two columns a mode: real and imaginary part.
    pub left: Block,
    /// `M x`
    pub right: Block,
    /// `y^H M x` of each mode.
    pub own: Vec<Complex64>,
}

/// Equilibrium and modes of a point.
pub struct PointSolution {
    /// The modes of the band, by frequency.
    pub modes: Vec<PointMode>,
    /// This rank's part of the displacements of the equilibrium.
    pub displacements: Vec<f64>,
    /// Shapes of those modes that [`shaped_modes`] names, on the root, where they are asked for.
    pub shapes: Vec<Shape>,
    /// By which the modes of other points are recognised, where modes are followed.
    pub weighted: Option<WeightedModes>,
    /// For the derivatives, where they are asked for.
    pub for_gradients: Option<NominalVectors>,
    /// By which these modes are recognised, unless they serve derivatives.
    vectors: Option<Vectors>,
}

/// The modes of a structure about its equilibrium at a friction coefficient, which is sought from the displacements
/// `start` where these are given and it converges from there, else from rest. Collective.
///
/// # Errors
/// Those of equilibrium and modes.
pub fn solve(
    comm: &Comm,
    (structure, friction): (&Structure, f64),
    request: &Request,
    start: Option<&[f64]>,
    observer: &mut dyn Observer,
) -> Result<PointSolution> {
    structure.require_mass()?;
    at_equilibrium(comm, (structure, friction), start, observer, |sweep, equilibrium, observer| {
        let found = sweep.modes(equilibrium, request.band, observer)?.modes;
        let mode = |mode: &Mode| PointMode {
            lambda: mode.lambda,
            unstable: mode.is_unstable(request.criterion),
            backward_error: mode.backward_error,
            link: None,
        };
        let modes: Vec<PointMode> = found.iter().map(mode).collect();
        let shapes = if request.shapes { shapes(structure, sweep, &found, &modes)? } else { Vec::new() };
        let displacements = equilibrium.u.to_vec()?;
        let mut solution =
            PointSolution { modes, displacements, shapes, weighted: None, for_gradients: None, vectors: None };
        if request.follow.is_some() && !found.is_empty() {
            solution.keep_vectors(sweep, equilibrium, &found, request.gradients)?;
        }
        Ok(solution)
    })
}

/// The shapes of those modes of a point that are kept. Collective.
fn shapes(structure: &Structure, sweep: &Sweep, found: &[Mode], modes: &[PointMode]) -> Result<Vec<Shape>> {
    let system = sweep.system;
    // Ranks agree: rounding may differ.
    let places = system.k.comm().broadcast_value(0, shaped_modes(modes));
    let shaped: Vec<&Mode> = places.iter().map(|&place| &found[place]).collect();
    whole_shapes(&mut structure.surface_motion(system)?, &shaped)
}

/// Calls `look` with the sweep of a structure and the equilibrium at a friction coefficient, which is sought as
/// [`solve`] does. Collective.
///
/// # Errors
/// Those of the equilibrium, and of `look`.
pub fn at_equilibrium<T>(
    comm: &Comm,
    (structure, friction): (&Structure, f64),
    start: Option<&[f64]>,
    observer: &mut dyn Observer,
    look: impl FnOnce(&mut Sweep, &Equilibrium, &mut dyn Observer) -> Result<T>,
) -> Result<T> {
    let (system, prestress) = (structure.assemble(comm)?, structure.prestress()?);
    let mut sweep = Sweep::of(structure, &system, prestress.as_ref())?;
    let start = start.filter(|start| comm.min(usize::from(start.len() == system.load.n_local())) == 1);
    let equilibrium = equilibrium_from(&mut sweep, friction, start, &system.load, observer)?;
    look(&mut sweep, &equilibrium, observer)
}

/// Accuracy of the left vectors that recognise modes, by the last round's change; what is left is a tenth of it, and so
/// is a share's error.
const LINK_ACCURACY: f64 = 1e-2;
/// The same of those that make derivatives: a growth rate changes by a thousandth of what the frequency does.
const DERIVATIVE_ACCURACY: f64 = 1e-7;

impl PointSolution {
    /// Keeps left and right vectors of the modes, for derivatives or to recognise modes. Collective.
    fn keep_vectors(
        &mut self,
        sweep: &mut Sweep,
        equilibrium: &Equilibrium,
        found: &[Mode],
        differentiates: bool,
    ) -> Result<()> {
        let accuracy = if differentiates { DERIVATIVE_ACCURACY } else { LINK_ACCURACY };
        let (left, right) = (sweep.left_vectors(found, |_| accuracy)?, sweep.right_vectors(found)?);
        let [weighted_left, weighted_right] =
            [left.multiplied_by(&sweep.system.m)?, right.multiplied_by(&sweep.system.m)?];
        let products = hermitian(&left, &weighted_right);
        let own: Vec<Complex64> = products.diagonal().iter().copied().collect();
        self.weighted = Some(WeightedModes { left: weighted_left, right: weighted_right, own: own.clone() });
        if !differentiates {
            self.vectors = Some(Vectors { left, right, own });
            return Ok(());
        }
        let lambdas = found.iter().map(|mode| mode.lambda).collect();
        let own = |problem: &QuadraticProblem| NominalVectors::new(problem, lambdas, [left, right]);
        self.for_gradients = Some(sweep.linearise(equilibrium, own)?);
        Ok(())
    }

    /// Says that the modes are those of the nominal point, where modes are followed.
    pub fn are_nominal(&mut self) {
        for (nominal, mode) in (1..).zip(&mut self.modes).filter(|_| self.weighted.is_some()) {
            mode.link = Some(Link { nominal, share: 1.0, doubtful: false });
        }
    }

    /// For each mode that of another point which it is. Collective.
    pub fn links(&self, other: &WeightedModes) -> Vec<Option<Link>> {
        let Some(vectors) = &self.vectors else { return vec![None; self.modes.len()] };
        let products = ModeProducts {
            nominal_left: hermitian(&other.left, &vectors.right),
            nominal_right: hermitian(&vectors.left, &other.right),
            nominal_own: other.own.clone(),
            own: vectors.own.clone(),
        };
        let lambdas: Vec<Complex64> = self.modes.iter().map(|mode| mode.lambda).collect();
        link(&products.shares(), &lambdas)
    }
}

/// The equilibrium from a state nearby, else from rest.
fn equilibrium_from(
    sweep: &mut Sweep,
    friction: f64,
    start: Option<&[f64]>,
    like: &Vector,
    observer: &mut dyn Observer,
) -> Result<Equilibrium> {
    let Some(start) = start else { return sweep.equilibrium(friction, observer) };
    sweep.restore(vec![(friction, Vector::from_local(like.comm(), start)?)], None);
    let nearby = sweep.equilibrium(friction, observer);
    unless_lost(nearby, || {
        sweep.restore(Vec::new(), None);
        sweep.equilibrium(friction, observer)
    })
}

/// The result of a start nearby, and where that does not converge, or ends where a part is unconstrained, the result
/// from rest.
fn unless_lost<T>(nearby: Result<T>, from_rest: impl FnOnce() -> Result<T>) -> Result<T> {
    match nearby {
        Err(error) if [ErrorKind::NotConverged, ErrorKind::Singular].contains(&error.kind()) => from_rest(),
        outcome => outcome,
    }
}

/// Left and right vectors of a point's modes.
struct Vectors {
    left: Block,
    right: Block,
    /// `y^H M x` of each mode.
    own: Vec<Complex64>,
}

/// `y_i^H x_j` of complex vectors that are kept as two columns each. Collective.
fn hermitian(y: &Block, x: &Block) -> DMatrix<Complex64> {
    let (m, n) = (y.n_columns(), x.n_columns());
    let products = DMatrix::from_vec(m, n, y.gram(x));
    DMatrix::from_fn(m / 2, n / 2, |i, j| complex_product(&products, (i, false), (j, false)))
}

/// An error that is that of a point, which the study records and continues: of a kind that all ranks have together.
/// Short memory is one only where all ranks solve the point: otherwise it is that of the points at the same time.
///
/// # Errors
/// Any other error, which ends the study.
pub fn of_point(groups: &Groups, error: Error) -> Result<Error> {
    unless_fatal([groups.n_groups(), groups.own.size()], error)
}

fn unless_fatal([n_groups, n_ranks]: [usize; 2], error: Error) -> Result<Error> {
    match error.kind() {
        ErrorKind::OutOfMemory if n_groups > 1 => {
            let what = format!("{error}. {n_groups} points are in memory at the same time, one a group of ranks");
            let text = format!("{what}. Give a larger --ranks-per-point than {n_ranks}, or fewer ranks to mpirun");
            Err(Error::Agreed { kind: error.kind(), text })
        }
        ErrorKind::Input | ErrorKind::NotConverged | ErrorKind::OutOfMemory | ErrorKind::Singular => Ok(error),
        ErrorKind::Library if n_ranks == 1 => Ok(error),
        ErrorKind::Library | ErrorKind::Io | ErrorKind::Interrupted { .. } => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;
    use crate::structure::StructureOptions;

    #[test]
    fn products_are_those_of_complex_vectors() {
        let comm = Session::start(&[]).unwrap();
        let block = |columns: &[[f64; 2]]| Block::from_columns(&comm, 2, columns.concat());
        let c = Complex64::new;
        let (y, x) = ([c(1.0, 2.0), c(-1.0, 0.5)], [c(0.3, -0.7), c(2.0, 1.0)]);
        let columns = |v: [Complex64; 2]| [[v[0].re, v[1].re], [v[0].im, v[1].im]];
        let found = hermitian(&block(&columns(y)), &block(&columns(x)))[(0, 0)];
        assert!((found - (y[0].conj() * x[0] + y[1].conj() * x[1])).norm() < 1e-15);
    }

    #[test]
    fn an_equilibrium_that_a_neighbour_does_not_lead_to_is_sought_from_rest() {
        let lost = || Error::not_converged("stagnates");
        let open = || Error::Singular { found_by: "MUMPS".into() };
        assert_eq!(unless_lost(Err(lost()), || Ok(1)).unwrap(), 1);
        assert_eq!(unless_lost(Err(open()), || Ok(1)).unwrap(), 1);
        assert_eq!(unless_lost(Ok(2), || Ok(1)).unwrap(), 2);
        assert!(unless_lost(Err(Error::input("x")), || Ok(1)).is_err());
    }

    #[test]
    fn a_start_nearby_needs_one_step_and_leads_to_the_same_equilibrium() {
        let comm = Session::start(&[]).unwrap();
        let file = "tests/data/pads_on_disc.toml".as_ref();
        let brake = Structure::read(&comm, file, &StructureOptions::default()).unwrap();
        let system = brake.assemble(&comm).unwrap();
        let mut sweep = Sweep::new(&system, brake.interface(), false).unwrap();
        let mut from = |start: Option<&[f64]>| equilibrium_from(&mut sweep, 0.4, start, &system.load, &mut ()).unwrap();
        let rest = from(None);
        assert_eq!(rest.steps[0].label, "settle");
        let own = rest.u.to_vec().unwrap();
        let start: Vec<f64> = own.iter().map(|u| 1.1 * u).collect();
        let nearby = from(Some(&start));
        assert_eq!((nearby.steps.len(), nearby.steps[0].label.as_str()), (1, "friction 0.4000"));
        let largest = own.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let found = nearby.u.to_vec().unwrap();
        assert!(own.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-9 * largest));
    }

    #[test]
    fn left_vectors_that_recognise_modes_give_products_to_a_thousandth() {
        let comm = Session::start(&[]).unwrap();
        let file = "tests/data/pads_on_disc.toml".as_ref();
        let brake = Structure::read(&comm, file, &StructureOptions::default()).unwrap();
        let [rough, exact] = [false, true].map(|gradients| {
            let (band, criterion) = ([0.0, 2500.0], brake.criterion());
            let request = Request { band, criterion, follow: Some(0), gradients, shapes: false };
            solve(&comm, (&brake, 0.5), &request, None, &mut ()).unwrap()
        });
        let right = rough.vectors.unwrap().right;
        let [found, expected] = [rough.weighted, exact.weighted].map(|own| hermitian(&own.unwrap().left, &right));
        assert!(expected.nrows() > 5 && expected.diagonal().iter().any(|z| z.norm() < 0.999), "friction has an effect");
        let worst = found.iter().zip(&expected).map(|(a, b)| (a.norm() - b.norm()).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst:e}");
    }

    #[test]
    fn a_point_fails_by_what_all_ranks_see() {
        let is_of_point = |groups, error| unless_fatal(groups, error).is_ok();
        let short = || Error::OutOfMemory { what: "the factor".into(), needed_mb: None };
        for groups in [[1, 4], [2, 2], [4, 1]] {
            for error in [Error::input("density"), Error::not_converged("0.3")] {
                assert!(is_of_point(groups, error));
            }
            assert!(is_of_point(groups, Error::Singular { found_by: "MUMPS".into() }));
            assert!(!is_of_point(groups, Error::Interrupted { signal: 2, text: String::new() }));
            assert!(!is_of_point(groups, Error::io("disc".as_ref())(std::io::ErrorKind::StorageFull.into())));
        }
        let library = || Error::library("x")("y");
        assert!(is_of_point([4, 1], library()) && !is_of_point([2, 2], library()));
        assert!(is_of_point([1, 4], short()), "more ranks do not help");
        let error = unless_fatal([2, 2], short()).unwrap_err();
        assert!(
            error.kind() == ErrorKind::OutOfMemory && error.to_string().contains("larger --ranks-per-point than 2")
        );
    }
}
