//! Several ranks: the same answers as one, and no rank left waiting when another fails.

use std::collections::{HashMap, HashSet};
use std::time::{Duration, Instant};

use crate::support::data;
use crate::support::program::{Finished, Place, run_test_on_two_ranks};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use squeal::native::Session;

/// Rows of a CSV file as numbers; texts are left out.
fn numbers(table: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').filter_map(|field| field.parse().ok()).collect();
    table.lines().skip(1).map(row).collect()
}

/// Frequency (Hz) and growth rate (1/s) of all modes, and the contact table, on some ranks.
pub fn stability(place: &Place, band: &str, ranks: usize) -> (Vec<[f64; 2]>, Vec<f64>) {
    let arguments = ["stability", "brake.toml", "--band", band, "-o", "run", "--force"];
    let Finished { code, err, .. } = if ranks == 1 { place.run(&arguments) } else { place.run_on(ranks, &arguments) };
    assert_eq!(code, 0, "{err}");
    assert!(!place.path("pieces").exists(), "{ranks} ranks wrote beside their folder");
    let modes = numbers(&place.read("run/modes.csv")).iter().map(|row| [row[2], row[3]]).collect();
    (modes, numbers(&place.read("run/contact.csv")).concat())
}

/// Requires the same modes and contact tables, to 1e-9.
fn assert_same(one: &(Vec<[f64; 2]>, Vec<f64>), other: &(Vec<[f64; 2]>, Vec<f64>)) {
    assert_same_modes(&one.0, &other.0);
    assert_same_contact(&one.1, &other.1, 1e-9);
}

/// Requires the same modes, to 1e-9.
pub fn assert_same_modes(modes: &[[f64; 2]], others: &[[f64; 2]]) {
    assert_eq!(others.len(), modes.len());
    for ([f, s], [g, t]) in modes.iter().zip(others) {
        let omega = std::f64::consts::TAU * f;
        let difference = (std::f64::consts::TAU * (f - g)).hypot(s - t);
        assert!(difference <= 1e-9 * omega, "{f} Hz {s} /s on one rank, {g} Hz {t} /s on several");
    }
}

/// Requires the same contact tables.
pub fn assert_same_contact(contact: &[f64], others: &[f64], tolerance: f64) {
    assert_eq!(others.len(), contact.len());
    for (a, b) in contact.iter().zip(others) {
        assert!((a - b).abs() <= tolerance * a.abs(), "{a} on one rank, {b} on several");
    }
}

#[test]
fn two_three_and_four_ranks_find_what_one_finds() {
    let place = Place::pads();
    let alone = stability(&place, "0:1500", 1);
    assert!(alone.0.iter().any(|[_, growth]| *growth > 1.0), "a pair flutters: {:?}", alone.0);
    [2, 3, 4].into_iter().for_each(|ranks| assert_same(&alone, &stability(&place, "0:1500", ranks)));
}

/// With loss factors, two values of the friction coefficient, and modes followed between them.
#[test]
fn loss_factors_give_the_same_on_two_ranks() {
    let place = Place::blocks();
    let text = place.read("brake.toml").replace("[part.pad]\nmaterial = \"iron\"", "[part.pad]\nmaterial = \"lining\"");
    let lining = "[material.lining]\nyoung = 9e9\npoisson = 0.25\ndensity = 2600\nloss_factor = 0.1\n[material.iron]";
    let text = text.replace("density = 7100", "density = 7100\nloss_factor = 0.002");
    place.write("brake.toml", text.replace("[material.iron]", lining));
    let mut found = Vec::new();
    for ranks in [1, 2] {
        let arguments =
            ["stability", "brake.toml", "--friction", "0.3,0.4", "--band", "0:50000", "-o", "run", "--force"];
        let run = if ranks == 1 { place.run(&arguments) } else { place.run_on(ranks, &arguments) };
        assert_eq!(run.code, 0, "{}", run.err);
        assert!(run.out.contains("with structural damping") && !run.out.contains("no damping"), "{}", run.out);
        let modes = numbers(&place.read("run/modes.csv"));
        assert!(modes.iter().all(|row| row[3].abs() > 1e-6 * row[2]), "every mode is damped: {modes:?}");
        found.push(modes.iter().map(|row| [row[2], row[3]]).collect::<Vec<_>>());
    }
    assert_same_modes(&found[0], &found[1]);
}

/// Frequencies, Hz, of the model on 10-node tetrahedra of 5 mm.
const OF_TETRAHEDRA: [f64; 3] = [32254.65, 32417.56, 45690.85];

