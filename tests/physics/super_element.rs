//! Super-elements against the models that they reduce: a pad pressed by a piston on a sliding disc, all blocks;
//! piston and pad stick, 4 reference nodes between pad and disc.

use crate::support::{assert_close, brake, pressed_pad};
use num_complex::Complex64;
use squeal::Result;
use squeal::analysis::Sweep;
use squeal::assembly::System;
use squeal::contact::{Interface, Response, Status};
use squeal::equilibrium::Equilibrium;
use squeal::equilibrium::{LabelledFactor, PairForces};
use squeal::model::NormalLaw;
use squeal::native::{Block as Columns, Comm, Precision, Session};
use squeal::reduction::craig_bampton::{self, Structure};
use squeal::reduction::recovery::OuterSurface;
use squeal::reduction::super_element::{Origin, SuperElement};
use squeal::reduction::{contacts, craig_bampton::Reduced, file};
use squeal::stability::{BandRequest, BandSolver, EigenOptions, QuadraticProblem};
use squeal::structure::FullModel;

const OWN: &str = r#"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[material.lining]
young = 9e9
poisson = 0.25
density = 2600
[part.disc]
material = "iron"
rayleigh = { alpha = 5.0, beta = 1e-7 }
[part.pad]
material = "lining"
rayleigh = { alpha = 20.0, beta = 2e-7 }
[part.piston]
material = "iron"
[[fix]]
nodes = "piston_z1"
axes = "xy"
[[contact]]
name = "piston / pad"
slave = "piston_z0"
master = "pad_z1"
law = { linear = 2e13 }
friction = 0.6
stick = 1e13
separation = false
[stability]
band = [0, 30000]
"#;

/// The whole text.
pub fn model() -> String {
    format!("{}{OWN}", pressed_pad::SLIDING)
}

const N_CONTACTS: usize = 4;
pub const FRICTION: f64 = 0.4;
const BAND: [f64; 2] = [0.0, 30000.0];

/// The brake with its reduced contacts.
pub fn blocks(text: &str) -> FullModel {
    let mut brake = brake(text, pressed_pad::mesh([3, 3, 1]));
    brake.interface = contacts::reduce(&brake.model, &brake.mesh, &brake.interface, N_CONTACTS).unwrap();
    brake
}

/// The full model at its equilibrium.
pub struct Full {
    pub brake: FullModel,
    system: System,
    pub equilibrium: Equilibrium,
    pub eigenvalues: Vec<Complex64>,
}

fn eigenvalues(sweep: &mut Sweep, equilibrium: &Equilibrium) -> Vec<Complex64> {
    let band = sweep.modes(equilibrium, BAND, &mut ()).unwrap();
    assert!(band.count.agrees());
    band.modes.iter().map(|mode| mode.lambda).collect()
}

impl Full {
    pub fn new(comm: &Comm, text: &str, friction: f64) -> Full {
        Full::of(comm, blocks(text), friction)
    }

    pub fn of(comm: &Comm, brake: FullModel, friction: f64) -> Full {
        let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
        let mut sweep = Sweep::new(&system, &brake.interface, brake.model.friction_damping).unwrap();
        let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
        let eigenvalues = eigenvalues(&mut sweep, &equilibrium);
        drop(sweep);
        Full { brake, system, equilibrium, eigenvalues }
    }

    pub fn reduce(&self, limit: f64) -> (Reduced, SuperElement) {
        let loaded = [self.brake.mesh.node_set("piston_z1").unwrap()];
        let Full { brake, system, equilibrium, .. } = self;
        let interface = &brake.interface;
        let structure = Structure { system, interface, equilibrium, loaded: &loaded, reference: 0.0 };
        let reduced = craig_bampton::reduce(&structure, limit, &mut |_| ()).unwrap();
        let origin = Origin {
            title: "blocks".into(),
            model: "none".into(),
            mesh: "none".into(),
            mesh_hash: String::new(),
            program: String::new(),
            friction: equilibrium.friction,
            n_dofs: system.dofs.n_global(),
            band: BAND,
            limit,
            friction_damping: brake.model.friction_damping,
            samples: Vec::new(),
            criterion: brake.model.criterion,
            prestress_friction: None,
            made_for: None,
        };
        let element = SuperElement::new(origin, &structure, &reduced, Vec::new(), &[[0.0; 3]]).unwrap();
        (reduced, element)
    }
}

