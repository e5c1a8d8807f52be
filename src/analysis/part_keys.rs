//! Parameters of a study that change the parts of a super-element.
//!
//! The text of the model file with the values of a point is read, and compared with the text as it is; what differs has
//! to be factors of the matrices of parts ([`crate::reduction::part_change`]).

use std::path::Path;

use crate::explore::{Design, DesignKind, Distribution, Nominal, Parameter, Study, Template};
use crate::model::{self, Model};
use crate::reduction::made_for::PartRange;
use crate::reduction::part_change::{PartChange, part_changes};
use crate::{Error, Result};

use super::other_parts::{OtherModel, SharedValues};

/// What of a model file a super-element can follow.
const FOLLOWED: &str = "friction, pressure, contact_stiffness and, of the model file, density, loss_factor and all \
                        moduli of a material by one factor, and the rayleigh of parts";
/// A key is tried with this factor on its nominal value.
const TRIAL: f64 = 1.01;

/// The parameters that change parts.
pub struct PartKeys {
    /// The model file with these parameters alone.
    template: Template,
    /// Their places among all parameters.
    places: Vec<usize>,
    /// The model as it is.
    own: Model,
    /// Whether any of them changes a modulus or a density.
    pub changes_matrices: bool,
}

impl PartKeys {
    /// Of the parameters of a study that super-elements do not have without a model file; none where there is none.
    ///
    /// # Errors
    /// [`Error::Input`] for keys that are not in the text, and for those that a super-element cannot follow.
    pub fn new(text: &str, file: &Path, parameters: &[Parameter]) -> Result<Option<PartKeys>> {
        let places: Vec<usize> = (0..parameters.len()).filter(|&i| parameters[i].shared_key().is_none()).collect();
        if places.is_empty() {
            return Ok(None);
        }
        let parsed = model::parse(text, file)?;
        let nominal = Nominal { model: &parsed, swept: &[] };
        // All texts come of a template, which takes the sweep out: the lines of what stands below it agree.
        let own = model::parse(&Template::new(text, &[], nominal)?.text(&[], None, file)?, file)?;
        let trials = places.iter().map(|&place| trial(text, nominal, &own, &parameters[place]));
        let trials = trials.collect::<Result<Vec<_>>>()?;
        let changes_matrices = trials.iter().flatten().any(|(_, change)| change.changes_matrices());
        let of_parts: Vec<Parameter> = places.iter().map(|&place| parameters[place].clone()).collect();
        Ok(Some(PartKeys { template: Template::new(text, &of_parts, nominal)?, places, own, changes_matrices }))
    }

    /// Number of the parameters.
    pub fn n_parameters(&self) -> usize {
        self.places.len()
    }

    /// Puts the values of the model file into those of all parameters.
    pub fn set_nominal(&self, values: &mut [f64]) {
        self.places.iter().zip(self.template.nominal()).for_each(|(&place, own)| values[place] = own);
    }

    /// The model as it is.
    pub fn own(&self) -> &Model {
        &self.own
    }

    /// The model at a point, given the values of all parameters.
    ///
    /// # Errors
    /// [`Error::Input`] where the model cannot have these values.
    pub fn model(&self, values: &[f64]) -> Result<Model> {
        let own: Vec<f64> = self.places.iter().map(|&place| values[place]).collect();
        model::parse(&self.template.text(&own, None, &self.own.file)?, &self.own.file)
    }

    /// What a point changes in the parts.
    ///
    /// # Errors
    /// [`Error::Input`] where the model cannot have these values.
    pub fn changes(&self, values: &[f64]) -> Result<Vec<(String, PartChange)>> {
        part_changes(&self.own, &self.model(values)?)
    }

    /// The model at a point of a study; none that no model can have.
    fn other(&self, values: &[f64], parameters: &[Parameter]) -> Option<OtherModel> {
        let model = self.model(values).ok()?;
        let changes = part_changes(&self.own, &model).ok()?;
        Some(OtherModel { changes, model, shared: SharedValues::at(values, parameters).ok()? })
    }

    /// The ranges of factors on parts over points; those of parts that do not change are left out.
    pub fn ranges(&self, points: &[Vec<f64>]) -> Vec<PartRange> {
        // Points that no model can have are left to the study.
        let changes: Vec<_> = points.iter().filter_map(|values| self.changes(values).ok()).collect();
        PartRange::over(changes.iter().map(Vec::as_slice))
    }
}

/// The models of the first points of a Sobol sequence over the parameters of a study, more of them near the ends of the
/// distributions than points of the study, as Chebyshev's are; points that no model can have are left out.
///
/// # Errors
/// [`Error::Input`] where there are no such points.
pub(super) fn samples(keys: &PartKeys, study: &Study, n_points: usize) -> Result<Vec<OtherModel>> {
    let parameters = &study.parameters;
    let kind = DesignKind::Sobol { n_points };
    let design = Design { kind, seed: 0, correlation: study.design.correlation.clone() };
    let unit = Distribution::Uniform { from: 0.0, to: 1.0 };
    let points = design.points(&vec![&unit; parameters.len()], &[])?;
    let value = |(own, &v): (&Parameter, &f64)| own.distribution.quantile(spread(v));
    let values = |point: &Vec<f64>| parameters.iter().zip(point).map(value).collect::<Vec<f64>>();
    Ok(points.iter().filter_map(|point| keys.other(&values(point), parameters)).collect())
}

/// The smallest and the largest value of a parameter at samples.
pub(super) fn sampled_range(parameter: &Parameter) -> [f64; 2] {
    [0.0, 1.0].map(|v| parameter.distribution.quantile(spread(v)))
}

