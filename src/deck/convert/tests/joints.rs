//! What ties, rigid bodies, equations, springs, masses and connectors of a deck mean.

use super::*;
use crate::model::{GROUND, Model};

/// The model of the good deck with these lines before its material.
#[track_caller]
fn model(lines: &str) -> Model {
    with("*MATERIAL, NAME=Steel\n", &format!("{lines}\n*MATERIAL, NAME=Steel\n")).unwrap().model
}

/// A reference node above the pad, coupled to its side.
fn coupled(kind: &str, lines: &str) -> String {
    format!(
        "*NODE\n101, 1., 2., 20.\n*SURFACE, NAME=Side\nPAD, S4\n*COUPLING, REF NODE=101, SURFACE=SIDE\n{kind}\n{lines}"
    )
}

fn all_close(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs())
}

#[test]
fn ties_and_tied_contact_are_ties() {
    let tied = model("*TIE, NAME=Glue, POSITION TOLERANCE=0.5, ADJUST=NO\nPAD_FACE, DISC_FACE");
    let tie = &tied.ties[0];
    assert_eq!((tie.name.as_str(), tie.slave.as_str(), tie.master.as_str()), ("Glue", "Pad_face", "Disc_face"));
    assert!(close(tie.search_distance.unwrap(), 5e-4) && tie.stiffness.is_none());
    let pair = with("*CONTACT PAIR, INTERACTION=I", "*CONTACT PAIR, INTERACTION=I, TIED").unwrap().model;
    assert_eq!((pair.contacts.len(), pair.ties[0].stiffness), (0, None));
    let pair = with("=LINEAR\n20000.", "=TIED\n20000.").unwrap().model;
    assert!(pair.contacts.is_empty() && close(pair.ties[0].stiffness.unwrap(), 2e13));
    let Converted { summary, .. } =
        with("*MATERIAL, NAME=Steel\n", "*TIE, NAME=T, ADJUST=YES\nPAD_FACE, DISC_FACE\n*MATERIAL, NAME=Steel\n")
            .unwrap();
    assert!(summary.notes.iter().any(|note| note.starts_with("ADJUST of the tie T")), "{:?}", summary.notes);
}

#[test]
fn rigid_bodies_are_rigid_sets_and_what_is_on_their_nodes_acts_there() {
    let body = model(
        "*NODE\n101, 1., 2., 20.\n102, 1., 2., 20.\n*NSET, NSET=TOP\n14, 18, 19, 20\n\
         *RIGID BODY, NSET=TOP, REF NODE=101, ROT NODE=102\n*CLOAD\n101, 1, 3.\n102, 3, 5.",
    );
    // The set has the nodes of BACK, and a name of its own.
    assert_eq!((body.rigid_sets.len(), body.rigid_sets[0].nodes.as_str()), (1, "TOP"));
    let load = body.loads.iter().find(|load| load.on == "TOP").unwrap();
    let LoadKind::ForceAt { force, moment, at } = load.kind else { panic!("{load:?}") };
    assert_eq!((force, at), ([3.0, 0.0, 0.0], Some([1e-3, 2e-3, 20e-3])));
    assert!(all_close(moment, [0.0, 0.0, 5e-3]));
    let beams = model("*NODE\n101, 1., 2., 20.\n*MPC\nBEAM, 14, 101\nBEAM, 18, 101\nBEAM, 19, 101");
    assert_eq!((beams.rigid_sets[0].nodes.as_str(), beams.equations.len()), ("beams to node 101", 0));
    let of_elements = model("*NODE\n101, 1., 2., 20.\n*RIGID BODY, ELSET=PAD, REF NODE=101");
    assert_eq!(of_elements.rigid_sets[0].nodes, "PAD nodes");
}

#[test]
fn a_reference_node_that_is_held_in_part_is_stiffly_joined_to_the_ground() {
    for (kind, n_rigid) in [("*KINEMATIC", 1), ("*DISTRIBUTING", 0)] {
        let held = model(&coupled(kind, "*BOUNDARY\n101, 1, 2\n101, 6"));
        let support = &held.connectors[0];
        assert_eq!((held.rigid_sets.len(), support.between.clone()), (n_rigid, ["Side".to_owned(), GROUND.to_owned()]));
        let [x, y, z] = support.stiffness;
        assert!(x > 1e11 && x == y && z == 0.0 && support.at == Some([1e-3, 2e-3, 20e-3]));
        let [u, v, w] = support.rotational_stiffness;
        assert!(u == 0.0 && v == 0.0 && w > 0.0);
    }
    let all = model(&coupled("*DISTRIBUTING", "*BOUNDARY\n101, 1, 6"));
    assert!(all.connectors[0].stiffness.iter().all(|k| *k > 0.0) && all.fixes.len() == 1);
}

