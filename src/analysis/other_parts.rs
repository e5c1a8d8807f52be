//! Other moduli and densities that a super-element is made for: points of a study.

use std::path::Path;

use crate::explore::{Parameter, Study};
use crate::model::Model;
use crate::reduction::made_for::{MadeFor, PartRange};
use crate::reduction::part_change::PartChange;
use crate::reduction::super_element::Sample;
use crate::structure::FullModel;
use crate::{Error, Result};

use super::observer::{Event, Observer};
use super::part_keys::{PartKeys, samples};

/// Samples at most.
const MAX_SAMPLES: usize = 64;

/// The model with other parts.
pub(super) struct OtherModel {
    pub model: Model,
    /// What the parts are changed by.
    pub changes: Vec<(String, PartChange)>,
    /// What the study changes beside the parts.
    pub shared: SharedValues,
}

/// Values that no part has, of a study's point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SharedValues {
    /// Friction coefficient; none where the study has no such parameter.
    pub friction: Option<f64>,
    /// Factor on the loads.
    pub pressure: f64,
    /// Factor on the contact stiffness.
    pub contact_stiffness: f64,
}

impl SharedValues {
    /// Of a point of a study.
    ///
    /// # Errors
    /// [`Error::Input`] for values that no model can have.
    pub fn at(values: &[f64], parameters: &[Parameter]) -> Result<SharedValues> {
        let of = |key: &str| {
            parameters.iter().position(|parameter| parameter.shared_key() == Some(key)).map(|place| values[place])
        };
        let friction = of("friction");
        let [pressure, contact_stiffness] = ["pressure", "contact_stiffness"].map(|key| of(key).unwrap_or(1.0));
        if friction.is_some_and(|friction| friction < 0.0) || pressure <= 0.0 || contact_stiffness <= 0.0 {
            let friction = friction.map_or(String::new(), |friction| format!("friction {friction}, "));
            let what = format!("{friction}pressure {pressure}, contact stiffness {contact_stiffness}");
            return Err(Error::input(format!("{what}: friction is 0 or above, the factors are above 0")));
        }
        Ok(SharedValues { friction, pressure, contact_stiffness })
    }

    /// The state of the full model there; at a friction value where the study changes none.
    pub fn sample(&self, friction: f64) -> Sample {
        let SharedValues { pressure, contact_stiffness, .. } = *self;
        Sample { friction: self.friction.unwrap_or(friction), pressure, contact_stiffness }
    }
}

/// The models of samples.
#[derive(Default)]
pub(super) struct OtherParts {
    pub models: Vec<OtherModel>,
    /// Samples at least: one more than what a linear function of the parameters has as coefficients.
    pub min_samples: usize,
    /// Whether any of them has other moduli or densities.
    pub changes_matrices: bool,
    /// What should be known of the study.
    warnings: Vec<String>,
    study: String,
}

impl OtherParts {
    /// Those of a model by the parameters of a study of it, or of its super-element `place`; none where no parameter
    /// changes a part. Reports what should be known of the study.
    ///
    /// # Errors
    /// [`Error::Input`] for a model or a study that goes without samples, and for keys that a super-element cannot
    /// follow.
    pub fn of(
        model: &FullModel,
        study: Option<&Study>,
        place: &Path,
        observer: &mut dyn Observer,
    ) -> Result<OtherParts> {
        let Some(study) = study else { return Ok(OtherParts::default()) };
        if model.model.has_prestress() {
            let what =
                "--for does not go with prestress: the geometric stiffness of an equilibrium changes with its parts";
            return Err(Error::input(format!("{}: {what}", model.model.file.display())));
        }
        let Some(text) = model.own_text() else {
            let what = "--for changes numbers of a model file with a Gmsh mesh, and this is a deck or has one";
            return Err(Error::input(format!(
                "{}: {what}. Write it as one by squeal convert",
                model.model.file.display()
            )));
        };
        let file = &model.model.file;
        let mut others = OtherParts::by(text, file, study)?;
        if !is_same(&study.model, file) && !is_same(&study.model, place) {
            let (of, file) = (study.model.display(), file.display());
            others.warnings.push(format!("{}: its model is {of}, and this is {file}", study.file.display()));
        }
        others.warnings.iter().for_each(|warning| observer.event(Event::Warning(warning)));
        Ok(others)
    }

    fn by(text: &str, file: &Path, study: &Study) -> Result<OtherParts> {
        study.require_no_fields()?;
        let in_study = |error: Error| Error::input(format!("{}: {error}", study.file.display()));
        let Some(keys) = PartKeys::new(text, file, &study.parameters).map_err(in_study)? else {
            let what = "no parameter changes a modulus, a density or the damping of a part: there are no samples";
            let warnings = vec![format!("{}: {what}", study.file.display())];
            return Ok(OtherParts { warnings, ..OtherParts::default() });
        };
        Ok(OtherParts {
            models: samples(&keys, study, MAX_SAMPLES).map_err(in_study)?,
            min_samples: keys.n_parameters() + 2,
            changes_matrices: keys.changes_matrices,
            warnings: Vec::new(),
            study: study.file.display().to_string(),
        })
    }