/// A disc of hexahedra and wedges under a pad of tetrahedra: the same on two ranks, and the modes of tetrahedra alone
/// to what coarse meshes leave.
#[test]
fn a_mixed_mesh_gives_the_same_on_two_ranks_and_nearly_what_tetrahedra_give() {
    let place = Place::blocks();
    std::fs::copy(data("mixed.msh"), place.path("blocks.msh")).unwrap();
    let alone = stability(&place, "0:50000", 1);
    assert_same(&alone, &stability(&place, "0:50000", 2));
    assert_eq!(alone.0.len(), 3);
    for ([found, _], tetrahedra) in alone.0.iter().zip(OF_TETRAHEDRA) {
        assert!((found / tetrahedra - 1.0).abs() < 0.03, "{found} Hz, of tetrahedra {tetrahedra} Hz");
    }
}

/// Displacements by position (single precision, as bits): nodes of two parts may lie at one place.
type Displacements = HashMap<[u32; 3], Vec<[f32; 3]>>;

/// Displacements of the nodes of a VTU file, and the number of its cells.
fn displacements(text: &str) -> (Displacements, usize) {
    let xml = roxmltree::Document::parse(text).unwrap();
    let vectors = |name: &str| -> Vec<[f32; 3]> {
        let array = xml.descendants().find(|node| node.attribute("Name") == Some(name)).unwrap();
        let bytes = STANDARD.decode(array.text().unwrap()).unwrap();
        let numbers: Vec<f32> = bytes[8..].as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
        numbers.as_chunks().0.to_vec()
    };
    let mut nodes = Displacements::new();
    for (x, u) in vectors("Points").into_iter().zip(vectors("displacement")) {
        nodes.entry(x.map(f32::to_bits)).or_default().push(u);
    }
    let piece = xml.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
    (nodes, piece.attribute("NumberOfCells").unwrap().parse().unwrap())
}

/// What a rank has of the mesh, or writes, adds up to what one rank has and writes alone.
#[test]
fn pieces_add_up_to_the_whole() {
    let place = Place::pads();
    let before_the_dofs = |finished: &Finished| {
        finished.out.lines().take_while(|l| !l.contains("free dofs")).collect::<Vec<_>>().join("\n")
    };
    let alone = place.run(&["check", "brake.toml"]);
    let finished = place.run(&["static", "brake.toml", "--friction", "0.4", "-o", "1"]);
    assert_eq!((alone.code, finished.code), (0, 0), "{}{}", alone.err, finished.err);
    let (whole, n_cells) = displacements(&place.read("1/equilibrium_mu0.400.vtu"));
    let largest = whole.values().flatten().flatten().fold(0.0, |most: f32, u| most.max(u.abs()));
    for ranks in [2, 3] {
        let check = place.run_on(ranks, &["check", "brake.toml"]);
        assert_eq!(before_the_dofs(&check), before_the_dofs(&alone));
        let folder = ranks.to_string();
        let finished = place.run_on(ranks, &["static", "brake.toml", "--friction", "0.4", "-o", &folder]);
        assert_eq!(finished.code, 0, "{}", finished.err);
        let list = place.read(&format!("{folder}/equilibrium_mu0.400.pvtu"));
        let (mut seen, mut cells) = (HashSet::new(), 0);
        for rank in 0..ranks {
            let name = format!("pieces/equilibrium_mu0.400.{rank}.vtu");
            assert!(list.contains(&format!("Source=\"{name}\"")), "{list}");
            let (piece, n) = displacements(&place.read(&format!("{folder}/{name}")));
            assert!(n < n_cells * 2 / ranks, "{n} of {n_cells} cells on rank {rank} of {ranks}");
            cells += n;
            for (x, u) in &piece {
                let is_near = |a: &[f32; 3], b: &[f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() <= 1e-6 * largest);
                assert!(
                    u.iter().all(|u| whole[x].iter().any(|w| is_near(u, w))),
                    "{u:?}, and {:?} on one rank",
                    whole[x]
                );
            }
            seen.extend(piece.into_keys());
        }
        assert_eq!((cells, seen.len()), (n_cells, whole.len()), "{ranks} ranks");
    }
}

/// Runs one of the tests below, which are told apart from tests by `ignore`, on two ranks.
fn on_two_ranks(name: &str) -> Finished {
    let start = Instant::now();
    let finished = run_test_on_two_ranks(&format!("parallel::{name}"));
    assert!(start.elapsed() < Duration::from_secs(60), "{name} hung");
    finished
}

#[test]
fn a_panic_on_one_rank_ends_all() {
    let finished = on_two_ranks("rank_one_panics");
    assert_eq!(finished.code, 101, "{}", finished.err);
    assert!(finished.err.contains("rank 1 has a bug"), "{}", finished.err);
}

#[test]
fn an_error_of_the_library_on_one_rank_ends_all() {
    let finished = on_two_ranks("rank_one_fails");
    assert_eq!(finished.code, 1, "{}", finished.err);
    assert!(finished.err.contains("error on rank 1: MUMPS: it has a bug"), "{}", finished.err);
}