#[test]
fn a_force_off_the_centroid_and_a_moment_act_at_the_point() {
    let spread = model(&coupled("*DISTRIBUTING", "*CLOAD\n101, 3, -7.\n101, 3, -1.\n101, 4, 2."));
    let load = spread.loads.iter().find(|load| load.on == "Side").unwrap();
    let LoadKind::ForceAt { force, moment, at } = load.kind else { panic!("{load:?}") };
    assert_eq!((force, at), ([0.0, 0.0, -8.0], Some([1e-3, 2e-3, 20e-3])));
    assert!(all_close(moment, [2e-3, 0.0, 0.0]));
}

#[test]
fn equations_are_between_nodes_or_sets_pairwise() {
    let one = model("*EQUATION\n3\n1, 1, 1., 12, 2, -2.,\n13, 3, 0.5\n2\n2, 2, 1., 3, 2, -1.");
    let terms = |i: usize| -> Vec<(&str, usize, f64)> {
        one.equations[i].terms.iter().map(|term| (term.node.as_str(), term.axis, term.coefficient)).collect()
    };
    assert_eq!(terms(0), [("node 1", 0, 1.0), ("node 12", 1, -2.0), ("node 13", 2, 0.5)]);
    assert_eq!(terms(1), [("node 2", 1, 1.0), ("node 3", 1, -1.0)]);
    let sets = model("*EQUATION\n3\nHUB, 1, 1., BACK, 1, -1., 1, 1, 3.");
    let first: Vec<&str> = sets.equations.iter().map(|own| own.terms[1].node.as_str()).collect();
    assert_eq!((sets.equations.len(), first), (4, vec!["node 7", "node 8", "node 9", "node 10"]));
    let pins = model("*MPC\nPIN, 2, 12\nBEAM, 4, 14");
    assert_eq!(pins.equations.iter().map(|own| own.terms.len()).collect::<Vec<_>>(), [2, 2, 2, 2]);
    assert_eq!(pins.equations[3].terms[0].axis, 2);
}

#[test]
fn supports_forces_and_equations_follow_local_axes() {
    // The first local axis is y, the second is -x.
    let turned = model("*TRANSFORM, NSET=BACK\n0., 1., 0., -1., 0., 0.\n*BOUNDARY\nBACK, 2");
    let support = turned.fixes.iter().find(|fix| fix.nodes == "support").unwrap();
    assert_eq!((support.axes, turned.equations.len()), ([true, false, false], 0));
    let text = "*TRANSFORM, NSET=BACK\n1., 1., 0., -1., 1., 0.\n*BOUNDARY\nBACK, 1";
    let oblique = model(&format!("{text}\n*CLOAD\n14, 2, 2."));
    assert_eq!((oblique.equations.len(), oblique.fixes.len()), (4, 1));
    let terms: Vec<f64> = oblique.equations[0].terms.iter().map(|term| term.coefficient).collect();
    assert!(terms.iter().all(|c| close(*c, 0.5_f64.sqrt())), "{terms:?}");
    let load = oblique.loads.iter().find(|load| load.on == "load 2").unwrap();
    let LoadKind::ForceByNode(force) = load.kind else { panic!("{load:?}") };
    assert!(all_close(force, [-(2.0_f64.sqrt()), 2.0_f64.sqrt(), -25.0]), "{load:?}");
    let all = model("*TRANSFORM, NSET=BACK, TYPE=C\n50., 0., 0., 50., 0., 1.\n*BOUNDARY\nBACK, 1, 3");
    assert_eq!(
        (all.equations.len(), all.fixes.iter().any(|fix| fix.axes == [true; 3] && fix.nodes == "support")),
        (0, true)
    );
}

