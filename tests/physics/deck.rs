//! A brake as a deck: written, read back, in other units and in a turned assembly, it is the same brake.

use std::path::Path;

use crate::support::data;
use squeal::analysis::Sweep;
use squeal::contact::search::Alone;
use squeal::deck;
use squeal::mesh::{Numbering, Piece};
use squeal::model::UnitSystem;
use squeal::native::{Comm, Session, Vector};
use squeal::stability::Mode;
use squeal::structure::{FullModel, ModelFiles};

/// Relative difference of matrices whose numbers were written with 20 characters.
const SAME_MATRIX: f64 = 1e-11;
/// Relative difference of eigenvalues.
const SAME_MODES: f64 = 1e-9;
/// Friction coefficient of the modes that are compared.
const FRICTION: f64 = 0.4;

fn brake(file: &Path) -> FullModel {
    let ModelFiles { model, mesh, .. } = ModelFiles::read(file, None).unwrap_or_else(|error| panic!("{error}"));
    let nodes = Numbering::even(mesh.nodes.len(), 0, 1);
    FullModel::new(model, Piece { mesh, nodes }, &Alone).unwrap_or_else(|error| panic!("{error}"))
}

/// A model as the text of a deck.
fn deck_of(file: &Path, units: UnitSystem) -> String {
    let ModelFiles { model, mesh, .. } = ModelFiles::read(file, None).unwrap();
    let mut out = Vec::new();
    let losses = deck::write(&model, &mesh, units, "a test", &mut out).unwrap();
    assert!(
        losses.iter().all(|loss| ["sweep", "search", "reduction"].iter().any(|word| loss.contains(word))),
        "{losses:?}"
    );
    String::from_utf8(out).unwrap()
}

/// The brake that a deck's text means.
fn brake_of(deck: &str) -> FullModel {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("brake.inp");
    std::fs::write(&file, deck).unwrap();
    brake(&file)
}

/// M x, C x, K x for a vector of waves, and the load.
fn products(comm: &Comm, brake: &FullModel) -> [Vec<f64>; 4] {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let wave: Vec<f64> = (0..system.dofs.n_local()).map(|i| (0.7 * i as f64).sin()).collect();
    let x = Vector::from_local(comm, &wave).unwrap();
    let times = |matrix: &squeal::native::Matrix| {
        let mut y = Vector::zeros(comm, system.dofs.n_local()).unwrap();
        matrix.multiply(&x, &mut y).unwrap();
        y.to_vec().unwrap()
    };
    [times(&system.m), times(&system.c), times(&system.k), system.load.to_vec().unwrap()]
}

#[track_caller]
fn assert_same_products(comm: &Comm, one: &FullModel, two: &FullModel) {
    let names = ["M", "C", "K", "load"];
    for ((a, b), name) in products(comm, one).iter().zip(&products(comm, two)).zip(names) {
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
        let difference = norm(&mut a.iter().zip(b).map(|(a, b)| a - b));
        let size = norm(&mut a.iter().copied());
        println!("{name}: {difference:.1e} of {size:.1e}");
        assert!(a.len() == b.len() && difference <= SAME_MATRIX * size, "{name}");
    }
}

