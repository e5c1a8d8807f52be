//! What the parser decides, keyword by keyword.

use super::*;
use crate::deck::types::{ActionKind, Behaviour, Dependence, ElasticKind, Entry, Procedure};

/// Reads a deck of these lines; messages without the folder.
fn read(text: &str) -> std::result::Result<Deck, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.inp");
    std::fs::write(&file, text).unwrap();
    let prefix = format!("{}/", folder.path().display());
    parse(&file).map_err(|error| error.to_string().replace(&prefix, ""))
}

/// Requires a refusal that begins with this.
#[track_caller]
fn refused(text: &str, begin: &str) {
    let message = read(text).unwrap_err();
    assert!(message.starts_with(begin), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
}

#[test]
fn comments_blank_lines_and_windows_line_ends_do_not_count_but_their_numbers_do() {
    let deck =
        read("** first\r\n\r\n*Heading\r\nA brake\r\n** c\r\nmore\r\n*NODE\r\n 1 , 2., 3.,\r\n** c\r\n7,1e1").unwrap();
    assert_eq!(deck.title.as_deref(), Some("A brake"));
    assert_eq!(deck.assembly.nodes.numbers, [1, 7]);
    assert_eq!(deck.assembly.nodes.coordinates, [[2.0, 3.0, 0.0], [10.0, 0.0, 0.0]]);
    assert_eq!(deck.assembly.nodes.places.iter().map(|place| place.line).collect::<Vec<_>>(), [8, 10]);
}

#[test]
fn keyword_lines_and_elements_continue_after_a_comma() {
    let deck = read("*ELEMENT,\nTYPE=C3D10, ELSET=a\n5, 1,2,3,4,5,6,\n7,8,9,10\n*ELSET, elset=A\n6,7\n").unwrap();
    let block = &deck.assembly.elements[0];
    assert_eq!((block.kind.name, &block.numbers[..]), ("C3D10", &[5][..]));
    assert_eq!(block.nodes, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    let sets = &deck.assembly.element_sets;
    assert_eq!((sets[0].name.as_str(), sets[1].name.as_str(), deck.spelled("A").as_str()), ("A", "A", "a"));
    refused(
        "*ELEMENT, TYPE=C3D8\n1, 1,2,3,4,5,6,7\n2, 2,2,3,4,5,6,7,8\n",
        "a.inp:2: element 1 has 7 nodes, but C3D8 has 8",
    );
    // CalculiX's decks may have nodes of the incompatible modes.
    let deck = read("*ELEMENT, TYPE=C3D8I\n1, 1,2,3,4,5,6,7,8,9,10,\n2, 1,2,3,4,5,6,7,8,\n").unwrap();
    assert_eq!(deck.assembly.elements[0].nodes.len(), 16);
    refused(
        "*ELEMENT, TYPE=C3D8I\n1, 1,2,3,4,5,6,7,8,9,10,11,12\n",
        "a.inp:2: the element has more nodes than its type",
    );
    refused("*ELEMENT, TYPE=C3D4\n1, 1,2,3,4,5\n", "a.inp:2: the element has more nodes than its type");
    refused("*ELEMENT, TYPE=S4R\n", "a.inp:1: elements of the type S4R are not supported");
}

#[test]
fn sets_have_numbers_ranges_and_names() {
    let deck = read("*NSET, NSET=one, GENERATE\n1, 9, 4\n3,5\n*NSET, NSET=two\n1, one, disc-1.hub\n").unwrap();
    let entries =
        |i: usize| deck.assembly.node_sets[i].entries.iter().map(|(entry, _)| entry.clone()).collect::<Vec<_>>();
    assert_eq!(entries(0), [Entry::Range(1, 9, 4), Entry::Range(3, 5, 1)]);
    assert_eq!(entries(1), [Entry::Number(1), Entry::Name("ONE".into()), Entry::Name("DISC-1.HUB".into())]);
    refused("*NSET, NSET=A, GENERATE\n9,1\n", "a.inp:2: the range from 9 to 1 is empty");
}

#[test]
fn included_files_are_read_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("mesh")).unwrap();
    write("a.inp", "*NODE\n1,0,0,0\n* Include, input=mesh/b.inp\n4,3.,0,0\n*INCLUDE, INPUT=mesh/c.inp\n");
    write("mesh/b.inp", "** nodes\n2,1.,0,0\n3,2.,0,0\n");
    write("mesh/c.inp", "*INCLUDE, INPUT=d.inp\n");
    write("mesh/d.inp", "*HEADING\ntitle\n");
    let deck = parse(&folder.path().join("a.inp")).unwrap();
    assert_eq!(deck.assembly.nodes.numbers, [1, 2, 3, 4]);
    let places: Vec<_> = deck.assembly.nodes.places.iter().map(|place| (place.file, place.line)).collect();
    assert_eq!(places, [(0, 2), (1, 2), (1, 3), (0, 4)]);
    assert_eq!((deck.title.as_deref(), deck.files.len()), (Some("title"), 4));
    write("mesh/d.inp", "*HEADING\n*INCLUDE, INPUT=mesh/c.inp\n");
    let message = parse(&folder.path().join("a.inp")).unwrap_err().to_string();
    assert!(message.ends_with("d.inp:2: mesh/c.inp includes itself. Remove one *INCLUDE"), "{message}");
    refused("*INCLUDE, INPUT=none.inp\n", "a.inp:1: cannot read the included file none.inp");
}

