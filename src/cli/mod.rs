//! The command line: arguments, one file a command, exit codes.

mod check;
mod compare;
mod completions;
mod convert;
mod explore;
mod export;
mod interrupt;
mod man;
mod modes;
mod new;
mod progress;
mod reduce;
mod report;
mod stability;
mod states;
mod r#static;
mod study;
mod values;
mod watch;
mod wear;

use std::env;
use std::ffi::OsString;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::Duration;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};
use serde::Serialize;

use crate::analysis::Output;
use crate::model::NormalLaw;
use crate::native::blas::restart_with_fitting_kernels;
use crate::native::{Comm, Session, all_libraries, unused_options};
use crate::output::json::{self, Failed, Warned};
use crate::output::text::printable;
use crate::results::Results;
use crate::structure::{PartDamping, StructureOptions};
use crate::{Error, Result};
use interrupt::Interrupt;
use values::{PetscOptions, Values};

/// Predicts disc-brake squeal: contact equilibrium and complex modes of a finite element brake.
///
/// Runs alone or under mpirun. Results go to one folder: tables as CSV, shapes as VTU for ParaView.
///
/// A run that is killed, or stopped by Ctrl-C, continues when the same command is given again.
///
/// Exit codes: 0 done, 2 the input cannot be analysed, 3 no convergence, 130 stopped by Ctrl-C, 1 anything else.
#[derive(Parser)]
#[command(name = "squeal", version, long_version = LONG_VERSION.as_str(), max_term_width = 110)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// An option for PETSc, SLEPc or MUMPS, e.g. --petsc "-equilibrium_snes_monitor" (may be repeated)
    #[arg(long, global = true, value_name = "OPTION", allow_hyphen_values = true)]
    petsc: Vec<String>,
    /// Print results as one JSON document on standard output, errors as one on standard error
    #[arg(long, global = true)]
    json: bool,
}

/// The program's version and those of its libraries.
static LONG_VERSION: LazyLock<String> = LazyLock::new(|| format!("{}\n{}", env!("CARGO_PKG_VERSION"), all_libraries()));

/// What every command runs with.
struct Shell<'a> {
    comm: &'a Comm,
    interrupt: &'a Interrupt,
    /// Options for PETSc as typed.
    petsc: &'a [String],
    /// Whether results are printed as JSON.
    json: bool,
}

impl Shell<'_> {
    /// Prints a text, or the document in its place, on the root. That a reader has seen enough (`squeal check
    /// model.toml | head`) is no error.
    ///
    /// # Errors
    /// The system's.
    pub fn print(&self, text: &str, document: &impl Serialize) -> Result<()> {
        match (self.comm.is_root(), self.json) {
            (false, _) => Ok(()),
            (true, true) => print(&json::text(document)),
            (true, false) => print(&printable(text)),
        }
    }
}

impl Shell<'_> {
    /// Prints results as text or JSON; an analysis that did not converge ends with its reason.
    ///
    /// # Errors
    /// The system's; [`Error::NotConverged`].
    fn print_results(&self, results: &Results, place: &Path, summary: fn(&Results, &str) -> String) -> Result<()> {
        let place = place.display().to_string();
        self.print(&summary(results, &place), &json::ResultsDocument::new(results, &place))?;
        self.comm.agree(match &results.failure {
            Some(failure) => Err(Error::not_converged(failure.reason.clone())),
            None => Ok(()),
        })
    }

    /// Says which options of `--petsc` nothing has read: a wrong name changes nothing.
    fn warn_of_unused(&self, options: &PetscOptions) -> Result<()> {
        let unread = |name| format!("--petsc: this command has not read the option {name}. Look at its name");
        self.warn(&unused_options(options)?.into_iter().map(unread).collect::<Vec<_>>());
        Ok(())
    }

    /// Writes warnings to standard error, a line each: as text, or as JSON like errors.
    pub fn warn(&self, warnings: &[String]) {
        for warning in warnings.iter().filter(|_| self.comm.is_root()) {
            let _ = writeln!(io::stderr(), "{}", warning_line(warning, self.json));
        }
    }
}

/// A warning as text, or as JSON like errors.
fn warning_line(warning: &str, as_json: bool) -> String {
    if as_json { json::line(&Warned { warning }) } else { printable(&format!("warning: {warning}")).into_owned() }
}

