//! Analyses of a small super-element, whole, stopped and taken up again.

use std::path::Path;

use nalgebra::DMatrix;
use tempfile::TempDir;

use super::{
    Event, ExportOptions, MatrixFormat, Observer, Output, StabilityOptions, StaticOptions, WearGoal, WearOptions,
    export, stability, statics, wear,
};
use crate::contact::ArchardWear;
use crate::equilibrium::testing::{ALONG_X, belt, blocks};
use crate::model::InstabilityCriterion;
use crate::native::{Comm, Session};
use crate::output::folder::{RESUME, unfinished};
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{ContactMotion, NodeContact, Origin, SuperElement};
use crate::results::Wear;
use crate::structure::{ReducedModel, Structure};
use crate::{Error, ErrorKind, Results};

const N: usize = 3;
const VALUES: [f64; 3] = [0.1, 0.2, 0.3];

/// Blocks that a force (N) presses on a belt, as a super-element; the belt's coordinates have no mass and are held.
fn pressed_by(force: f64) -> Structure {
    let matrices = blocks(N).map(|a| a.resize(6 * N, 6 * N, 0.0).as_slice().to_vec());
    let belt = belt(N, ALONG_X);
    let contact = |point: &_| NodeContact { point: Clone::clone(point), displacement: [0.0; 3], normal_force: 0.0 };
    let load = (0..6 * N).map(|i| if i < 3 * N && i % 3 == 2 { -force } else { 0.0 }).collect();
    let element = SuperElement {
        origin: Origin {
            title: "blocks".into(),
            model: "blocks.toml".into(),
            mesh: "blocks.msh".into(),
            mesh_hash: String::new(),
            program: String::new(),
            friction: VALUES[0],
            n_dofs: 3 * N,
            band: [0.0, 10.0],
            limit: 100.0,
            friction_damping: false,
            samples: Vec::new(),
            criterion: InstabilityCriterion::default(),
            prestress_friction: None,
            made_for: None,
        },
        points: vec![[0.0; 3]; 2 * N],
        frequencies: Vec::new(),
        mass: matrices.m,
        damping: matrices.c,
        stiffness: matrices.k,
        viscoelastic: Vec::new(),
        model_text: None,
        geometric_stiffness: None,
        structural_damping: matrices.g,
        parts: Vec::new(),
        rest: Some("blocks".into()),
        load,
        preload: vec![0.0; 6 * N],
        pairs: belt.pairs.clone(),
        contacts: belt.points.iter().map(contact).collect(),
        motion: ContactMotion::Nodes,
    };
    let surface = OuterSurface {
        nodes: (0..N).map(|i| [i as f64, (i % 2) as f64, 0.0]).collect(),
        triangles: vec![[0, 1, 2]],
        part: vec![0],
        parts: vec!["blocks".into()],
        basis: DMatrix::<f32>::identity(3 * N, 6 * N).as_slice().to_vec(),
    };
    Structure::Reduced(Box::new(ReducedModel::new("blocks.se.h5".as_ref(), element, surface)))
}

/// Counts values, keeps warnings, and asks to stop after some of the values.
#[derive(Default)]
struct Counter {
    n_finished: usize,
    n_replayed: usize,
    n_inserted: usize,
    warnings: Vec<String>,
    stop_after: Option<usize>,
}

impl Observer for Counter {
    fn event(&mut self, event: Event) {
        match event {
            Event::Finished(_) | Event::Worn { is_replayed: false, .. } => self.n_finished += 1,
            Event::Replayed(_) | Event::Worn { is_replayed: true, .. } => self.n_replayed += 1,
            Event::Inserted => self.n_inserted += 1,
            Event::Warning(text) => self.warnings.push(text.to_owned()),
            _ => (),
        }
    }

    fn stop_signal(&mut self) -> Option<i32> {
        self.stop_after.filter(|&n| self.n_finished >= n).map(|_| 2)
    }
}

/// Modes at all values into a folder.
fn analyse(comm: &Comm, folder: &Path, options: StabilityOptions, counter: &mut Counter) -> crate::Result<Results> {
    let output = options.output.unwrap_or_default();
    let output = Some(Output { folder: folder.to_owned(), ..output });
    let friction_values = options.friction_values.or(Some(VALUES.to_vec()));
    stability(comm, &pressed_by(10.0), &StabilityOptions { friction_values, output, ..options }, counter)
}

