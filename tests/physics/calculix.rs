//! CalculiX and we on the same mesh of 10-node tetrahedra: frequencies of real modes.
//!
//! ```text
//! our mesh, materials, supports ---> deck: C3D10, *ELASTIC ANISO, *BOUNDARY, *FREQUENCY ---> ccx ---> frequencies
//! closed contact points ----------->       *EQUATION q = sqrt(w k_n) n.(B u), a spring of 1 N/m on q
//! ```
//!
//! Source: CalculiX CrunchiX (ccx) 2.20, G. Dhondt, as Debian packages it. Its C3D10 has the same corners and midsides
//! in the same order, curved edges, and 4 points for the stiffness, as ours. It has 4 points for the mass too
//! (`e_c3d.f`: `mint3d=4` unless `intscheme` asks for more), where an exact rule takes 14: an error of the size of the
//! mesh's own, which grows with frequency. So modes are compared twice: with our exact mass, and with the mass of 4
//! points, [`TheirMass`], which shows that nothing else differs.
//!
//! Goal and, in brackets, measured: with the mass of 4 points 1e-6 [2e-7, 2e-7; ccx prints eigenvalues with seven
//! digits]; with our own 1e-4 below 4 kHz [5.6e-5], 5e-4 to the 30th mode [3.3e-4].
//!
//! Friction is not compared: ccx takes the direction of sliding from the displacements of a static step, and has no
//! imposed velocity.
//!
//! `make calculix` prints the tables. Without ccx (`scripts/setup.sh --tests` installs it) there is nothing to compare
//! with, and the tests fail.

mod decks;
mod elements;
mod gravity;
mod references;

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use crate::support::block::Block;
use crate::support::{self, data};
use squeal::analysis::Sweep;
use squeal::assembly::{Connectivity, ElementMatrices, Elements, Solids, System};
use squeal::contact::{Response, Status};
use squeal::element::ElementKind;
use squeal::mesh::Mesh;
use squeal::native::{Comm, Session};
use squeal::stability::Mode;
use squeal::structure::FullModel;

/// Largest relative difference of a frequency with the same mass: what seven digits of an eigenvalue leave.
const SAME: f64 = 1e-6;
/// With masses of 4 and of 14 points, for modes below [`LOW`] and for all.
const OTHER: [f64; 2] = [1e-4, 5e-4];
/// Hz.
const LOW: f64 = 4000.0;
const N_MODES: usize = 30;

/// The deck: the brake as it is about an equilibrium, without friction.
fn deck(brake: &FullModel, responses: &[Response]) -> String {
    let mut out = String::from("*NODE\n");
    for (i, [x, y, z]) in brake.mesh.nodes.iter().enumerate() {
        writeln!(out, "{},{x:.12e},{y:.12e},{z:.12e}", i + 1).unwrap();
    }
    parts(&mut out, brake);
    contacts(&mut out, brake, responses);
    out += "*BOUNDARY\n";
    for (i, held) in brake.held.iter().enumerate() {
        for axis in (0..3).filter(|&axis| held[axis]) {
            writeln!(out, "{},{}", i + 1, axis + 1).unwrap();
        }
    }
    writeln!(out, "*STEP\n*FREQUENCY\n{N_MODES}\n*NODE PRINT,NSET=FIRST\nU\n*END STEP").unwrap();
    out
}

/// Tetrahedra, materials and sections. An element's nodes are in our order.
fn parts(out: &mut String, brake: &FullModel) {
    *out += "*NSET,NSET=FIRST\n1\n";
    for (p, name) in brake.mesh.parts.iter().enumerate() {
        let kind = brake.mesh.elements.iter().find(|element| element.part as usize == p).unwrap().kind.name();
        writeln!(out, "*ELEMENT,TYPE={kind},ELSET=PART{p}").unwrap();
        for (e, element) in brake.mesh.elements.iter().enumerate().filter(|(_, element)| element.part as usize == p) {
            let nodes: Vec<String> = element.nodes.iter().map(|node| (node + 1).to_string()).collect();
            let lines: Vec<String> = nodes.chunks(10).map(|line| line.join(",")).collect();
            writeln!(out, "{},{}", e + 1, lines.join(",\n")).unwrap();
        }
        let material = &brake.model.parts.iter().find(|part| part.name == *name).unwrap().material;
        writeln!(out, "*MATERIAL,NAME=MATERIAL{p}\n{}", elastic(&material.elasticity)).unwrap();
        writeln!(out, "*DENSITY\n{:.12e}\n*SOLID SECTION,ELSET=PART{p},MATERIAL=MATERIAL{p}", material.density)
            .unwrap();
    }
}