/// The modes at a friction value.
fn modes(comm: &Comm, brake: &FullModel) -> Vec<Mode> {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(FRICTION, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    assert!(band.count.agrees());
    band.modes
}

#[track_caller]
fn assert_same_modes(one: &[Mode], two: &[Mode]) {
    assert!(one.len() == two.len() && one.len() > 20, "{} and {} modes", one.len(), two.len());
    let off = |mode: &Mode| {
        let all = two.iter().map(|other| (other.lambda - mode.lambda).norm() / mode.lambda.norm());
        all.fold(f64::INFINITY, f64::min)
    };
    let worst = one.iter().map(off).fold(0.0, f64::max);
    println!("{} modes, largest difference {worst:.1e}", one.len());
    assert!(worst <= SAME_MODES, "{worst}");
}

/// M, C, K and the load of pads on a disc: written in four systems of units and read back.
#[test]
fn a_deck_has_the_matrices_of_its_model_in_any_units() {
    let comm = Session::start(&[]).unwrap();
    let file = data("pads_on_disc.toml");
    let model = brake(&file);
    for system in UnitSystem::ALL.into_iter().filter(|system| system.name != "cm-g-s") {
        let deck = brake_of(&deck_of(&file, system));
        assert_eq!(deck.model.parts.len(), 5);
        println!("{}", system.name);
        assert_same_products(&comm, &model, &deck);
        assert_eq!(model.interface.points.len(), deck.interface.points.len());
    }
}

/// Modes to 1e-9: of the deck in millimetres, tonnes and seconds, and of the same deck as an instance that is moved
/// along and turned about the disc's axis.
#[test]
fn a_deck_and_an_instance_in_a_turned_assembly_have_the_modes_of_the_model() {
    let comm = Session::start(&[]).unwrap();
    let file = data("pads_on_disc.toml");
    let expected = modes(&comm, &brake(&file));
    let text = deck_of(&file, UnitSystem::ALL[0]);
    assert_same_modes(&expected, &modes(&comm, &brake_of(&text)));
    let turned = brake_of(&as_instance(&text));
    assert!(turned.mesh.parts.iter().all(|part| part.starts_with("B-1.")), "{:?}", turned.mesh.parts);
    assert_same_modes(&expected, &modes(&comm, &turned));
}

/// A flat deck as a part with one instance.
fn as_instance(deck: &str) -> String {
    const OF_PART: [&str; 5] = ["*NODE", "*ELEMENT", "*NSET", "*SURFACE", "*SOLID SECTION"];
    const WITH_NAMES: [&str; 4] = ["*CONTACT PAIR", "*BOUNDARY", "*CLOAD", "*MOTION"];
    let (mut part, mut rest) = (String::new(), String::new());
    for block in deck.split("\n*").skip(1).filter(|block| !block.starts_with('*')) {
        let (head, data) = block.split_once('\n').unwrap_or((block, ""));
        let head = format!("*{head}");
        let keyword = head.split(',').next().unwrap();
        let out = if OF_PART.contains(&keyword) { &mut part } else { &mut rest };
        *out += &format!("{head}\n");
        for line in data.lines() {
            let line = match keyword {
                "*CONTACT PAIR" => line.split(',').map(|name| format!("B-1.{name}")).collect::<Vec<_>>().join(","),
                _ if WITH_NAMES.contains(&keyword) => format!("B-1.{line}"),
                _ => line.to_owned(),
            };
            *out += &format!("{line}\n");
        }
    }
    let place = "0., 0., 7.\n0.,0.,0., 0.,0.,1., 37.";
    format!(
        "*PART, NAME=BRAKE\n{part}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=B-1, PART=BRAKE\n{place}\n*END INSTANCE\n\
         *END ASSEMBLY\n{rest}"
    )
}

/// The demo brake with its connectors, pressures, damping and anisotropic linings.
#[test]
fn the_demo_brake_as_a_deck_has_its_matrices() {
    let comm = Session::start(&[]).unwrap();
    let file = Path::new("meshes/brake-small.toml");
    let (model, deck) = (brake(file), brake_of(&deck_of(file, UnitSystem::ALL[0])));
    assert_same_products(&comm, &model, &deck);
    assert_eq!(model.joints.elements.len(), deck.joints.elements.len());
}

/// What joins the pads of `with_joints`: a tie, a rigid back, a mass, a spring to the ground, a force and a moment.
const JOINTS: &str = r#"
[[tie]]
slave = "lining_outer_face"
master = "disc_outer_face"
search = 1.0
[[rigid]]
nodes = "backplate_inner_back"
[[mass]]
nodes = "backplate_outer_back"
at = [0, 10, 60]
mass = 0.1
inertia = [1e-4, 2e-4, 3e-4, 1e-5, -2e-5, 3e-5]
[[connector]]
between = ["backplate_outer_back", "ground"]
at = [5, 0, 50]
stiffness = [1e6, 2e6, 0]
rotational_stiffness = [10, 0, 30]
damping = [0, 2, 3]
[[load]]
name = "side"
on = "backplate_outer_back"
at = [1, 2, 50]
force = [10, 0, -5]
moment = [1, 2, 0]
"#;

/// Pads of which one is tied to the disc, with all other joints that need no point.
fn with_joints(folder: &Path) -> std::path::PathBuf {
    let text = std::fs::read_to_string(data("pads_on_disc.toml")).unwrap();
    let outer = text.find("[[contact]]\nname = \"disc / outer pad\"").unwrap()..text.find("[[load]]").unwrap();
    let mesh = data("pads_on_disc.msh");
    let text = text.replace(&text[outer], "").replace("pads_on_disc.msh", mesh.to_str().unwrap());
    let file = folder.join("joints.toml");
    std::fs::write(&file, text.replace("[stability]", &format!("{JOINTS}\n[stability]"))).unwrap();
    file
}

#[test]
fn joints_of_a_deck_have_the_matrices_of_their_model() {
    let comm = Session::start(&[]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = with_joints(folder.path());
    let (model, deck) = (brake(&file), brake_of(&deck_of(&file, UnitSystem::ALL[0])));
    assert_eq!(model.joints.elements.len(), deck.joints.elements.len());
    assert_same_products(&comm, &model, &deck);
}
