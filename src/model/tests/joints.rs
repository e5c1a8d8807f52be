//! Connectors, ties, rigid sets, masses, equations and forces at points.

use super::{GOOD, complains, parsed};
use crate::model::{EquationTerm, LoadKind};

#[test]
fn connectors_are_checked() {
    let said = "stiffness must be 0 or above, not -2 (connector \"pin / hole\"). Give [x, y, z] in N/m";
    complains("stiffness = [1, 2, 3]", "stiffness = [1, -2, 3]", 0, said);
    let said = "both ends are \"pin\" (connector \"pin / pin\"). Name two different node sets";
    complains("between = [\"pin\", \"hole\"]", "between = [\"pin\", \"pin\"]", 0, said);
    let said = parsed(&GOOD.replace("stiffness = [1, 2, 3]", "stiffness = [0, 0, 0]")).unwrap_err();
    assert!(said.contains(":38: all its constants are 0 (connector \"pin / hole\")"), "{said}");
}

/// The good file with one more table.
fn with(table: &str) -> Result<crate::model::Model, String> {
    parsed(&format!("{GOOD}{table}\n"))
}

/// What is said about one more table.
#[track_caller]
fn refused(table: &str, expected: &str) {
    let said = with(table).expect_err("accepted");
    assert!(said.ends_with(expected), "{said}");
}

#[test]
fn ties_have_two_surfaces_and_lengths_of_the_mesh() {
    let model = with("[[tie]]\nslave = \"a\"\nmaster = \"b\"\nsearch = 2\nstiffness = 1e18").unwrap();
    let tie = &model.ties[0];
    assert_eq!((tie.name.as_str(), tie.search_distance, tie.stiffness), ("a / b", Some(2e-3), Some(1e18)));
    let plain = &with("[[tie]]\nslave = \"a\"\nmaster = \"b\"").unwrap().ties[0];
    assert_eq!((plain.search_distance, plain.stiffness), (None, None));
    let itself = "slave and master are both \"a\" (tie \"a / a\"). Name the two surfaces that move as one";
    refused("[[tie]]\nslave = \"a\"\nmaster = \"a\"", itself);
    let soft = "[[tie]]\nslave = \"a\"\nmaster = \"b\"\nstiffness = 0";
    refused(soft, "Give N/m3, or leave it out: it then follows from the elements beside the surfaces");
}

#[test]
fn names_of_one_kind_differ() {
    let twice = "[[rigid]]\nnodes = \"a\"\n[[rigid]]\nnodes = \"a\"";
    refused(twice, "the name is taken by line 49 (rigid \"a\"). Give each its own name");
    assert_eq!(with("[[rigid]]\nnodes = \"a\"\n[[rigid]]\nname = \"b\"\nnodes = \"a\"").unwrap().rigid_sets.len(), 2);
}

#[test]
fn masses_are_positive_with_their_inertia() {
    let mass = |keys: &str| with(&format!("[[mass]]\nnodes = \"a\"\n{keys}"));
    let full = &mass("mass = 2\nat = [1, 2, 3]\ninertia = [3, 4, 5, 0.1, 0.2, 0.3]").unwrap().masses[0];
    assert_eq!((full.mass, full.at, full.inertia), (2.0, Some([1e-3, 2e-3, 3e-3]), [3.0, 4.0, 5.0, 0.1, 0.2, 0.3]));
    assert_eq!(mass("mass = 2").unwrap().masses[0].inertia, [0.0; 6]);
    assert_eq!(mass("mass = 0\ninertia = [1, 1, 1, 0, 0, 0]").unwrap().masses[0].mass, 0.0);
    let said = |keys: &str| mass(keys).unwrap_err();
    assert!(said("mass = -1").contains(":51: mass must be 0 or above, not -1 (mass \"a\")"));
    assert!(said("mass = 0").contains(":49: mass is 0, and there is no inertia (mass \"a\")"));
    let with_inertia = |inertia: &str| mass(&format!("mass = 1\ninertia = {inertia}"));
    for rod in ["[1, 1, 0, 0, 0, 0]", "[1, 1, 1, 1, 0, 0]", "[0.1, 0.9, 1, 0.3, 0, 0]"] {
        assert!(with_inertia(rod).is_ok(), "{rod}");
    }
    for impossible in ["[1, 1, -1, 0, 0, 0]", "[1, 1, 1, 1.0000001, 0, 0]", "[1, 1, 1, 0, 2, 0]"] {
        let said = with_inertia(impossible).unwrap_err();
        assert!(said.contains(":52: inertia has a negative principal moment (mass \"a\"). Give [xx, yy, zz"), "{said}");
    }
}

#[test]
fn equations_have_two_different_terms() {
    let equation = |terms: &str| with(&format!("[[equation]]\nterms = [{terms}]"));
    let term = |node: &str, axis: &str, a: f64| format!("{{ node = {node:?}, axis = {axis:?}, coefficient = {a} }},");
    let model = equation(&(term("a", "x", 1.0) + &term("b", "z", -2.0))).unwrap();
    assert_eq!(model.equations[0].name, "a x, b z");
    assert_eq!(model.equations[0].terms[1], EquationTerm { node: "b".into(), axis: 2, coefficient: -2.0 });
    let said = |terms: &str| equation(terms).unwrap_err();
    assert!(said(&term("a", "x", 1.0)).contains("an equation has two terms at least (equation \"a x\")"));
    let twice = term("a", "x", 1.0) + &term("a", "x", 2.0);
    assert!(said(&twice).contains("the displacement of \"a\" along x is there twice"), "{}", said(&twice));
    assert!(said(&(term("a", "w", 1.0) + &term("b", "x", 1.0))).contains("unknown axis \"w\""));
    let none = said(&(term("a", "x", 0.0) + &term("b", "x", 1.0)));
    assert!(none.contains("coefficient must not be 0, not 0"), "{none}");
}

#[test]
fn forces_act_at_points_where_a_moment_or_a_point_is_given() {
    let load = |keys: &str| parsed(&GOOD.replace("force = [0, 0, 4000]", keys));
    let kind = |keys: &str| load(keys).unwrap().loads[0].kind;
    let at = |force, moment, at| LoadKind::ForceAt { force, moment, at };
    assert_eq!(kind("force = [1, 0, 0]\nat = [1, 2, 3]"), at([1.0, 0.0, 0.0], [0.0; 3], Some([1e-3, 2e-3, 3e-3])));
    assert_eq!(kind("moment = [0, 1, 0]"), at([0.0; 3], [0.0, 1.0, 0.0], None));
    let said = |keys: &str| load(keys).unwrap_err();
    let spread = said("force = [1, 0, 0]\nmoment = [0, 1, 0]\nspread = \"nodes\"");
    assert!(spread.contains(":46: the load acts at a point, so that spread does not apply"), "{spread}");
    assert!(said("at = [0, 0, 0]").contains("nothing acts"));
    let pressure = said("pressure = 1\nmoment = [0, 1, 0]");
    assert!(pressure.contains(":45: spread, moment and at say how a force acts, but this is a pressure"), "{pressure}");
}