/// The keyword with the constants.
fn elastic(elasticity: &[[f64; 6]; 6]) -> String {
    // Upper triangle by columns, in the order xx yy zz xy xz yz; ours ends with yz zx.
    const ORDER: [usize; 6] = [0, 1, 2, 3, 5, 4];
    let triangle = (0..6).flat_map(|column| (0..=column).map(move |row| [row, column].map(|i| ORDER[i])));
    let constants: Vec<String> = triangle.map(|[i, j]| format!("{:.12e}", elasticity[i][j])).collect();
    let lines: Vec<String> = constants.chunks(8).map(|line| line.join(",")).collect();
    format!("*ELASTIC,TYPE=ANISO\n{}", lines.join("\n"))
}

/// Closed points as springs: `q = sqrt(n^T D n) n.(B u)` is the displacement along x of a node of its own.
fn contacts(out: &mut String, brake: &FullModel, responses: &[Response]) {
    let interface = &brake.interface;
    let closed: Vec<usize> = (0..responses.len()).filter(|&a| responses[a].status != Status::Open).collect();
    let (n_nodes, n_elements) = (brake.mesh.nodes.len(), brake.mesh.elements.len());
    if closed.is_empty() {
        return;
    }
    let number = |k: usize| n_nodes + k + 1;
    *out += "*NODE\n";
    (0..closed.len()).for_each(|k| writeln!(out, "{},0,0,0", number(k)).unwrap());
    *out += "*ELEMENT,TYPE=SPRING1,ELSET=SPRINGS\n";
    (0..closed.len()).for_each(|k| writeln!(out, "{},{}", n_elements + k + 1, number(k)).unwrap());
    *out += "*SPRING,ELSET=SPRINGS\n1\n1.\n*BOUNDARY\n";
    (0..closed.len()).for_each(|k| writeln!(out, "{},2,3", number(k)).unwrap());
    for (k, &a) in closed.iter().enumerate() {
        let (normal, d) = (interface.points[a].law.normal, responses[a].tangent);
        let stiffness: f64 = (0..9).map(|at| normal[at / 3] * d[at / 3][at % 3] * normal[at % 3]).sum();
        let (nodes, blocks) = interface.gap_operator.point(a);
        let mut terms = vec![format!("{},1,-1.", number(k))];
        for (node, block) in nodes.iter().zip(blocks) {
            for axis in 0..3 {
                let c: f64 = (0..3).map(|i| normal[i] * block[i][axis]).sum();
                if c.abs() > 1e-14 && !brake.held[*node as usize][axis] {
                    terms.push(format!("{},{},{:.12e}", node + 1, axis + 1, stiffness.sqrt() * c));
                }
            }
        }
        writeln!(out, "*EQUATION\n{}", terms.len()).unwrap();
        terms.chunks(4).for_each(|line| writeln!(out, "{}", line.join(",")).unwrap());
    }
}

/// Runs ccx on a deck; the folder has its files, `deck.*`.
fn run(deck: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("deck.inp"), deck).unwrap();
    let run = Command::new("ccx").arg("deck").current_dir(folder.path()).env("OMP_NUM_THREADS", "1").output();
    let run = run.expect("CalculiX: `scripts/setup.sh --tests` installs ccx");
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(!said.contains("*ERROR"), "{said}");
    folder
}

/// Frequencies (Hz) that ccx finds.
fn calculix(deck: &str) -> Vec<f64> {
    let folder = run(deck);
    let text = std::fs::read_to_string(folder.path().join("deck.dat")).unwrap();
    let table = text.split("E I G E N V A L U E   O U T P U T").nth(1).unwrap_or_else(|| panic!("{text}"));
    // MODE NO, EIGENVALUE, FREQUENCY in rad/time and cycles/time
    let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    let rows = table.lines().filter_map(numbers).skip_while(Vec::is_empty).take_while(|row| row.len() >= 4);
    rows.map(|row| row[1].sqrt() / std::f64::consts::TAU).collect()
}

/// Solids whose mass is integrated by CalculiX's points, `m_ab = sum_q rho w detJ N_a N_b`.
struct TheirMass<'a> {
    solids: Solids<'a>,
    mesh: &'a Mesh,
}

impl<'a> TheirMass<'a> {
    fn of(brake: &'a FullModel) -> TheirMass<'a> {
        TheirMass { solids: Solids::new(&brake.model, &brake.mesh).unwrap(), mesh: &brake.mesh }
    }
}

impl Connectivity for TheirMass<'_> {
    fn len(&self) -> usize {
        self.solids.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        self.solids.nodes(e)
    }
}

impl Elements for TheirMass<'_> {
    fn mass_couples_axes(&self) -> bool {
        false
    }

    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        self.solids.matrices(e, out);
        let mass = elements::mass(self.mesh.elements.get(e).kind, &self.mesh.element_nodes(e));
        let density = self.solids.part(e).material.density;
        out.m.iter_mut().zip(&mass).for_each(|(m, own)| *m = density * own);
    }
}