    /// The first ones.
    pub fn first(&self, n: usize) -> &[OtherModel] {
        self.after(0, n)
    }

    /// So many after the first ones.
    pub fn after(&self, first: usize, n: usize) -> &[OtherModel] {
        let first = first.min(self.models.len());
        &self.models[first..(first + n).min(self.models.len())]
    }

    /// What a super-element is made for, with what its samples found; none where there are none.
    pub fn made_for(self, found: MadeFor) -> Option<MadeFor> {
        let parts = PartRange::over(self.first(found.n_samples).iter().map(|own| &own.changes[..]));
        (found.n_samples > 0).then_some(MadeFor { study: self.study, parts, ..found })
    }
}

/// Whether two paths are of one file.
fn is_same(a: &Path, b: &Path) -> bool {
    let whole = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).ok();
    whole(a) == whole(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore;

    const FILE: &str = "tests/data/pads_on_disc.toml";

    fn by(parameters: &str) -> OtherParts {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("for.toml");
        std::fs::write(&file, format!("model = \"a.toml\"\n[design]\nkind = \"grid\"\n{parameters}")).unwrap();
        let text = std::fs::read_to_string(FILE).unwrap();
        OtherParts::by(&text, FILE.as_ref(), &explore::read(&file).unwrap()).unwrap()
    }

    #[test]
    fn a_study_that_changes_no_part_has_a_warning_and_no_samples() {
        let others = by("[parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.5]\n");
        assert!(others.models.is_empty() && others.warnings[0].contains("for.toml: no parameter changes"));
        assert_eq!(others.made_for(MadeFor::default()), None);
    }

    #[test]
    fn ranges_are_those_of_the_samples_taken() {
        let others = by("[parameter.E]\nkey = \"material.lining.young\"\nfactor = true\nuniform = [0.7, 1.4]\n");
        assert!(others.warnings.is_empty() && others.changes_matrices);
        assert_eq!((others.models.len(), others.min_samples), (MAX_SAMPLES, 3));
        let factor =
            |own: &OtherModel| own.changes.iter().find(|(part, _)| part == "lining_inner").unwrap().1.stiffness;
        let factors: Vec<f64> = others.first(3).iter().map(factor).chain([1.0]).collect();
        let range = [f64::INFINITY, f64::NEG_INFINITY];
        let range = factors.iter().fold(range, |[from, to], &own| [from.min(own), to.max(own)]);
        let made_for = others.made_for(MadeFor { n_samples: 3, ..MadeFor::default() }).unwrap();
        assert_eq!((made_for.parts.len(), made_for.parts[0].stiffness), (2, range));
    }

    #[test]
    fn a_point_has_values_beside_those_of_its_parts() {
        let text = |key: &str| format!("[parameter.{key}]\nkey = \"{key}\"\nuniform = [0.2, 0.5]\n");
        let lining = "[parameter.E]\nkey = \"material.lining.young\"\nfactor = true\nuniform = [0.7, 1.4]\n";
        let shared = |keys: &str| by(&format!("{keys}{lining}")).models[0].shared;
        let none = shared("");
        assert_eq!(none, SharedValues { friction: None, pressure: 1.0, contact_stiffness: 1.0 });
        assert_eq!(none.sample(0.7), Sample::at(0.7));
        let all = shared(&["friction", "pressure", "contact_stiffness"].map(text).concat()).sample(0.7);
        let Sample { friction, pressure, contact_stiffness } = all;
        assert!([friction, pressure, contact_stiffness].iter().all(|value| (0.2..0.5).contains(value)), "{all:?}");
    }

    #[test]
    fn no_model_has_a_negative_friction_coefficient() {
        let study = by("[parameter.mu]\nkey = \"friction\"\nuniform = [-1, 0.5]\n[parameter.E]\n\
                        key = \"material.lining.young\"\nfactor = true\nuniform = [0.7, 1.4]\n");
        assert!(study.models.len() < MAX_SAMPLES && study.models.iter().all(|own| own.shared.friction >= Some(0.0)));
    }

    #[test]
    fn a_file_has_several_paths() {
        assert!(is_same("tests/data/../data/pads_on_disc.toml".as_ref(), FILE.as_ref()));
        assert!(is_same("./none.se.h5".as_ref(), "none.se.h5".as_ref()));
        assert!(!is_same("none.se.h5".as_ref(), FILE.as_ref()));
    }
}