#[test]
fn springs_go_to_the_ground_and_between_nodes() {
    let spring = |nodes: &str, kind: &str, dofs: &str| {
        model(&format!("*ELEMENT, TYPE={kind}, ELSET=S\n901, {nodes}\n*SPRING, ELSET=S\n{dofs}\n500."))
    };
    let ground = spring("14", "SPRING1", "2");
    let own = &ground.connectors[0];
    assert_eq!(own.between, ["node 14".to_owned(), GROUND.to_owned()]);
    assert!(all_close(own.stiffness, [0.0, 5e5, 0.0]) && own.at == Some([0.0, 0.0, 0.01]));
    let along = spring("4, 14", "SPRINGA", "");
    assert!(all_close(along.connectors[0].stiffness, [0.0, 0.0, 5e5]));
    // From (0, 10, 0) to (0, 0, 10) mm.
    let oblique = spring("2, 14", "SPRINGA", "");
    let [x, y, z] = oblique.connectors[0].axes.unwrap();
    let half = 0.5_f64.sqrt();
    assert!(all_close([-half, half, 1.0], [x[1], x[2], y[0].abs()]) && x[0] == 0.0, "{x:?} {y:?} {z:?}");
    assert!(all_close(oblique.connectors[0].stiffness, [5e5, 0.0, 0.0]));
    let axes = "*ORIENTATION, NAME=A\n3., 4., 0., -4., 3., 0.\n*ELEMENT, TYPE=SPRING2, ELSET=S\n901, 1, 11\n";
    let turned = model(&format!("{axes}*SPRING, ELSET=S, ORIENTATION=A\n2, 2\n500."));
    let own = &turned.connectors[0];
    assert!(all_close(own.stiffness, [0.0, 5e5, 0.0]) && all_close(own.axes.unwrap()[1], [-0.8, 0.6, 0.0]), "{own:?}");
    let bush = axes.replace("SPRING2", "CONN3D2") + "*CONNECTOR SECTION, ELSET=S\nJOIN\nA";
    assert!(all_close(model(&bush).connectors[0].axes.unwrap()[0], [0.6, 0.8, 0.0]));
    let in_part = axes.replace("SPRING2", "SPRING1").replace("901, 1, 11", "901, 14");
    let instance = read(&as_instance(&format!("{in_part}*SPRING, ELSET=S, ORIENTATION=A\n2\n500.\n"))).unwrap();
    let turned = instance.model.connectors[0].axes.unwrap()[1];
    assert!((0..3).all(|i| close(turned[i] + 2.0, [1.4, 1.2, 2.0][i])), "{turned:?}");
    let between = spring("4, 14", "SPRING2", "3, 3");
    assert_eq!(between.connectors[0].between, ["node 4".to_owned(), "node 14".to_owned()]);
    let held = model(
        "*NODE\n101, 0., 0., 30.\n*BOUNDARY\n101, 1, 3\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n901, 101, 14\n\
         *SPRING, ELSET=S\n\n500.",
    );
    assert_eq!(held.connectors[0].between, ["node 14".to_owned(), GROUND.to_owned()]);
    let reference =
        model(&coupled("*KINEMATIC", "*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 101\n*SPRING, ELSET=S\n5\n500."));
    assert!(all_close(reference.connectors[0].rotational_stiffness, [0.0, 0.5, 0.0]));
    let dashpot = model("*ELEMENT, TYPE=DASHPOT1, ELSET=S\n901, 14\n*DASHPOT, ELSET=S\n1\n0.2");
    assert!(all_close(dashpot.connectors[0].damping, [200.0, 0.0, 0.0]));
}

