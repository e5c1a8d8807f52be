//! Matrices of other programs and our own: Abaqus's and CalculiX's text with named nodes, bad files, and export.
//!
//! Abaqus's formats are those of its documentation (src/matrices/abaqus.rs). The structure is a chain of three masses,
//! held at its first node by 1e36 on the diagonal; its modes are those of `[2 -1; -1 1] k / m`: `omega^2 = (3 -+ sqrt
//! 5) / 2 k / m`.
//!
//! Goal and, in brackets, measured: exported matrices have the modes of `squeal stability` to 1e-9 [1e-11].

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, refusal};
use insta::assert_snapshot;

/// `omega` of the chain, k = 1e6 N/m, m = 1 kg.
fn chain() -> [f64; 2] {
    [-1.0, 1.0].map(|sign| 1e3 * ((3.0 + sign * 5_f64.sqrt()) / 2.0).sqrt())
}

fn modes(place: &Place, mass: &str, stiffness: &str) -> Finished {
    place.run(&["modes", "--mass", mass, "--stiffness", stiffness, "--band", "0:1000", "-o", "out", "--force"])
}

fn column(table: &str, name: &str) -> Vec<f64> {
    let mut lines = table.lines();
    let at = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[track_caller]
fn assert_is_the_chain(place: &Place, mass: &str, stiffness: &str) -> String {
    let finished = modes(place, mass, stiffness);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let table = place.read("out/modes.csv");
    let found = column(&table, "frequency_hz");
    assert_eq!(found.len(), 2, "{table}");
    for (hertz, omega) in found.iter().zip(chain()) {
        assert!((TAU * hertz / omega - 1.0).abs() < 1e-10, "{hertz}");
    }
    finished.out + &table
}

/// FORMAT=MATRIX INPUT and LABELS: node, dof, node, dof, value; one triangle.
#[test]
fn labelled_matrices_keep_their_nodes() {
    let place = Place::empty();
    place.write(
        "k.mtx",
        "** stiffness\n101,1, 101,1,  1.000000000000000e+36\n205,1, 101,1, -1.0e+06\n205,1, 205,1, 2.0e+06\n\
        -3,1, 205,1, -1.0e+06\n-3,1, -3,1, 1.0e+06\n",
    );
    place.write("m.mtx", "101,1, 101,1, 1.0\n-3,1, -3,1, 1.0\n205,1, 205,1, 1.0\n");
    let text = assert_is_the_chain(&place, "m.mtx", "k.mtx");
    assert!(text.contains("1 constrained dofs (1e36") && text.contains("node -3, dof 1"), "{text}");
    assert!(
        text.contains("largest_node,largest_dof") && text.contains(",-3,1\n") && text.contains(",205,1\n"),
        "{text}"
    );
}

/// FORMAT=COORDINATE: row, column, value without any header.
#[test]
fn bare_coordinates() {
    let place = Place::empty();
    place.write("k.mtx", "1 1 1.0e36\n2 1 -1e6\n2 2 2e6\n3 2 -1e6\n3 3 1e6\n");
    place.write("m.mtx", "1 1 1\n2 2 1\n3 3 1\n");
    assert_is_the_chain(&place, "m.mtx", "k.mtx");
}

/// A substructure holds K and M in one file, rows up to the diagonal, four values to a line.
#[test]
fn a_substructure_has_its_matrices_in_one_file() {
    let place = Place::empty();
    let element = "**\n** GENERATION OF SUBSTRUCTURE\n*USER ELEMENT, NODES= 2, LINEAR\n** ELEMENT NODES\n** 7, 9,\n1\n2, 2\n\
        *MATRIX,TYPE=STIFFNESS\n 2.0D+06 ,\n-1.0D+06 , 1.0D+06\n*MATRIX,TYPE=MASS\n 1.0 ,\n 0.0 , 1.0\n";
    place.write("sub.mtx", element);
    let text = assert_is_the_chain(&place, "sub.mtx", "sub.mtx");
    assert!(text.contains("node 9, dof 2"), "{text}");
    place.write("cut.mtx", element.replace("-1.0D+06 , 1.0D+06\n", "-1.0D+06\n"));
    let finished = modes(&place, "cut.mtx", "cut.mtx");
    assert!(
        finished.code == 2 && finished.err.contains("2 values of stiffness: 3 or 4 would be whole"),
        "{}",
        finished.err
    );
}

const HEAD: &str = "%%MatrixMarket matrix coordinate real general\n";

/// Every wrong file leads to exit code 2 and a message that parts what and where; no folder is left behind.
#[test]
fn bad_files_are_refused_with_their_line() {
    let good = format!("{HEAD}2 2 2\n1 1 1\n2 2 1\n");
    let gzip = {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut encoder, good.as_bytes()).unwrap();
        let whole = encoder.finish().unwrap();
        whole[..whole.len() - 12].to_vec()
    };
    let mut million = format!("{HEAD}1000000 1000000 1000000\n");
    for i in 1..=1_000_000 {
        let value = if i == 765_432 { "1.0x" } else { "2.5" };
        writeln!(million, "{i} {i} {value}").unwrap();
    }
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("not square", format!("{HEAD}2 3 1\n1 1 1\n").into()),
        ("other size", format!("{HEAD}3 3 3\n1 1 1\n2 2 1\n3 3 1\n").into()),
        ("NaN", format!("{HEAD}2 2 2\n1 1 1\n2 2 NaN\n").into()),
        ("complex", good.replace("real", "complex").into()),
        ("pattern", good.replace("real", "pattern").into()),
        ("cut", format!("{HEAD}2 2 3\n1 1 1\n2 2 1\n").into()),
        ("too long", format!("{HEAD}2 2 1\n1 1 1\n2 2 1\n").into()),
        ("outside", format!("{HEAD}2 2 1\n1 3 1\n").into()),
        ("cut gzip", gzip),
        ("empty", Vec::new()),
        ("prose", b"hello there\n".to_vec()),
        ("million", million.into()),
        ("named", b"1,1, 1,1, 5.0\n".to_vec()),
        ("one percent sign", good[1..].into()),
        (
            "a dense binary matrix of a billion rows",
            [1_211_216, 1_000_000_000, 1_000_000_000, -1].map(i32::to_be_bytes).concat(),
        ),
    ];
    let place = Place::empty();
    place.write("m", &good);
    let mut messages = String::new();
    for (name, bytes) in cases {
        place.write("k", bytes);
        messages += &format!("{name}: {}", refusal(&modes(&place, "m", "k")));
        assert_eq!(place.list("."), ["k", "m"], "{name}");
    }
    assert_snapshot!(messages);
}

