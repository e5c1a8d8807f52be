//! Which part of a slave starts in contact.

use super::*;

/// The good deck with the pad at another place (mm) and the nodes of a set for ADJUST.
fn adjusted(shift: [f64; 3], set: &str) -> std::result::Result<Converted, String> {
    let pad = [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];
    let moved = pad.map(|x| [0, 1, 2].map(|i| x[i] + shift[i]));
    let text = good().replace(&nodes(11, pad), &nodes(11, moved));
    let text = text.replace("*CONTACT PAIR, INTERACTION=I\n", "*CONTACT PAIR, INTERACTION=I, ADJUST=Near\n");
    read(&text.replace("*MATERIAL, NAME=Steel\n", &format!("*NSET, NSET=Near\n{set}\n*MATERIAL, NAME=Steel\n")))
}

/// The face of the pad, and its other nodes.
const FACE: &str = "11, 12, 13, 15, 16, 17";

/// Heights of the pad's nodes, mm.
fn heights(converted: &Converted) -> Vec<f64> {
    converted.mesh.nodes[10..].iter().map(|x| (1e9 * x[2]).round() / 1e6).collect()
}

#[test]
fn gaps_up_to_a_distance_are_closed() {
    let adjusted = |value: &str| with("INTERACTION=I\n", &format!("INTERACTION=I, ADJUST={value}\n"));
    assert!(close(adjusted("0.02").unwrap().model.contacts[0].adjust, 2e-5));
    assert!(adjusted("-1.").unwrap_err().starts_with("a.inp:51: ADJUST must be 0 or above, not -1"));
}

#[test]
fn slave_nodes_of_a_set_are_moved_onto_the_master_from_a_gap_and_from_an_overlap() {
    for gap in [0.5, -0.25] {
        let found = adjusted([0.0, 0.0, gap], FACE).unwrap();
        let (apex, middle) = (10.0 + gap, 5.0 + gap);
        assert_eq!(heights(&found), [0.0, 0.0, 0.0, apex, 0.0, 0.0, 0.0, middle, middle, middle]);
        assert_eq!(found.model.contacts[0].adjust, 0.0);
        let note = format!("ADJUST: 6 nodes of Near are moved onto Disc_face, by {:.2e} at most", gap.abs());
        assert!(found.summary.notes.contains(&note), "{:?}", found.summary.notes);
    }
}

/// As in CalculiX.
#[test]
fn nodes_of_a_tied_pair_are_moved_too_but_not_by_a_distance() {
    let tied = |value: &str| {
        let pad = [[0.0, 0.0, 0.5], [10.0, 0.0, 0.5], [0.0, 10.0, 0.5], [0.0, 0.0, 10.5]];
        let low = [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];
        let text = good().replace(&nodes(11, low), &nodes(11, pad));
        let pair = format!("*CONTACT PAIR, INTERACTION=I, TIED, ADJUST={value}\n");
        let text = text.replace("*CONTACT PAIR, INTERACTION=I\n", &pair);
        let set = format!("*NSET, NSET=Near\n{FACE}\n*MATERIAL, NAME=Steel\n");
        read(&text.replace("*MATERIAL, NAME=Steel\n", &set)).unwrap()
    };
    let by_set = tied("Near");
    assert_eq!((by_set.model.ties.len(), heights(&by_set)[0]), (1, 0.0));
    assert!(!by_set.summary.notes.iter().any(|note| note.contains("not applied")), "{:?}", by_set.summary.notes);
    let by_distance = tied("1.");
    assert_eq!(heights(&by_distance)[0], 0.5);
    let is_noted = |note: &String| note.starts_with("ADJUST of the tied pair") && note.contains("is not applied");
    assert!(by_distance.summary.notes.iter().any(is_noted), "{:?}", by_distance.summary.notes);
}

#[test]
fn nodes_of_no_slave_and_nodes_outside_the_set_stay() {
    let found = adjusted([0.0, 0.0, 0.5], "11, 16, 18, 3").unwrap();
    assert_eq!(heights(&found), [0.0, 0.5, 0.5, 10.5, 0.5, 0.0, 0.5, 5.5, 5.5, 5.5]);
    assert_eq!(found.mesh.nodes[2], [0.01, 0.0, 0.0]);
}

#[test]
fn nodes_beside_the_master_stay_and_are_noted() {
    let found = adjusted([-5.0, 0.0, 0.5], FACE).unwrap();
    // Nodes at x < 0: a corner, the midside of y, and the corner at (-5, 10).
    assert_eq!(heights(&found)[..7], [0.5, 0.0, 0.5, 10.5, 0.0, 0.0, 0.5]);
    let note = "ADJUST: 3 nodes of Near are moved onto Disc_face, by 5.00e-1 at most; 3 lie beside it and stay";
    assert!(found.summary.notes.iter().any(|own| own == note), "{:?}", found.summary.notes);
}

#[test]
fn sets_that_say_nothing_and_nodes_that_cannot_be_moved_are_refused() {
    let message = |shift, set| adjusted(shift, set).unwrap_err();
    let far = message([0.0, 0.0, -20.0], FACE);
    assert!(
        far.starts_with("a.inp:54: ADJUST moves nodes onto Disc_face so far that elements turn inside out"),
        "{far}"
    );
    let other = message([0.0; 3], "18, 1");
    assert!(other.starts_with("a.inp:54: no node of Near is on the slave Pad_face (ADJUST). Name nodes"), "{other}");
    let unknown = with("INTERACTION=I\n", "INTERACTION=I, ADJUST=Nea\n").unwrap_err();
    assert!(unknown.starts_with("a.inp:52: there is no node set Nea"), "{unknown}");
}
