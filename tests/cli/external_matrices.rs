//! Modes of given matrices through files: exact models, problems of any structure against a dense solver, formats,
//! ranks.
//!
//! Sources: Hoffmann et al., Mech. Res. Commun. 29 (2002); Sinou and Jezequel, Eur. J. Mech. A 26 (2007); Meijaard et
//! al., Proc. R. Soc. A 463 (2007); Betcke et al., NLEVP, ACM TOMS 39 (2013). Random problems: eigenvalues of `[0 I;
//! -M^-1 K, -M^-1 C]` by nalgebra.
//!
//! Goal and, in brackets, measured: eigenvalues to 1e-10 of exact ones [1e-15], to 1e-8 of the dense solver's; backward
//! errors below 1e-12 [1e-15]; Hopf points to 1e-6 of the parameter's range [4e-8].

use std::f64::consts::TAU;
use std::io::Write;

use crate::support::data;
use crate::support::program::Place;
use flate2::Compression;
use flate2::write::GzEncoder;
use nalgebra::DMatrix;
use num_complex::Complex64;
use proptest::prelude::*;

/// Columns of a table as numbers; what is no number is NaN.
fn columns(table: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let places: Vec<usize> =
        names.iter().map(|name| header.iter().position(|column| column == name).unwrap()).collect();
    lines.map(|line| places.iter().map(|&i| line[i].parse().unwrap_or(f64::NAN)).collect()).collect()
}

/// Eigenvalues of modes.csv; backward errors are checked.
fn eigenvalues(table: &str) -> Vec<Complex64> {
    let rows = columns(table, &["frequency_hz", "growth_rate_per_s", "backward_error"]);
    rows.iter()
        .map(|row| {
            assert!(row[2] < 1e-12, "backward error {}", row[2]);
            Complex64::new(row[1], TAU * row[0])
        })
        .collect()
}

