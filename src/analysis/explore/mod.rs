//! Modes at points of many parameters.
//!
//! The nominal point is the first one; then come the points of the design, each with a system and factors of its own,
//! so that a point depends on nothing but its values and the state that it starts from: an equilibrium nearby. So a
//! study that was interrupted ends with the same numbers. Groups of ranks solve points at the same time ([`groups`]).

mod checkpoint;
mod fields;
mod files;
mod gradients;
mod groups;
mod nominal;
mod path;
mod point;
mod reduced_subject;
mod rounds;
mod subject;

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::explore::{
    Answers, Distribution, Refinement, Study, by_weight, keeps_shapes, shaped_modes, standing_alone, with_tables,
    write_tables,
};
use crate::hdf::is_hdf5;
use crate::native::Comm;
use crate::output::explore::{Document, PAGE, WORST, write};
use crate::output::folder::Folder;
use crate::results::{About, Exploration, PointShape, Surface, n_on_page};
use crate::{Error, Result};

use super::observer::{Event, Observer, stop_signal};
use super::start::{Earlier, N_RANKS, Output, about, announce, identity, open_folder};

use checkpoint::{Points, UNIT};
use groups::Groups;
use point::Request;
use rounds::require_progress;
use subject::Subject;

/// A folder that a study writes, with its page.
#[derive(Debug, Clone)]
pub struct ExploreOutput {
    /// The folder.
    pub output: Output,
    /// The text of the page, which is written before the folder gets its name.
    pub page: fn(&Study, &Exploration) -> Result<String>,
}

/// Finds the modes at the points of a study, follows them to the nominal point, and computes the probability of squeal
/// and the influence of each parameter. A point that fails is recorded with its reason. Groups of `ranks_per_point`
/// ranks solve points at the same time; where it is not given, all ranks solve each point together, or each has points
/// of its own where the study is of a super-element. With `output` the study is written to a folder, and continues
/// where an earlier run has ended, also on other ranks. Only the root gets the result. Collective.
///
/// ```no_run
/// use squeal::analysis::explore;
///
/// let comm = squeal::Session::start(&[])?;
/// let study = squeal::explore::read("explore.toml".as_ref())?;
/// let found = explore(&comm, &study, None, None, &mut ())?.expect("this is the root");
/// println!("unstable with a probability of {:.2}", found.answers.unstable.value);
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for a study, model or folder that cannot be used, and for ranks that cannot be divided so;
/// [`Error::Interrupted`]; the system's.
pub fn explore(
    comm: &Comm,
    study: &Study,
    ranks_per_point: Option<usize>,
    output: Option<&ExploreOutput>,
    observer: &mut dyn Observer,
) -> Result<Option<Exploration>> {
    let groups = groups_for(comm, study, ranks_per_point)?;
    let found = Run::new(groups, study, output.map(|own| &own.output))?.run(output, observer)?;
    Ok(comm.is_root().then_some(found))
}

/// The groups that a study works in. The few dofs of a super-element are not worth sharing.
fn groups_for(world: &Comm, study: &Study, ranks_per_point: Option<usize>) -> Result<Groups> {
    let is_reduced = is_hdf5(&study.model);
    let n_ranks = ranks_per_point.unwrap_or(if is_reduced { 1 } else { world.size() });
    if is_reduced && n_ranks > 1 {
        let what = "is a super-element, of which each rank has points of its own. Leave --ranks-per-point out";
        return Err(Error::input(format!("{} {what}", study.model.display())));
    }
    Groups::new(world, n_ranks)
}

/// A study under way.
struct Run<'s> {
    groups: Groups,
    study: &'s Study,
    subject: Subject<'s>,
    about: About,
    request: Request,
    /// Values of the parameters, the nominal point first.
    values: Vec<Vec<f64>>,
    /// What adds points, in an adaptive design.
    refinement: Option<Refinement>,
    /// Ranges of the parameters over all points.
    scales: Vec<f64>,
    /// Where shapes are kept; empty where they are not.
    surface: Surface,
    folder: Option<Folder>,
}

