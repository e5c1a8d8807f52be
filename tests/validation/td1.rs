//! TD-1 of the Ansys Technology Showcase: a whole ventilated disc with two pads, 29 frequencies and a pair that
//! flutters.
//!
//! ```text
//!            ___________
//!     ______|___________|______      pads on both cheeks, 60 degrees, backs held in x and y
//!    |_________________________|     cheeks r 125-175; 21 vanes between them
//!     ___| |___   ___| |_______
//!    |_________|_|_____________|     flange, hat, held at its bore and five holes: meshes/td1.geo
//! ```
//!
//! Source: Ansys Technology Showcase, FullModel-Squeal Analysis, table 1.2, linear non-prestressed modal analysis: 60
//! thousand nodes of hexahedra with reduced integration; 26 bodies (hat, its cylinder, flange, two cheeks, 21 vanes)
//! *bonded* to one another by constraints between meshes that do not match; contact at Gauss points, its stiffness by a
//! rule of the program. Its frequencies are omega / 2 pi, and so are its real parts: ours, divided by 2 pi, are of that
//! size. Density 7850 kg/m3 is the scripts'; the text says 7800.
//!
//! Ours is one body, meshed by tetrahedra: [`SIZES`], the same geometry. Contacts are closed as in the published linear
//! analysis (`separation = false`), and the modes do not depend on the small pressure.
//!
//! Goal: the pair is found at its place among 30 modes, unstable at 0.3, with the published growth; 1 % for all other
//! frequencies. Measured on the fine mesh: growth 7 %; 1.2 % for 15 modes, 3.2 % for 25, those in which the pads bend
//! above the published ones; 4 to 9 % below them for five modes of the hat. The document says what was tried to find
//! out why.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

use squeal::analysis::{FrictionFamily, Snapshot, Sweep, tracking_options, widened};
use squeal::model::InstabilityCriterion;
use squeal::native::{Comm, Session};
use squeal::stability::Mode;
use squeal::structure::FullModel;
use squeal::tracking::{Diagram, track};

use super::table::{ADVICE, document, section_of};
use crate::support::assert_close;

/// Published frequencies, Hz; those of the pair are [`PAIR`] and the next.
const PUBLISHED: [f64; 30] = [
    775.91, 863.54, 1097.18, 1311.54, 1328.73, 1600.95, 1616.15, 1910.50, 2070.73, 2081.26, 2676.71, 2724.05, 3373.96,
    4141.64, 4145.16, 4433.91, 4486.50, 4668.51, 4767.54, 5241.61, 6474.25, 6474.25, 6763.36, 6765.62, 6920.64,
    6929.25, 7069.69, 7243.80, 8498.41, 8623.76,
];
/// Place of the unstable pair.
const PAIR: usize = 20;
/// Its published growth rate, `a / 2 pi` in Hz.
const GROWTH: f64 = 21.61;
/// Meshes of `meshes/td1.geo` and their names.
const SIZES: [&str; 3] = ["coarse", "medium", "fine"];
/// Band that holds all of the list on all meshes, Hz.
const BAND: [f64; 2] = [0.0, 9800.0];
const TITLE: &str = "TD-1, a whole brake";