#[test]
fn what_is_no_text_is_refused() {
    refused("*NODE\n1,0,0,0\n\0\0\n", "a.inp:3: here is a zero byte: the file is binary");
    refused(&format!("*NODE\n1{}\n", ",0".repeat(40_000)), "a.inp:2: the line has more than 65536 bytes");
    assert!(read("** caf\u{e9}\n*HEADING\n\u{e9}\n").is_ok());
}

#[test]
fn constants_of_materials_fill_lines() {
    let text = "*MATERIAL, NAME=m\n*ELASTIC, TYPE=ANISOTROPIC\n1,2,3,4,5,6,7,8\n9,10,11,12,13,14,15,16\n17,18,19,20,21\n\
                *DENSITY\n7.85e-9\n*DAMPING, ALPHA=5., BETA=1e-7, STRUCTURAL=0.02\n";
    let deck = read(text).unwrap();
    let material = &deck.materials[0];
    let elastic = material.elastic.as_ref().unwrap();
    assert_eq!((elastic.kind, elastic.constants.len(), elastic.constants[20]), (ElasticKind::Anisotropic, 21, 21.0));
    assert_eq!((material.density.unwrap().0, material.alpha, material.beta), (7.85e-9, 5.0, 1e-7));
    assert_eq!(material.structural, 0.02);
    refused("*MATERIAL, NAME=m\n*ELASTIC\n2e5,.3,0.\n1e5,.3,100.\n", "a.inp:4: a second row of constants");
    refused("*MATERIAL, NAME=m\n*ELASTIC\n2e5\n", "a.inp:3: 1 elastic constants, but ISOTROPIC has 2");
    refused("*ELASTIC\n2e5,.3\n", "a.inp:1: *ELASTIC before any *MATERIAL");
    refused("*MATERIAL, NAME=m\n*DENSITY\n-1\n", "a.inp:3: the density must be above 0");
    refused("*MATERIAL, NAME=m\n*DAMPING, COMPOSITE=.1\n", "a.inp:2: composite damping");
    refused("*MATERIAL, NAME=m\n*DAMPING, STRUCTURAL=-.1\n", "a.inp:2: ALPHA, BETA and STRUCTURAL must be");
    refused("*MATERIAL, NAME=m\n*MATERIAL, NAME=M\n", "a.inp:2: the material M is there already, in line 1");
}

