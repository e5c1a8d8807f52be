//! A super-element whose numbers a study changes.
//!
//! Friction, loads and contact stiffness are those of the options of `squeal stability`. All other keys are those of
//! the model file, whose text the super-element has ([`PartKeys`]).

use std::path::Path;
use std::rc::Rc;

use crate::algebra::span;
use crate::analysis::other_parts::SharedValues;
use crate::analysis::part_keys::PartKeys;
use crate::explore::{Nominal, Parameter, Study, Template, standing_alone};
use crate::model::names;
use crate::reduction::file;
use crate::reduction::made_for::{MadeFor, PartRange};
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{Sample, SuperElement};
use crate::structure::{ReducedModel, StructureOptions};
use crate::{Error, Result};

/// Keys that a super-element has without a model file.
const KEYS: [&str; 3] = ["friction", "pressure", "contact_stiffness"];
/// Friction coefficients may lie this far outside those at which a Galerkin super-element has modes without a warning.
const FRICTION_MARGIN: f64 = 0.05;

/// A super-element, the parameters of a study, and the model file for those that change its parts.
pub struct ReducedSubject<'s> {
    place: &'s Path,
    element: SuperElement,
    surface: Rc<OuterSurface>,
    parameters: &'s [Parameter],
    parts: Option<PartKeys>,
}