/// The model on one of the meshes, with some text of the model file in place of other.
fn brake(comm: &Comm, size: &str, changes: &[(&str, &str)]) -> FullModel {
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes");
    let mut text = std::fs::read_to_string(meshes.join("td1.toml")).unwrap();
    let mesh = meshes.join(format!("build/td1-{size}.msh"));
    for (old, new) in [("build/td1-medium.msh", mesh.to_str().unwrap())].iter().chain(changes) {
        assert!(text.contains(old), "{old:?} is not in td1.toml");
        text = text.replace(old, new);
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("td1.toml");
    std::fs::write(&file, text).unwrap();
    FullModel::read(comm, &file).unwrap()
}

/// Eigenvalues at friction 0.3 as (frequency, growth), both in Hz, by rising frequency; and the number of nodes.
fn modes(comm: &Comm, size: &str, changes: &[(&str, &str)]) -> (Vec<[f64; 2]>, usize) {
    let brake = brake(comm, size, changes);
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(0.3, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, BAND, &mut ()).unwrap();
    assert!(band.count.agrees(), "{:?}", band.count);
    assert!(band.modes.iter().all(|mode| mode.backward_error < 1e-10));
    let hertz = |mode: &Mode| [mode.frequency(), mode.growth_rate() / TAU];
    (band.modes.iter().map(hertz).collect(), brake.mesh.nodes.len())
}

/// The largest growth among the modes, which has to be that of the published pair: by place and by frequency.
fn growth(modes: &[[f64; 2]]) -> f64 {
    let worst = (0..modes.len()).max_by(|&a, &b| modes[a][1].total_cmp(&modes[b][1])).unwrap();
    assert!(worst == PAIR || worst == PAIR + 1, "mode {} at {} Hz grows most", worst + 1, modes[worst][0]);
    assert_close("the pair", modes[worst][0], PUBLISHED[PAIR], 0.07);
    modes[worst][1]
}

/// A line of the table for a mode on several meshes, against the published value.
fn line(mode: usize, meshes: &[Vec<[f64; 2]>]) -> String {
    let found: Vec<String> = meshes.iter().map(|modes| format!("{:.2}", modes[mode][0])).collect();
    let published = PUBLISHED[mode];
    let difference = 100.0 * (meshes.last().unwrap()[mode][0] / published - 1.0);
    format!("| {} | {} | {published:.2} | {difference:+.2} % |", mode + 1, found.join(" | "))
}

/// How far frequencies of two meshes made alike may be apart: gmsh moves the middle nodes of strongly curved elements a
/// little differently from run to run (8.6e-5 seen in five).
const SAME_MESH: f64 = 2e-4;

/// On the coarse mesh: the pair, its growth to 20 %, and frequencies to 10 %; the document has them.
#[test]
fn the_published_pair_flutters_on_the_coarse_mesh() {
    let comm = Session::start(&[]).unwrap();
    let (modes, _) = modes(&comm, SIZES[0], &[]);
    assert_close("growth", growth(&modes), GROWTH, 0.2);
    for (mode, published) in modes.iter().zip(PUBLISHED) {
        assert_close("frequency", mode[0], published, 0.1);
    }
    let document = std::fs::read_to_string(document()).unwrap_or_default();
    let section = section_of(&document, TITLE);
    for (i, mode) in modes.iter().take(PUBLISHED.len()).enumerate() {
        let start = format!("| {} | ", i + 1);
        let line =
            section.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("mode {i}: {ADVICE}"));
        let written: f64 = line[start.len()..].split(' ').next().unwrap().parse().unwrap();
        assert!(
            (written / mode[0] - 1.0).abs() < SAME_MESH,
            "mode {}: {} Hz, {written} in the document: {ADVICE}",
            i + 1,
            mode[0]
        );
    }
}

/// The modes of 0-9000 Hz followed from friction 0 to 0.3.
fn followed(comm: &Comm, size: &str) -> Diagram {
    let brake = brake(comm, size, &[]);
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let band = brake.model.band;
    let mut solve = |friction: f64| {
        let equilibrium = sweep.equilibrium(friction, &mut ())?;
        let modes = sweep.modes(&equilibrium, widened(band), &mut ())?;
        Snapshot::new(&mut sweep, &modes, band[1])
    };
    let mut family =
        FrictionFamily { solutions: &mut solve, m: &system.m, c: &system.c, viscoelastic: &system.viscoelastic };
    let (diagram, outcome) =
        track(&mut family, &brake.model.frictions, &tracking_options(band, InstabilityCriterion::default()));
    outcome.unwrap();
    diagram
}

/// Hopf points, and the branches that become unstable with the one each couples with.
fn sweep_text(diagram: &Diagram) -> String {
    let mut out = String::from(
        "| Hopf point at friction | Hz | couples with the branch at | growth at 0.3, Hz |\n|---|---|---|---|\n",
    );
    for hopf in &diagram.hopf {
        let partner = hopf.partner.map_or("-".to_owned(), |partner| {
            format!("{:.1} Hz", diagram.branches[partner.branch].points[0].lambda.im / TAU)
        });
        let last = diagram.branches[hopf.branch].points.last().unwrap();
        let kind = if hopf.onset { "" } else { " (stable again)" };
        let at = format!("{:.4}{kind} | {:.1}", hopf.value, hopf.omega / TAU);
        writeln!(out, "| {at} | {partner} | {:.2} |", last.lambda.re / TAU).unwrap();
    }
    let strongest = diagram.branches.iter().max_by(|a, b| a.worst().lambda.re.total_cmp(&b.worst().lambda.re)).unwrap();
    let at = |value: f64, branch: &squeal::tracking::Branch| {
        branch.points.iter().find(|point| point.value == value).map(|point| point.lambda / TAU)
    };
    let hopf = diagram.hopf.iter().find(|hopf| std::ptr::eq(&diagram.branches[hopf.branch], strongest));
    let partner = hopf.and_then(|hopf| hopf.partner).map(|partner| &diagram.branches[partner.branch]);
    out +=
        "\nThe two branches of the pair:\n\n| friction | Hz | growth, Hz | Hz | growth, Hz |\n|---|---|---|---|---|\n";
    for &value in &diagram.values {
        let cells = [Some(strongest), partner].into_iter().flatten().filter_map(|branch| at(value, branch));
        let cells: Vec<String> = cells.map(|z| format!("{:.2} | {:+.2}", z.im, z.re + 0.0)).collect();
        writeln!(out, "| {value:.4} | {} |", cells.join(" | ")).unwrap();
    }
    out
}

