//! Supports, and the displacements that they prescribe.

use super::*;

#[test]
fn a_held_kinematic_coupling_is_a_support_and_a_distributing_one_spreads_a_force() {
    let coupled = |kind: &str, action: &str| {
        let text = format!(
            "*NODE\n103, 3.3333333333, 3.3333333333, 5.\n*COUPLING, REF NODE=103, SURFACE=DISC_FACE\n{kind}\n{action}\n*MATERIAL, NAME=Steel\n"
        );
        with("*MATERIAL, NAME=Steel\n", &text).map(|converted| converted.model)
    };
    let held = coupled("*KINEMATIC\n1, 2", "*BOUNDARY\n103, 1, 6").unwrap();
    assert_eq!((held.fixes[1].nodes.as_str(), held.fixes[1].axes), ("Disc_face", [true, true, false]));
    let spread = coupled("*DISTRIBUTING", "*CLOAD\n103, 3, -7.").unwrap();
    assert_eq!(spread.loads[1].kind, LoadKind::ForceByArea([0.0, 0.0, -7.0]));
}

#[test]
fn the_last_displacement_of_a_node_counts_and_goes_with_what_else_holds_the_node() {
    let step = "*CLOAD\nBACK, 3, -25.\n";
    let Converted { model, mesh, .. } = with(step, "*BOUNDARY\n8, 2, 2, 0.3\n7, 1, 1, 5.\n7, 1, 1, 0.\n").unwrap();
    let fixes: Vec<_> = model.fixes.iter().map(|fix| (mesh.node_set(&fix.nodes).unwrap(), fix.displacement)).collect();
    assert!(fixes.contains(&(vec![7], [0.0, 0.3 * 1e-3, 0.0])), "{fixes:?}");
    assert!(fixes.contains(&(vec![6, 8, 9], [0.0; 3])), "{fixes:?}");
    assert!(fixes.iter().all(|(nodes, moved)| nodes.contains(&7) == (*moved != [0.0; 3])));
    let mut deck = Vec::new();
    crate::deck::write(&model, &mesh, UnitSystem::ALL[0], "a test", &mut deck).unwrap();
    let again = read(&String::from_utf8(deck).unwrap()).unwrap();
    let moved = again.model.fixes.iter().find(|fix| fix.displacement != [0.0; 3]).unwrap();
    assert!(close(moved.displacement[1], 0.3e-3) && moved.axes == [true; 3]);
}

#[test]
fn a_reference_node_that_is_held_moves_what_follows_it() {
    let coupled = |actions: &str| {
        let text = format!(
            "*NODE\n103, 3.3, 3.3, 5.\n*COUPLING, REF NODE=103, SURFACE=DISC_FACE\n*KINEMATIC\n1, 3\n*BOUNDARY\n{actions}\n*MATERIAL, NAME=Steel\n"
        );
        with("*MATERIAL, NAME=Steel\n", &text).map(|converted| converted.model)
    };
    let moved = coupled("103, 1, 6\n103, 2, 2, -0.5").unwrap();
    assert_eq!((moved.fixes[1].nodes.as_str(), moved.fixes[1].displacement), ("Disc_face", [0.0, -0.5 * 1e-3, 0.0]));
    for refused in ["103, 1, 5\n103, 2, 2, -0.5", "103, 1, 6\n103, 5, 5, 0.1"] {
        let message = coupled(refused).unwrap_err();
        assert!(message.contains("a displacement other than 0 is supported of nodes of solids"), "{message}");
    }
}
