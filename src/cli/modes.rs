//! `squeal modes`: modes of external matrices, along a parameter of them, and of a free part.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::analysis::{ExternalOptions, FreeModesOptions, external_modes, free_modes};
use crate::matrices::family::{self, Coefficient, MatrixFamily};
use crate::matrices::{Role, Term};
use crate::model::InstabilityCriterion;
use crate::output;
use crate::output::external::ExternalDocument;
use crate::output::folder::Folder;
use crate::output::free_modes::FreeModesDocument;
use crate::output::overwrite::may_write_folder;
use crate::structure::FullModel;
use crate::{Error, Result};

use super::Shell;
use super::values::{self, Values};
use super::watch::Watch;

/// What `modes` takes.
#[derive(Args)]
#[group(skip)]
pub struct Modes {
    /// A family of matrices along a parameter (TOML), or with --part a model file
    #[arg(required_unless_present = "mass", conflicts_with_all = ["mass", "stiffness", "damping", "structural"])]
    subject: Option<PathBuf>,
    /// M, kg: Matrix Market, PETSc binary, or Abaqus's text, also gzipped
    #[arg(long, value_name = "FILE", requires = "stiffness")]
    mass: Option<PathBuf>,
    /// K, N/m
    #[arg(long, value_name = "FILE", requires = "mass")]
    stiffness: Option<PathBuf>,
    /// C, N s/m (default: none)
    #[arg(long, value_name = "FILE", requires = "mass")]
    damping: Option<PathBuf>,
    /// G, N/m, the imaginary part of the stiffness: structural damping (default: none)
    #[arg(long, value_name = "FILE", requires = "mass")]
    structural: Option<PathBuf>,
    /// Frequency band in Hz (with --part default: the model file's)
    #[arg(long, value_name = "FROM:TO", value_parser = values::band, allow_hyphen_values = true)]
    band: Option<[f64; 2]>,
    /// What counts as unstable, of external matrices: damping_ratio:X for damping ratios below X (a fraction: -0.001
    /// is -0.1 %), or growth_rate:X for growth rates above X in 1/s (default: all growth that is not rounding)
    #[arg(long, value_name = "CRITERION", value_parser = values::criterion)]
    unstable: Option<InstabilityCriterion>,
    /// Values of a family's parameter: one value, a list or a range FROM:TO:STEP
    #[arg(long, value_name = "VALUES", value_parser = values::values, allow_hyphen_values = true)]
    parameter: Option<Values>,
    /// Of a model the free, undamped modes of this part alone, unconstrained
    #[arg(long, value_name = "NAME", requires = "subject")]
    part: Option<String>,
    /// Compare a part's modes with measured ones: CSV with columns x, y, z (in the mesh's unit), direction (x, -y, or
    /// "nx ny nz"), and one for each mode under its frequency in Hz
    #[arg(long, value_name = "CSV", requires = "part")]
    measured: Option<PathBuf>,
    /// Write the shapes of all modes of external matrices, shapes.csv
    #[arg(long, conflicts_with = "part")]
    shapes: bool,
    /// Do not follow a family's modes over its parameter
    #[arg(long, conflicts_with = "part")]
    no_branches: bool,
    /// Folder of the results (default: the name of the stiffness, the family or the part, with -modes)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace the results of an earlier run
    #[arg(long)]
    force: bool,
    /// Print a line for each finished value on standard error
    #[arg(short, long)]
    verbose: bool,
}

pub fn run(shell: &Shell, arguments: &Modes) -> Result<()> {
    match (&arguments.subject, &arguments.part) {
        (Some(model), Some(part)) => of_part(shell, arguments, model, part),
        _ => of_matrices(shell, arguments),
    }
}

fn of_part(shell: &Shell, arguments: &Modes, model: &Path, part: &str) -> Result<()> {
    let comm = shell.comm;
    if arguments.parameter.is_some() {
        return Err(Error::input("--parameter is for families of matrices: a part has none"));
    }
    let place = arguments.folder(&format!("{}-{part}", stem(model)));
    let model = FullModel::read_part(comm, model, part)?;
    let folder = Folder::open_empty(comm, &place, arguments.force)?;
    let options = FreeModesOptions { band: arguments.band, measured: arguments.measured.clone() };
    let mut watch = Watch::new(shell, arguments.verbose);
    let found = free_modes(comm, &model, &options, folder.as_ref(), &mut watch)?;
    watch.finish();
    let text = output::free_modes::summary(&found, &place.display().to_string());
    comm.agree(folder.map_or(Ok(()), |folder| output::free_modes::write(&found, folder, &text)))?;
    shell.print(&text, &FreeModesDocument::from(&found))
}

fn of_matrices(shell: &Shell, arguments: &Modes) -> Result<()> {
    let comm = shell.comm;
    let family = comm.agree(arguments.family())?;
    let place = arguments.folder(&arguments.name());
    comm.agree(if comm.is_root() { may_write_folder(&place, arguments.force) } else { Ok(()) })?;
    let options = ExternalOptions {
        band: arguments.band.ok_or_else(|| Error::input("which band? Give --band FROM:TO in Hz"))?,
        criterion: arguments.unstable.unwrap_or_default(),
        values: arguments.parameter.as_ref().map_or_else(|| vec![0.0], |values| values.0.clone()),
        branches: !arguments.no_branches,
        shapes: arguments.shapes,
    };
    let mut watch = Watch::new(shell, arguments.verbose);
    let results = external_modes(comm, &family, &options, &mut watch)?;
    watch.finish();
    let text = output::external::summary(&results, &place.display().to_string());
    let folder = Folder::open_empty(comm, &place, arguments.force)?;
    comm.agree(folder.map_or(Ok(()), |folder| output::external::write(&results, folder, &text)))?;
    shell.print(&text, &ExternalDocument::from(&results))
}

impl Modes {
    /// The matrices: those of the command line are a family that does not vary.
    fn family(&self) -> Result<MatrixFamily> {
        let (Some(mass), Some(stiffness)) = (&self.mass, &self.stiffness) else {
            let path = self.subject.as_deref().expect("clap has asked for one");
            let family = family::read(path)?;
            return match self.parameter {
                Some(_) => Ok(family),
                None => Err(Error::input(format!("{}: which {}? Give --parameter", path.display(), family.parameter))),
            };
        };
        if self.parameter.is_some() {
            return Err(Error::input("--parameter is for families: single matrices have none"));
        }
        let term = |role, file: &PathBuf| Term { role, file: file.clone(), factor: Coefficient::one() };
        let mut terms = vec![term(Role::Mass, mass)];
        terms.extend(self.damping.iter().map(|file| term(Role::Damping, file)));
        terms.push(term(Role::Stiffness, stiffness));
        terms.extend(self.structural.iter().map(|file| term(Role::Structural, file)));
        Ok(MatrixFamily { title: stem(stiffness), parameter: "parameter".into(), terms })
    }

    /// What results are called after.
    fn name(&self) -> String {
        self.subject.as_deref().or(self.stiffness.as_deref()).map_or_else(String::new, stem)
    }

    fn folder(&self, name: &str) -> PathBuf {
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{name}-modes")))
    }
}

/// A file's name up to its first dot.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    name.split('.').next().unwrap_or_default().to_owned()
}