impl<'s> Run<'s> {
    /// Reads and checks everything before anything is computed. Collective.
    fn new(groups: Groups, study: &'s Study, output: Option<&Output>) -> Result<Run<'s>> {
        let (world, comm) = (&groups.world, &groups.own);
        let folder = open_folder(world, output)?;
        let subject = groups.agree(Subject::read(comm, study))?;
        let nominal = subject.nominal();
        let (structure, _) = groups.agree(subject.structure(comm, &nominal))?;
        structure.require_mass()?;
        // The root alone prints a warning.
        let band = world.agree(if world.is_root() { structure.band(study.band) } else { Ok([0.0; 2]) })?;
        let band = world.broadcast_value(0, band);
        let criterion = study.criterion.unwrap_or(structure.criterion());
        let distributions: Vec<&Distribution> = study.parameters.iter().map(|own| &own.distribution).collect();
        let design = study.design.points(&distributions, &nominal)?;
        let about = groups.agree(about(comm, &structure, output))?;
        let about = About { n_ranks: world.size(), band, criterion, ..about };
        let values: Vec<Vec<f64>> = [nominal].into_iter().chain(design).collect();
        // Shapes are kept in the folder.
        let surface = output.map_or_else(Surface::default, |_| structure.outer_surface(comm));
        let keeps_shapes = keeps_shapes(study.design.n_points(&distributions), surface.nodes.len());
        let surface = if keeps_shapes { surface } else { Surface::default() };
        let shapes = !surface.nodes.is_empty();
        let request = Request { band, criterion, follow: study.follow, gradients: false, shapes };
        let scales = scales(&values);
        let refinement = Refinement::new(study)?;
        Ok(Run { groups, study, subject, about, request, values, refinement, scales, surface, folder })
    }

    /// Solves the points, and writes the folder. Collective.
    fn run(mut self, output: Option<&ExploreOutput>, observer: &mut dyn Observer) -> Result<Exploration> {
        let place = output.map(|own| own.output.folder.as_path());
        let mut points = self.open(output.map(|own| &own.output))?;
        self.announce(&points, place, observer);
        let nominal = self.nominal(&mut points, observer)?;
        while self.has_next(&points, observer)? {
            let n_missing = |points: &Points| points.missing(self.values.len()).len();
            let n_before = n_missing(&points);
            self.round(&mut points, nominal.as_ref(), observer)?;
            self.stop_if_asked(&points, place, observer)?;
            require_progress(n_before, n_missing(&points))?;
        }
        self.about.n_dofs = self.groups.own.sum(points.n_own_dofs());
        let (done, gradients) = (points.all(), points.gradients.clone());
        let answers = Answers::new(self.study, &done, &gradients, self.request.band, self.request.criterion);
        let worst = answers.worst.map_or(Ok(None), |number| self.subject.model(&done[number].values))?;
        let (contacts, fields) = (self.subject.contacts(), self.subject.field_shares());
        let (about, surface, shapes) = (self.about, self.surface, Vec::new());
        let mut found =
            Exploration { about, points: done, gradients, answers, worst, contacts, fields, surface, shapes };
        self.groups.world.agree(match (self.folder.take(), output) {
            (Some(folder), Some(output)) => finish(folder, self.study, &mut found, output, &points),
            _ => Ok(()),
        })?;
        Ok(found)
    }

    /// Whether there is another point; where all so far are finished, an adaptive design may add some.
    fn has_next(&mut self, points: &Points, observer: &mut dyn Observer) -> Result<bool> {
        let is_finished = |n| points.missing(n).is_empty();
        while let Some(refinement) = self.refinement.as_mut().filter(|_| is_finished(self.values.len())) {
            let added = refinement.next(&points.all()[1..self.values.len()])?;
            if added.is_empty() {
                break;
            }
            added.iter().for_each(|_| observer.event(Event::Inserted));
            self.values.extend(added);
        }
        Ok(!is_finished(self.values.len()))
    }

    /// The points that an earlier run has finished. Collective.
    fn open(&self, output: Option<&Output>) -> Result<Points> {
        let (identity, force) = (self.identity(output), output.is_some_and(|output| output.force));
        let place = output.map(|output| output.folder.as_path());
        Points::open(&self.groups, self.folder.as_ref(), place, &identity, force)
    }

    /// All that the numbers depend on, by name; ranks and groups are none of it.
    fn identity(&self, output: Option<&Output>) -> Vec<(&'static str, String)> {
        let Study { parameters, fields, design, contacts, gradients, .. } = self.study;
        let study = format!("{:?}", (parameters, fields, design, self.request, contacts, gradients));
        let digest: String = Sha256::digest(study).iter().map(|byte| format!("{byte:02x}")).collect();
        let own = [
            ("SHA-256 of parameters and design", digest),
            ("band", format!("{:?}", self.request.band)),
            ("unstable", self.request.criterion.to_string()),
        ];
        let mut identity = identity("explore".to_owned(), own, output, &self.about);
        identity.retain(|(name, _)| *name != N_RANKS);
        identity
    }

    /// Reports what is known before anything is computed.
    fn announce(&self, points: &Points, place: Option<&Path>, observer: &mut dyn Observer) {
        let earlier = Earlier { n: points.iter().count(), unit: UNIT };
        announce(&self.about, self.values.len(), place, earlier, observer);
        let warnings = self.subject.warnings(&self.values);
        points.warnings.iter().chain(&warnings).for_each(|warning| observer.event(Event::Warning(warning)));
        for (number, point) in points.iter() {
            observer.event(Event::Point { number, point, is_replayed: true });
        }
    }

    /// Ends the work where a signal has asked any rank for it. Collective.
    fn stop_if_asked(&self, points: &Points, place: Option<&Path>, observer: &mut dyn Observer) -> Result<()> {
        let n_missing = points.missing(self.values.len()).len();
        let Some(signal) = stop_signal(&self.groups.world, observer).filter(|_| n_missing > 0) else {
            return Ok(());
        };
        let to = place.map_or_else(String::new, |place| format!(" to {}", place.display()));
        let n = self.values.len() - 1;
        let text = format!("stopped after {} of {n} points. The same command continues{to}", n - n_missing);
        Err(Error::Interrupted { signal, text })
    }
}

/// Writes the files of the folder, and gives it its name. Not collective.
fn finish(
    folder: Folder,
    study: &Study,
    found: &mut Exploration,
    output: &ExploreOutput,
    points: &Points,
) -> Result<()> {
    found.shapes = shapes_for_page(found, points)?;
    let place = output.output.folder.as_path();
    let document = Document::new(study, found, place);
    write(&folder, study, &document, found, &mut |number| points.shapes(number))?;
    let page = (output.page)(study, found)?;
    folder.write(PAGE, |out| out.write_all(page.as_bytes()))?;
    if let Some(worst) = &found.worst {
        let (mesh, band) = (mesh_from(place, &found.about.mesh), found.about.band);
        let text = standing_alone(&worst.text, &study.model, &mesh, band, study.criterion)?;
        let text = document.worst_head() + &with_tables(&text, &worst.tables)?;
        folder.write(WORST, |out| out.write_all(text.as_bytes()))?;
        for quantity in worst.quantities() {
            folder.write(quantity.file(), |out| write_tables(out, quantity, &worst.tables))?;
        }
    }
    folder.finish()
}

/// The shapes that matter most, as many as a page has. Not collective.
fn shapes_for_page(found: &Exploration, points: &Points) -> Result<Vec<PointShape>> {
    let n_nodes = found.surface.nodes.len();
    let mut places = by_weight(&found.points, &found.answers.instabilities);
    places.truncate(if n_nodes > 0 { n_on_page(n_nodes) } else { 0 });
    places.sort();
    let mut shapes = Vec::new();
    for own in places.chunk_by(|a, b| a.point == b.point) {
        let all = shaped_modes(found.points[own[0].point].modes().unwrap_or_default());
        let kept = all.into_iter().zip(points.shapes(own[0].point)?);
        shapes.extend(kept.filter_map(|(mode, shape)| {
            let place = *own.iter().find(|place| place.mode == mode)?;
            Some(PointShape { place, shape })
        }));
    }
    Ok(shapes)
}

/// The path of a mesh as a model file in a folder gives it: relative where both are known to the system.
fn mesh_from(folder: &Path, mesh: &str) -> String {
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (Ok(parent), Ok(mesh)) = (parent.canonicalize(), Path::new(mesh).canonicalize()) else {
        return mesh.to_owned();
    };
    let n_common = parent.iter().zip(mesh.iter()).take_while(|(a, b)| a == b).count();
    // One level more: the folder itself.
    let up = vec![".."; parent.iter().count() - n_common + 1];
    let down = mesh.iter().skip(n_common).map(|name| name.to_string_lossy().into_owned());
    up.into_iter().map(str::to_owned).chain(down).collect::<Vec<_>>().join("/")
}

/// Ranges of the parameters over all points; 1 where a parameter does not vary.
fn scales(values: &[Vec<f64>]) -> Vec<f64> {
    let range = |i: usize| {
        let own = || values.iter().map(|point| point[i]);
        own().fold(f64::NEG_INFINITY, f64::max) - own().fold(f64::INFINITY, f64::min)
    };
    (0..values[0].len()).map(range).map(|range| if range > 0.0 { range } else { 1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_found_from_the_folder_of_the_results() {
        let place = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(place.path().join("a/b")).unwrap();
        std::fs::create_dir_all(place.path().join("c")).unwrap();
        std::fs::write(place.path().join("a/brake.msh"), "").unwrap();
        let mesh = place.path().join("a/brake.msh").display().to_string();
        assert_eq!(mesh_from(&place.path().join("a/b/run"), &mesh), "../../brake.msh");
        assert_eq!(mesh_from(&place.path().join("c/run"), &mesh), "../../a/brake.msh");
        assert_eq!(mesh_from(&place.path().join("a/run"), &mesh), "../brake.msh");
        assert_eq!(mesh_from("run".as_ref(), "no/such.msh"), "no/such.msh");
    }

    #[test]
    fn scales_are_ranges() {
        assert_eq!(scales(&[vec![1.0, 5.0], vec![4.0, 5.0], vec![2.0, 5.0]]), [3.0, 1.0]);
    }
}
