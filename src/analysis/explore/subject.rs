//! What a study changes: a model with its mesh, or a super-element.

use std::path::Path;

use crate::explore::{Nominal, Parameter, Study, Template};
use crate::hdf::is_hdf5;
use crate::model::names;
use crate::native::Comm;
use crate::reduction::file;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::SuperElement;
use crate::structure::{FullModel, ModelVariants, ReducedModel, Structure, StructureOptions};
use crate::{Error, Result};

/// A model or super-element whose numbers a study changes.
pub enum Subject<'s> {
    Full { variants: Box<ModelVariants>, template: Box<Template>, contacts: Option<usize> },
    Reduced { place: &'s Path, element: Box<SuperElement>, parameters: &'s [Parameter] },
}

/// Keys of super-elements.
const KEYS: [&str; 3] = ["friction", "pressure", "contact_stiffness"];

/// What a super-element can be changed in.
struct ReducedValues {
    friction: f64,
    pressure: f64,
    contact_stiffness: f64,
}

impl<'s> Subject<'s> {
    /// Reads the model or super-element of a study, and finds the numbers of the parameters. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] for files that cannot be used, and keys that match nothing.
    pub fn read(comm: &Comm, study: &'s Study) -> Result<Subject<'s>> {
        if is_hdf5(&study.model) {
            refuse_contacts(study)?;
            let element = Box::new(file::read_element(&study.model)?);
            let parameters = &study.parameters[..];
            parameters.iter().try_for_each(|parameter| require_shared(study, parameter))?;
            return Ok(Subject::Reduced { place: &study.model, element, parameters });
        }
        let variants = ModelVariants::read(comm, &study.model)?;
        let nominal = Nominal { model: &variants.model, swept: &variants.swept };
        let template = Template::new(&variants.text, &study.parameters, nominal)
            .map_err(|error| Error::input(format!("{}: {error}", study.file.display())))?;
        Ok(Subject::Full { variants: Box::new(variants), template: Box::new(template), contacts: study.contacts })
    }

    /// The parameters' values in the file.
    pub fn nominal(&self) -> Vec<f64> {
        match self {
            Subject::Full { template, .. } => template.nominal(),
            Subject::Reduced { element, parameters, .. } => {
                let of = |parameter: &Parameter| {
                    if parameter.shared_key() == Some(KEYS[0]) { element.origin.friction } else { 1.0 }
                };
                parameters.iter().map(of).collect()
            }
        }
    }

    /// The structure at a point, and the friction coefficient of its swept pairs. Collective: all ranks fail together.
    ///
    /// # Errors
    /// [`Error::Input`] where the structure cannot have these values.
    pub fn structure(&self, comm: &Comm, values: &[f64]) -> Result<(Structure, f64)> {
        let structure = match self {
            Subject::Full { variants, template, contacts } => {
                let full: FullModel = variants.brake(comm, &template.text(values, &variants.file)?, *contacts)?;
                Structure::Full(Box::new(full))
            }
            Subject::Reduced { place, element, parameters } => {
                let own = ReducedValues::at(element, parameters, values)?;
                let (element, surface) = ((**element).clone(), OuterSurface::default());
                let ReducedValues { pressure: load_factor, contact_stiffness, .. } = own;
                let options = StructureOptions { load_factor, contact_stiffness, ..StructureOptions::default() };
                Structure::Reduced(Box::new(ReducedModel::with(place, element, surface, &options)?))
            }
        };
        let friction = match self {
            Subject::Reduced { element, parameters, .. } => ReducedValues::at(element, parameters, values)?.friction,
            // The text has a sweep of one value where pairs slide.
            Subject::Full { .. } => structure.friction_values(None).map_or(0.0, |list| list[0]),
        };
        Ok((structure, friction))
    }

    /// The text of the model file at a point; none of a super-element.
    ///
    /// # Errors
    /// [`Error::Input`] where the model cannot have these values.
    pub fn text(&self, values: &[f64]) -> Result<Option<String>> {
        match self {
            Subject::Full { variants, template, .. } => template.text(values, &variants.file).map(Some),
            Subject::Reduced { .. } => Ok(None),
        }
    }
}

impl ReducedValues {
    fn at(element: &SuperElement, parameters: &[Parameter], values: &[f64]) -> Result<ReducedValues> {
        let of = |key: &str, otherwise: f64| {
            let place = parameters.iter().position(|parameter| parameter.shared_key() == Some(key));
            place.map_or(otherwise, |i| values[i])
        };
        let [friction, pressure, contact_stiffness] =
            [of(KEYS[0], element.origin.friction), of(KEYS[1], 1.0), of(KEYS[2], 1.0)];
        if friction < 0.0 || pressure <= 0.0 || contact_stiffness <= 0.0 {
            let what = format!("friction {friction}, pressure {pressure}, contact stiffness {contact_stiffness}");
            return Err(Error::input(format!("{what}: friction is 0 or above, the factors are above 0")));
        }
        Ok(ReducedValues { friction, pressure, contact_stiffness })
    }
}

fn refuse_contacts(study: &Study) -> Result<()> {
    let what = "a super-element has its contacts already; contacts is for models";
    study.contacts.map_or(Ok(()), |_| Err(Error::input(format!("{}: {what}", study.file.display()))))
}

fn require_shared(study: &Study, parameter: &Parameter) -> Result<()> {
    let text = parameter.keys.first().map_or("", |key| key.text());
    match parameter.shared_key() {
        Some(_) => Ok(()),
        None => Err(Error::input(format!(
            "{}: parameter {:?}: a super-element has no key {text:?}. {}",
            study.file.display(),
            parameter.name,
            names::advice(text, KEYS)
        ))),
    }
}
