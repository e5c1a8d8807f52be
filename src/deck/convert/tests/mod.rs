//! What a small deck means, what it means in other forms, and what is wrong with broken ones.
//!
//! ```text
//!   pad   element 2, nodes 11 to 20, above z = 0
//!   -----
//!   disc  element 1, nodes 1 to 10, below; turns about z
//! ```

mod adjust;
mod broken;
mod broken_joints;
mod gravity;
mod joints;
mod rotations;
mod supports;

use super::*;
use crate::deck::parse;
use crate::error::ErrorKind;
use crate::model::friction::{FrictionCurve, SpeedDecay};
use crate::model::{Contact, LoadKind, NormalLaw};
use std::fmt::Write;

const REST: &str = "*NSET, NSET=Hub, GENERATE
7, 10
*NSET, NSET=BACK
14, 18, 19, 20
*NSET, NSET=TURNING, GENERATE
1, 10
*SURFACE, NAME=Disc_face
DISC, S1
*SURFACE, NAME=Pad_face
2, S1
*MATERIAL, NAME=Steel
*ELASTIC
210000., 0.3
*DENSITY
7.85e-9
*DAMPING, ALPHA=5., BETA=1e-7, STRUCTURAL=0.02
*SOLID SECTION, ELSET=DISC, MATERIAL=STEEL
*SOLID SECTION, ELSET=PAD, MATERIAL=STEEL
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
20000.
*FRICTION
0.4
*CONTACT PAIR, INTERACTION=I
PAD_FACE, DISC_FACE
*BOUNDARY
HUB, 1, 3
*STEP
*STATIC
*CLOAD
BACK, 3, -25.
*MOTION, ROTATION
TURNING, 5., 0,0,0, 0,0,1
*END STEP
*STEP
*COMPLEX FREQUENCY, FRICTION DAMPING=YES
20, 100., 6000.
*END STEP
";

/// Ten nodes from a number on: corners, then midsides.
fn nodes(first: usize, corners: [[f64; 3]; 4]) -> String {
    const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
    let middle = |[a, b]: [usize; 2]| [0, 1, 2].map(|i| 0.5 * (corners[a][i] + corners[b][i]));
    let all = corners.into_iter().chain(EDGES.map(middle));
    let mut out = String::new();
    all.zip(first..).for_each(|([x, y, z], n)| writeln!(out, "{n}, {x}, {y}, {z}").unwrap());
    out
}

fn good() -> String {
    let disc = nodes(1, [[0.0; 3], [0.0, 10.0, 0.0], [10.0, 0.0, 0.0], [0.0, 0.0, -10.0]]);
    let pad = nodes(11, [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]]);
    let element = |number: usize, first: usize| {
        let nodes: Vec<String> = (first..first + 10).map(|node| node.to_string()).collect();
        format!("{number}, {}\n", nodes.join(", "))
    };
    let (one, two) = (element(1, 1), element(2, 11));
    format!(
        "*HEADING\ntwo blocks\n*NODE\n{disc}{pad}*ELEMENT, TYPE=C3D10, ELSET=Disc\n{one}*ELEMENT, TYPE=C3D10M, ELSET=PAD\n{two}{REST}"
    )
}

/// Reads a deck of these lines as the program does; messages without the folder.
fn read(text: &str) -> std::result::Result<Converted, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.inp");
    std::fs::write(&file, text).unwrap();
    let prefix = format!("{}/", folder.path().display());
    let read = parse(&file).and_then(|deck| convert(&deck, KnownUnits::default())).and_then(|mut converted| {
        settle(&mut converted.model, &converted.mesh, |_| true);
        converted.model.check_against(&converted.mesh)?;
        Ok(converted)
    });
    read.map_err(|error| {
        assert_eq!(error.kind(), ErrorKind::Input);
        error.to_string().replace(&prefix, "")
    })
}

