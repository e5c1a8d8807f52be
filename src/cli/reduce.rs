//! `squeal reduce`: a super-element.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Value as Json, json};

use crate::native::{Comm, FactorStats};
use crate::output::overwrite::{FileKind, may_write_file};
use crate::reduction::craig_bampton::{Costs, Event};
use crate::reduction::file;
use crate::reduction::super_element::SuperElement;
use crate::sweep::{Brake, Sweep};
use crate::{Error, Result};

use super::progress::Progress;
use super::{Reduce, Shell};

/// What `reduce` writes.
const SUPER_ELEMENT: FileKind = FileKind { name: "a super-element of squeal", is_one: file::is_super_element };

pub fn run(shell: &Shell, arguments: &Reduce) -> Result<()> {
    let (comm, start) = (shell.comm, Instant::now());
    let brake = read(comm, arguments)?;
    brake.require_held(comm)?;
    let friction = match arguments.friction {
        Some(friction) => friction,
        None => brake.interface.pairs.iter().find(|pair| pair.swept).map_or(0.0, |pair| pair.friction),
    };
    let limit = arguments.limit.unwrap_or_else(|| brake.reduction_limit());
    let place = arguments.file();
    comm.agree(if comm.is_root() { may_write_file(&place, &SUPER_ELEMENT, arguments.force) } else { Ok(()) })?;
    let progress = Progress::new(comm, 1, false);
    progress.say("assembling");
    let system = brake.assemble(comm, &brake.families()?)?;
    let mut sweep = Sweep::new(&system, &brake.interface)?;
    let equilibrium =
        sweep.equilibrium(friction, &mut |_| progress.say(format!("equilibrium at friction {friction}")))?;
    let (_, seconds) = (drop(sweep), start.elapsed().as_secs_f64());
    let (element, surface, costs) =
        brake.reduce(comm, &system, &equilibrium, limit, &mut |event| say(&progress, event))?;
    let write = || {
        // Something may have come to that place since.
        may_write_file(&place, &SUPER_ELEMENT, arguments.force)?;
        file::write(&place, &element, &surface)
    };
    comm.agree(if comm.is_root() { write() } else { Ok(()) })?;
    progress.finish();
    let in_all = start.elapsed().as_secs_f64();
    shell.tell(&text(&element, &costs, seconds, in_all, &place), || document(&element, &costs, in_all, &place))
}

/// The brake with its reference nodes: as many as the command line says, else the model.
fn read(comm: &Comm, arguments: &Reduce) -> Result<Brake> {
    let mut brake = Brake::read(comm, &arguments.model)?;
    let n = arguments.contacts.or(brake.model.reduction.as_ref().map(|reduction| reduction.contacts));
    let n = n.ok_or_else(|| {
        let file = arguments.model.display();
        Error::input(format!(
            "{file}: how many contacts? Give --contacts, such as 104, or [reduction] contacts in the model"
        ))
    })?;
    brake.reduce_contacts(n)?;
    Ok(brake)
}

impl Reduce {
    fn file(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.se.h5")))
    }
}

fn say(progress: &Progress, event: Event) {
    progress.say(match event {
        Event::Factor => "factorising the structure without its sliding contacts".into(),
        Event::Constraint(done, all) => format!("constraint modes: {done} of {all}"),
        Event::Fixed(size) => format!("fixed-interface modes: a space of {size} vectors"),
        Event::Project => "projecting".into(),
    });
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