/// Frequencies (Hz) of a system's modes about its equilibrium without friction, and what the contact points answer
/// there.
fn ours(brake: &FullModel, system: &System) -> (Vec<f64>, Vec<Response>) {
    let mut sweep = Sweep::new(system, &brake.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    assert!(band.count.agrees() && band.modes.len() >= N_MODES, "{:?}", band.count);
    (band.modes.iter().map(Mode::frequency).collect(), equilibrium.responses)
}

/// Compares the modes about the equilibrium at friction 0.
fn compare(comm: &Comm, brake: &FullModel) {
    let families = brake.families().unwrap();
    let (exact, responses) = ours(brake, &brake.assemble(comm, &families).unwrap());
    let (same, _) = ours(brake, &brake.assemble_families(comm, &[&TheirMass::of(brake), families.joints]).unwrap());
    let theirs = calculix(&deck(brake, &responses));
    assert_eq!(theirs.len(), N_MODES);
    println!("mode     CalculiX Hz       squeal Hz  difference  with 4 points for the mass");
    for (i, theirs) in theirs.iter().enumerate() {
        let [by_mass, at_all] = [exact[i], same[i]].map(|ours| ours / theirs - 1.0);
        println!("{:4}  {theirs:14.7}  {:14.7}  {by_mass:+10.1e}  {at_all:+10.1e}", i + 1, exact[i]);
        assert!(at_all.abs() < SAME, "mode {}", i + 1);
        assert!(by_mass.abs() < OTHER[usize::from(*theirs > LOW)], "mode {}", i + 1);
    }
}

/// The two pads pressed on the disc, without friction.
#[test]
fn calculix_finds_the_modes_of_a_brake_in_contact() {
    let comm = Session::start(&[]).unwrap();
    let mut brake = FullModel::read(&comm, &data("pads_on_disc.toml")).unwrap();
    brake.model.band = [0.0, 11000.0];
    compare(&comm, &brake);
}

/// A disc and two pads that do not touch, the disc of a material with a tilted axis.
#[test]
fn calculix_finds_the_modes_of_parts_of_any_elasticity() {
    let comm = Session::start(&[]).unwrap();
    let text = std::fs::read_to_string(data("pads_on_disc.toml")).unwrap();
    let mut text = text.replace("axes = \"xy\"", "axes = \"xyz\"");
    let contacts = text.find("[[rotation]]").unwrap()..text.find("[stability]").unwrap();
    text.replace_range(contacts, "");
    let isotropic = "young = 110e9\npoisson = 0.27\n";
    assert!(text.contains(isotropic));
    let transverse = "kind = \"transverse\"\naxis = [1, 2, 3]\nyoung = 110e9\nyoung_axial = 70e9\npoisson = 0.27\n\
                      poisson_axial = 0.2\nshear_axial = 30e9\n";
    let mesh = data("pads_on_disc.msh");
    let text = text.replace(isotropic, transverse).replace("pads_on_disc.msh", mesh.to_str().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parts.toml");
    std::fs::write(&file, text).unwrap();
    let mut brake = FullModel::read(&comm, Path::new(&file)).unwrap();
    brake.model.band = [0.0, 14000.0];
    compare(&comm, &brake);
}

const BEAMS: &str = r#"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[part.full]
material = "iron"
[part.linear]
material = "iron"
[[fix]]
nodes = "full_x0"
axes = "xyz"
[[fix]]
nodes = "linear_x0"
axes = "xyz"
[stability]
band = [0, 60e3]
"#;

/// Two curved cantilevers, of C3D20 and of C3D8, in one mesh: kinds whose mass has the same points in CalculiX.
#[test]
fn calculix_finds_the_modes_of_mixed_hexahedra() {
    let comm = Session::start(&[]).unwrap();
    let mut mesh = Mesh::default();
    let bent = |x: [f64; 3]| [0.1 * x[0], 0.02 * x[1] + 0.03 * x[0] * x[0], 0.015 * x[2] * (1.2 - 0.4 * x[0])];
    let aside = |x: [f64; 3]| bent(x).map(|x| 1.3 * x + 0.3);
    Block { part: "full", cells: [6, 2, 1], wraps: false, map: &bent }.add_solids_to(&mut mesh, ElementKind::C3D20);
    Block { part: "linear", cells: [9, 2, 3], wraps: false, map: &aside }.add_solids_to(&mut mesh, ElementKind::C3D8);
    let brake = support::brake(BEAMS, mesh);
    let (found, responses) = ours(&brake, &brake.assemble(&comm, &brake.families().unwrap()).unwrap());
    let theirs = calculix(&deck(&brake, &responses));
    for (i, theirs) in theirs.iter().enumerate() {
        println!("{:4}  {theirs:14.7}  {:14.7}  {:+10.1e}", i + 1, found[i], found[i] / theirs - 1.0);
        assert!((found[i] / theirs - 1.0).abs() < SAME, "mode {}", i + 1);
    }
}