/// Modes of a family of tests/data/matrices at one value.
fn of_family(name: &str, value: &str, band: &str) -> Vec<Complex64> {
    let place = Place::empty();
    let file = data("matrices").join(name);
    let finished = place.run(&["modes", file.to_str().unwrap(), "--parameter", value, "--band", band, "-o", "out"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    eigenvalues(&place.read("out/modes.csv"))
}

/// Each expected eigenvalue is found, and no other.
#[track_caller]
fn assert_same(found: &[Complex64], expected: &[Complex64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for z in expected {
        let nearest = found.iter().map(|f| (f - z).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest <= tolerance * z.norm(), "{z} is off by {nearest:.1e}: {found:?}");
    }
}

#[test]
fn hoffmanns_eigenvalues_are_exact() {
    for mu in ["0.5", "0.8", "0.9"] {
        let root = Complex64::new(1.0 - 4.0 * mu.parse::<f64>().unwrap() / 3.0, 0.0).sqrt();
        let upper = |z: Complex64| if z.im < 0.0 { -z } else { z };
        let expected = [root, -root].map(|root| upper((root - 2.0).sqrt()));
        assert_same(&of_family("hoffmann.toml", mu, "0:1"), &expected, 1e-10);
    }
}

/// The bicycle's quartic `det(lambda^2 M + lambda v C1 + g K0 + v^2 K2)`, its roots as eigenvalues of the companion
/// matrix.
#[test]
fn the_bicycles_eigenvalues_are_the_roots_of_its_quartic() {
    let m = [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]];
    let k0 = [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]];
    let k2 = [[0.0, 76.59734589573222], [0.0, 2.65431523794604]];
    let c1 = [[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]];
    for v in [1.0, 4.0, 5.0, 8.0] {
        let p = |i: usize, j: usize| [9.81 * k0[i][j] + v * v * k2[i][j], v * c1[i][j], m[i][j]];
        let product = |a: [f64; 3], b: [f64; 3]| -> [f64; 5] {
            std::array::from_fn(|n| (0..3).filter(|&i| n >= i && n - i < 3).map(|i| a[i] * b[n - i]).sum())
        };
        let (ad, bc) = (product(p(0, 0), p(1, 1)), product(p(0, 1), p(1, 0)));
        let quartic: [f64; 5] = std::array::from_fn(|i| ad[i] - bc[i]);
        let companion = DMatrix::from_fn(4, 4, |i, j| match (i, j) {
            (0, j) => -quartic[3 - j] / quartic[4],
            (i, j) => f64::from(u8::from(i == j + 1)),
        });
        let roots: Vec<Complex64> = companion.complex_eigenvalues().iter().copied().filter(|z| z.im >= 0.0).collect();
        assert_same(&of_family("bicycle.toml", &v.to_string(), "0:20"), &roots, 1e-10);
    }
}

/// Eigenvalues 1/3, 1/2, 1, i and an infinite one; M is singular and unsymmetric. Real ones are printed as divergence.
#[test]
fn qep1_with_its_singular_mass() {
    let place = Place::empty();
    let file = |name: &str| data("matrices").join(name).to_str().unwrap().to_owned();
    let [m, c, k] = ["qep1_m.mtx", "qep1_c.mtx", "qep1_k.mtx"].map(file);
    let finished =
        place.run(&["modes", "--mass", &m, "--damping", &c, "--stiffness", &k, "--band", "0:1", "-o", "out"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let z = Complex64::new;
    let expected = [z(1.0 / 3.0, 0.0), z(0.5, 0.0), z(1.0, 0.0), z(0.0, 1.0)];
    assert_same(&eigenvalues(&place.read("out/modes.csv")), &expected, 1e-10);
    assert_eq!(finished.out.matches("real eigenvalue, divergence").count(), 3, "{}", finished.out);
}

/// Critical values where a growth rate passes zero; the bicycle weaves below 4.292 m/s and capsizes above 6.024.
#[test]
fn hopf_points_of_families() {
    for (family, values, band, parameter, expected) in [
        ("hoffmann.toml", "0:1:0.1", "0:1", "mu", vec![(0.75, 2.0_f64.sqrt() / TAU)]),
        ("sinou.toml", "0:0.5:0.1", "0:200", "mu", vec![(0.27179003, 93.02605)]),
        (
            "bicycle.toml",
            "1:10:0.5",
            "0:20",
            "v",
            vec![(4.292_382_536_341_11, 0.546_702_64), (6.024_262_015_388_37, 0.0)],
        ),
    ] {
        let place = Place::empty();
        let file = data("matrices").join(family);
        let finished =
            place.run(&["modes", file.to_str().unwrap(), "--parameter", values, "--band", band, "-o", "out"]);
        assert_eq!(finished.code, 0, "{}", finished.err);
        assert!(!finished.out.contains("not converged"), "{}", finished.out);
        let rows = columns(&place.read("out/hopf.csv"), &[parameter, "frequency_hz"]);
        assert_eq!(rows.len(), expected.len(), "{family}: {rows:?}");
        for (row, (value, hertz)) in rows.iter().zip(expected) {
            println!("{family}: {} at {} Hz", row[0], row[1]);
            assert!(
                (row[0] - value).abs() < 1e-5 && (row[1] - hertz).abs() < 1e-4 * hertz.max(1.0),
                "{family}: {row:?}"
            );
        }
        let branches = columns(&place.read("out/branches.csv"), &["branch", parameter]);
        assert!(branches.len() > 10);
    }
}

/// A matrix in Matrix Market's array format.
fn array(a: &DMatrix<f64>) -> String {
    let values: String = a.iter().map(|value| format!("{value:e}\n")).collect();
    format!("%%MatrixMarket matrix array real general\n{} {}\n{values}", a.nrows(), a.ncols())
}

/// All eigenvalues of the closed upper half plane by a dense solver.
fn dense(m: &DMatrix<f64>, c: &DMatrix<f64>, k: &DMatrix<f64>) -> Vec<Complex64> {
    let (n, inverse) = (m.nrows(), m.clone().try_inverse().unwrap());
    let mut companion = DMatrix::zeros(2 * n, 2 * n);
    companion.view_mut((0, n), (n, n)).fill_with_identity();
    companion.view_mut((n, 0), (n, n)).copy_from(&(-&inverse * k));
    companion.view_mut((n, n), (n, n)).copy_from(&(-&inverse * c));
    companion.complex_eigenvalues().iter().copied().filter(|z| z.im >= 0.0).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Unsymmetric K, any C (damping and gyroscopic), scaled rows and columns of very different size.
    #[test]
    fn random_problems_agree_with_a_dense_solver(
        values in prop::collection::vec(-1.0..1.0_f64, 3 * 49),
        decades in prop::collection::vec(-4.0..4.0_f64, 7),
    ) {
        let n = 7;
        let random = |i: usize| DMatrix::from_column_slice(n, n, &values[49 * i..49 * (i + 1)]);
        let half = random(0);
        let m = DMatrix::identity(n, n) + 0.1 * &half * half.transpose();
        let (c, k) = (0.5 * random(1), 4.0 * DMatrix::identity(n, n) + 2.0 * random(2));
        let expected = dense(&m, &c, &k);
        prop_assume!(expected.iter().enumerate().all(|(i, a)| expected[..i].iter().all(|b| (a - b).norm() > 1e-3)));
        let d = DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(n, decades.iter().map(|x| 10_f64.powf(*x))));
        let place = Place::empty();
        for (name, matrix) in [("m.mtx", &m), ("c.mtx", &c), ("k.mtx", &k)] {
            place.write(name, array(&(&d * matrix * &d)));
        }
        let finished = place.run(&["modes", "--mass", "m.mtx", "--damping", "c.mtx", "--stiffness", "k.mtx", "--band", "0:100", "-o", "out"]);
        prop_assert_eq!(finished.code, 0, "{}", finished.err);
        assert_same(&eigenvalues(&place.read("out/modes.csv")), &expected, 1e-8);
    }
}

/// A chain of 60 masses, gyroscopic: `M x'' + G x' + K x = 0` with G skew. All its eigenvalues are imaginary; inertia
/// is not counted.
#[test]
fn a_gyroscopic_chain_has_all_its_modes_on_any_number_of_ranks() {
    const N: usize = 130;
    let k = DMatrix::from_fn(N, N, |i, j| match i.abs_diff(j) {
        0 => 2.0 + 0.01 * i as f64,
        1 => -1.0,
        _ => 0.0,
    });
    let g = DMatrix::from_fn(N, N, |i, j| if i / 2 == j / 2 && i != j { if i < j { 0.3 } else { -0.3 } } else { 0.0 });
    let mut expected: Vec<f64> =
        dense(&DMatrix::identity(N, N), &g, &k).iter().map(|z| z.im).filter(|w| *w < 0.8).collect();
    expected.sort_by(f64::total_cmp);
    let place = Place::empty();
    place.write("m.mtx", coordinates(&DMatrix::identity(N, N), "symmetric"));
    place.write("k.mtx", coordinates(&k, "symmetric"));
    place.write("g.mtx", coordinates(&g, "skew-symmetric"));
    let end = format!("0:{}", 0.8 / TAU);
    let arguments =
        ["modes", "--mass", "m.mtx", "--damping", "g.mtx", "--stiffness", "k.mtx", "--band", &end, "--shapes", "-o"];
    for ranks in [1, 2, 3] {
        let folder = format!("out{ranks}");
        let all = [&arguments[..], &[&folder]].concat();
        let finished = if ranks == 1 { place.run(&all) } else { place.run_on(ranks, &all) };
        assert_eq!(finished.code, 0, "{}", finished.err);
        assert!(
            finished.out.contains("C unsymmetric") && finished.out.contains("neither is a proof"),
            "{}",
            finished.out
        );
        let found = eigenvalues(&place.read(&format!("{folder}/modes.csv")));
        assert_eq!(found.len(), expected.len());
        for (z, omega) in found.iter().zip(&expected) {
            assert!((z.im - omega).abs() < 1e-10 * omega && z.re.abs() < 1e-10, "{z} {omega}");
        }
        assert_eq!(place.read(&format!("{folder}/shapes.csv")).lines().count(), N + 1);
    }
}

/// Nonzeros of a matrix as Matrix Market; of a symmetric or skew one the lower triangle.
fn coordinates(a: &DMatrix<f64>, symmetry: &str) -> String {
    let n = a.nrows();
    let keep = |i: usize, j: usize| a[(i, j)] != 0.0 && (symmetry == "general" || i >= j);
    let places: Vec<(usize, usize)> =
        (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| keep(i, j)).collect();
    let lines: String = places.iter().map(|&(i, j)| format!("{} {} {:e}\n", i + 1, j + 1, a[(i, j)])).collect();
    format!("%%MatrixMarket matrix coordinate real {symmetry}\n% a comment\n{n} {n} {}\n{lines}", places.len())
}

/// PETSc's binary format, written here again.
fn petsc(a: &DMatrix<f64>) -> Vec<u8> {
    let n = a.nrows() as i32;
    let rows: Vec<Vec<i32>> =
        (0..n).map(|i| (0..n).filter(|&j| a[(i as usize, j as usize)] != 0.0).collect()).collect();
    let total: usize = rows.iter().map(Vec::len).sum();
    let mut bytes: Vec<u8> = [1_211_216, n, n, total as i32].iter().flat_map(|x: &i32| x.to_be_bytes()).collect();
    bytes.extend(rows.iter().flat_map(|row| (row.len() as i32).to_be_bytes()));
    bytes.extend(rows.iter().flatten().flat_map(|j| j.to_be_bytes()));
    let values = rows.iter().enumerate().flat_map(|(i, row)| row.iter().map(move |&j| a[(i, j as usize)]));
    bytes.extend(values.flat_map(f64::to_be_bytes));
    bytes
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The same matrices as array, coordinate, PETSc binary and gzip give the same modes, to the last digit.
#[test]
fn formats_do_not_matter() {
    let k = DMatrix::from_fn(5, 5, |i, j| if i == j { 10.0 + i as f64 } else { -1.0 / (1 + i + 2 * j) as f64 });
    let m = DMatrix::from_fn(5, 5, |i, j| if i == j { 2.0 } else { 0.0 });
    let place = Place::empty();
    place.write("m0", array(&m));
    place.write("k0", array(&k));
    place.write("m1", coordinates(&m, "symmetric").replace("2e0", "2").replace("real", "integer"));
    place.write("k1", gzipped(coordinates(&k, "general").as_bytes()));
    place.write("m2", gzipped(&petsc(&m)));
    place.write("k2", petsc(&k));
    let modes = [0, 1, 2].map(|i| {
        let [m, k, out] = ["m", "k", "out"].map(|name| format!("{name}{i}"));
        let finished = place.run(&["modes", "--mass", &m, "--stiffness", &k, "--band", "0:10", "-o", &out]);
        assert_eq!(finished.code, 0, "{}", finished.err);
        place.read(&format!("{out}/modes.csv"))
    });
    assert!(modes[0].lines().count() == 6 && modes[0] == modes[1] && modes[1] == modes[2], "{modes:?}");
}

/// A singular K, two coupled masses without constraints: the rigid motion is found and reported as such.
#[test]
fn a_free_structure_is_solved_about_a_shift() {
    let place = Place::empty();
    place.write("m.mtx", array(&DMatrix::identity(2, 2)));
    place.write("k.mtx", array(&DMatrix::from_row_slice(2, 2, &[1e6, -1e6, -1e6, 1e6])));
    let finished = place.run(&["modes", "--mass", "m.mtx", "--stiffness", "k.mtx", "--band", "0:1000", "-o", "out"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("K is singular") && !finished.out.contains("unstable"), "{}", finished.out);
    assert!(finished.out.contains("2 modes with |lambda| below 1000.0 Hz, as many as"), "{}", finished.out);
    // The motion itself is a double zero with one vector: rounding leaves half of the digits.
    let found = columns(&place.read("out/modes.csv"), &["frequency_hz", "backward_error"]);
    let highest = found.last().unwrap();
    assert!((TAU * highest[0] / 2e6_f64.sqrt() - 1.0).abs() < 1e-10 && highest[1] < 1e-12, "{found:?}");
    assert!(found[..found.len() - 1].iter().all(|row| row[0] < 1e-3), "{found:?}");
}

/// Where the scaled matrix has lost its digits, a warning is printed.
#[test]
fn an_ill_conditioned_stiffness_is_warned_of() {
    let place = Place::empty();
    let k = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0 + 1e-13]);
    place.write("m.mtx", array(&(1e-9 * DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0 + 1e-13]))));
    place.write("k.mtx", array(&k));
    let finished = place.run(&["modes", "--mass", "m.mtx", "--stiffness", "k.mtx", "--band", "0:10000", "-o", "out"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("warning: it is above 1e12"), "{}", finished.out);
}

/// A free chain of three masses whose stiffness has a circulatory part, with a damping matrix if there is one.
fn free_chain(damping: &str) -> Place {
    let place = Place::empty();
    let symmetric = "%%MatrixMarket matrix coordinate real symmetric\n3 3";
    place.write("m.mtx", format!("{symmetric} 3\n1 1 1\n2 2 1\n3 3 1\n"));
    place.write("k0.mtx", format!("{symmetric} 5\n1 1 1000\n2 1 -1000\n2 2 3000\n3 2 -2000\n3 3 2000\n"));
    place.write("c.mtx", format!("{symmetric} 5\n1 1 0.2\n2 1 -0.2\n2 2 0.4\n3 2 -0.2\n3 3 0.2\n"));
    let general = "%%MatrixMarket matrix coordinate real general\n3 3";
    place.write("k1.mtx", format!("{general} 4\n1 2 100\n1 3 -100\n2 1 50\n2 3 -50\n"));
    let terms = "parameter = \"mu\"\n[[mass]]\nfile = \"m.mtx\"\n[[stiffness]]\nfile = \"k0.mtx\"\n[[stiffness]]\n\
                 file = \"k1.mtx\"\nfactor = \"mu\"\n";
    place.write("fam.toml", format!("{terms}{damping}"));
    place
}

#[test]
fn rigid_motions_of_a_family_are_not_followed() {
    for damping in ["", "[[damping]]\nfile = \"c.mtx\"\n"] {
        let place = free_chain(damping);
        let run = place.run(&["modes", "fam.toml", "--parameter", "0:1:0.25", "--band", "0:20", "-o", "out"]);
        assert_eq!(run.code, 0, "{}", run.err);
        assert!(run.out.contains("rigid-body modes at 0 Hz, left out of the branches: 1\n"), "{}", run.out);
        assert!(run.out.contains("2 branches over 5 values of mu"), "{}", run.out);
        assert_eq!(place.read("out/hopf.csv").lines().count(), 1, "{}", place.read("out/hopf.csv"));
        assert!(!run.out.contains("unstable: real"), "{}", run.out);
    }
}

#[test]
fn what_is_unstable_is_an_option() {
    let hoffmann = data("matrices").join("hoffmann.toml");
    let modes = |criterion: &str| {
        let place = Place::empty();
        let family = hoffmann.to_str().unwrap();
        let run =
            place.run(&["modes", family, "--parameter", "0.8", "--band", "0:1", "--unstable", criterion, "-o", "o"]);
        assert_eq!(run.code, 0, "{}", run.err);
        let unstable = columns(&place.read("o/modes.csv"), &["damping_ratio", "unstable"]);
        (run.out, unstable.iter().map(|row| row[0]).fold(0.0, f64::min), unstable.iter().any(|row| row[1] == 1.0))
    };
    let (text, ratio, is_unstable) = modes("damping_ratio:-0.001");
    assert!(is_unstable && ratio < -0.001 && text.contains("damping ratio below -0.1 %"), "{text}");
    let limit = format!("damping_ratio:{}", 1.1 * ratio);
    assert!(!modes(&limit).2, "{limit}");
    assert!(!modes("growth_rate:1000").2);
}
