//! Damaged files: every reader takes files with random mutations, and answers with a value or an error.
//!
//! A reader fails where it panics, aborts, takes longer than [`LONGEST`], or has more memory at once than
//! [`largest_memory`]. The input at hand is in target/fuzz/<format>/, so that one that ends the process is kept.
//!
//! `SQUEAL_FUZZ_SECONDS` is the time for each format; `make fuzz` sets it. `SQUEAL_FUZZ_SEED`
//! chooses the sequence of mutations. A reader without end does not end its test: nextest does, after ten minutes.

mod mutate;
mod seeds;
#[path = "../support/mod.rs"]
mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

use mutate::Mutator;
use squeal::deck::KnownUnits;
use squeal::matrices::Role;
use squeal::{analysis, deck, matrices, mesh, model, reduction, results};

/// A reader takes no longer for one file.
const LONGEST: Duration = Duration::from_secs(5);

/// Bytes that a reader may have at once, for a file of so many.
fn largest_memory(n_bytes: usize) -> usize {
    10 * n_bytes + 200_000_000
}

/// Counts the bytes that are allocated, and their largest sum.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static LARGEST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(NOW.fetch_add(layout.size(), Relaxed) + layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A number from the environment.
fn setting(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect("a whole number"))
}

/// Mutates the seeds for the time given, and reads each result from a file with this ending.
fn fuzz(format: &str, ending: &str, seeds: Vec<Vec<u8>>, read: impl Fn(&Path) -> bool) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fuzz").join(format);
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join(format!("input.{ending}"));
    for seed in &seeds {
        std::fs::write(&file, seed).unwrap();
        assert!(read(&file), "{format}: a seed is not read");
    }
    let mut mutator = Mutator::new(setting("SQUEAL_FUZZ_SEED", 1), seeds);
    let (start, time) = (Instant::now(), Duration::from_secs(setting("SQUEAL_FUZZ_SECONDS", 1)));
    let (mut n_inputs, mut n_read) = (0, 0);
    let (mut most_memory, mut longest) = (0, Duration::ZERO);
    while start.elapsed() < time {
        let input = mutator.next();
        std::fs::write(&file, &input).unwrap();
        let (before, began) = (NOW.load(Relaxed), Instant::now());
        LARGEST.store(before, Relaxed);
        let outcome = catch_unwind(AssertUnwindSafe(|| read(&file)));
        let (memory, took) = (LARGEST.load(Relaxed) - before, began.elapsed());
        let kept = file.display();
        assert!(outcome.is_ok(), "{format}: a panic on {kept}");
        assert!(took < LONGEST, "{format}: {took:?} for {kept}");
        assert!(memory < largest_memory(input.len()), "{format}: {memory} bytes for {} of {kept}", input.len());
        n_inputs += 1;
        n_read += u64::from(outcome.is_ok_and(|is_read| is_read));
        (most_memory, longest) = (most_memory.max(memory), longest.max(took));
    }
    println!(
        "{format}: {n_inputs} inputs, {n_read} of them read; at most {:.1} MB and {:.3} s",
        most_memory as f64 / 1e6,
        longest.as_secs_f64()
    );
}

#[test]
fn model_files() {
    fuzz("model", "toml", seeds::models(), |path| model::read(path).is_ok());
}

#[test]
fn gmsh_meshes() {
    fuzz("gmsh", "msh", seeds::meshes(), |path| mesh::read(path, 1e-3).is_ok());
}

#[test]
fn decks() {
    fuzz("deck", "inp", seeds::decks(), |path| deck::read(path, KnownUnits::default()).is_ok());
}

#[test]
fn matrix_market() {
    fuzz("market", "mtx", seeds::matrix_market(), |path| matrices::read(path, Role::Stiffness).is_ok());
}

#[test]
fn petsc_matrices() {
    fuzz("petsc", "bin", seeds::petsc(), |path| matrices::read(path, Role::Stiffness).is_ok());
}

#[test]
fn matrices_of_abaqus() {
    fuzz("abaqus", "mtx", seeds::abaqus(), |path| matrices::read(path, Role::Stiffness).is_ok());
}

#[test]
fn gap_fields() {
    let points = [[0.0125, 0.098, 0.0], [0.0, 0.09, 0.002]];
    let read = |path: &Path| model::GapField::read(path, "disc / pad").and_then(|field| field.at(&points));
    fuzz("gap", "csv", seeds::gap_fields(), |path| read(path).is_ok());
}

#[test]
fn gap_images() {
    let frame =
        model::ImageFrame { plane: [0, 1], lower_left: [0.0; 2], upper_right: [1.0; 2], black: 0.0, white: 1e-5 };
    let read = |path: &Path| model::GapField::read_image(path, frame).and_then(|field| field.at(&[[0.4, 0.6, 0.0]]));
    fuzz("image", "png", seeds::gap_images(), |path| read(path).is_ok());
}

#[test]
fn measured_modes() {
    fuzz("measured", "csv", seeds::measured(), |path| analysis::read_measured(path).is_ok());
}

#[test]
fn matrix_families() {
    fuzz("family", "toml", seeds::families(), |path| matrices::family::read(path).is_ok());
}

#[test]
fn results_files() {
    fuzz("results", "h5", seeds::results(), |path| results::file::read(path).is_ok());
}

#[test]
fn super_elements() {
    fuzz("super_element", "h5", seeds::super_elements(), |path| reduction::file::read(path).is_ok());
}