#[test]
fn masses_and_inertias_on_one_node_are_one_mass() {
    let both = "*ELEMENT, TYPE=MASS, ELSET=M\n901, 101\n*MASS, ELSET=M\n2e-6\n*ELEMENT, TYPE=ROTARYI, ELSET=R\n902, 101\n\
                *ROTARY INERTIA, ELSET=R\n1e-3, 2e-3, 3e-3, 1e-4, 2e-4, 3e-4";
    let own = model(&coupled("*DISTRIBUTING", both));
    let mass = &own.masses[0];
    assert_eq!((own.masses.len(), mass.nodes.as_str(), mass.at), (1, "Side", Some([1e-3, 2e-3, 20e-3])));
    let expected = [1e-6, 2e-6, 3e-6, 1e-7, 3e-7, 2e-7];
    assert!(close(mass.mass, 2e-3) && mass.inertia.iter().zip(expected).all(|(a, b)| close(*a, b)), "{mass:?}");
    let rod = model(&coupled("*DISTRIBUTING", &both.replace("1e-3, 2e-3, 3e-3, 1e-4, 2e-4, 3e-4", "0, 2e-3, 2e-3")));
    assert!(rod.masses[0].inertia.iter().zip([0.0, 2e-6, 2e-6, 0.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-18));
    let single = model("*ELEMENT, TYPE=MASS, ELSET=M\n901, 14\n*MASS, ELSET=M\n2e-6");
    assert_eq!(single.masses[0].nodes, "node 14");
}

#[test]
fn connector_elements_have_components() {
    let two = "*NODE\n102, 1., 2., 20.\n*SURFACE, NAME=Hub_nodes, TYPE=NODE\nHUB\n\
               *COUPLING, REF NODE=102, SURFACE=HUB_NODES\n*DISTRIBUTING\n*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 101, 102\n";
    let section = |types: &str, behaviour: &str| {
        let text = format!(
            "{two}*CONNECTOR SECTION, ELSET=C{behaviour}\n{types}\n*CONNECTOR BEHAVIOR, NAME=B\n\
            *CONNECTOR ELASTICITY, COMPONENT=1\n10.\n*CONNECTOR ELASTICITY, COMPONENT=4\n20.\n*CONNECTOR DAMPING, COMPONENT=2\n0.1"
        );
        model(&coupled("*DISTRIBUTING", &text)).connectors.remove(0)
    };
    let bushing = section("BUSHING", ", BEHAVIOR=B");
    assert_eq!(bushing.between, ["Side".to_owned(), "Hub_nodes".to_owned()]);
    assert!(all_close(bushing.stiffness, [1e4, 0.0, 0.0]) && all_close(bushing.rotational_stiffness, [0.02, 0.0, 0.0]));
    assert!(all_close(bushing.damping, [0.0, 100.0, 0.0]));
    let hinge = section("HINGE", "");
    assert!(hinge.stiffness.iter().all(|k| *k > 1e10) && hinge.rotational_stiffness[0] == 0.0);
    assert!(hinge.rotational_stiffness[1] > 0.0);
    assert!(section("JOIN, ALIGN", "").rotational_stiffness[0] > 0.0);
}

/// Two holes on one pin: both are rigid with its node, and so with each other.
#[test]
fn rigid_couplings_at_one_node_are_one_set() {
    let second = "*SURFACE, NAME=Hub_nodes, TYPE=NODE\nHUB\n*COUPLING, REF NODE=101, SURFACE=HUB_NODES\n";
    let pin = model(&coupled("*KINEMATIC", &format!("{second}*KINEMATIC\n*CLOAD\n101, 1, 3.")));
    assert_eq!((pin.rigid_sets.len(), pin.rigid_sets[0].nodes.as_str()), (1, "Side and Hub_nodes"));
    assert!(pin.loads.iter().any(|load| load.on == "Side and Hub_nodes"));
    let two = format!("{}\n*MATERIAL, NAME=Steel\n", coupled("*KINEMATIC", &format!("{second}*DISTRIBUTING")));
    let said = with("*MATERIAL, NAME=Steel\n", &two).unwrap_err();
    assert!(said.contains("node 101 is the reference node of two couplings"), "{said}");
}

/// A joint between single nodes is as stiff in every system of units.
#[test]
fn a_joint_between_nodes_has_the_stiffness_of_an_element() {
    let weld = model("*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 1, 11\n*CONNECTOR SECTION, ELSET=C\nJOIN");
    // Two elements in a box of 10 x 10 x 20 mm, E = 2.1e11 Pa.
    let size = (1e-4_f64 + 1e-4 + 4e-4).sqrt() / 2.0_f64.cbrt();
    assert!(all_close(weld.connectors[0].stiffness, [1e4 * 2.1e11 * size; 3]), "{:?}", weld.connectors[0]);
}

#[test]
fn a_clearance_is_the_gap_of_a_pair() {
    let lines = "*BOUNDARY\nHUB, 1, 3\n";
    let clearance = "*CLEARANCE, VALUE=-0.02, MASTER=DISC_FACE, SLAVE=PAD_FACE\n";
    let above = model(clearance.trim_end());
    assert!(close(above.contacts[0].clearance.unwrap(), -2e-5));
    let text = format!("{clearance}{lines}");
    let Converted { model, mesh, .. } = with(lines, &text).unwrap();
    assert!(close(model.contacts[0].clearance.unwrap(), -2e-5));
    let mut deck = Vec::new();
    crate::deck::write(&model, &mesh, UnitSystem::ALL[0], "a test", &mut deck).unwrap();
    let again = read(&String::from_utf8(deck).unwrap()).unwrap();
    assert!(close(again.model.contacts[0].clearance.unwrap(), -2e-5));
}

/// A deck with everything that joins nodes.
fn with_all_joints() -> String {
    let lines = "*BOUNDARY\n101, 3\n*CLOAD\n101, 1, 4.\n101, 5, 2.\n*TIE, NAME=Glue, POSITION TOLERANCE=0.5\nPAD_FACE, DISC_FACE\n\
         *NSET, NSET=BACK2\n14, 18, 19, 20\n*RIGID BODY, NSET=BACK2, REF NODE=102\n*NODE\n102, 0., 0., 12.\n\
         *EQUATION\n5\n1, 1, 1., 2, 1, -0.25, 3, 1, -0.25, 4, 2, -0.25,\n5, 1, 0.125\n\
         *ELEMENT, TYPE=MASS, ELSET=M\n901, 101\n*MASS, ELSET=M\n2e-6\n*ELEMENT, TYPE=ROTARYI, ELSET=R\n902, 101\n\
         *ROTARY INERTIA, ELSET=R\n1e-3, 2e-3, 3e-3, 1e-4, 2e-4, 3e-4\n*ELEMENT, TYPE=SPRING1, ELSET=S\n903, 14\n\
         *SPRING, ELSET=S\n2\n500.\n*ELEMENT, TYPE=DASHPOT2, ELSET=D\n904, 101, 102\n*DASHPOT, ELSET=D\n3, 3\n0.5";
    let lines = coupled("*DISTRIBUTING", lines).replace("101, 1., 2., 20.", "101, 0., 0., 20.");
    good().replace("*MATERIAL, NAME=Steel\n", &format!("{lines}\n*MATERIAL, NAME=Steel\n"))
}

/// What must be the same in two models, by numbers and mesh nodes.
#[track_caller]
fn assert_same_joints(one: &Model, two: &Model) {
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-11 * b.abs().max(1e-12));
    assert_eq!(
        [one.connectors.len(), one.ties.len(), one.rigid_sets.len(), one.masses.len(), one.equations.len()],
        [two.connectors.len(), two.ties.len(), two.rigid_sets.len(), two.masses.len(), two.equations.len()]
    );
    for (a, b) in one.connectors.iter().zip(&two.connectors) {
        assert_eq!(a.between.contains(&GROUND.to_owned()), b.between.contains(&GROUND.to_owned()));
        let all =
            |own: &crate::model::Connector| [own.stiffness, own.rotational_stiffness, own.damping, own.at.unwrap()];
        assert!(near(all(a).as_flattened(), all(b).as_flattened()), "{a:?} {b:?}");
    }
    for (a, b) in one.masses.iter().zip(&two.masses) {
        assert!(near(&[a.mass], &[b.mass]) && near(&a.inertia, &b.inertia) && near(&a.at.unwrap(), &b.at.unwrap()));
    }
    for (a, b) in one.equations.iter().zip(&two.equations) {
        let numbers = |own: &crate::model::Equation| {
            own.terms.iter().map(|term| (term.axis, term.coefficient)).collect::<Vec<_>>()
        };
        assert_eq!(numbers(a), numbers(b));
    }
    for (a, b) in one.ties.iter().zip(&two.ties) {
        assert_eq!((&a.slave, &a.master), (&b.slave, &b.master));
        assert!(near(&[a.search_distance.unwrap_or(0.0)], &[b.search_distance.unwrap_or(0.0)]));
        assert!(near(&[a.stiffness.unwrap_or(0.0)], &[b.stiffness.unwrap_or(0.0)]));
    }
    let at_points = |model: &Model| -> Vec<f64> {
        let numbers = |load: &crate::model::Load| match load.kind {
            LoadKind::ForceAt { force, moment, at } => Some([force, moment, at.unwrap()].as_flattened().to_vec()),
            _ => None,
        };
        model.loads.iter().filter_map(numbers).flatten().collect()
    };
    assert!(at_points(one).len() == 9 && near(&at_points(one), &at_points(two)), "{:?}", at_points(two));
}

