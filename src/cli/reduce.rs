//! `squeal reduce`: a super-element.

use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use crate::Result;
use crate::analysis::{ReduceOptions, Reduction, reduce, with_reference_contacts};
use crate::native::FactorStats;
use crate::reduction::craig_bampton::Costs;
use crate::reduction::super_element::SuperElement;
use crate::structure::FullModel;

use super::watch::Watch;
use super::{Reduce, Shell};

pub fn run(shell: &Shell, arguments: &Reduce) -> Result<()> {
    let comm = shell.comm;
    let model = with_reference_contacts(FullModel::read(comm, &arguments.model)?, arguments.contacts)?;
    let options = ReduceOptions {
        friction: arguments.friction,
        limit: arguments.limit,
        file: arguments.file(),
        force: arguments.force,
    };
    let mut watch = Watch::new(shell, false);
    let Reduction { element, costs, equilibrium_seconds, seconds } = reduce(comm, &model, &options, &mut watch)?;
    watch.finish();
    let place = &options.file;
    shell.tell(&text(&element, &costs, equilibrium_seconds, seconds, place), || {
        document(&element, &costs, seconds, place)
    })
}

impl Reduce {
    fn file(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.se.h5")))
    }
}

/// The same as JSON: what was made, and the seconds that its steps took.
fn document(element: &SuperElement, costs: &Costs, seconds: f64, place: &Path) -> Json {
    let origin = &element.origin;
    json!({
        "title": origin.title,
        "model": origin.model,
        "mesh": origin.mesh,
        "mesh_sha256": origin.mesh_hash,
        "friction": origin.friction,
        "limit_hz": origin.limit,
        "contacts": element.contacts.len(),
        "retained_points": element.points.len(),
        "fixed_interface_modes": element.frequencies.len(),
        "inertia_modes": element.n_inertia_modes(),
        "coordinates": element.n_coordinates(),
        "equations_of_the_model": origin.n_equations,
        "constraint_seconds": costs.constraint_seconds,
        "fixed_interface_seconds": costs.fixed_seconds,
        "projection_seconds": costs.projection_seconds,
        "seconds": seconds,
        "file": place.display().to_string(),
    })
}

/// What was made, and what each step cost.
fn text(element: &SuperElement, costs: &Costs, before: f64, seconds: f64, place: &Path) -> String {
    let (n_points, n_contacts, n_modes) = (element.points.len(), element.contacts.len(), element.frequencies.len());
    let origin = &element.origin;
    let FactorStats { analysis_seconds, factorisation_seconds, entries, used_mb, .. } = costs.factor;
    format!(
        "{}: super-element at friction {}\n\n\
         {n_contacts} contacts, {n_points} retained points, {n_modes} fixed-interface modes below {} Hz and {} inertia modes: \
         {} coordinates instead of {}\n\n\
         equilibrium            {before:8.1} s\n\
         one LDL^T factor       {:8.1} s  {:.0} M entries, {used_mb:.0} MB, ordering {}\n\
         constraint modes       {:8.1} s  {} solves in blocks\n\
         fixed-interface modes  {:8.1} s  {} solves in blocks\n\
         projection of M, C, K  {:8.1} s\n\
         in all                 {seconds:8.1} s\n\n\
         results in {}\n",
        origin.title,
        origin.friction,
        origin.limit,
        element.n_inertia_modes(),
        element.n_coordinates(),
        origin.n_equations,
        analysis_seconds + factorisation_seconds,
        1e-6 * entries,
        costs.factor.ordering_name(),
        costs.constraint_seconds,
        3 * n_points,
        costs.fixed_seconds,
        costs.n_solves,
        costs.projection_seconds,
        place.display()
    )
}