/// What does not depend on clocks.
fn numbers(results: &Results) -> Vec<(f64, Vec<f64>)> {
    let of = |mode: &crate::results::ModeData| mode.lambda.norm();
    results.values.iter().map(|value| (value.friction, value.modes.iter().map(of).collect())).collect()
}

#[test]
fn an_analysis_that_was_stopped_resumes_after_its_last_value() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let (whole, folder) = (place.path().join("whole"), place.path().join("stopped"));
    let whole = analyse(&comm, &whole, StabilityOptions::default(), &mut Counter::default()).unwrap();
    assert!(whole.values.iter().all(|value| value.modes.len() > 3) && whole.diagram.is_some());
    let mut first = Counter { stop_after: Some(2), ..Counter::default() };
    let error = analyse(&comm, &folder, StabilityOptions::default(), &mut first).err().unwrap();
    assert!(matches!(&error, Error::Interrupted { signal: 2, .. }), "{error}");
    assert_eq!(first.n_finished, 2, "the analysis ends after the value at hand");
    let kept = unfinished(&folder).unwrap().join(RESUME);
    assert!(kept.join("value-0001.h5").exists() && !kept.join("value-0002.h5").exists() && !folder.exists());
    assert!(kept.join("path-0001.0.h5").exists() && !kept.join("path-0000.0.h5").exists(), "the last path alone");
    let mut second = Counter::default();
    let resumed = analyse(&comm, &folder, StabilityOptions::default(), &mut second).unwrap();
    assert_eq!((second.n_replayed, second.n_replayed + second.n_finished), (2, whole.values.len()));
    for ((mu, found), (value, expected)) in numbers(&resumed).into_iter().zip(numbers(&whole)) {
        assert!((mu - value).abs() < 1e-6 && found.len() == expected.len(), "{mu}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{mu}");
    }
    let is_first = |value: &crate::results::Value| value.steps.iter().any(|step| step.label == "settle");
    assert!(is_first(&resumed.values[0]) && !is_first(&resumed.values[2]), "the path continues where it was");
    assert!(resumed.costs.contains("without 2 values") && !whole.costs.contains("without"));
}

#[test]
fn an_analysis_begun_otherwise_is_refused_or_begins_again_by_force() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let folder = place.path().join("run");
    let mut counter = Counter { stop_after: Some(1), ..Counter::default() };
    analyse(&comm, &folder, StabilityOptions::default(), &mut counter).err().unwrap();
    let other = |force| StabilityOptions {
        branches: false,
        output: Some(Output { force, ..Output::default() }),
        ..StabilityOptions::default()
    };
    let error = analyse(&comm, &folder, other(false), &mut Counter::default()).err().unwrap();
    let text = error.to_string();
    assert!(error.kind() == ErrorKind::Input && text.contains("analysis was stability, is stability --no-"), "{text}");
    let mut forced = Counter::default();
    analyse(&comm, &folder, other(true), &mut forced).unwrap();
    assert_eq!((forced.n_replayed, forced.n_finished), (0, VALUES.len()));
}

#[test]
fn a_damaged_value_is_refused_before_anything_is_computed_unless_by_force() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let folder = place.path().join("run");
    let mut counter = Counter { stop_after: Some(1), ..Counter::default() };
    analyse(&comm, &folder, StabilityOptions::default(), &mut counter).err().unwrap();
    std::fs::write(unfinished(&folder).unwrap().join(RESUME).join("value-0000.h5"), "nothing").unwrap();
    let mut second = Counter::default();
    let error = analyse(&comm, &folder, StabilityOptions::default(), &mut second).err().unwrap();
    assert!(error.kind() == ErrorKind::Input && second.n_finished == 0, "{error}");
    let output = Some(Output { force: true, ..Output::default() });
    let (mut forced, by_force) = (Counter::default(), StabilityOptions { output, ..StabilityOptions::default() });
    analyse(&comm, &folder, by_force, &mut forced).unwrap();
    assert_eq!((forced.n_replayed, forced.n_finished), (0, VALUES.len()), "force begins again");
}

