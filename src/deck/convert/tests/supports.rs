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

#[test]
fn displacements_along_local_axes_are_turned_or_refused() {
    // The first local axis is y, the second is -x.
    let along = |axes: &str, rows: &str| {
        let text = format!("*TRANSFORM, NSET=BACK\n{axes}\n*BOUNDARY\n{rows}\n*STEP\n*STATIC\n*CLOAD");
        let Converted { model, mesh, .. } = with("*STEP\n*STATIC\n*CLOAD", &text)?;
        let moved = model.fixes.iter().find(|fix| fix.displacement != [0.0; 3]).unwrap();
        assert_eq!(mesh.node_set(&moved.nodes).unwrap(), [13]);
        Ok::<_, String>((moved.axes, moved.displacement.map(|u| (1e12 * u).round() / 1e9 + 0.0), model.equations.len()))
    };
    let turned = "0., 1., 0., -1., 0., 0.";
    assert_eq!(along(turned, "14, 2, 2, 0.5").unwrap(), ([true, false, false], [-0.5, 0.0, 0.0], 0));
    let oblique = "3., 4., 0., -4., 3., 0.";
    let all = along(oblique, "14, 1, 1, 0.5\n14, 2, 2, 1.\n14, 3, 3, 2.").unwrap();
    assert_eq!(all, ([true; 3], [0.6 * 0.5 - 0.8, 0.8 * 0.5 + 0.6, 2.0], 0));
    // The radius is held by an equation.
    assert_eq!(along(oblique, "14, 3, 3, 2.\n14, 1, 1").unwrap(), ([false, false, true], [0.0, 0.0, 2.0], 1));
    let message = along(oblique, "14, 1, 1, 0.5").unwrap_err();
    assert!(message.contains("along x, y and z or along all three of their local axes"), "{message}");
}