#[test]
fn joints_are_the_same_in_a_deck_and_in_a_model_file_that_are_written_of_them() {
    let text = with_all_joints();
    let tied = text.replace("=LINEAR\n20000.", "=TIED\n20000.");
    for (text, n_ties) in [(text, 1), (tied, 2)] {
        let Converted { model, mesh, .. } = read(&text).unwrap();
        assert_eq!((model.connectors.len(), model.ties.len()), (3, n_ties));
        let toml = crate::model::write(&model, "a.msh");
        assert_same_joints(&model, &crate::model::parse(&toml, std::path::Path::new("a.toml")).unwrap());
        for units in UnitSystem::ALL {
            let mut deck = Vec::new();
            let losses = crate::deck::write(&model, &mesh, units, "a test", &mut deck).unwrap();
            assert!(losses.is_empty(), "{losses:?}");
            let again = read(&String::from_utf8(deck).unwrap()).unwrap();
            assert_same_joints(&model, &again.model);
            let nodes = |own: &Converted, name: &str| own.mesh.node_set(name).map(|nodes| nodes.len());
            assert_eq!(nodes(&again, &again.model.rigid_sets[0].nodes), Some(4));
        }
    }
}

/// A connector, a force and a support by couplings: the reference nodes 101 to 103.
pub(super) const COUPLINGS: &str = "*NODE
101, 0., 0., 20.
102, 0., 0., 20.
103, 3.3333333333, 3.3333333333, 5.
*SURFACE, NAME=Side
PAD, S4
*SURFACE, NAME=Hub_nodes, TYPE=NODE
HUB
*COUPLING, REF NODE=101, SURFACE=SIDE, CONSTRAINT NAME=C1
*DISTRIBUTING
*COUPLING, REF NODE=102, SURFACE=HUB_NODES, CONSTRAINT NAME=C2
*DISTRIBUTING
*ELEMENT, TYPE=SPRING2, ELSET=S
901, 101, 102
*SPRING, ELSET=S
2, 2
500.
*ELEMENT, TYPE=DASHPOT2, ELSET=D
902, 101, 102
*DASHPOT, ELSET=D
3, 3
0.02
*MATERIAL, NAME=Steel
";