#[test]
fn a_value_where_another_one_is_due_is_refused() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let folder = place.path().join("run");
    let mut counter = Counter { stop_after: Some(2), ..Counter::default() };
    analyse(&comm, &folder, StabilityOptions::default(), &mut counter).err().unwrap();
    let kept = unfinished(&folder).unwrap().join(RESUME);
    std::fs::copy(kept.join("value-0000.h5"), kept.join("value-0001.h5")).unwrap();
    let error = analyse(&comm, &folder, StabilityOptions::default(), &mut Counter::default()).err().unwrap();
    assert!(error.to_string().contains("has friction coefficient 0.1 where"), "{error}");
}

/// Wear of the blocks by the belt, in steps of one length, into a folder.
fn wear_blocks(comm: &Comm, output: Output, n_steps: usize, counter: &mut Counter) -> crate::Result<(Wear, Vec<f64>)> {
    let mut blocks = pressed_by(10.0);
    blocks.interface_mut().pairs[0].wear = Some(ArchardWear { coefficient: 1e-2, density: 3.0 });
    let goal = WearGoal::Distance { distance: n_steps as f64, n_steps };
    let options = WearOptions { friction: Some(0.2), goal, output: Some(output) };
    let worn = wear(comm, &mut blocks, &options, counter)?;
    Ok((worn, blocks.interface().points.iter().map(|point| point.law.gap).collect()))
}

#[test]
fn wear_that_was_stopped_resumes_after_its_last_step_and_ends_with_the_same_numbers() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let output = |name: &str| Output { folder: place.path().join(name), ..Output::default() };
    let (whole, gaps) = wear_blocks(&comm, output("whole"), 4, &mut Counter::default()).unwrap();
    let last = &whole.steps[4].pairs[0];
    assert!(last.volume > 0.0 && (last.volume / last.archard_volume - 1.0).abs() < 1e-12);
    assert!((last.mass - 3.0 * last.volume).abs() < 1e-12 * last.mass && whole.is_reduced);
    assert!(gaps.iter().zip(&whole.points).all(|(gap, point)| *gap > 0.0 && *gap == point.gap_m));
    let mut first = Counter { stop_after: Some(3), ..Counter::default() };
    let error = wear_blocks(&comm, output("run"), 4, &mut first).err().unwrap();
    assert!(matches!(&error, Error::Interrupted { signal: 2, .. }) && first.n_finished == 3, "{error}");
    assert!(error.to_string().contains("m of sliding; 3 equilibria are done. The same command goes on"), "{error}");
    let kept = unfinished(&place.path().join("run")).unwrap().join(RESUME);
    let has = |i: usize| kept.join(format!("state-000{i}.0.bin")).exists();
    assert_eq!([0, 1, 2].map(has), [true, false, true], "the first and the last state alone");
    let other = wear_blocks(&comm, output("run"), 5, &mut Counter::default()).err().unwrap().to_string();
    assert!(other.contains("goal was Distance"), "{other}");
    let mut second = Counter::default();
    let (resumed, same) = wear_blocks(&comm, output("run"), 4, &mut second).unwrap();
    assert_eq!((second.n_replayed, second.n_finished), (3, 2));
    assert_eq!((&resumed.steps, &resumed.points, same), (&whole.steps, &whole.points, gaps));
}

#[test]
fn damaged_states_of_wear_are_refused_before_anything_is_computed_unless_by_force() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    for damaged in ["step-0000.bin", "state-0001.0.bin"] {
        let folder = place.path().join(damaged);
        let output = |force| Output { folder: folder.clone(), force, ..Output::default() };
        let kept = unfinished(&folder).unwrap().join(RESUME);
        let mut counter = Counter { stop_after: Some(2), ..Counter::default() };
        wear_blocks(&comm, output(false), 2, &mut counter).err().unwrap();
        std::fs::write(kept.join(damaged), [7]).unwrap();
        let mut second = Counter::default();
        let error = wear_blocks(&comm, output(false), 2, &mut second).err().unwrap();
        assert!(error.to_string().contains(damaged) && second.n_finished == 0, "{error}");
        let mut forced = Counter { stop_after: Some(1), ..Counter::default() };
        wear_blocks(&comm, output(true), 2, &mut forced).err().unwrap();
        assert_eq!((forced.n_replayed, forced.n_finished), (0, 1));
    }
}