#[derive(Subcommand)]
enum Command {
    /// Write a model file for a mesh: parts, touching surfaces and axis are filled in, the rest is to be chosen
    New(new::New),
    /// Print a model file that has every key, each explained (also: squeal help model)
    Example,
    /// Print the JSON schema of model files, by which editors complete and check keys
    Schema,
    /// Print what a model is: parts, masses, contact pairs, mesh quality, free parts, memory
    Check(check::Check),
    /// Write a deck of Abaqus or CalculiX as a model file with a Gmsh mesh, or a model as a deck
    Convert(convert::Convert),
    /// Find the static equilibrium under load, contact and friction
    Static(Run),
    /// Reduce a model to a super-element with a few hundred coordinates
    Reduce(reduce::Reduce),
    /// Write M, C and K about an equilibrium, with what contact has in K and the meaning of each row
    Export(export::Export),
    /// Find the modes of external matrices M, C, K, along a parameter of them, or of a free part of a model
    Modes(modes::Modes),
    /// Find the complex modes of the band, and which of them squeal, for one friction coefficient or a sweep
    Stability(stability::Stability),
    /// Make a page of a stability run's results: whether, where and why it squeals, sensitivities, figures, moving
    /// shapes, tables
    Report(report::Report),
    /// Compare reduced models with full contact: contact layouts and super-elements, their sizes, seconds and errors
    ///
    /// Each model has a folder of its own, as `squeal stability` makes it. Run again, a study makes only what is
    /// missing or out of date.
    Study(study::Study),
    /// Find the modes at points of many parameters, the probability of squeal, and the influence of each parameter
    Explore(explore::Explore),
    /// Wear the sliding contacts of a model or super-element by Archard's law, to a sliding distance or until the wear
    /// rate is uniform
    ///
    /// Contacts wear that have wear = COEFFICIENT (m2/N) in the model file.
    Wear(wear::Wear),
    /// Compare the modes of a model in named states, such as forward and reverse, hot and cold, new and worn
    ///
    /// Each state has a folder of its own, as `squeal stability` makes it. Run again, only states that are missing or
    /// out of date are made.
    States(states::States),
    /// Compare the modes of two results, full or reduced: frequencies, growth rates, shapes
    Compare(compare::Compare),
    /// Print the completions of a shell: squeal completions bash > /etc/bash_completion.d/squeal
    Completions(completions::Completions),
    /// Write the manual pages
    #[command(hide = true)]
    Man(man::Man),
}

/// What all computing commands take.
#[derive(Args)]
#[group(skip)]
struct Run {
    /// The model file, a deck (.inp), or the file of a super-element
    model: PathBuf,
    /// Friction coefficient of the swept contacts: one value, a list 0.2,0.5 or a range FROM:TO:STEP (default: the
    /// model file's)
    #[arg(long, alias = "mu", value_name = "MU", value_parser = values::parse, allow_hyphen_values = true)]
    friction: Option<Values>,
    /// Number of reference pairs in place of the contact points of the sliding contacts, e.g. 104
    #[arg(long, value_name = "N", value_parser = values::count)]
    contacts: Option<usize>,
    /// Of a super-element: the normal law of its contacts, linear:K or cubic:K1,K3 in N/m and N/m3
    #[arg(long, value_name = "LAW", value_parser = values::law)]
    law: Option<NormalLaw>,
    /// Of a super-element: a gap field (CSV) of its contacts in place of its model's, such as worn.csv of squeal wear
    #[arg(long, value_name = "FILE")]
    gap: Option<PathBuf>,
    /// Of a super-element: the loads as a multiple of the model's
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = values::factor, allow_hyphen_values = true)]
    pressure: f64,
    /// The normal stiffness of the swept contacts as a multiple of the model's
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = values::factor, allow_hyphen_values = true)]
    contact_stiffness: f64,
    /// Of a super-element: another Rayleigh damping of a part, alpha in 1/s and beta in s; may be given for several
    /// parts
    #[arg(long, value_name = "PART=ALPHA,BETA", value_parser = values::damping)]
    damping: Vec<PartDamping>,
    /// Folder of the results (default: the model file's name with the command's)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace the results of an earlier run, and what another command or model has left unfinished
    #[arg(long)]
    force: bool,
    /// Print a line for each finished value on standard error, with the time left, and one twice a minute for what is
    /// being done (a terminal shows a bar anyway)
    #[arg(short, long)]
    verbose: bool,
}

impl Run {
    fn structure_options(&self) -> StructureOptions {
        StructureOptions {
            contacts: self.contacts,
            law: self.law.clone(),
            gap: self.gap.clone(),
            load_factor: self.pressure,
            contact_stiffness: self.contact_stiffness,
            damping: self.damping.clone(),
        }
    }

    fn friction_values(&self) -> Option<Vec<f64>> {
        self.friction.as_ref().map(|values| values.0.clone())
    }

    /// Where a command writes, and what its numbers depend on beside structure and options.
    fn output(&self, shell: &Shell, command: &str) -> Output {
        Output {
            folder: self.folder(command),
            force: self.force,
            command: command_line(),
            identity: vec![
                ("structure", format!("{:?}", self.structure_options())),
                ("options for PETSc", shell.petsc.join(" ")),
            ],
        }
    }

    fn folder(&self, command: &str) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-{command}")))
    }
}

/// The words of the command, without the program's name.
fn command_line() -> String {
    let words: Vec<_> = env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    words.join(" ")
}

