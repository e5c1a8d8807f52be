//! What a study changes: a model with its mesh, or a super-element.

use crate::explore::{Nominal, PointModel, Study, Template};
use crate::hdf::is_hdf5;
use crate::model;
use crate::native::Comm;
use crate::results::FieldShare;
use crate::structure::{FullModel, ModelVariants, Structure};
use crate::{Error, Result};

use super::fields::Fields;
use super::reduced_subject::ReducedSubject;

/// A model or super-element whose numbers a study changes.
pub enum Subject<'s> {
    Full { variants: Box<ModelVariants>, template: Box<Template>, fields: Fields<'s>, contacts: Option<usize> },
    Reduced(Box<ReducedSubject<'s>>),
}

impl<'s> Subject<'s> {
    /// Reads the model or super-element of a study, and finds the numbers of the parameters. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] for files that cannot be used, and keys that match nothing.
    pub fn read(comm: &Comm, study: &'s Study) -> Result<Subject<'s>> {
        if is_hdf5(&study.model) {
            return Ok(Subject::Reduced(Box::new(ReducedSubject::read(study)?)));
        }
        let variants = ModelVariants::read(comm, &study.model)?;
        let nominal = Nominal { model: &variants.model, swept: &variants.swept };
        let template = Template::new(&variants.text, &study.parameters, nominal)
            .and_then(|template| template.require_one_friction(&variants.model).map(|()| template))
            .map_err(|error| Error::input(format!("{}: {error}", study.file.display())))?;
        let fields = Fields::new(comm, study, &variants)?;
        let (variants, template) = (Box::new(variants), Box::new(template));
        Ok(Subject::Full { variants, template, fields, contacts: study.contacts })
    }

    /// The parameters' values in the file.
    pub fn nominal(&self) -> Vec<f64> {
        match self {
            Subject::Full { template, .. } => template.nominal(),
            Subject::Reduced(reduced) => reduced.nominal(),
        }
    }

    /// The structure at a point, and the friction coefficient of its swept pairs. Collective: all ranks fail together.
    ///
    /// # Errors
    /// [`Error::Input`] where the structure cannot have these values.
    pub fn structure(&self, comm: &Comm, values: &[f64]) -> Result<(Structure, f64)> {
        match self {
            Subject::Full { variants, template, fields, contacts } => {
                let text = template.text(values, None, &variants.file)?;
                let model = model::parse(&text, &variants.file).and_then(|model| fields.applied(model, values));
                let full: FullModel = variants.brake_of(comm, comm.agree(model)?, *contacts)?;
                let structure = Structure::Full(Box::new(full));
                // The text has a sweep of one value where pairs slide.
                let friction = structure.friction_values(None).map_or(0.0, |list| list[0]);
                Ok((structure, friction))
            }
            Subject::Reduced(reduced) => {
                let (reduced, friction) = reduced.structure(values)?;
                Ok((Structure::Reduced(Box::new(reduced)), friction))
            }
        }
    }

    /// What should be known of points before they are solved.
    pub fn warnings(&self, points: &[Vec<f64>]) -> Vec<String> {
        match self {
            Subject::Full { .. } => Vec::new(),
            Subject::Reduced(reduced) => reduced.warnings(points),
        }
    }

    /// Reference pairs of the layout, where there are any.
    pub fn contacts(&self) -> Option<usize> {
        match self {
            Subject::Full { contacts, .. } => *contacts,
            Subject::Reduced(reduced) => reduced.contacts(),
        }
    }

    /// What the modes of the random fields have of them.
    pub fn field_shares(&self) -> Vec<FieldShare> {
        match self {
            Subject::Full { fields, .. } => fields.shares(),
            Subject::Reduced(_) => Vec::new(),
        }
    }

    /// The model file at a point; none of a super-element whose parts do not change.
    ///
    /// # Errors
    /// [`Error::Input`] where the model cannot have these values.
    pub fn model(&self, values: &[f64]) -> Result<Option<PointModel>> {
        match self {
            Subject::Full { variants, template, fields, .. } => {
                let text = template.text(values, None, &variants.file)?;
                let tables = fields.tables(model::parse(&text, &variants.file)?, values)?;
                Ok(Some(PointModel { text, tables }))
            }
            Subject::Reduced(reduced) => Ok(reduced.text(values)?.map(|text| PointModel { text, tables: Vec::new() })),
        }
    }
}