#[test]
fn springs_between_couplings_are_a_connector() {
    let Converted { model, .. } = with("*MATERIAL, NAME=Steel\n", COUPLINGS).unwrap();
    let connector = &model.connectors[0];
    assert_eq!(
        (connector.between.clone(), connector.at.unwrap()),
        (["Side".to_owned(), "Hub_nodes".to_owned()], [0.0, 0.0, 0.02])
    );
    assert!(close(connector.stiffness[1], 5e5) && close(connector.damping[2], 20.0));
    assert_eq!((connector.stiffness[0], connector.rotational_stiffness), (0.0, [0.0; 3]));
    let lossy =
        COUPLINGS.replace("*SPRING, ELSET=S\n2, 2\n500.", "*SPRING, ELSET=S, COMPLEX STIFFNESS\n2, 2\n500., 50.");
    let model = with("*MATERIAL, NAME=Steel\n", &lossy).unwrap().model;
    assert!(model.connectors.len() == 1 && close(model.connectors[0].loss_factor, 0.1));
    let second =
        "*ELEMENT, TYPE=SPRING2, ELSET=S2\n903, 101, 102\n*SPRING, ELSET=S2\n1, 1\n200.\n*MATERIAL, NAME=Steel\n";
    let model = with("*MATERIAL, NAME=Steel\n", &lossy.replace("*MATERIAL, NAME=Steel\n", second)).unwrap().model;
    let of = |own: &crate::model::Connector| (own.stiffness.map(|k| k > 0.0), own.loss_factor > 0.0);
    let both: Vec<_> = model.connectors.iter().map(of).collect();
    assert_eq!(both, [([false, true, false], true), ([true, false, false], false)], "a loss factor each");
    let message = with("*MATERIAL, NAME=Steel\n", &lossy.replace("500., 50.", "0., 50.")).unwrap_err();
    assert!(message.contains("an imaginary stiffness must be 0 or above, beside a real one"), "{message}");
    let far = COUPLINGS.replace("102, 0., 0., 20.", "102, 0., 0., 21.");
    let message = with("*MATERIAL, NAME=Steel\n", &far).unwrap_err();
    assert!(message.contains("the line between them is not along the axis of the spring"), "{message}");
}
