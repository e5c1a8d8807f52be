//! The real program, alone and under mpirun, in a folder of its own.

use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, Output, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin;
use tempfile::TempDir;

use super::data;
use super::pad_on_disc::{MODEL, PadOnDisc};

/// A run that takes longer hangs. mpirun ends its ranks a little earlier, so that none is left behind.
const PATIENCE: u64 = 240;

/// `mpirun -n ranks program`, ready for arguments.
pub fn mpirun(ranks: usize, program: &Path) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["-q", "--allow-run-as-root", "--bind-to", "none", "--oversubscribe"]);
    command.args(["--timeout", &(PATIENCE - 20).to_string(), "-n", &ranks.to_string()]).arg(program);
    quiet(&mut command);
    command
}

/// One thread a rank, which leaves its core to others while it waits; no backtraces, and no way of copying between
/// processes that containers forbid.
fn quiet(command: &mut Command) {
    command.timeout(Duration::from_secs(PATIENCE));
    command.env("OPENBLAS_NUM_THREADS", "1").env("RUST_BACKTRACE", "0");
    command.env("OMPI_MCA_btl_vader_single_copy_mechanism", "none").env("OMPI_MCA_mpi_yield_when_idle", "1");
}

/// The exit code and the texts of a run.
pub struct Finished {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl From<Output> for Finished {
    fn from(output: Output) -> Finished {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        // Of what a signal has ended shells give 128 and its number.
        let code = output.status.code().or(output.status.signal().map(|number| 128 + number));
        Finished { code: code.unwrap_or(-1), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// A folder in which the program runs, with a model file `brake.toml` and what that needs.
pub struct Place {
    folder: TempDir,
}

impl Place {
    /// An empty folder.
    pub fn empty() -> Place {
        Place { folder: tempfile::tempdir().unwrap() }
    }

    /// The two pads on a disc of tests/data.
    pub fn pads() -> Place {
        Place::with_pads(|text| text)
    }

    /// The same with another model file.
    pub fn with_pads(change: impl FnOnce(String) -> String) -> Place {
        let place = Place::empty();
        std::fs::copy(data("pads_on_disc.msh"), place.path("pads_on_disc.msh")).unwrap();
        place.write("brake.toml", change(std::fs::read_to_string(data("pads_on_disc.toml")).unwrap()));
        place
    }

    /// A small pad on a small disc: [`MODEL`] and its mesh.
    pub fn blocks() -> Place {
        Place::with_blocks(|text| text, &PadOnDisc::default())
    }

    /// The same with another model file and mesh.
    pub fn with_blocks(change: impl FnOnce(String) -> String, mesh: &PadOnDisc) -> Place {
        let place = Place::empty();
        place.write("blocks.msh", mesh.gmsh());
        place.write("brake.toml", change(MODEL.into()));
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// All names in a folder of the place, hidden ones too, sorted.
    pub fn list(&self, name: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(name)).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Number of files with this beginning that an unfinished run into the folder `run` keeps.
    pub fn n_kept(&self, beginning: &str) -> usize {
        let folder = ".run.unfinished/.resume";
        let is_kept = |name: &String| name.starts_with(beginning);
        if self.path(folder).exists() { self.list(folder).iter().filter(|name| is_kept(name)).count() } else { 0 }
    }

    /// Waits until a run keeps so many of these files, or is over.
    pub fn wait_for(&self, child: &mut Child, beginning: &str, n: usize) {
        let patience = Instant::now() + Duration::from_secs(200);
        while self.n_kept(beginning) < n && child.try_wait().unwrap().is_none() {
            assert!(Instant::now() < patience, "{n} files {beginning} do not come");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// The program, ready for arguments.
    pub fn command(&self) -> Command {
        let mut command = Command::new(cargo_bin("squeal"));
        command.current_dir(self.folder.path());
        quiet(&mut command);
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Finished {
        self.command().args(arguments).output().unwrap().into()
    }

    pub fn run_on(&self, ranks: usize, arguments: &[&str]) -> Finished {
        let mut command = mpirun(ranks, &cargo_bin("squeal"));
        command.current_dir(self.folder.path()).args(arguments).output().unwrap().into()
    }
}

/// Starts the program without waiting for it.
pub fn start(place: &Place, ranks: usize, arguments: &[&str]) -> Child {
    let program = cargo_bin("squeal");
    let mut command = if ranks == 1 {
        Process::new(program)
    } else {
        let mpirun = mpirun(ranks, &program);
        let mut command = Process::new(mpirun.get_program());
        command.args(mpirun.get_args());
        mpirun.get_envs().for_each(|(name, value)| {
            command.env(name, value.unwrap_or_default());
        });
        command
    };
    command.args(arguments).current_dir(place.path("")).env("OPENBLAS_NUM_THREADS", "1").env("RUST_BACKTRACE", "0");
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Sends a signal to a process.
pub fn signal(name: &str, process: u32) {
    let sent = Process::new("bash").args(["-c", &format!("kill -{name} {process}")]).status().unwrap();
    assert!(sent.success());
}

/// The end of a run that was started.
pub fn end(child: Child) -> Finished {
    child.wait_with_output().unwrap().into()
}

/// The message with which the program refused its input: exit code 2, nothing printed, and one error.
#[track_caller]
pub fn refusal(finished: &Finished) -> String {
    let Finished { code, out, err } = finished;
    assert_eq!(*code, 2, "{out}{err}");
    assert_eq!(err.lines().filter(|line| line.starts_with("error")).count(), 1, "one message: {err}");
    assert!(err.starts_with("error: ") && out.is_empty(), "{out}{err}");
    err.clone()
}

/// Requires that the program refused its input with all of these parts in its message.
#[track_caller]
pub fn assert_refused(finished: &Finished, parts: &[&str]) {
    let message = refusal(finished);
    parts.iter().for_each(|part| assert!(message.contains(part), "{part:?} is not in: {message}"));
}

/// Runs an ignored test of this executable, by its full name, on two ranks.
pub fn run_test_on_two_ranks(name: &str) -> Finished {
    let mut command = mpirun(2, &std::env::current_exe().unwrap());
    command.args(["--exact", name, "--ignored", "--nocapture", "--test-threads=1"]).output().unwrap().into()
}

/// Replaces the one place where a text stands.
#[track_caller]
pub fn swap(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old:?} is not in the file");
    text.replacen(old, new, 1)
}
