//! `squeal reduce`: a super-element.

use std::path::PathBuf;

use clap::Args;

use crate::Result;
use crate::analysis::{
    GalerkinOptions, GalerkinReduction, ReduceOptions, Reduction, friction_samples, reduce, reduce_galerkin,
    with_reference_contacts,
};
use crate::explore::{self, Study};
use crate::native::Comm;
use crate::output::super_element::{GalerkinDocument, ReductionDocument};
use crate::structure::FullModel;

use super::values::Values;
use super::watch::Watch;
use super::{Shell, values};

/// What `reduce` takes.
#[derive(Args)]
#[group(skip)]
pub struct Reduce {
    /// The model file
    model: PathBuf,
    /// Number of reference pairs over the sliding contacts, e.g. 104 (default: the model file's)
    #[arg(long, value_name = "N", value_parser = values::count)]
    contacts: Option<usize>,
    /// Friction coefficient at which the other contacts are linearised (default: the swept contacts' own)
    #[arg(long, value_name = "MU", value_parser = values::single, allow_hyphen_values = true)]
    friction: Option<f64>,
    /// Keep fixed-interface modes up to this frequency in Hz (default: the model file's reduction, else twice its band)
    #[arg(long, value_name = "HZ", value_parser = values::frequency, allow_hyphen_values = true)]
    limit: Option<f64>,
    /// Keep all contacts with their laws and status, and reduce the brake to a basis of its own equilibria and modes:
    /// one super-element for all friction coefficients, pressures and contact stiffnesses
    #[arg(long, conflicts_with_all = ["contacts", "friction", "limit"])]
    galerkin: bool,
    /// Make the super-element for a study of many parameters: its basis holds over the ranges of moduli and densities,
    /// with --galerkin also of friction, pressure and contact stiffness
    #[arg(long = "for", value_name = "STUDY")]
    for_study: Option<PathBuf>,
    /// With --galerkin: friction coefficients at which the full model's modes are found, a list 0.1,0.5,0.9 (default:
    /// the first, the middle and the last of the model file's sweep, widened to the friction coefficients of --for)
    #[arg(long, value_name = "MU", value_parser = values::parse, requires = "galerkin")]
    samples: Option<Values>,
    /// With --galerkin: keep the basis in the file (four bytes a coordinate and displacement of the mesh), so that
    /// `squeal stability --certify` can compare results with the full model
    #[arg(long, requires = "galerkin")]
    keep_basis: bool,
    /// The super-element's file (default: the model file's name with .se.h5)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an earlier file
    #[arg(long)]
    force: bool,
}

pub fn run(shell: &Shell, arguments: &Reduce) -> Result<()> {
    let comm = shell.comm;
    if arguments.galerkin {
        return run_galerkin(shell, arguments);
    }
    let model = with_reference_contacts(FullModel::read(comm, &arguments.model)?, arguments.contacts)?;
    let options = ReduceOptions {
        friction: arguments.friction,
        limit: arguments.limit,
        for_study: arguments.study(comm)?,
        file: arguments.file(),
        force: arguments.force,
    };
    let mut watch = Watch::new(shell, false);
    let Reduction { element, costs, equilibrium_seconds, seconds } = reduce(comm, &model, &options, &mut watch)?;
    watch.finish();
    let document = ReductionDocument::new(&element, &costs, [equilibrium_seconds, seconds], &options.file);
    shell.print(&document.text(), &document)
}

fn run_galerkin(shell: &Shell, arguments: &Reduce) -> Result<()> {
    let comm = shell.comm;
    let model = FullModel::read(comm, &arguments.model)?;
    let for_study = arguments.study(comm)?;
    let all = model.friction_values(arguments.samples.as_ref().map(|values| &values.0[..]))?;
    let samples = if arguments.samples.is_some() { all } else { friction_samples(&all, for_study.as_ref()) };
    let options = GalerkinOptions {
        force: arguments.force,
        keep_basis: arguments.keep_basis,
        for_study,
        ..GalerkinOptions::over(&samples, arguments.file())
    };
    let mut watch = Watch::new(shell, false);
    let GalerkinReduction { element, report, certificates } = reduce_galerkin(comm, &model, &options, &mut watch)?;
    watch.finish();
    let document = GalerkinDocument::new(&element, &report, &certificates, &options.file);
    shell.print(&document.text(), &document)
}

impl Reduce {
    /// The study that the super-element is made for. Collective.
    fn study(&self, comm: &Comm) -> Result<Option<Study>> {
        self.for_study.as_ref().map(|file| comm.agree(explore::read(file))).transpose()
    }

    fn file(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.se.h5")))
    }
}