/// Runs the program and gives its exit code.
///
/// ```no_run
/// std::process::exit(squeal::cli::main());
/// ```
pub fn main() -> i32 {
    restart_with_fitting_kernels();
    let (arguments, options) = match arguments() {
        Ok(parsed) => parsed,
        Err(usage) => return print_usage(&usage),
    };
    match Interrupt::receive().and_then(|interrupt| Ok((interrupt, Session::start(&options)?))) {
        Ok((interrupt, comm)) => {
            let shell = Shell { comm: &comm, interrupt: &interrupt, petsc: &arguments.petsc, json: arguments.json };
            guard_as(&comm, shell.json, || {
                run(&arguments.command, &shell)?;
                shell.warn_of_unused(&options)
            })
        }
        Err(error) => {
            print_error("error", &error, arguments.json);
            error.exit_code()
        }
    }
}

fn arguments() -> std::result::Result<(Arguments, PetscOptions), clap::Error> {
    let mut words: Vec<OsString> = env::args_os().collect();
    if words.iter().skip(1).eq(["help", "model"]) {
        words = vec!["squeal".into(), "example".into()];
    }
    let arguments = Arguments::try_parse_from(words)?;
    match values::petsc_options(&arguments.petsc) {
        Ok(options) => Ok((arguments, options)),
        Err(message) => Err(Arguments::command().error(ErrorKind::InvalidValue, message)),
    }
}

/// Prints what is wrong with the arguments, or the help asked for. Once, also where a launcher has started several
/// processes: only MPI gives the first of them, and its end keeps a launcher from killing that one before it has
/// printed.
fn print_usage(usage: &clap::Error) -> i32 {
    const LAUNCHED: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"];
    let launched = LAUNCHED.iter().any(|name| std::env::var_os(name).is_some());
    let comm = if launched { Session::start(&[]).ok() } else { None };
    if comm.as_ref().is_none_or(Comm::is_root) {
        // An error here has no place where it could be printed.
        let _ = match (usage.use_stderr(), env::args_os().any(|word| word == "--json")) {
            (true, true) => {
                let text = usage.to_string();
                let error = text.trim().trim_start_matches("error: ").to_owned();
                let failed = Failed { error, exit_code: usage.exit_code() };
                writeln!(io::stderr(), "{}", json::line(&failed))
            }
            _ => usage.print(),
        };
    }
    usage.exit_code()
}

fn run(command: &Command, shell: &Shell) -> Result<()> {
    match command {
        Command::New(new) => new::run(shell, new),
        Command::Example => new::example(shell),
        Command::Schema => new::schema(shell),
        Command::Check(check) => check::run(shell, check),
        Command::Convert(convert) => convert::run(shell, convert),
        Command::Static(run) => r#static::run(shell, run),
        Command::Export(export) => export::run(shell, export),
        Command::Modes(modes) => modes::run(shell, modes),
        Command::Reduce(reduce) => reduce::run(shell, reduce),
        Command::Report(report) => report::run(shell, report),
        Command::Stability(stability) => stability::run(shell, stability),
        Command::Study(study) => study::run(shell, study),
        Command::Explore(explore) => explore::run(shell, explore),
        Command::Wear(wear) => wear::run(shell, wear),
        Command::States(states) => states::run(shell, states),
        Command::Compare(compare) => compare::run(shell, compare),
        Command::Completions(completions) => completions::run(shell, completions),
        Command::Man(man) => man::run(shell, man),
    }
}

/// Runs what all ranks do together and gives the exit code. An error is printed once; an error or panic of one rank
/// alone ends all of them, so that none waits for ever.
pub fn guard(comm: &Comm, work: impl FnOnce() -> Result<()>) -> i32 {
    guard_as(comm, false, work)
}

/// The same, with errors as JSON where that is asked for.
fn guard_as(comm: &Comm, json: bool, work: impl FnOnce() -> Result<()>) -> i32 {
    const PANICKED: i32 = 101;
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => end(comm, &error, json),
        Err(_) if comm.size() > 1 => comm.abort(PANICKED),
        Err(_) => PANICKED,
    }
}

/// Prints the error once and ends all ranks. Input, convergence and signals are judged alike everywhere, so that ranks
/// end in order; anything else may have happened on this rank alone, so that the others are ended.
fn end(comm: &Comm, error: &Error, json: bool) -> i32 {
    let together = error.is_of_all_ranks();
    if comm.is_root() {
        print_error("error", error, json);
    } else if !together {
        // The root may be about to print the same.
        std::thread::sleep(Duration::from_millis(500));
        print_error(&format!("error on rank {}", comm.rank()), error, json);
    }
    if comm.size() > 1 && !together {
        comm.abort(error.exit_code());
    }
    error.exit_code()
}

/// Writes to standard error, as far as it can be written.
fn print_error(what: &str, error: &Error, as_json: bool) {
    let text = match (as_json, error.kind()) {
        (true, _) => json::line(&Failed { error: error.to_string(), exit_code: error.exit_code() }),
        // That a run was stopped is no error.
        (false, crate::ErrorKind::Interrupted { .. }) => error.to_string(),
        (false, _) => printable(&format!("{what}: {error}")).into_owned(),
    };
    let _ = writeln!(io::stderr(), "{text}");
}

/// Writes to standard output, as far as it is read.
fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::io("standard output".as_ref())(error)),
        _ => Ok(()),
    }
}