#[test]
fn laws_of_contact() {
    let law = |card: &str| {
        read(&format!("*SURFACE INTERACTION, NAME=i\n{card}\n")).map(|mut deck| deck.interactions.remove(0))
    };
    assert_eq!(law("*SURFACE BEHAVIOR").unwrap().behaviour, Behaviour::Hard);
    let linear =
        law("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR, NO SEPARATION\n2e4, 1.\n*FRICTION\n.4, 1e4").unwrap();
    assert!(matches!(linear.behaviour, Behaviour::Linear(k, _) if k == 2e4) && linear.no_separation);
    assert_eq!(linear.friction.map(|friction| (friction.coefficient, friction.stick)), Some((0.4, Some(1e4))));
    assert!(law("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n0.").unwrap_err().contains("must be above 0"));
    assert!(law("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n1,2").unwrap_err().contains("not supported"));
    let friction = |card: &str| law(card).map(|law| law.friction.unwrap()).unwrap();
    let decay = friction("*FRICTION, EXPONENTIAL DECAY\n.6, .4, 1e-3");
    assert_eq!((decay.coefficient, decay.stick), (0.6, None));
    assert_eq!(decay.dependence, Dependence::Decay { kinetic: 0.4, decay: 1e-3 });
    let table = friction("*FRICTION\n.3, 0., 1.\n.2, 5., 1.");
    assert_eq!((table.coefficient, table.stick), (0.3, None));
    assert_eq!(table.dependence, Dependence::Table(vec![[0.3, 0.0, 1.0, 0.0], [0.2, 5.0, 1.0, 0.0]]));
    assert!(law("*FRICTION\n.3\n-.4, 1.").unwrap_err().contains("must be 0 or above"));
    assert!(law("*FRICTION, EXPONENTIAL DECAY\n.6").unwrap_err().contains("the kinetic coefficient"));
    assert!(law("*FRICTION, TAUMAX=3.\n.3").unwrap_err().contains("TAUMAX is not supported"));
    refused("*CONTACT PAIR, INTERACTION=i\n", "a.inp:1: the two surfaces are missing");
}

#[test]
fn steps_keep_what_acts_in_them() {
    let text = "*BOUNDARY\nhub, ENCASTRE\n*STEP, NLGEOM\nload\n*STATIC\n1.,1.\n*CLOAD, OP=NEW\n12, 3, -4.\n*MOTION, ROTATION\n\
                disc, 5., 0,0,0, 0,0,1\n*END STEP\n*STEP\n*CHANGE FRICTION, INTERACTION=i\n*FRICTION\n.5\n\
                *COMPLEX FREQUENCY, FRICTION DAMPING=YES\n40, 0., 6000.\n*END STEP\n";
    let deck = read(text).unwrap();
    assert!(matches!(&deck.initial[0].what, ActionKind::Boundary(Entry::Name(set), [1, 6], 0.0) if &**set == "HUB"));
    let actions = &deck.steps[0].actions;
    assert!(matches!(actions[0].what, ActionKind::Force(Entry::Number(12), 3, -4.0)) && actions[0].is_new);
    assert!(
        matches!(actions[1].what, ActionKind::Rotation(_, spin) if spin.speed == 5.0 && spin.to == [0.0, 0.0, 1.0])
    );
    assert!(matches!(&deck.steps[1].actions[0].what, ActionKind::Friction(_, friction) if friction.coefficient == 0.5));
    let band = [Some(0.0), Some(6000.0)];
    assert_eq!(deck.steps[1].procedure, Procedure::ComplexFrequency { band, friction_damping: true, coriolis: false });
    assert!(deck.notes[0].starts_with("NLGEOM"));
    let deck = read("*STEP, PERTURBATION\n*COMPLEX FREQUENCY, CORIOLIS\n10\n*END STEP\n").unwrap();
    assert!(deck.steps[0].perturbation && !deck.steps[0].nlgeom);
    assert!(matches!(deck.steps[0].procedure, Procedure::ComplexFrequency { coriolis: true, .. }));
    refused("*STEP\n*STATIC\n", "a.inp:1: the step does not end: the deck is cut off");
    refused("*STEP\n*END STEP\n", "a.inp:1: the step has no procedure");
    refused("*STEP\n*DYNAMIC\n", "a.inp:2: *DYNAMIC is not supported: the procedures are");
    refused("*STATIC\n", "a.inp:1: *STATIC outside a step");
    refused("*BOUNDARY\n1,11,11\n", "a.inp:2: the displacement \"11\" is not supported");
    refused("*AMPLITUDE, NAME=a\n0.,0.,1.,.5\n*CLOAD, AMPLITUDE=A\n1,1,1.\n", "a.inp:3: the amplitude A ends with 0.5");
    let deck = read("*DLOAD\nall, Centrif, 9., 1,2,3, 0,0,2\n").unwrap();
    assert!(matches!(deck.initial[0].what, ActionKind::Centrifugal(_, spin)
        if (spin.speed, spin.from, spin.to) == (3.0, [1.0, 2.0, 3.0], [1.0, 2.0, 5.0])));
    refused("*DLOAD\nall,CENTRIF,-9.,0,0,0,0,0,1\n", "a.inp:2: the square of the speed of rotation is -9, below 0");
    refused("*DLOAD\nall,CENTRIF,9.,0,0,0\n", "a.inp:2: the direction of the axis of rotation is missing");
    refused("*DLOAD\nall,BX,9.81\n", "a.inp:2: the load \"BX\" is not supported");
}

