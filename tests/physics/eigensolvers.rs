//! Two eigensolvers, one answer.
//!
//! TOAR takes one right-hand side at a time and is the reference; the blocked search, which large models use, takes
//! many. Both solve the damped brake (10 803 nodes, 6 kHz) and the undamped pads on a disc, whose modes couple.
//!
//! Goal and, in brackets, what was measured: the same number of modes; eigenvalues to 1e-9 of their modulus, on the
//! damped brake [3.0e-10, five runs] and beside a coupling [3.5e-10]; backward errors within the search's 1e-9. A
//! search that starts from the modes of another friction does as well [4.1e-10], with three quarters of the solves
//! at most where friction differs by 0.1 [272 for 458].

use std::path::{Path, PathBuf};

use crate::support::data;
use squeal::analysis::Sweep;
use squeal::native::{Comm, Session};
use squeal::stability::{Band, Mode};
use squeal::structure::FullModel;

/// Modes of a model at one friction by TOAR and by blocks.
fn both(model: &Path, friction: f64) -> [Vec<Mode>; 2] {
    let comm = Session::start(&[]).unwrap();
    let brake = FullModel::read(&comm, model).unwrap();
    let families = brake.families().unwrap();
    let system = brake.assemble(&comm, &families).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
    let one_by_one = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    sweep.solve_as_large();
    let in_blocks = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    assert!(one_by_one.count.agrees() && in_blocks.count.agrees());
    [one_by_one.modes, in_blocks.modes]
}

/// Largest distance of eigenvalues, relative to their moduli.
fn distance([one_by_one, in_blocks]: &[Vec<Mode>; 2]) -> f64 {
    assert_eq!(one_by_one.len(), in_blocks.len());
    let nearest = |mode: &Mode| {
        let distances = in_blocks.iter().map(|other| (other.lambda - mode.lambda).norm() / mode.lambda.norm());
        distances.fold(f64::INFINITY, f64::min)
    };
    let worst = one_by_one.iter().map(nearest).fold(0.0, f64::max);
    println!("{} modes, largest distance {worst:.1e}", one_by_one.len());
    assert!(in_blocks.iter().all(|mode| mode.backward_error <= 1e-9));
    worst
}

fn small_brake() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("meshes/brake-small.toml")
}

#[test]
fn eigensolvers_agree_on_a_damped_brake() {
    assert!(distance(&both(&small_brake(), 0.5)) < 1e-9);
}

/// The modes at the last of some friction values, found in blocks after those at the others.
fn in_blocks_along(comm: &Comm, friction_values: &[f64]) -> Band {
    let brake = FullModel::read(comm, &small_brake()).unwrap();
    let families = brake.families().unwrap();
    let system = brake.assemble(comm, &families).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    sweep.solve_as_large();
    let mut modes_at = |&friction: &f64| {
        let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
        sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap()
    };
    friction_values.iter().map(&mut modes_at).last().unwrap()
}

#[test]
fn a_search_starts_from_the_modes_of_another_friction() {
    let comm = Session::start(&[]).unwrap();
    let [alone, after] = [in_blocks_along(&comm, &[0.6]), in_blocks_along(&comm, &[0.5, 0.6])];
    println!("{} and {} solves", alone.report.n_solves, after.report.n_solves);
    assert!(4 * after.report.n_solves < 3 * alone.report.n_solves);
    assert!(alone.count.agrees() && after.count.agrees());
    let distance = distance(&[alone.modes, after.modes]);
    assert!(distance < 1e-9, "{distance:e}");
}

#[test]
fn eigensolvers_agree_where_undamped_modes_couple() {
    assert!(distance(&both(&data("pads_on_disc.toml"), 0.6)) < 1e-9);
}
