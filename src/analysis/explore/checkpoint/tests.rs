//! What an earlier run has left, whole and damaged.

use num_complex::Complex64;

use super::*;
use crate::explore::{Difference, Link, Outcome, PointMode};
use crate::native::{Block, Session};

fn point(values: &[f64]) -> PointResult {
    let link = Some(Link { nominal: 2, share: 1.0 / 3.0, doubtful: true });
    let lambda = Complex64::new(0.1, 1e4 / 3.0);
    let mode = PointMode { lambda, unstable: true, backward_error: 1e-13, link };
    PointResult { values: values.to_vec(), outcome: Outcome::Modes(vec![mode]) }
}

fn shapes() -> Vec<Shape> {
    vec![Shape { re: vec![[1.0, 0.0, 1.0 / 3.0]], im: vec![[0.0, 0.1, -0.2]] }]
}

#[test]
fn an_earlier_run_is_continued_bit_by_bit() {
    let comm = Session::start(&[]).unwrap();
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("run");
    let folder = Folder::open(&target, false).unwrap();
    let groups = Groups::new(&comm, 1).unwrap();
    let open = |identity: &str, force| {
        Points::open(&groups, Some(&folder), Some(&target), &[("seed", identity.to_owned())], force)
    };
    let mut points = open("1", false).unwrap();
    let nominal = WeightedModes {
        left: Block::from_columns(&comm, 2, vec![1.0, 2.0, 3.0, 1.0 / 3.0]),
        right: Block::from_columns(&comm, 2, vec![0.1; 4]),
        own: vec![Complex64::new(0.1, 0.2)],
    };
    points.keep_nominal(&nominal).unwrap();
    let slopes = vec![Complex64::new(1.0 / 3.0, -7.0)];
    points.keep_gradients(vec![Gradient { slopes, difference: Difference::Forward }]).unwrap();
    points.commit(0, point(&[0.1, 5.0]), shapes(), Some(vec![1.0 / 7.0])).unwrap();
    points.commit(1, point(&[0.3, 5.0]), vec![], None).unwrap();
    // Another group has point 2.
    points.commit(3, point(&[0.4, 5.0]), vec![], Some(vec![1.0])).unwrap();
    assert_eq!((points.missing(5), points.news().len(), points.news().len()), (vec![2, 4], 3, 0));
    let again = open("1", false).unwrap();
    assert_eq!((&again.done, &again.states), (&points.done, &points.states));
    assert_eq!((again.shapes(0).unwrap(), again.shapes(1).unwrap()), (shapes(), vec![]));
    assert!(again.gradients == points.gradients && again.gradients.len() == 1);
    let kept = again.nominal().unwrap();
    assert!(kept.left.values() == nominal.left.values() && kept.own == nominal.own);
    let state = folder.draft().join(".resume/state-000000.1.0.h5");
    std::fs::rename(&state, state.with_extension("away")).unwrap();
    assert_eq!(open("1", false).unwrap().states, BTreeMap::from([(3, vec![1.0])]), "a state is missing");
    let message = open("2", false).err().unwrap().to_string();
    assert!(message.contains("3 points are done") && message.contains("seed was 1, is 2"), "{message}");
    for Damage { file, is_absent } in damages() {
        std::fs::write(folder.draft().join(".resume").join(file), [1, 2]).unwrap();
        let again = open("1", false).unwrap();
        assert!(is_absent(&again), "{file}");
    }
    let again = open("1", false).unwrap();
    assert_eq!((again.missing(4), again.warnings.len()), (vec![1, 2], 0), "the damaged file is removed");
    assert!(open("2", true).unwrap().done.is_empty());
}

/// A file to be damaged, and whether what it has counts as absent.
struct Damage {
    file: &'static str,
    is_absent: fn(&Points) -> bool,
}

fn damages() -> [Damage; 4] {
    [
        Damage { file: "state-000003.1.0.h5", is_absent: |points| points.n_states() == 0 && points.missing(4) == [2] },
        Damage { file: "nominal.1.0.h5", is_absent: |points| points.nominal().is_none() && points.get(0).is_some() },
        Damage { file: "gradients.bin", is_absent: |points| points.gradients.is_empty() && points.missing(4) == [2] },
        Damage {
            file: "point-000001.bin",
            is_absent: |points| points.missing(4) == [1, 2] && points.warnings[0].contains("point-000001.bin"),
        },
    ]
}

/// What another group of the same run writes is found by its file. Of a run on other ranks all serves but the
/// displacements.
#[test]
fn points_of_other_groups_are_found() {
    let comm = Session::start(&[]).unwrap();
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("run");
    let folder = Folder::open(&target, false).unwrap();
    let groups = Groups::new(&comm, 1).unwrap();
    let open = || Points::open(&groups, Some(&folder), Some(&target), &[], false).unwrap();
    let (mut own, mut other) = (open(), open());
    other.commit(0, point(&[0.1]), vec![], None).unwrap();
    let path = other.place().unwrap().join(point_name(2));
    other.keep_binary(&path, &KeptPoint { n_state_files: 4, point: point(&[0.2]), shapes: Vec::new() }).unwrap();
    own.look_for(&[0, 1, 2]);
    assert_eq!((own.missing(3), own.news().len()), (vec![1], 2));
    other.commit(1, point(&[0.3]), vec![], None).unwrap();
    own.look_for(&[1]);
    assert_eq!(own.missing(3), [1], "it has just looked");
    let again = open();
    assert_eq!((again.missing(4), again.n_states()), (vec![3], 0));
}

#[test]
fn a_point_starts_from_the_nearest_one() {
    let comm = Session::start(&[]).unwrap();
    let groups = Groups::new(&comm, 1).unwrap();
    let mut points = Points::open(&groups, None, None, &[], false).unwrap();
    assert_eq!(points.nearest(&[0.2, 5.0], &[1.0, 1.0]), None);
    let finished = [([0.1, 5.0], Some(1.0)), ([0.2, 9.0], Some(2.0)), ([0.2, 5.0], None)];
    for (number, (values, state)) in finished.into_iter().enumerate() {
        points.commit(number, point(&values), vec![], state.map(|u| vec![u])).unwrap();
    }
    assert_eq!(points.nearest(&[0.2, 5.0], &[1.0, 1.0]), Some(&[1.0][..]));
    assert_eq!(points.nearest(&[0.2, 5.0], &[0.001, 1.0]), Some(&[2.0][..]), "measured by the scales");
    assert_eq!(points.n_states(), 2);
}