#[test]
fn parts_and_instances_have_scopes_of_their_own() {
    let text = "*PART, NAME=block\n*NODE\n1,0,0,0\n*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=left, PART=block\n1.,2.,3.\n\
                0,0,0, 0,0,1, 90.\n*END INSTANCE\n*NODE\n1,9,9,9\n*END ASSEMBLY\n";
    let deck = read(text).unwrap();
    assert_eq!((deck.parts[0].nodes.numbers.len(), deck.assembly.nodes.numbers.len()), (1, 1));
    let instance = &deck.instances[0];
    assert_eq!(
        (instance.name.as_str(), instance.part.as_str(), instance.translation),
        ("LEFT", "BLOCK", [1.0, 2.0, 3.0])
    );
    assert_eq!(instance.rotation.map(|turn| turn.degrees), Some(90.0));
    refused("*PART, NAME=a\n*NODE\n", "a.inp:1: the part does not end: the deck is cut off");
    refused("*PART, NAME=a\n*PART, NAME=b\n", "a.inp:2: *PART within the part of line 1");
    refused("*END PART\n", "a.inp:1: *END PART ends nothing");
    let twice = "*INSTANCE, NAME=a, PART=b\n*END INSTANCE\n*INSTANCE, NAME=A, PART=b\n";
    refused(twice, "a.inp:3: two instances are called A (line 1)");
}

#[test]
fn systems_of_axes_place_nodes() {
    let text = "*SYSTEM\n1,0,0, 1,1,0\n0,0,0\n*NODE\n1, 2,0,0\n*SYSTEM\n*NODE, SYSTEM=C\n2, 2., 90., 5.\n";
    let x = read(text).unwrap().assembly.nodes.coordinates;
    let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-14);
    assert!(close(x[0], [1.0, 2.0, 0.0]) && close(x[1], [0.0, 2.0, 5.0]), "{x:?}");
    refused("*SYSTEM\n0,0,0, 1,0,0\n2,0,0\n", "a.inp:1: the points of the axes lie on a line");
}

#[test]
fn ignored_keywords_are_counted() {
    let deck = read("*NODE PRINT, NSET=a\nU\n*Node Print\n*EL FILE\nS\n").unwrap();
    let list: Vec<_> =
        deck.ignored.iter().map(|ignored| (ignored.keyword.as_str(), ignored.times, ignored.place.line)).collect();
    assert_eq!(list, [("*NODE PRINT", 2, 1), ("*EL FILE", 1, 4)]);
}