/// The good deck with one thing exchanged.
#[track_caller]
fn with(old: &str, new: &str) -> std::result::Result<Converted, String> {
    let text = good();
    assert_eq!(text.matches(old).count(), 1, "{old:?}");
    read(&text.replace(old, new))
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[test]
fn a_deck_in_millimetres_and_tonnes_is_a_model_in_si_units() {
    let Converted { model, mesh, summary } = read(&good()).unwrap();
    assert_eq!(
        (mesh.nodes.len(), mesh.elements.len(), &mesh.parts[..]),
        (20, 2, &["Disc".to_owned(), "PAD".to_owned()][..])
    );
    assert_eq!(mesh.nodes[1], [0.0, 0.01, 0.0]);
    let material = &model.parts[0].material;
    assert!(close(material.density, 7850.0) && close(model.parts[0].rayleigh.beta, 1e-7));
    assert_eq!(model.parts[0].material.loss_factor, 0.02);
    assert!(close(crate::model::isotropic(material).unwrap()[0], 210e9));
    let Contact { name, slave, master, law, friction, stick, separation, .. } = &model.contacts[0];
    assert_eq!((name.as_str(), slave.as_str(), master.as_str()), ("Pad_face / Disc_face", "Pad_face", "Disc_face"));
    assert!(matches!(law, Some(NormalLaw::Linear { stiffness }) if close(*stiffness, 2e13)));
    assert_eq!((*friction, *stick, *separation), (0.4, None, true));
    assert_eq!((model.fixes[0].nodes.as_str(), model.fixes[0].axes), ("Hub", [true; 3]));
    assert_eq!(mesh.node_sets["Hub"], [6, 7, 8, 9]);
    let LoadKind::ForceByNode(force) = model.loads[0].kind else { panic!("{:?}", model.loads) };
    assert_eq!((model.loads[0].on.as_str(), force), ("BACK", [0.0, 0.0, -100.0]));
    let rotation = &model.rotations[0];
    assert_eq!((rotation.part.as_str(), rotation.axis, rotation.speed), ("Disc", [0.0, 0.0, 1.0], 5.0));
    assert_eq!((model.band, model.friction_damping, model.title.as_str()), ([100.0, 6000.0], true, "two blocks"));
    let kinds: Vec<_> = summary.elements.iter().map(|count| (count.kind.as_str(), count.elements)).collect();
    assert_eq!((summary.units.as_str(), kinds), ("mm-t-s", vec![("C3D10", 1), ("C3D10M", 1)]));
}

#[test]
fn another_system_of_units_gives_the_same_model() {
    let factor = |text: String, old: &str, new: &str| {
        assert_eq!(text.matches(old).count(), 1, "{old:?}");
        text.replace(old, new)
    };
    // mm-kg-ms: stresses in GPa, densities in kg/mm3, forces in kN, rates in 1/ms, frequencies in kHz.
    let changes = [
        ("210000., 0.3", "210., 0.3"),
        ("7.85e-9", "7.85e-6"),
        ("ALPHA=5., BETA=1e-7", "ALPHA=5e-3, BETA=1e-4"),
        ("\n20000.\n", "\n20.\n"),
        ("BACK, 3, -25.", "BACK, 3, -25e-3"),
        ("TURNING, 5.", "TURNING, 5e-3"),
        ("20, 100., 6000.", "20, .1, 6."),
    ];
    let text = changes.iter().fold(good(), |text, (old, new)| factor(text, old, new));
    let (one, two) = (read(&good()).unwrap(), read(&text).unwrap());
    assert_eq!(two.summary.units, "mm-kg-ms");
    let numbers = |converted: &Converted| {
        let model = &converted.model;
        let (part, Some(NormalLaw::Linear { stiffness })) = (&model.parts[0], &model.contacts[0].law) else { panic!() };
        let LoadKind::ForceByNode([_, _, force]) = model.loads[0].kind else { panic!() };
        let c = part.material.elasticity[0][0];
        [
            c,
            part.material.density,
            part.rayleigh.alpha,
            part.rayleigh.beta,
            part.material.loss_factor,
            *stiffness,
            force,
            model.rotations[0].speed,
            model.band[1],
        ]
    };
    assert!(
        numbers(&one).iter().zip(numbers(&two)).all(|(a, b)| close(*a, b)),
        "{:?} {:?}",
        numbers(&one),
        numbers(&two)
    );
}

/// The good deck as an instance, moved and then turned, with these lines in its part.
fn as_instance(lines: &str) -> String {
    let text = good();
    let (mesh, rest) = text.split_once("*MATERIAL").unwrap();
    let (heading, mesh) = mesh.split_once("*NODE").unwrap();
    let sections = "*SOLID SECTION, ELSET=DISC, MATERIAL=STEEL\n*SOLID SECTION, ELSET=PAD, MATERIAL=STEEL\n";
    let rest = rest.replace(sections, "").replace("PAD_FACE, DISC_FACE", "b-1.PAD_FACE, B-1.DISC_FACE");
    let rest =
        rest.replace("HUB, 1", "b-1.HUB, 1").replace("BACK, 3", "FOUR, 3").replace("TURNING, 5", "B-1.TURNING, 5");
    format!(
        "{heading}*PART, NAME=brake\n*NODE{mesh}{sections}{lines}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=B-1, PART=Brake\n\
         1., 2., 3.\n0,0,0, 0,0,1, 90.\n*END INSTANCE\n*NSET, NSET=FOUR, INSTANCE=B-1\nBACK\n*END ASSEMBLY\n*MATERIAL{rest}"
    )
}

#[test]
fn instances_are_moved_and_then_turned() {
    let text = as_instance("");
    let Converted { model, mesh, summary } = read(&text).unwrap();
    assert_eq!((summary.instances, &mesh.parts[..]), (1, &["B-1.Disc".to_owned(), "B-1.PAD".to_owned()][..]));
    // (0, 10, 0) + (1, 2, 3), turned by a right angle: (-12, 1, 3) mm.
    let x = mesh.nodes[1];
    assert!([-0.012, 0.001, 0.003].iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-15), "{x:?}");
    assert_eq!((model.fixes[0].nodes.as_str(), model.loads[0].on.as_str()), ("B-1.Hub", "FOUR"));
    assert_eq!((model.contacts[0].slave.as_str(), model.rotations[0].part.as_str()), ("B-1.Pad_face", "B-1.Disc"));
    let message = read(&text.replace("INSTANCE=B-1\n", "INSTANCE=B-2\n")).unwrap_err();
    assert!(message.contains("there is no instance B-2"), "{message}");
    let message = read(&text.replace("PART=Brake", "PART=Brakes")).unwrap_err();
    assert!(message.contains("there is no part Brakes (instance B-1)"), "{message}");
}

