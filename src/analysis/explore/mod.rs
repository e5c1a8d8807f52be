//! Modes at points of many parameters.
//!
//! The nominal point is the first one; then come the points of the design, each with a system and factors of its own,
//! so that a point depends on nothing but its values and the state that it starts from: an equilibrium nearby. So a
//! study that was interrupted ends with the same numbers.

mod checkpoint;
mod gradients;
mod point;
mod subject;

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::explore::{Answers, Distribution, Outcome, PointResult, Refinement, Study, standing_alone};
use crate::hdf::is_hdf5;
use crate::native::Comm;
use crate::output::explore::{Document, PAGE, WORST, write};
use crate::output::folder::Folder;
use crate::results::{About, Exploration};
use crate::{Error, Result};

use super::observer::{Event, Observer, stop_signal};
use super::start::{Output, about, announce, identity};

use checkpoint::Points;
use point::{NominalModes, Request, is_of_point, solve};
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
/// and the influence of each parameter. A point that fails is recorded with its reason. With `output` the study is
/// written to a folder, and continues where an earlier run has ended. Only the root gets the result. Collective.
///
/// ```no_run
/// use squeal::analysis::explore;
///
/// let comm = squeal::Session::start(&[])?;
/// let study = squeal::explore::read("explore.toml".as_ref())?;
/// let found = explore(&comm, &study, None, &mut ())?.expect("this is the root");
/// println!("unstable with a probability of {:.2}", found.answers.unstable.value);
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for a study, model or folder that cannot be used; [`Error::Interrupted`]; the system's.
pub fn explore(
    comm: &Comm,
    study: &Study,
    output: Option<&ExploreOutput>,
    observer: &mut dyn Observer,
) -> Result<Option<Exploration>> {
    let found = Run::new(comm, study, output.map(|own| &own.output))?.run(output, observer)?;
    Ok(comm.is_root().then_some(found))
}

/// Displacements are kept of so many bytes.
const STATES_BYTES: usize = 1 << 30;
/// Displacements are kept of at most so many points.
const MAX_STATES: usize = 1000;

/// A point with this rank's displacements.
type Solved = (PointResult, Option<Vec<f64>>);

/// A study under way.
struct Run<'s> {
    /// All ranks.
    world: Comm,
    /// The ranks of a point: all of them, or each alone where the study is of a super-element, whose few dofs are not
    /// worth sharing.
    comm: Comm,
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
    folder: Option<Folder>,
}

