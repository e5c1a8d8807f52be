//! What features cost where they are off, and where they are on: `cargo bench --bench features`.
//!
//! The program finds equilibrium and modes of the small demo brake at one friction value, in rounds: each variant of
//! the model once, then all again. What counts is the ratio of CPU times within a round to that of the model as it
//! stands. With `SQUEAL_OLDER=FILE` an older program takes part, with the model as it stands; `SQUEAL_ROUNDS` is the
//! number of rounds.
//!
//! Not a timed test: it prints figures and judges nothing.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Clock ticks of `/proc` in a second.
const TICKS: f64 = 100.0;

/// A run that is repeated.
struct Variant {
    name: &'static str,
    program: PathBuf,
    model: PathBuf,
}

/// Replacements in the model file that say nothing, and those that change the physics.
const CHANGES: [(&str, &[[&str; 2]]); 11] = [
    ("as it stands, again", &[]),
    ("loss_factor = 0", &[["density = 7100", "loss_factor = 0\ndensity = 7100"]]),
    ("mu(v) constant", &[["friction = 0.5", "friction = { by = [\"speed\"], table = [[0.5, 0], [0.5, 2]] }"]]),
    ("inertia none", &[["speed = 5.0", "inertia = \"none\"\nspeed = 5.0"]]),
    ("prestress false", &[["[stability]", "[stability]\nprestress = false"]]),
    ("friction damping", &[["[stability]", "[stability]\nfriction_damping = true"]]),
    ("mu(v) falling", &[["friction = 0.5", "friction = { by = [\"speed\"], table = [[0.6, 0], [0.4, 2]] }"]]),
    ("loss factors", &[["density = 7100", "loss_factor = 0.002\ndensity = 7100"]]),
    ("viscoelastic steel", &[["density = 7850", "viscoelastic = { maxwell = [[1e9, 1e-4]] }\ndensity = 7850"]]),
    ("inertia fixed_frame", &[["speed = 5.0", "inertia = \"fixed_frame\"\nspeed = 5.0"], NO_PRESTRESS]),
    ("prestress", &[["[stability]", "[stability]\nprestress = true"]]),
];
/// What older programs do not read.
const OLDER: [&str; 2] = ["wear = 1e-14                  # m2/N, for squeal wear and squeal states", ""];
const NO_PRESTRESS: [&str; 2] = ["[stability]", "[stability]\nprestress = false"];

/// CPU seconds of all children that have ended.
fn cpu_of_children() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("Linux has it");
    let after_name = stat.rsplit(')').next().expect("the name is in brackets");
    // Fields 16 and 17 of the line, the state being field 3.
    let fields = after_name.split_whitespace().skip(13).take(2);
    fields.map(|field| field.parse::<f64>().expect("a number of ticks")).sum::<f64>() / TICKS
}

/// CPU seconds of a run.
fn measure(variant: &Variant) -> f64 {
    let before = cpu_of_children();
    let mut command = Command::new(&variant.program);
    command.args(["stability", "--friction", "0.3", "--no-branches"]).arg(&variant.model);
    command.args(["--output", "results", "--force"]).env("OPENBLAS_NUM_THREADS", "1");
    let place = variant.model.parent().expect("it is in a folder");
    let status = command.current_dir(place).stdout(Stdio::null()).status().expect("the program runs");
    assert!(status.success(), "{}: {status}", variant.name);
    cpu_of_children() - before
}

/// The model with some replacements, written into a folder.
fn write(folder: &Path, number: usize, changes: &[[&str; 2]]) -> PathBuf {
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes");
    let text = std::fs::read_to_string(meshes.join("brake-small.toml")).expect("the repository has it");
    let text = text.replace("build/", &format!("{}/", meshes.join("build").display()));
    let text = changes.iter().fold(text, |text, [old, new]| {
        assert!(text.contains(old), "{old:?} is in the model");
        text.replace(old, new)
    });
    let path = folder.join(format!("model{number}.toml"));
    std::fs::write(&path, text).expect("the folder can be written");
    path
}

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let own = || PathBuf::from(env!("CARGO_BIN_EXE_squeal"));
    let mut variants = vec![Variant { name: "as it stands", program: own(), model: write(folder.path(), 0, &[]) }];
    for (i, (name, changes)) in CHANGES.into_iter().enumerate() {
        variants.push(Variant { name, program: own(), model: write(folder.path(), i + 1, changes) });
    }
    let older = std::env::var_os("SQUEAL_OLDER").map(PathBuf::from);
    let model = write(folder.path(), variants.len(), &[OLDER]);
    variants.extend(older.map(|program| Variant { name: "older program", program, model }));
    let n_rounds = std::env::var("SQUEAL_ROUNDS").map_or(5, |n| n.parse().expect("a number of rounds"));
    let mut ratios = vec![Vec::new(); variants.len()];
    for round in 0..n_rounds {
        let mut seconds = vec![0.0; variants.len()];
        // Each round begins elsewhere, so that no variant is always the first.
        (0..variants.len()).map(|i| (i + 5 * round) % variants.len()).for_each(|i| seconds[i] = measure(&variants[i]));
        ratios.iter_mut().zip(&seconds).for_each(|(all, own)| all.push(own / seconds[0]));
        println!("round {}: {:.1} s as it stands", round + 1, seconds[0]);
    }
    for (variant, ratios) in variants.iter().zip(&mut ratios) {
        ratios.sort_by(f64::total_cmp);
        let (median, last) = (ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
        println!("{:20} {median:6.3}  ({:.3} to {last:.3})", variant.name, ratios[0]);
    }
}