#[test]
fn an_input_error_on_one_rank_is_told_once_by_the_first() {
    let finished = on_two_ranks("rank_one_misses_a_file");
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert_eq!(finished.err.matches("error: rank 1 has no such file").count(), 1, "{}", finished.err);
}

/// Runs `work` as the program runs a command, while the other rank waits for this one.
fn as_the_program(work: fn() -> squeal::Result<()>) -> ! {
    let comm = Session::start(&[]).unwrap();
    let code = squeal::cli::guard(&comm, || {
        if comm.rank() == 1 {
            work()?;
        }
        comm.barrier();
        Ok(())
    });
    drop(comm);
    std::process::exit(code)
}

#[test]
#[ignore = "one of the ranks of a_panic_on_one_rank_ends_all"]
fn rank_one_panics() {
    as_the_program(|| panic!("rank 1 has a bug"))
}

#[test]
#[ignore = "one of the ranks of an_error_of_the_library_on_one_rank_ends_all"]
fn rank_one_fails() {
    as_the_program(|| Err(squeal::Error::library("MUMPS")("it has a bug")))
}

#[test]
#[ignore = "one of the ranks of an_input_error_on_one_rank_is_told_once_by_the_first"]
fn rank_one_misses_a_file() {
    let comm = Session::start(&[]).unwrap();
    let own = if comm.rank() == 1 { Err(squeal::Error::input("rank 1 has no such file")) } else { Ok(()) };
    let code = squeal::cli::guard(&comm, || comm.agree(own));
    drop(comm);
    std::process::exit(code)
}

#[test]
fn numbers_and_values_reach_other_ranks() {
    let finished = on_two_ranks("ranks_exchange_numbers_and_values");
    assert_eq!(finished.code, 0, "{} {}", finished.out, finished.err);
}

#[test]
fn an_error_of_mpi_ends_all() {
    let finished = on_two_ranks("ranks_broadcast_from_a_rank_that_is_not_there");
    assert_eq!(finished.code, 1, "{}", finished.err);
    assert!(finished.err.contains("MPI_Bcast failed: MPI_ERR_ROOT"), "{}", finished.err);
}

#[test]
#[ignore = "one of the ranks of numbers_and_values_reach_other_ranks"]
fn ranks_exchange_numbers_and_values() {
    let comm = Session::start(&[]).unwrap();
    let (rank, other) = (comm.rank(), 1 - comm.rank());
    assert_eq!((comm.sum(rank + 1), comm.max(-1.5_f32), comm.min(rank as i64)), (3, -1.5, 0));
    // Of equal values the first; a larger one wherever it is.
    let first = comm.max_loc_all(&[2.0, rank as f64, -(rank as f64)]);
    assert_eq!(first.iter().map(|found| found.rank()).collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(first.iter().map(|found| found.value).collect::<Vec<_>>(), [2.0, 1.0, 0.0]);
    assert_eq!(comm.join(&vec![rank as u8; 1 + rank]), [0, 1, 1]);
    let theirs = comm.exchange(&[vec![rank as u32; 2], vec![10 + rank as u32]]);
    assert_eq!(theirs, if rank == 0 { [vec![0, 0], vec![1, 1]] } else { [vec![10], vec![11]] });
    assert_eq!(comm.broadcast(1, vec![rank as i32; 1 + rank]), [1, 1]);
    let value = (rank == 1, format!("rank {rank}"), vec![[0.5, rank as f64]]);
    assert_eq!(comm.broadcast_value(1, value.clone()), (true, "rank 1".to_owned(), vec![[0.5, 1.0]]));
    assert_eq!(
        comm.join_values(value).iter().map(|(_, text, _)| text.as_str()).collect::<Vec<_>>(),
        ["rank 0", "rank 1"]
    );
    assert_eq!(comm.gather_values(Some(rank)), if rank == 0 { vec![Some(0), Some(1)] } else { Vec::new() });
    if rank == 0 {
        comm.send_value(&[1.5, 2.5], other)
    } else {
        assert_eq!(comm.receive_value::<[f64; 2]>(other), [1.5, 2.5])
    }
    let own = if rank == 1 { Err(squeal::Error::not_converged("late")) } else { Ok(()) };
    let agreed = comm.agree(own).unwrap_err();
    assert_eq!((agreed.kind(), agreed.to_string().as_str()), (squeal::ErrorKind::NotConverged, "late"));
}

#[test]
#[ignore = "one of the ranks of an_error_of_mpi_ends_all"]
fn ranks_broadcast_from_a_rank_that_is_not_there() {
    let comm = Session::start(&[]).unwrap();
    comm.broadcast(7, vec![1_u8]);
}