/// The probability of a smaller value: `sin^2(pi/2 (0.05 + 0.9 v))`, 0.6 % at v = 0 and 99.4 % at v = 1.
fn spread(v: f64) -> f64 {
    (std::f64::consts::FRAC_PI_2 * (0.05 + 0.9 * v)).sin().powi(2)
}

/// What one other value of a parameter changes; refuses what is more than factors of parts.
fn trial(text: &str, nominal: Nominal, own: &Model, parameter: &Parameter) -> Result<Vec<(String, PartChange)>> {
    let template = Template::new(text, std::slice::from_ref(parameter), nominal)?;
    let value = match template.nominal()[0] {
        0.0 => parameter.distribution.quantile(0.5),
        value => TRIAL * value,
    };
    let changed = template.text(&[value], None, &own.file).and_then(|text| model::parse(&text, &own.file));
    changed.and_then(|changed| part_changes(own, &changed)).map_err(|reason| {
        let key = parameter.keys[0].text();
        let what = format!("parameter {:?}: a super-element cannot follow the key {key}: {reason}", parameter.name);
        Error::input(format!("{what}. It can follow {FOLLOWED}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::KeyPath;

    const FILE: &str = "tests/data/pads_on_disc.toml";

    fn parameter(name: &str, key: &str, is_factor: bool) -> Parameter {
        let distribution = Distribution::Uniform { from: 0.7, to: 1.4 };
        Parameter { name: name.into(), keys: vec![KeyPath::parse(key).unwrap()], is_factor, distribution }
    }

    fn keys(parameters: &[Parameter]) -> Result<Option<PartKeys>> {
        PartKeys::new(&std::fs::read_to_string(FILE).unwrap(), FILE.as_ref(), parameters)
    }

    #[test]
    fn keys_of_parts_stand_between_those_of_all_super_elements() {
        let parameters = [
            parameter("mu", "friction", false),
            parameter("E", "material.lining.young", true),
            parameter("p", "pressure", false),
            parameter("rho", "material.iron.density", false),
        ];
        assert!(keys(&parameters[..1]).unwrap().is_none());
        let keys = keys(&parameters).unwrap().unwrap();
        let mut values = vec![0.4, 1.0, 1.0, 1.0];
        keys.set_nominal(&mut values);
        assert_eq!(values, [0.4, 1.0, 1.0, 7100.0]);
        let changes = keys.changes(&[0.3, 0.5, 2.0, 3550.0]).unwrap();
        let of = |name: &str| changes.iter().find(|(own, _)| own == name).unwrap().1;
        assert!((of("lining_outer").stiffness - 0.5).abs() < 1e-15 && of("lining_outer").mass == 1.0);
        assert_eq!((of("disc").stiffness, of("disc").mass), (1.0, 0.5));
    }

    #[test]
    fn a_key_that_is_more_than_factors_of_parts_is_refused() {
        for key in ["load.*.force", "contact.*.law.linear", "material.iron.poisson", "rotation.disc.speed"] {
            let message = keys(&[parameter("x", key, true)]).err().unwrap().to_string();
            assert!(message.contains(&format!("cannot follow the key {key}")), "{message}");
            assert!(message.contains("It can follow friction, pressure"), "{message}");
        }
    }

    fn study(parameter: &str) -> Study {
        let text = format!("model = \"a.se.h5\"\n[design]\nkind = \"grid\"\n[parameter.x]\n{parameter}\n");
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("for.toml"), text).unwrap();
        crate::explore::read(&place.path().join("for.toml")).unwrap()
    }

    fn samples_of(study: &Study) -> Vec<OtherModel> {
        samples(&keys(&study.parameters).unwrap().unwrap(), study, 5).unwrap()
    }

    #[test]
    fn samples_are_spread_over_the_ranges_of_their_parts() {
        let models = samples_of(&study("key = \"material.lining.young\"\nfactor = true\nuniform = [0.7, 1.4]"));
        let ranges = PartRange::over(models.iter().map(|own| &own.changes[..]));
        assert_eq!((models.len(), ranges.len()), (5, 2), "two linings");
        assert!(ranges.iter().all(|range| range.stiffness[0] < 0.9 && range.stiffness[1] > 1.2), "{ranges:?}");
        assert!(ranges.iter().all(|range| range.mass == [1.0, 1.0]));
    }

    /// The ends of the distributions have more samples than points of a study.
    #[test]
    fn samples_are_denser_near_the_ends() {
        let near_the_ends = (0..1000).filter(|&i| (spread(i as f64 / 999.0) - 0.5).abs() > 0.4).count();
        assert!((340..380).contains(&near_the_ends), "{near_the_ends} of 1000, of a study 200");
        assert!((spread(0.0) - 0.006_156).abs() < 1e-6 && (spread(1.0) - 0.993_844).abs() < 1e-6);
        assert!((spread(0.5) - 0.5).abs() < 1e-15);
    }

    /// Densities below zero are no model's.
    #[test]
    fn points_that_no_model_can_have_are_no_samples() {
        let n = samples_of(&study("key = \"material.iron.density\"\nfactor = true\nuniform = [-1, 1]")).len();
        assert!((1..5).contains(&n), "{n}");
    }

    #[test]
    fn damping_alone_changes_no_matrices_of_parts() {
        let changes = |key, is_factor| keys(&[parameter("x", key, is_factor)]).unwrap().unwrap().changes_matrices;
        assert!(changes("material.lining.young", true) && changes("material.iron.density", true));
        let damped = std::fs::read_to_string(FILE).unwrap();
        let damped = damped.replace("[part.disc]", "[part.disc]\nrayleigh = { alpha = 1, beta = 0 }");
        let of_damping = [parameter("x", "part.disc.rayleigh.alpha", true)];
        assert!(!PartKeys::new(&damped, FILE.as_ref(), &of_damping).unwrap().unwrap().changes_matrices);
    }
}