/// What was tried to find out why we differ: each with the change of the model file.
const TRIED: [(&str, &[(&str, &str)]); 5] = [
    ("as it is: density 7850 kg/m3, penalty 5e13 N/m3, no separation", &[]),
    ("density 7800 kg/m3", &[("density = 7850", "density = 7800")]),
    ("penalty 1e12 N/m3", &[("linear = 5e13", "linear = 1e12")]),
    ("penalty 1e13 N/m3", &[("linear = 5e13", "linear = 1e13")]),
    ("penalty 2e14 N/m3", &[("linear = 5e13", "linear = 2e14")]),
];

/// A table of what each change does, on the medium mesh.
fn tried(comm: &Comm) -> String {
    let shown = [0, 1, 2, 7, 8, 13, PAIR, 28];
    let heads: Vec<String> = shown.iter().map(|i| format!("mode {}", i + 1)).collect();
    let mut out =
        format!("| medium mesh | {} | growth, Hz |\n|{}\n", heads.join(" | "), "---|".repeat(shown.len() + 2));
    for (what, changes) in TRIED {
        let (modes, _) = modes(comm, SIZES[1], changes);
        let cells: Vec<String> = shown.iter().map(|&i| format!("{:.1}", modes[i][0])).collect();
        let most = modes.iter().map(|mode| mode[1]).fold(0.0, f64::max);
        writeln!(out, "| {what} | {} | {most:.2} |", cells.join(" | ")).unwrap();
    }
    let published: Vec<String> = shown.iter().map(|&i| format!("{:.1}", PUBLISHED[i])).collect();
    writeln!(out, "| published | {} | {GROWTH} |", published.join(" | ")).unwrap();
    out
}

const TEXT: &str = "Ansys Technology Showcase, FullModel-Squeal Analysis (TD-1): a ventilated disc on its hat and two pads, all steel, friction 0.3, undamped, \
linear without prestress; 29 frequencies and a pair that flutters. Geometry: `meshes/td1.geo`, model: `meshes/td1.toml`.";

const WHY: &str = "Where we differ, and why, as far as trying has told:

* Growth rates are published as a / 2 pi, in Hz: in 1/s ours would be 6.3 times theirs.
* The stiffness of the contact, its status and the density (7800 kg/m3 in the text, 7850 in the scripts) are not the reason: the table below
  has their effect. The mesh is not either: the meshes above converge from above, away from the published hat modes.
* The published model is not one body: hat, cylinder, flange, two cheeks and 21 vanes are meshed by themselves, coarsely (cheeks of 32 elements
  around, one element through the hat) and bonded by constraints between nodes of one side and faces of the other. Tried once by hand with
  CalculiX on the disc alone, hexahedra of the published counts with reduced integration: with the nodes of flange, hat and vanes tied to faces of their
  neighbours the first eight modes lie at 817, 821, 1111, 1341, 1341, 1577, 1578 and 1845 Hz; with the other side tied at hat and flange at 794, 797, 1072,
  1322, 1322, 1548, 1548, 1828; with the master faces refined at 800, 803, 1083, 1322, 1323, 1552, 1552, 1828; our single body of tetrahedra (43 thousand
  nodes) has 787, 787, 1077, 1324, 1324, 1561, 1561, 1837. So bonding alone moves the hat modes (1, 2, 3) by up to 4 % and modes of two and three
  diameters by 1 %, the way the published ones differ; the rest of the hat modes' difference is not explained.
* Modes in which the pads bend (11, 12, 16, 17, 21, 29, 30) lie up to 3.5 % above. A contact 50 times softer would lower them by that much, but
  then they would no longer agree with one another; what the published contact elements' stiffness is, is not known.
";

/// The section of the document.
pub fn section(comm: &Comm) -> String {
    let (meshes, nodes): (Vec<_>, Vec<_>) = SIZES.map(|size| modes(comm, size, &[])).into_iter().unzip();
    let heads: Vec<String> = SIZES.iter().zip(nodes).map(|(size, n)| format!("{size}, {n} nodes")).collect();
    let head =
        format!("| mode | {} | published | {} against it |\n|---|---|---|---|---|---|\n", heads.join(" | "), SIZES[2]);
    let lines: Vec<String> = (0..PUBLISHED.len()).map(|mode| line(mode, &meshes)).collect();
    let growths: Vec<String> = meshes.iter().map(|modes| format!("{:.2}", growth(modes))).collect();
    let against = 100.0 * (growth(&meshes[2]) / GROWTH - 1.0);
    let growths = format!("| growth of the pair, Hz | {} | {GROWTH} | {against:+.1} % |\n", growths.join(" | "));
    let (tried, sweep) = (tried(comm), sweep_text(&followed(comm, SIZES[0])));
    format!(
        "## {TITLE}\n\n{TEXT}\n\n{head}{}\n{growths}\n{WHY}\n{tried}\n\
         ### Over friction, 0 to 0.3, coarse mesh\n\n(The published plot of this sweep contradicts its own table.)\n\n{sweep}",
        lines.join("\n")
    )
}