impl<'s> ReducedSubject<'s> {
    /// Reads the super-element of a study, and finds what its parameters change.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that cannot be used, and for keys that a super-element cannot follow.
    pub fn read(study: &'s Study) -> Result<ReducedSubject<'s>> {
        if study.contacts.is_some() {
            let what = "a super-element has its contacts already; contacts is for models";
            return Err(Error::input(format!("{}: {what}", study.file.display())));
        }
        study.require_no_fields()?;
        let (element, surface) = file::read(&study.model)?;
        ReducedSubject::of(study, element, surface)
    }

    fn of(study: &'s Study, element: SuperElement, surface: OuterSurface) -> Result<ReducedSubject<'s>> {
        let in_study = |error: Error| Error::input(format!("{}: {error}", study.file.display()));
        let parts = part_keys(&element, &study.parameters).map_err(in_study)?;
        if parts.as_ref().is_some_and(|parts| parts.changes_matrices) {
            element.require_no_prestress().map_err(in_study)?;
        }
        Ok(ReducedSubject {
            place: &study.model,
            element,
            surface: Rc::new(surface),
            parameters: &study.parameters,
            parts,
        })
    }

    /// The parameters' values that the super-element was made with.
    pub fn nominal(&self) -> Vec<f64> {
        let of = |parameter: &Parameter| match parameter.shared_key() {
            Some("friction") => self.element.origin.friction,
            _ => 1.0,
        };
        let mut values: Vec<f64> = self.parameters.iter().map(of).collect();
        if let Some(parts) = &self.parts {
            parts.set_nominal(&mut values);
        }
        values
    }

    /// The super-element at a point, and its friction coefficient there.
    ///
    /// # Errors
    /// [`Error::Input`] where it cannot have these values.
    pub fn structure(&self, values: &[f64]) -> Result<(ReducedModel, f64)> {
        let Sample { friction, pressure, contact_stiffness } = self.sample(values)?;
        let mut element = self.element.clone();
        for (part, change) in self.parts.as_ref().map_or(Ok(Vec::new()), |parts| parts.changes(values))? {
            element.change_part(&part, &change)?;
        }
        let options = StructureOptions { load_factor: pressure, contact_stiffness, ..StructureOptions::default() };
        Ok((ReducedModel::with(self.place, element, self.surface.clone(), &options)?, friction))
    }

    /// Where the samples of the super-element did not agree, and what points have far outside the friction
    /// coefficients, moduli and densities that it is made for: a line for friction and for each part.
    pub fn warnings(&self, points: &[Vec<f64>]) -> Vec<String> {
        let friction: Vec<f64> = points.iter().filter_map(|own| Some(self.sample(own).ok()?.friction)).collect();
        let friction = friction_warning(&self.element.origin.samples, &friction);
        friction.into_iter().chain(self.part_warnings(points)).collect()
    }

    fn part_warnings(&self, points: &[Vec<f64>]) -> Vec<String> {
        let Some(parts) = &self.parts else { return Vec::new() };
        let made_for = self.element.origin.made_for.as_ref();
        let made = made_for.map_or(&[][..], |own| &own.parts);
        let own = |part: &str| made.iter().find(|own| own.part == part).cloned();
        let line = |range: PartRange| {
            let own = own(&range.part).unwrap_or(PartRange::nominal(&range.part));
            range.is_far_outside(&own).then(|| outside(&range, &own))
        };
        let samples = made_for.and_then(MadeFor::warning);
        samples.into_iter().chain(parts.ranges(points).into_iter().filter_map(line)).collect()
    }

    /// Reference pairs of its layout; a Galerkin super-element has all contact points.
    pub fn contacts(&self) -> Option<usize> {
        (!self.element.is_galerkin()).then_some(self.element.contacts.len())
    }

    /// The text of the model file at a point, as it stands beside the super-element's; none where no part changes.
    ///
    /// # Errors
    /// [`Error::Input`] where the model cannot have these values.
    pub fn text(&self, values: &[f64]) -> Result<Option<String>> {
        let (Some(parts), Some(own)) = (&self.parts, &self.element.model_text) else { return Ok(None) };
        let swept = self.element.pairs.iter().filter(|pair| pair.swept).map(|pair| pair.name.clone());
        let swept: Vec<String> = swept.collect();
        let (file, origin) = (&parts.own().file, &self.element.origin);
        let template = Template::new(own, self.parameters, Nominal { model: parts.own(), swept: &swept })?;
        let text = template.text(values, Some(self.sample(values)?.friction), file)?;
        standing_alone(&text, file, &origin.mesh, origin.band, None).map(Some)
    }

    /// What a point changes beside the parts.
    fn sample(&self, values: &[f64]) -> Result<Sample> {
        Ok(SharedValues::at(values, self.parameters)?.sample(self.element.origin.friction))
    }
}

/// What is wrong where points have friction coefficients beyond those at which a Galerkin super-element has modes.
fn friction_warning(samples: &[Sample], points: &[f64]) -> Option<String> {
    let [from, to] = span(samples.iter().map(|sample| sample.friction));
    let [low, high] = span(points.iter().copied());
    let is_outside = from <= to && (low < from - FRICTION_MARGIN || high > to + FRICTION_MARGIN);
    is_outside.then(|| {
        format!(
            "friction coefficients of the study: {low:.3} to {high:.3}; the super-element has modes of the full model \
             from {from:.3} to {to:.3}. Modes outside are less exact: make one by `squeal reduce --galerkin` with \
             --samples or --for"
        )
    })
}

fn outside(range: &PartRange, own: &PartRange) -> String {
    let text = |[from, to]: [f64; 2]| format!("{from:.3} to {to:.3}");
    let factors = |range: &PartRange| format!("stiffness {} and mass {}", text(range.stiffness), text(range.mass));
    format!(
        "factors of the study on the part {:?}: {}; the super-element is made for {}. Modes far outside are less exact: \
         make one by `squeal reduce --for` with this study",
        range.part,
        factors(range),
        factors(own)
    )
}

/// The parameters that change parts; none where there is none.
fn part_keys(element: &SuperElement, parameters: &[Parameter]) -> Result<Option<PartKeys>> {
    let Some(first) = parameters.iter().find(|parameter| parameter.shared_key().is_none()) else { return Ok(None) };
    let text = element.model_text.as_deref().ok_or_else(|| unknown(first))?;
    PartKeys::new(text, Path::new(&element.origin.model), parameters)
}

/// A key of a super-element that has no model file.
fn unknown(parameter: &Parameter) -> Error {
    let text = parameter.keys.first().map_or("", |key| key.text());
    let what = format!(
        "parameter {:?}: this super-element has no key {text:?}, as its file has no model file",
        parameter.name
    );
    let advice = "One that `squeal reduce` makes of a model file with a Gmsh mesh has those of its parts, too";
    Error::input(format!("{what}. {} {advice}", names::advice(text, KEYS)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::{self, KeyPath};
    use crate::native::Mck;
    use crate::reduction::parts::MatricesByPart;
    use crate::reduction::testing;

    fn study(key: &str) -> Study {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("soft.toml");
        let text =
            "model = \"a.se.h5\"\n[design]\nkind = \"grid\"\n[parameter.x]\nfactor = true\nuniform = [0.9, 1.1]\n";
        std::fs::write(&file, format!("{text}key = \"{key}\"\n")).unwrap();
        explore::read(&file).unwrap()
    }

    fn element(text: Option<&str>) -> SuperElement {
        let rest = Mck { m: vec![1.0], c: vec![0.0], k: vec![1.0], g: None };
        let by_part = MatricesByPart { parts: Vec::new(), rest, rest_name: "joints".into() };
        SuperElement { model_text: text.map(str::to_owned), ..testing::element(1, by_part) }
    }

    fn of(study: &Study, element: SuperElement) -> Result<ReducedSubject<'_>> {
        ReducedSubject::of(study, element, OuterSurface::default())
    }

    const LINING: &str = "material.lining.young";

    fn model() -> String {
        let text = std::fs::read_to_string("tests/data/pads_on_disc.toml").unwrap();
        text.replace("[part.disc]", "[part.disc]\nrayleigh = { alpha = 1, beta = 0 }")
    }

    #[test]
    fn an_element_without_a_model_file_has_no_keys_of_parts() {
        let message = of(&study(LINING), element(None)).err().unwrap().to_string();
        assert!(message.contains("soft.toml") && message.contains("no key \"material.lining.young\""), "{message}");
        assert!(message.contains("that `squeal reduce` makes of a model file"), "{message}");
    }

    /// When the study is read, not at each of its points.
    #[test]
    fn a_study_of_moduli_of_a_prestressed_element_is_refused() {
        let prestressed = || SuperElement { geometric_stiffness: Some(vec![0.0]), ..element(Some(&model())) };
        let message = of(&study(LINING), prestressed()).err().unwrap().to_string();
        assert!(message.contains("soft.toml: the super-element has the geometric stiffness of one"), "{message}");
        assert!(of(&study("part.disc.rayleigh.alpha"), prestressed()).is_ok());
        assert!(of(&study(LINING), element(Some(&model()))).is_ok());
    }

    #[test]
    fn friction_coefficients_without_modes_nearby_have_a_warning() {
        let samples = [0.5, 0.2].map(Sample::at);
        let is_silent = |points: &[f64]| friction_warning(&samples, points).is_none();
        assert!(is_silent(&[0.16, 0.3, 0.54]) && !is_silent(&[0.14, 0.3]) && !is_silent(&[0.3, 0.56]));
        assert!(friction_warning(&samples[..1], &[0.3, 0.7]).unwrap().contains("0.300 to 0.700; the super-element"));
        assert_eq!(friction_warning(&[], &[0.9]), None, "no samples: a super-element of reference pairs");
        let mut study = study("material.lining.young");
        (study.parameters[0].keys, study.parameters[0].is_factor) = (vec![KeyPath::parse("friction").unwrap()], false);
        let mut subject = of(&study, element(None)).unwrap();
        subject.element.origin.samples = samples.to_vec();
        assert_eq!(subject.warnings(&[vec![0.9], vec![0.3]]).len(), 1);
    }

    #[test]
    fn samples_that_did_not_agree_are_reported_again() {
        let study = study(LINING);
        let mut subject = of(&study, element(Some(&model()))).unwrap();
        let lining = |part: &str| PartRange { stiffness: [0.5, 1.0], ..PartRange::nominal(part) };
        let parts = ["lining_inner", "lining_outer"].map(lining).to_vec();
        let made_for =
            |errors: [f64; 2]| MadeFor { sample_errors: errors.to_vec(), parts: parts.clone(), ..MadeFor::default() };
        subject.element.origin.made_for = Some(made_for([0.02, 0.01]));
        let warnings = subject.warnings(&[vec![0.6], vec![2.0]]);
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        assert!(warnings[0].contains("still differ by 2.00 %") && warnings[1].contains("lining_inner"), "{warnings:?}");
        subject.element.origin.made_for = Some(made_for([1e-6, 1e-6]));
        assert!(subject.warnings(&[vec![0.6]]).is_empty());
    }
}