/// Equilibrium and eigenvalues of a super-element.
pub fn analyse(
    comm: &Comm,
    element: &SuperElement,
    law: Option<NormalLaw>,
    friction: f64,
) -> (Interface, Equilibrium, Vec<Complex64>) {
    analyse_under(comm, element, element.interface(law), friction)
}

pub fn analyse_under(
    comm: &Comm,
    element: &SuperElement,
    interface: Interface,
    friction: f64,
) -> (Interface, Equilibrium, Vec<Complex64>) {
    let system = element.assemble(comm, &interface, 1.0).unwrap();
    let mut sweep = Sweep::new(&system, &interface, element.origin.friction_damping).unwrap();
    let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
    let eigenvalues = eigenvalues(&mut sweep, &equilibrium);
    drop(sweep);
    (interface, equilibrium, eigenvalues)
}

/// Largest distance of eigenvalues over their modulus.
pub fn largest_error(found: &[Complex64], exact: &[Complex64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    found.iter().zip(exact).map(|(f, e)| (f - e).norm() / e.norm()).fold(0.0, f64::max)
}

/// With every fixed-interface mode kept the basis is a change of coordinates: eigenvalues to 1e-10 (measured 8e-13).
#[test]
fn all_modes_kept_give_the_full_models_eigenvalues() {
    let comm = Session::start(&[]).unwrap();
    let full = Full::new(&comm, &model(), FRICTION);
    let (_, element) = full.reduce(f64::INFINITY);
    // The load point keeps its two held coordinates.
    assert_eq!(element.n_coordinates(), full.system.dofs.n_global() + 2);
    let (_, _, found) = analyse(&comm, &element, None, FRICTION);
    let error = largest_error(&found, &full.eigenvalues);
    println!("{} modes, largest error {error:.1e}", found.len());
    assert!(found.len() >= 5 && error < 1e-10, "{error}");
}

/// Loss factors of both materials are in the super-element, and in its file: eigenvalues to 1e-9 with all modes kept,
/// to 1e-3 with those up to 100 kHz.
#[test]
fn loss_factors_are_in_the_super_element() {
    let comm = Session::start(&[]).unwrap();
    let text = model().replace("density = 7100", "density = 7100\nloss_factor = 0.01");
    let full = Full::new(&comm, &text.replace("density = 2600", "density = 2600\nloss_factor = 0.1"), FRICTION);
    let undamped = Full::new(&comm, &model(), FRICTION);
    assert!(full.eigenvalues.iter().zip(&undamped.eigenvalues).all(|(z, w)| z.re < w.re - 1e-3 * w.norm()));
    for (limit, allowed) in [(f64::INFINITY, 1e-9), (100e3, 1e-3)] {
        let (reduced, element) = full.reduce(limit);
        let place = tempfile::TempDir::new().unwrap();
        let path = place.path().join("brake.se.h5");
        let boundary = full.brake.boundary(&comm, &full.system);
        let surface = OuterSurface::new(boundary, &full.brake.mesh.parts, &full.system, &reduced.basis).unwrap();
        file::write(&path, &element, &surface, None).unwrap();
        let (read, _) = file::read(&path).unwrap();
        assert!(read.structural_damping.is_some() && read.structural_damping == element.structural_damping);
        let (_, _, found) = analyse(&comm, &read, None, FRICTION);
        let error = largest_error(&found, &full.eigenvalues);
        println!("{} modes, largest error {error:.1e}", found.len());
        assert!(error < allowed, "{error} up to {limit} Hz");
    }
}

/// The gyroscopic terms of the disc are in the super-element: eigenvalues to 1e-9 with all modes kept, to 1e-3 with
/// those up to 100 kHz.
#[test]
fn inertia_forces_of_the_disc_are_in_the_super_element() {
    let comm = Session::start(&[]).unwrap();
    let fast = model().replace("speed = ", "inertia = \"fixed_frame\"\nspeed = 3e3 # ");
    let (full, still) = (Full::new(&comm, &fast, FRICTION), Full::new(&comm, &model(), FRICTION));
    let difference = largest_error(&full.eigenvalues, &still.eigenvalues);
    assert!(difference > 1e-5, "the terms count: {difference}");
    for (limit, allowed) in [(f64::INFINITY, 1e-9), (100e3, 1e-3)] {
        let (_, element) = full.reduce(limit);
        assert!(element.is_gyroscopic());
        let error = largest_error(&analyse(&comm, &element, None, FRICTION).2, &full.eigenvalues);
        println!("{limit} Hz: largest error {error:.1e}");
        assert!(error < allowed, "{error} up to {limit} Hz");
    }
}

/// Gravity presses the pad of the layout and of its super-element as their piston does: the force between pad and disc
/// is the load and the weight above it, to 1e-9.
#[test]
fn gravity_is_in_the_layout_and_in_the_super_element() {
    let comm = Session::start(&[]).unwrap();
    let heavy = model() + "[[load]]\ngravity = [0, 0, -1e5]\n";
    let full = Full::new(&comm, &heavy, FRICTION);
    let weight = 1e5 * (2600.0 * 20.0 * 21.0 * 5.0 + 7100.0 * 12.0 * 13.0 * 8.0) * 1e-9;
    let pressed = |interface: &Interface, equilibrium: &Equilibrium| {
        let pairs = PairForces::all(interface, &equilibrium.responses);
        pairs.iter().zip(&interface.pairs).find(|(_, pair)| pair.is_sliding()).unwrap().0.normal
    };
    assert_close("layout", pressed(&full.brake.interface, &full.equilibrium), 1000.0 + weight, 1e-9);
    for limit in [f64::INFINITY, 100e3] {
        let (_, element) = full.reduce(limit);
        let (interface, equilibrium, _) = analyse(&comm, &element, None, FRICTION);
        assert_close("super-element", pressed(&interface, &equilibrium), 1000.0 + weight, 1e-9);
    }
}

/// A tie, a rigid set, a mass, springs to the ground and an equation in place of the piston's contact and supports.
fn with_joints() -> String {
    let text = model();
    let (before, rest) = text.split_once("[[fix]]\nnodes = \"piston_z1\"\naxes = \"xy\"\n").unwrap();
    let (_, end) = rest.split_once("[stability]").unwrap();
    let joints = "[[tie]]\nslave = \"piston_z0\"\nmaster = \"pad_z1\"\n[[rigid]]\nnodes = \"piston_z1\"\n\
                  [[mass]]\nnodes = \"piston_z1\"\nmass = 0.1\nat = [0.014, 0.016, 0.03]\n\
                  inertia = [2e-5, 2e-5, 2e-5, 0, 0, 0]\n\
                  [[connector]]\nbetween = [\"piston_z1\", \"ground\"]\nstiffness = [2e8, 1e8, 1e5]\n\
                  rotational_stiffness = [1e3, 1e3, 1e3]\n";
    format!("{before}{joints}[stability]{end}")
}

/// With joints the super-element has the full model's eigenvalues, too: all modes kept 1e-9, those up to 60 kHz 1e-3.
#[test]
fn joints_are_in_the_super_element() {
    let comm = Session::start(&[]).unwrap();
    let full = Full::new(&comm, &with_joints(), FRICTION);
    assert!(full.eigenvalues.len() >= 3, "{:?}", full.eigenvalues);
    for (limit, allowed) in [(f64::INFINITY, 1e-9), (100e3, 1e-3)] {
        let (_, element) = full.reduce(limit);
        let (_, _, found) = analyse(&comm, &element, None, FRICTION);
        let error = largest_error(&found, &full.eigenvalues);
        println!("{} modes, largest error {error:.1e}", found.len());
        assert!(error < allowed, "{error} up to {limit} Hz");
    }
}

/// In the modal coordinates of the first friction the others have the modes that a search with a factor of their own
/// finds: eigenvalues to 1e-9 (measured 2.7e-10, the other search's), and left vectors solve the transposed problem to
/// 1e-10, which is the largest backward error accepted (measured 4e-12; the first value's are found one by one, since
/// modal coordinates leave 1.5e-10 there).
#[test]
fn modal_coordinates_of_one_friction_serve_the_others() {
    const WIDE: [f64; 2] = [0.0, 60000.0];
    let comm = Session::start(&[]).unwrap();
    let (_, element) = Full::new(&comm, &model(), FRICTION).reduce(2.0 * WIDE[1]);
    let interface = element.interface(Some(NormalLaw::Cubic { k1: 2e13, k3: 1e25 }));
    let system = element.assemble(&comm, &interface, 1.0).unwrap();
    let mut sweep = Sweep::new(&system, &interface, false).unwrap();
    for friction in [FRICTION, 0.2] {
        let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
        let modes = sweep.modes(&equilibrium, WIDE, &mut ()).unwrap().modes;
        let left = sweep.left_vectors(&modes, |_| 1e-7).unwrap();
        let look = |problem: &QuadraticProblem| {
            let mut solver = BandSolver::new(EigenOptions::default(), Vec::new());
            let (mut factor, request) =
                (LabelledFactor::new(Precision::Double), BandRequest { band: WIDE, shift: 1.0 });
            let direct = solver.solve_band(problem, &mut factor, &request, &mut |_| ())?.modes;
            let [found, exact] =
                [&modes, &direct].map(|modes| modes.iter().map(|mode| mode.lambda).collect::<Vec<_>>());
            let errors = transposed_errors(problem, &found, &left)?;
            let (right, left) = (largest_error(&found, &exact), errors.into_iter().fold(0.0, f64::max));
            println!("friction {friction}: {} modes, right {right:.1e}, left {left:.1e}", found.len());
            assert!(found.len() > 6 && right < 1e-9 && left < 1e-10, "{right} {left}");
            Ok(())
        };
        sweep.linearise(&equilibrium, look).unwrap();
    }
}

/// `|P(lambda)^T v| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |v|)`, `v = conj(y)`, largest components.
pub fn transposed_errors(problem: &QuadraticProblem, lambdas: &[Complex64], y: &Columns) -> Result<Vec<f64>> {
    let products = [problem.matrices.k, problem.matrices.c, problem.matrices.m].map(|a| y.multiplied_by_transpose(a));
    let norms = [problem.matrices.k.norm_inf()?, problem.matrices.c.norm_inf()?, problem.matrices.m.norm_inf()?];
    let [k, c, m] = products;
    let products = [k?, c?, m?];
    let largest = |column: &dyn Fn(usize) -> Complex64| (0..y.n_local()).map(|i| column(i).norm()).fold(0.0, f64::max);
    let error = |(j, lambda): (usize, &Complex64)| {
        let of = |a: &Columns, i: usize| Complex64::new(a.column(2 * j)[i], -a.column(2 * j + 1)[i]);
        let powers = [Complex64::ONE, *lambda, lambda * lambda];
        let residual = |i: usize| products.iter().zip(powers).map(|(a, power)| power * of(a, i)).sum::<Complex64>();
        let scale: f64 = norms.iter().zip(powers).map(|(norm, power)| norm * power.norm()).sum();
        largest(&residual) / (scale * largest(&|i| of(y, i)))
    };
    Ok(lambdas.iter().enumerate().map(error).collect())
}

/// A basis that grows can only lower the frequencies of a conservative model, and never below the exact ones
/// (Rayleigh-Ritz).
#[test]
fn frequencies_fall_to_the_exact_ones_as_modes_are_added() {
    let comm = Session::start(&[]).unwrap();
    let undamped: String =
        model().lines().filter(|line| !line.starts_with("rayleigh")).map(|l| format!("{l}\n")).collect();
    let full = Full::new(&comm, &undamped, 0.0);
    let exact: Vec<f64> = full.eigenvalues.iter().map(|l| l.im).collect();
    let mut above: Vec<f64> = vec![f64::INFINITY; exact.len()];
    for limit in [50e3, 100e3, 200e3] {
        let (reduced, element) = full.reduce(limit);
        let (_, _, found) = analyse(&comm, &element, None, 0.0);
        let errors: Vec<f64> = found.iter().zip(&exact).map(|(f, e)| f.im / e - 1.0).collect();
        println!("{} fixed-interface modes: {errors:?}", reduced.frequencies.len());
        for (error, above) in errors.iter().zip(&mut above) {
            assert!(*error > -1e-9 && *error < *above + 1e-9, "{error} after {above}");
            *above = *error;
        }
    }
    assert!(above.iter().all(|error| *error < 1e-8), "{above:?}");
}

/// The free brake moves rigidly in its constraint modes alone: no strain, and the mass and inertia of the full model.
#[test]
fn constraint_modes_hold_rigid_motions_with_their_mass_and_inertia() {
    let comm = Session::start(&[]).unwrap();
    let mut brake = blocks(&model());
    brake.held.fill([false; 3]);
    let system = brake.assemble(&comm, &brake.families().unwrap()).unwrap();
    let stuck = Response { force: [0.0; 3], tangent: [[0.0; 3]; 3], normal_force: 0.0, status: Status::Stick };
    let responses = vec![stuck; brake.interface.points.len()];
    let equilibrium = Equilibrium { u: system.zeros().unwrap(), responses, friction: 0.0, steps: vec![] };
    let loaded = [brake.mesh.node_set("piston_z1").unwrap()];
    let (system, interface, equilibrium) = (&system, &brake.interface, &equilibrium);
    let structure = Structure { system, interface, equilibrium, loaded: &loaded, reference: 0.0 };
    let reduced = craig_bampton::reduce(&structure, 50e3, &mut |_| ()).unwrap();
    let n = reduced.load.len();
    let scale = reduced.matrices.k.amax();
    for axis in 0..6 {
        let rigid = |node: u32| {
            let [x, y, z] = brake.mesh.nodes[node as usize].map(|x| 10.0 * x);
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]][axis]
        };
        let mut q: Vec<f64> = (0..reduced.retained.len()).flat_map(|p| reduced.retained.gap(p, rigid)).collect();
        q.resize(n, 0.0);
        let times = |a: &[f64]| -> Vec<f64> {
            a.chunks_exact(n).map(|row| row.iter().zip(&q).map(|(a, q)| a * q).sum()).collect()
        };
        let energy: f64 = times(reduced.matrices.m.as_slice()).iter().zip(&q).map(|(a, q)| a * q).sum();
        let mut u = system.zeros().unwrap();
        let nodal: Vec<f64> = (0..brake.mesh.nodes.len() as u32).flat_map(rigid).collect();
        u.local_mut(|values| values.copy_from_slice(&nodal)).unwrap();
        let u = Columns::from_columns(&comm, system.dofs.n_local(), u.to_vec().unwrap());
        assert_close("inertia", energy, u.gram(&u.multiplied_by(&system.m).unwrap())[0], 1e-11);
        if axis < 3 {
            let mass = 1e-9 * (7100.0 * (30.0 * 31.0 * 10.0 + 12.0 * 13.0 * 8.0) + 2600.0 * 20.0 * 21.0 * 5.0);
            assert_close("mass", energy, mass, 1e-11);
        }
        let force = times(reduced.matrices.k.as_slice()).iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        assert!(force < 1e-10 * scale, "{force} of {scale}");
    }
}

#[test]
fn a_band_beyond_the_modes_kept_is_refused() {
    let comm = Session::start(&[]).unwrap();
    let (_, element) = Full::new(&comm, &model(), FRICTION).reduce(60e3);
    assert_eq!(element.require_band([0.0, 30e3]).unwrap(), None);
    assert!(element.require_band([0.0, 31e3]).unwrap().unwrap().contains("above 30000 Hz are less exact"));
    assert!(element.require_band([0.0, 61e3]).unwrap_err().to_string().contains("up to 60000 Hz only"));
}