#[test]
fn a_contact_without_a_stiffness_gets_ten_times_that_of_its_elements() {
    let linear = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n20000.\n";
    let Converted { model, mesh, .. } = with(linear, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n").unwrap();
    // One facet of 50 mm2, half a square with an edge of 10 mm.
    let proposed = &model.proposed(&mesh)[0];
    assert!((proposed.stiffness / (10.0 * 210e9 / 0.01) - 1.0).abs() < 1e-12, "{proposed}");
    assert_eq!(proposed.to_string(), "proposed: the contact Pad_face / Disc_face gets a stiffness of 2.100e14 N/m3");
}

#[test]
fn pairs_that_do_not_slide_stick_and_the_turning_side_is_the_master() {
    let motion = "*MOTION, ROTATION\nTURNING, 5., 0,0,0, 0,0,1\n";
    let still = with(motion, "").unwrap().model;
    assert!(close(still.contacts[0].stick.unwrap(), 1e13));
    let given = with(&format!("0.4\n*CONTACT PAIR, INTERACTION=I\nPAD_FACE, DISC_FACE\n*BOUNDARY\nHUB, 1, 3\n*STEP\n*STATIC\n*CLOAD\nBACK, 3, -25.\n{motion}"),
        "0.4, 3000.\n*CONTACT PAIR, INTERACTION=I\nPAD_FACE, DISC_FACE\n*BOUNDARY\nHUB, 1, 3\n*STEP\n*STATIC\n*CLOAD\nBACK, 3, -25.\n").unwrap().model;
    assert!(close(given.contacts[0].stick.unwrap(), 3e12));
    let swapped = with("PAD_FACE, DISC_FACE", "DISC_FACE, PAD_FACE").unwrap().model;
    assert_eq!((swapped.contacts[0].slave.as_str(), swapped.contacts[0].master.as_str()), ("Pad_face", "Disc_face"));
}

#[test]
fn friction_is_that_of_the_last_step() {
    let changed = "*CHANGE FRICTION, INTERACTION=I\n*FRICTION\n0.55\n*COMPLEX FREQUENCY, FRICTION DAMPING=YES";
    let model = with("*COMPLEX FREQUENCY, FRICTION DAMPING=YES", changed).unwrap().model;
    assert_eq!(model.contacts[0].friction, 0.55);
}

#[test]
fn friction_that_depends_on_slip_rate_and_pressure_comes_in_si_units() {
    let curve = |rows: &str| {
        with("*FRICTION\n0.4\n", &format!("*FRICTION{rows}\n")).map(|deck| {
            let contact = &deck.model.contacts[0];
            (contact.friction, contact.friction_curve.clone().unwrap())
        })
    };
    // A slip rate in mm/s, a pressure in MPa.
    let decay = FrictionCurve::Decay(SpeedDecay { kinetic_ratio: 0.5, decay: 2.0 });
    assert_eq!(curve(", EXPONENTIAL DECAY\n0.4, 0.2, 2e-3").unwrap(), (0.4, decay));
    let (value, FrictionCurve::Table(table)) = curve("\n0.4, 0., 2.\n0.2, 1000., 2.").unwrap() else {
        panic!("a table")
    };
    assert_eq!((value, table.values, table.speeds), (0.4, vec![1.0, 0.5], vec![0.0, 1.0]));
    assert!(close(table.pressures[0], 2e6));
    for (rows, said) in [
        ("\n0.4, 0., 2., 20.\n0.2, 0., 2., 200.", "friction depends on the temperature, which no deck says"),
        ("\n0.4, 0., 2.\n0.2, 1., 3.", "a combination of values not at all or twice"),
        (", EXPONENTIAL DECAY\n0., 0.3, 1.", "an exponential decay needs a static coefficient"),
    ] {
        let message = curve(rows).unwrap_err();
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn a_table_of_pressures_begins_where_its_last_row_without_pressure_is() {
    let rows = |table: &str| {
        let text = good().replace("=LINEAR\n20000.\n", &format!("=TABULAR\n{table}"));
        read(&text).map(|own| match own.model.contacts[0].law.clone() {
            Some(NormalLaw::Table { rows }) => {
                let mut deck = Vec::new();
                crate::deck::write(&own.model, &own.mesh, UnitSystem::ALL[0], "a test", &mut deck).unwrap();
                let again = read(&String::from_utf8(deck).unwrap()).unwrap();
                assert_eq!(again.model.contacts[0].law, own.model.contacts[0].law);
                let toml = crate::model::write(&own.model, "a.msh");
                let again = crate::model::parse(&toml, std::path::Path::new("a.toml")).unwrap();
                assert_eq!(again.contacts[0].law, own.model.contacts[0].law);
                rows.as_flattened().to_vec()
            }
            law => panic!("{law:?}"),
        })
    };
    let all_close = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || close(*a, *b));
    let found = rows("0.,-0.2\n0.,-0.1\n1.,0.\n4.,0.5\n").unwrap();
    assert!(all_close(&found, &[-1e-4, 0.0, 0.0, 1e6, 5e-4, 4e6]), "{found:?}");
    let found = rows("2.,1.\n3.,2.\n").unwrap();
    assert!(all_close(&found, &[0.0, 0.0, 1e-3, 2e6, 2e-3, 3e6]), "{found:?}");
}

#[test]
fn rough_surfaces_and_coefficients_from_a_thousand_on_never_slip() {
    let friction = |text: &str| {
        let still = good().replace("*MOTION, ROTATION\nTURNING, 5., 0,0,0, 0,0,1\n", "");
        read(&still.replace("*FRICTION\n0.4\n", text))
            .map(|own| (own.model.contacts[0].friction, own.model.contacts[0].stick))
    };
    let half = Some(1e13);
    assert_eq!(friction("*FRICTION, ROUGH\n").unwrap(), (crate::model::ROUGH, half));
    assert_eq!(friction("*FRICTION\n1000.\n").unwrap(), (crate::model::ROUGH, half));
    assert_eq!(friction("*FRICTION\n1.9\n").unwrap(), (1.9, half));
    assert!(friction("*FRICTION\n999.\n").unwrap_err().contains("a friction coefficient of 999 is above 2"));
}

#[test]
fn pressures_act_on_faces_and_surfaces() {
    let loads = |new: &str| {
        let Converted { model, mesh, .. } = with("*CLOAD\nBACK, 3, -25.\n", new).unwrap();
        let load = &model.loads[0];
        let LoadKind::Pressure(pressure) = load.kind else { panic!("{load:?}") };
        (pressure, mesh.surfaces[&load.on].facets.len(), mesh.surfaces[&load.on].parts[0])
    };
    let (pressure, n, part) = loads("*DLOAD\nPAD, P3, 2.5\n");
    assert!(close(pressure, 2.5e6) && (n, part) == (1, 1));
    let (pressure, n, part) =
        loads("*SURFACE, NAME=ALL_PAD\nPAD,\n*DSLOAD\nALL_PAD, P, 1.\n*DSLOAD\nALL_PAD, P, 1.5\n");
    assert!(close(pressure, 2.5e6) && (n, part) == (4, 1));
}

#[test]
fn a_surface_of_nodes_is_the_facets_between_them() {
    let nodes = "*SURFACE, NAME=Pad_face, TYPE=NODE\n11\n12\n13\n15\n16\n17\n";
    let Converted { mesh, summary, .. } = with("*SURFACE, NAME=Pad_face\n2, S1\n", nodes).unwrap();
    assert_eq!(mesh.surfaces["Pad_face"].facets.len(), 1);
    assert!(summary.notes.iter().any(|note| note.contains("6 nodes is read as the 1 facets")), "{:?}", summary.notes);
}

#[test]
fn the_faces_of_a_surface_keep_their_order_and_are_there_once() {
    let corners = |faces: &str| {
        let Converted { mesh, .. } =
            with("*SURFACE, NAME=Pad_face\n2, S1\n", &format!("*SURFACE, NAME=Pad_face\n{faces}"))?;
        Ok::<_, String>(mesh.surfaces["Pad_face"].facets.iter().map(|facet| facet.key()).collect::<Vec<_>>())
    };
    let (first, third) = (corners("2, S1\n").unwrap()[0], corners("2, S3\n").unwrap()[0]);
    assert_ne!(first, third);
    assert_eq!(corners("2, S3\n2, S1\n2, S3\n").unwrap(), [third, first]);
    assert_eq!(corners("2, S1\n2, S3\n").unwrap(), [first, third]);
}

#[test]
fn bodies_of_one_section_that_touch_are_parts() {
    let sections = "*SOLID SECTION, ELSET=DISC, MATERIAL=STEEL\n*SOLID SECTION, ELSET=PAD, MATERIAL=STEEL\n";
    let one = "*ELSET, ELSET=BOTH\nDISC, PAD\n*SOLID SECTION, ELSET=BOTH, MATERIAL=STEEL\n";
    let Converted { model, mesh, summary } = with(sections, one).unwrap();
    assert_eq!(mesh.parts, ["BOTH", "BOTH body"]);
    assert_eq!((model.rotations[0].part.as_str(), mesh.elements.get(1).part), ("BOTH", 1));
    assert!(summary.notes.iter().any(|note| note.starts_with("2 bodies of BOTH touch")), "{:?}", summary.notes);
}

#[test]
fn a_deck_of_statics_needs_no_density_and_one_of_modes_does() {
    let text = good().replace("*DENSITY\n7.85e-9\n", "");
    assert!(read(&text).unwrap_err().starts_with("a.inp:38: the material Steel has no *DENSITY"));
    let (statics, _) = text.split_once("*STEP\n*COMPLEX").unwrap();
    let Converted { model, summary, .. } = read(statics).unwrap();
    assert_eq!(model.parts[0].material.density, 0.0);
    assert!(summary.notes.iter().any(|note| note.starts_with("the material Steel has no *DENSITY")));
}