#[test]
fn singular_eigenproblems_are_refused() {
    let place = Place::empty();
    place.write("m", format!("{HEAD}2 2 1\n1 1 1\n"));
    place.write("k", format!("{HEAD}2 2 1\n1 1 1\n"));
    let empty_row = refusal(&modes(&place, "m", "k"));
    // A common null vector (1, 1) that no empty row shows.
    place.write("m", format!("{HEAD}2 2 4\n1 1 1\n1 2 -1\n2 1 -1\n2 2 1\n"));
    place.write("k", format!("{HEAD}2 2 4\n1 1 5\n1 2 -5\n2 1 -5\n2 2 5\n"));
    assert_snapshot!(empty_row + &refusal(&modes(&place, "m", "k")));
    assert_eq!(place.list("."), ["k", "m"]);
}

/// The small pad on its disc at friction 0.3: what is exported, in either format and from two ranks, has the modes of
/// `stability`.
#[test]
fn exported_matrices_have_the_same_modes_on_two_ranks() {
    let place = Place::blocks();
    let band = "0:90000";
    let finished =
        place.run(&["stability", "brake.toml", "--friction", "0.3", "--band", band, "--no-branches", "-o", "ours"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let expected = place.read("ours/modes.csv");
    for (ranks, format) in [(1, "mtx"), (2, "petsc")] {
        let arguments = ["export", "brake.toml", "--friction", "0.3", "--format", format, "-o", format];
        let finished = if ranks == 1 { place.run(&arguments) } else { place.run_on(ranks, &arguments) };
        assert_eq!(finished.code, 0, "{}", finished.err);
        let [m, c, k] = ["mass", "damping", "stiffness"].map(|name| format!("{format}/{name}.{format}"));
        let finished = place.run(&[
            "modes",
            "--mass",
            &m,
            "--damping",
            &c,
            "--stiffness",
            &k,
            "--band",
            band,
            "-o",
            "theirs",
            "--force",
        ]);
        assert_eq!(finished.code, 0, "{}", finished.err);
        let found = place.read("theirs/modes.csv");
        let [ours, theirs] = [&expected, &found].map(|table| column(table, "frequency_hz"));
        assert!(!ours.is_empty() && ours.len() == theirs.len(), "{expected} {found}");
        let worst = ours.iter().zip(&theirs).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{} modes, off by {worst:.1e}", ours.len());
        assert!(worst < 1e-9, "{worst}");
        let rows = place.read(&format!("{format}/dofs.csv"));
        assert!(rows.starts_with("equation,kind,node,axis,x_m,y_m,z_m\n1,node,"));
    }
}

/// A free part has six rigid motions and, through export, the same elastic modes; the sweep of the model concerns
/// contacts, of which it has none.
#[test]
fn a_free_part_and_its_export() {
    let sweep = "[sweep]\nfriction = { from = 0.1, to = 0.5, step = 0.1 }\n";
    let place = Place::with_blocks(|text| text + sweep, &PadOnDisc::default());
    let finished = place.run(&["modes", "brake.toml", "--part", "disc", "--band", "0:60000", "-o", "free"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("6 rigid motions") && finished.out.contains("none is missing"), "{}", finished.out);
    let elastic = column(&place.read("free/modes.csv"), "frequency_hz");
    let finished = place.run(&["export", "brake.toml", "--part", "disc", "-o", "ex"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let files = ["--mass", "ex/mass.mtx", "--stiffness", "ex/stiffness.mtx"];
    let finished = place.run(&[&["modes", "--band", "0:60000", "-o", "given"], &files[..]].concat());
    assert_eq!(finished.code, 0, "{}", finished.err);
    let mut given = column(&place.read("given/modes.csv"), "frequency_hz");
    given.retain(|hertz| *hertz > 1.0);
    assert!(!elastic.is_empty() && elastic.len() == given.len(), "{elastic:?} {given:?}");
    assert!(elastic.iter().zip(&given).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{elastic:?} {given:?}");
    let finished = place.run(&["modes", "brake.toml", "--part", "dics"]);
    assert!(finished.code == 2 && finished.err.contains("Did you mean \"disc\"?"), "{}", finished.err);
}

/// Sizes that only a header or an index claims take no memory.
#[test]
fn a_billion_empty_rows_are_refused() {
    let place = Place::empty();
    let texts = ["1 1 1\n1000000000 1000000000 1\n".to_owned(), format!("{HEAD}1000000000 1000000000 1\n1 1 1\n")];
    for text in texts {
        place.write("bare", text);
        let message = refusal(&modes(&place, "bare", "bare"));
        assert!(message.contains("have 1000000000 rows, but only "), "{message}");
    }
}

#[test]
fn a_zero_mass_matrix_is_refused() {
    let place = Place::empty();
    place.write("m", format!("{HEAD}2 2 1\n1 1 0\n"));
    place.write("k", format!("{HEAD}2 2 2\n1 1 1\n2 2 1\n"));
    let message = refusal(&modes(&place, "m", "k"));
    assert!(message.contains("the mass matrix is zero"), "{message}");
}

/// The blocks with loss factors: G is exported, and `modes --structural` finds the modes of `stability` with it.
#[test]
fn structural_damping_is_exported_and_read() {
    let place = Place::blocks();
    place.write("brake.toml", place.read("brake.toml").replace("density = 7100", "density = 7100\nloss_factor = 0.05"));
    let band = ["--band", "0:90000"];
    let run = |arguments: &[&str]| {
        let finished = place.run(&[arguments, &band].concat());
        assert_eq!(finished.code, 0, "{}", finished.err);
        finished.out
    };
    run(&["stability", "brake.toml", "--friction", "0.3", "--no-branches", "-o", "ours"]);
    let exported = place.run(&["export", "brake.toml", "--friction", "0.3", "-o", "ex"]);
    assert!(exported.code == 0 && exported.out.contains("--structural ex/structural.mtx"), "{}", exported.out);
    let [m, c, k, g] = ["mass", "damping", "stiffness", "structural"].map(|name| format!("ex/{name}.mtx"));
    let matrices = ["modes", "--mass", &m, "--damping", &c, "--stiffness", &k, "--structural", &g, "-o", "theirs"];
    let said = run(&matrices);
    assert!(said.contains("structural damping G symmetric"), "{said}");
    for name in ["frequency_hz", "growth_rate_per_s"] {
        let [ours, theirs] = ["ours", "theirs"].map(|folder| column(&place.read(&format!("{folder}/modes.csv")), name));
        assert!(!ours.is_empty() && ours.len() == theirs.len());
        let worst = ours.iter().zip(&theirs).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{} modes, {name} off by {worst:.1e}", ours.len());
        assert!(worst < 1e-7, "{worst}");
    }
    // A family of them, G with a factor: half the loss factor is half the decay, nearly.
    let file = |role: &str, name: &str| format!("[[{role}]]\nfile = \"ex/{name}.mtx\"\n");
    let terms = file("mass", "mass") + &file("stiffness", "stiffness") + &file("structural", "structural");
    place.write("family.toml", format!("parameter = \"g\"\n{terms}factor = \"g\"\n"));
    run(&["modes", "family.toml", "--parameter", "0.5,1", "-o", "both"]);
    let decays = column(&place.read("both/modes.csv"), "growth_rate_per_s");
    let (half, full) = decays.split_at(decays.len() / 2);
    assert!(half.iter().zip(full).all(|(a, b)| (b / a - 2.0).abs() < 0.01), "{half:?} {full:?}");
    assert!(place.read("both/branches.csv").lines().count() > 2);
}
