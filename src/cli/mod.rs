//! The command line: arguments, one file a command, exit codes.

mod check;
mod friction;
mod progress;
mod results;
mod stability;
mod statics;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};

use crate::petsc::{Comm, Session};
use crate::{Error, Result};
use friction::Frictions;

/// Predicts disc-brake squeal: contact equilibrium and complex modes of a finite element brake.
///
/// Runs alone or under mpirun. Results go to one folder: tables as CSV, shapes as VTU for ParaView.
///
/// Exit codes: 0 done, 2 the input cannot be analysed, 3 no convergence, 1 anything else.
#[derive(Parser)]
#[command(name = "squeal", version, max_term_width = 110)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// An option for PETSc, SLEPc or MUMPS, e.g. --petsc "-equilibrium_snes_monitor" (may be repeated)
    #[arg(long, global = true, value_name = "OPTION", allow_hyphen_values = true)]
    petsc: Vec<String>,
}

#[derive(Subcommand)]
enum Command {
    /// Tell what a model is: parts, masses, contact pairs, mesh quality, free parts, memory
    Check {
        /// The model file
        model: PathBuf,
    },
    /// Find the static equilibrium under load, contact and friction
    Static {
        #[command(flatten)]
        run: Run,
    },
    /// Find the complex modes of the band, and which of them squeal, for one friction or a sweep
    Stability {
        #[command(flatten)]
        run: Run,
        /// Frequency band in Hz, instead of the model file's
        #[arg(long, value_name = "FROM:TO", value_parser = friction::band)]
        band: Option<[f64; 2]>,
    },
}

/// What all computing commands take.
#[derive(Args)]
struct Run {
    /// The model file
    model: PathBuf,
    /// Friction of the swept contacts: one value, a list 0.2,0.5 or a range FROM:TO:STEP (default: the model file's)
    #[arg(long, value_name = "MU", value_parser = friction::parse)]
    friction: Option<Frictions>,
    /// Folder of the results (default: the model file's name with the command's)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace the results of an earlier run
    #[arg(long)]
    force: bool,
}

impl Run {
    fn folder(&self, command: &str) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-{command}")))
    }
}

/// Runs the program and gives its exit code.
pub fn main() -> i32 {
    let arguments = Arguments::parse();
    let comm = match options(&arguments.petsc).and_then(|options| Session::start(&options)) {
        Ok(comm) => comm,
        Err(error) => {
            eprintln!("error: {error}");
            return error.exit_code();
        }
    };
    match catch_unwind(AssertUnwindSafe(|| run(&arguments.command, &comm))) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => end(&comm, &error),
        Err(_) if comm.size() > 1 => comm.abort(101),
        Err(_) => 101,
    }
}

fn run(command: &Command, comm: &Comm) -> Result<()> {
    match command {
        Command::Check { model } => check::run(comm, model),
        Command::Static { run } => statics::run(comm, run),
        Command::Stability { run, band } => stability::run(comm, run, *band),
    }
}

/// Tells the error once and ends all ranks. Input and convergence are judged alike everywhere, so that ranks end in order;
/// anything else may have happened on this rank alone, so that the others are ended.
fn end(comm: &Comm, error: &Error) -> i32 {
    let together = matches!(error, Error::Input(_) | Error::NotConverged(_) | Error::Elsewhere(_));
    if comm.is_root() && !matches!(error, Error::Elsewhere(_)) {
        eprintln!("error: {error}");
    } else if !together {
        // The root may be about to say the same.
        std::thread::sleep(Duration::from_millis(500));
        eprintln!("error on rank {}: {error}", comm.rank());
    }
    if comm.size() > 1 && !together {
        comm.abort(error.exit_code());
    }
    error.exit_code()
}

/// `-name value` pairs for PETSc's option database.
fn options(texts: &[String]) -> Result<Vec<(String, String)>> {
    let mut pairs: Vec<(String, String)> = Vec::new();
    for word in texts.iter().flat_map(|text| text.split_whitespace()) {
        match (word.starts_with('-') && word.parse::<f64>().is_err(), pairs.last_mut()) {
            (true, _) => pairs.push((word.into(), String::new())),
            (false, Some((_, value))) if value.is_empty() => *value = word.into(),
            _ => return Err(Error::input(format!("--petsc takes options like -name value; {word:?} has no -name"))),
        }
    }
    Ok(pairs)
}