#[test]
fn matrices_are_exported_about_one_equilibrium() {
    let comm = Session::start(&[]).unwrap();
    let export = |friction: &[f64]| {
        let format = MatrixFormat::Petsc;
        let options = ExportOptions { with_contact: true, friction: Some(friction.to_vec()), format };
        export(&comm, &pressed_by(10.0), &options, None, &mut ())
    };
    assert_eq!(export(&[0.2]).unwrap().friction, Some(0.2));
    assert_eq!(export(&VALUES).err().unwrap().kind(), ErrorKind::Input);
}

#[test]
fn values_come_in_the_order_given_unless_modes_are_followed() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let order = |name: &str, branches| {
        let friction_values = Some(vec![0.3, 0.1, 0.2]);
        let options = StabilityOptions { friction_values, branches, ..StabilityOptions::default() };
        let results = analyse(&comm, &place.path().join(name), options, &mut Counter::default()).unwrap();
        results.values.iter().filter(|value| value.asked).map(|value| value.friction).collect::<Vec<_>>()
    };
    assert_eq!(order("alone", false), [0.3, 0.1, 0.2]);
    assert_eq!(order("followed", true), VALUES);
}

#[test]
fn an_equilibrium_that_is_not_reached_leaves_its_steps_and_its_last_state() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let output = Some(Output { folder: place.path().join("run"), ..Output::default() });
    let options = StaticOptions { friction_values: Some(VALUES.to_vec()), output };
    let results = statics(&comm, &pressed_by(f64::NAN), &options, &mut ()).unwrap();
    let failure = results.failure.expect("a load that is no number has no equilibrium");
    assert!(results.values.is_empty() && failure.friction == Some(VALUES[0]) && !failure.steps.is_empty());
    assert!(failure.reason.contains("The last state is in"), "{}", failure.reason);
}

#[test]
fn a_warning_says_at_which_values_no_sliding_contact_is_closed() {
    let comm = Session::start(&[]).unwrap();
    let warnings = |force| {
        let options = StaticOptions { friction_values: Some(vec![0.1, 0.25]), output: None };
        let mut counter = Counter::default();
        statics(&comm, &pressed_by(force), &options, &mut counter).unwrap();
        counter.warnings
    };
    assert!(warnings(10.0).is_empty());
    let text = |friction| format!("no sliding contact carries a force at friction {friction}: the loads close none");
    assert_eq!(warnings(-10.0), ["0.100", "0.250"].map(text));
}

#[test]
fn modes_of_the_band_alone_are_results_and_unstable_ones_are_explained_where_a_value_was_asked_for() {
    let (comm, place) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let options =
        StabilityOptions { friction_values: Some(vec![0.1, 2.5]), band: Some([4.0, 8.0]), ..Default::default() };
    let mut counter = Counter::default();
    let results = analyse(&comm, &place.path().join("run"), options, &mut counter).unwrap();
    assert!(counter.n_inserted > 0, "a Hopf point is bracketed by values that were not asked for");
    assert_eq!(results.values.iter().filter(|value| !value.asked).count(), counter.n_inserted);
    let names = std::fs::read_dir(place.path().join("run")).unwrap();
    let n_fields = names.filter(|name| name.as_ref().unwrap().file_name().to_string_lossy().starts_with("equilibrium"));
    assert_eq!(n_fields.count(), 2, "fields of the values asked for");
    for value in &results.values {
        for mode in &value.modes {
            assert!((4.0..=8.0).contains(&(mode.lambda.im / std::f64::consts::TAU)));
            let is_explained = value.asked && mode.unstable;
            assert_eq!((mode.shape.is_some(), !mode.sources.is_empty()), (is_explained, is_explained));
        }
    }
    assert!(results.values.iter().any(|value| value.asked && value.modes.iter().any(|mode| mode.unstable)));
}