impl<'s> Run<'s> {
    /// Reads and checks everything before anything is computed. Collective.
    fn new(world: &Comm, study: &'s Study, output: Option<&Output>) -> Result<Run<'s>> {
        let open = |output: &Output| Folder::open(&output.folder, output.force).map(Some);
        let folder = world.agree(output.filter(|_| world.is_root()).map_or(Ok(None), open))?;
        let comm = if is_hdf5(&study.model) { world.alone() } else { world.clone() };
        let subject = world.agree(Subject::read(&comm, study))?;
        let nominal = subject.nominal();
        let (structure, _) = subject.structure(&comm, &nominal)?;
        structure.require_mass()?;
        // The root alone prints a warning.
        let band = world.agree(if world.is_root() { structure.band(study.band) } else { Ok([0.0; 2]) })?;
        let band = world.broadcast_value(0, band);
        let criterion = study.criterion.unwrap_or(structure.criterion());
        let distributions: Vec<&Distribution> = study.parameters.iter().map(|own| &own.distribution).collect();
        let design = study.design.points(&distributions, &nominal)?;
        let about = About { n_ranks: world.size(), band, criterion, ..about(&comm, &structure, output)? };
        let values: Vec<Vec<f64>> = [nominal].into_iter().chain(design).collect();
        let request = Request { band, criterion, follow: study.follow, gradients: study.gradients };
        let scales = scales(&values);
        let refinement = Refinement::new(study)?;
        Ok(Run { world: world.clone(), comm, study, subject, about, request, values, refinement, scales, folder })
    }

    /// Solves the points, and writes the folder. Collective.
    fn run(mut self, output: Option<&ExploreOutput>, observer: &mut dyn Observer) -> Result<Exploration> {
        let place = output.map(|own| own.output.folder.as_path());
        let (mut points, mut nominal) = self.open(output.map(|own| &own.output))?;
        self.announce(&points, place, observer);
        while self.has_next(&points, observer)? {
            for (point, state) in self.next(&mut points, &mut nominal, observer)? {
                let n_dofs = self.comm.sum(state.as_ref().map_or(0, Vec::len));
                let room = (STATES_BYTES / 8 / n_dofs.max(1)).clamp(1, MAX_STATES);
                let number = points.done.len();
                points.commit(point, state.filter(|_| points.n_states() < room))?;
                self.folder.iter().for_each(Folder::keep);
                observer.event(Event::Point { number, point: &points.done[number], is_replayed: false });
            }
            self.stop_if_asked(points.done.len() - 1, place, observer)?;
        }
        self.about.n_dofs = self.comm.sum(points.n_own_dofs());
        let answers = Answers::new(self.study, &points.done, &points.gradients, self.request.band);
        let worst = answers.worst.map_or(Ok(None), |number| self.subject.text(&points.done[number].values))?;
        let Points { done, gradients, .. } = points;
        let found = Exploration { about: self.about, points: done, gradients, answers, worst };
        self.world.agree(match (self.folder.take(), output) {
            (Some(folder), Some(output)) => finish(folder, self.study, &found, output),
            _ => Ok(()),
        })?;
        Ok(found)
    }

    /// Whether there is another point; where all so far are finished, an adaptive design may add some.
    fn has_next(&mut self, points: &Points, observer: &mut dyn Observer) -> Result<bool> {
        while let Some(refinement) = self.refinement.as_mut().filter(|_| points.done.len() >= self.values.len()) {
            let added = refinement.next(&points.done[1..self.values.len()])?;
            if added.is_empty() {
                break;
            }
            added.iter().for_each(|_| observer.event(Event::Inserted));
            self.values.extend(added);
        }
        Ok(points.done.len() < self.values.len())
    }

    /// The points that an earlier run has finished, and its nominal modes, on all ranks. Collective.
    fn open(&self, output: Option<&Output>) -> Result<(Points, Option<NominalModes>)> {
        let (identity, force) = (self.identity(output), output.is_some_and(|output| output.force));
        // A rank alone does not write.
        let is_writer = self.world.is_root() || !self.is_divided();
        let place = output.filter(|_| is_writer).map(|output| output.folder.as_path());
        let mut points = self.world.agree(Points::open(&self.comm, self.folder.as_ref(), place, &identity, force))?;
        let mut nominal = self.world.agree(points.nominal())?;
        if self.is_divided() {
            points.share(&self.world);
            nominal = NominalModes::shared(&self.world, &self.comm, nominal);
        }
        Ok((points, nominal))
    }

    /// Whether each rank has points of its own.
    fn is_divided(&self) -> bool {
        self.comm.size() < self.world.size()
    }

    /// Solves the next points: one, or one for each rank where each rank has points of its own. All ranks need the
    /// nominal point, and each solves it. Collective.
    fn next(
        &self,
        points: &mut Points,
        nominal: &mut Option<NominalModes>,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Solved>> {
        let first = points.done.len();
        if first == 0 || !self.is_divided() {
            let solved = self.point(first, points, nominal, observer);
            return Ok(vec![if self.is_divided() { self.world.agree(solved)? } else { solved? }]);
        }
        let own = first + self.world.rank();
        let solved = (own < self.values.len()).then(|| self.point(own, points, nominal, observer));
        let solved = self.world.agree(solved.transpose())?;
        Ok(self.world.join_values(solved).into_iter().flatten().collect())
    }

    /// Solves one point; what fails is its result. Collective.
    fn point(
        &self,
        number: usize,
        points: &mut Points,
        nominal: &mut Option<NominalModes>,
        observer: &mut dyn Observer,
    ) -> Result<Solved> {
        let values = self.values[number].clone();
        let start = points.nearest(&values, &self.scales);
        let found = self.subject.structure(&self.comm, &values).and_then(|(structure, friction)| {
            let brake = (&structure, friction);
            solve(&self.comm, brake, &self.request, start, nominal.as_ref(), observer)
        });
        match found {
            Ok(found) => {
                if number == 0 {
                    let vectors = found.vectors.as_ref();
                    let gradients =
                        vectors.map(|own| self.gradients(own, &found.displacements, observer)).transpose()?;
                    gradients.map_or(Ok(()), |gradients| points.keep_gradients(gradients))?;
                    found.nominal.iter().try_for_each(|modes| points.keep_nominal(modes))?;
                    *nominal = found.nominal;
                }
                let outcome = Outcome::Modes(found.modes);
                Ok((PointResult { values, outcome }, Some(found.displacements)))
            }
            Err(error) if is_of_point(&self.comm, &error) => {
                // A reason is the same on all ranks.
                let reason = self.comm.broadcast_value(0, error.to_string());
                Ok((PointResult { values, outcome: Outcome::Failed(reason) }, None))
            }
            Err(error) => Err(error),
        }
    }

    /// All that the numbers depend on, by name.
    fn identity(&self, output: Option<&Output>) -> Vec<(&'static str, String)> {
        let study = format!("{:?}", (&self.study.parameters, &self.study.design, self.request, self.study.contacts));
        let digest: String = Sha256::digest(study).iter().map(|byte| format!("{byte:02x}")).collect();
        let own = [
            ("SHA-256 of parameters and design", digest),
            ("band", format!("{:?}", self.request.band)),
            ("unstable", self.request.criterion.to_string()),
        ];
        identity("explore".to_owned(), own, output, &self.about)
    }

    /// Reports what is known before anything is computed.
    fn announce(&self, points: &Points, place: Option<&Path>, observer: &mut dyn Observer) {
        announce(&self.about, self.values.len(), place, points.done.len(), observer);
        for (number, point) in points.done.iter().enumerate() {
            observer.event(Event::Point { number, point, is_replayed: true });
        }
    }

    /// Ends the work where a signal has asked any rank for it. Collective.
    fn stop_if_asked(&self, number: usize, place: Option<&Path>, observer: &mut dyn Observer) -> Result<()> {
        let Some(signal) = stop_signal(&self.world, observer).filter(|_| number + 1 < self.values.len()) else {
            return Ok(());
        };
        let to = place.map_or_else(String::new, |place| format!(" to {}", place.display()));
        let text = format!("stopped after point {number} of {}. The same command continues{to}", self.values.len() - 1);
        Err(Error::Interrupted { signal, text })
    }
}

/// Writes the files of the folder, and gives it its name. Not collective.
fn finish(folder: Folder, study: &Study, found: &Exploration, output: &ExploreOutput) -> Result<()> {
    let place = output.output.folder.as_path();
    let document = Document::new(study, found, place);
    write(&folder, study, &document, found)?;
    let page = (output.page)(study, found)?;
    folder.write(PAGE, |out| out.write_all(page.as_bytes()))?;
    if let Some(worst) = &found.worst {
        let text = document.worst_head()
            + &standing_alone(worst, &study.model, &mesh_from(place, &found.about.mesh), found.about.band)?;
        folder.write(WORST, |out| out.write_all(text.as_bytes()))?;
    }
    folder.finish()
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
