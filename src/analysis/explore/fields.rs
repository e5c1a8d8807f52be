//! Random fields over the contact points of a model.
//!
//! The contact points come of the model as it stands in the file. At a point of the study the contacts get gap fields
//! and factors as if their model file named a table with a row for each contact point: the model file of the point
//! names that table.

use std::path::Path;

use crate::explore::{ContactTable, Field, FieldQuantity, RandomField, Study};
use crate::model::{Contact, GapField, Model, StiffnessField, names};
use crate::native::Comm;
use crate::results::FieldShare;
use crate::structure::ModelVariants;
use crate::{Error, Result};

/// The random fields of a study.
pub struct Fields<'s> {
    study: &'s Study,
    all: Vec<PointField<'s>>,
}

/// A field over the points of its contacts.
struct PointField<'s> {
    field: &'s Field,
    /// In the unit of the quantity: m of gaps.
    deviation: f64,
    surfaces: Vec<Surface>,
    /// Over the points of all surfaces, one surface's after the other's.
    modes: RandomField,
}

/// The contact points of a contact.
struct Surface {
    /// Its place in the model's list.
    contact: usize,
    /// Their positions, m.
    points: Vec<[f64; 3]>,
    /// Their areas, m2.
    areas: Vec<f64>,
}

impl<'s> Fields<'s> {
    /// The fields with their modes, which all ranks compute from the same contact points. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] for fields that match no contact, or one that has no gap, or have too many modes.
    pub fn new(comm: &Comm, study: &'s Study, variants: &ModelVariants) -> Result<Fields<'s>> {
        if study.fields.is_empty() {
            return Ok(Fields { study, all: Vec::new() });
        }
        let brake = variants.brake(comm, &variants.text, None)?;
        let surface = |(contact, own): (usize, &Contact)| {
            let pair = brake.interface.pairs.iter().find(|pair| pair.name == own.name);
            let points = &brake.interface.points[pair.map_or(0..0, |pair| pair.points.clone())];
            let areas = points.iter().map(|point| point.law.weight).collect();
            Surface { contact, points: points.iter().map(|point| point.position).collect(), areas }
        };
        let own = |field: &'s Field| {
            let covered = brake.model.contacts.iter().enumerate().filter(|(_, own)| field.covers(&own.name));
            PointField::new(field, &brake.model, covered.map(surface).collect())
                .map_err(|what| Error::input(format!("{}: field {:?}: {what}", study.file.display(), field.name)))
        };
        let all = study.fields.iter().map(own).collect::<Result<_>>();
        Ok(Fields { study, all: comm.agree(all)? })
    }

    /// The model with gaps and factors of the fields at a point; where a field is zero, as at the nominal point, those
    /// of the model file with its table, which the digests of a study are of.
    ///
    /// # Errors
    /// [`Error::Input`] where tables of the model file do not cover the contact points.
    pub fn applied(&self, mut model: Model, values: &[f64]) -> Result<Model> {
        for own in self.all.iter().filter(|own| own.field.coefficients(values).iter().any(|z| *z != 0.0)) {
            own.apply(&mut model, values, &self.study.file).map_err(|what| self.error(own, &what))?;
        }
        Ok(model)
    }

    /// The gaps and factors of the contacts at a point, with those that the model file gives them.
    ///
    /// # Errors
    /// See [`Fields::applied`].
    pub fn tables(&self, model: Model, values: &[f64]) -> Result<Vec<ContactTable>> {
        let model = self.applied(model, values)?;
        let mut tables: Vec<ContactTable> = Vec::new();
        for own in &self.all {
            let quantity = own.field.quantity;
            for Surface { contact, points, .. } in &own.surfaces {
                // Two fields of one contact are in one table.
                if tables.iter().any(|table| (table.contact, table.quantity) == (*contact, quantity)) {
                    continue;
                }
                let of = &model.contacts[*contact];
                let numbers = numbers(of, quantity, points).map_err(|what| self.error(own, &what))?;
                let rows = points.iter().copied().zip(numbers).collect();
                tables.push(ContactTable { contact: *contact, name: of.name.clone(), quantity, rows });
            }
        }
        Ok(tables)
    }

    /// What the modes have of the fields.
    pub fn shares(&self) -> Vec<FieldShare> {
        let share = |own: &PointField| FieldShare {
            name: own.field.name.clone(),
            n_points: own.surfaces.iter().map(|surface| surface.points.len()).sum(),
            n_modes: own.field.n_modes,
            share: own.modes.share(),
        };
        self.all.iter().map(share).collect()
    }

    fn error(&self, own: &PointField, what: &str) -> Error {
        Error::input(format!("{}: field {:?}: {what}", self.study.file.display(), own.field.name))
    }
}

impl<'s> PointField<'s> {
    /// A field over the points of contacts of a model, given by their surfaces.
    fn new(field: &'s Field, model: &Model, surfaces: Vec<Surface>) -> std::result::Result<PointField<'s>, String> {
        let known = || model.contacts.iter().map(|own| own.name.as_str());
        if let Some(missing) = field.pattern_without(known()) {
            return Err(format!("there is no contact {missing:?}. {}", names::advice(missing, known())));
        }
        let is_gap = field.quantity == FieldQuantity::Gap;
        let mut covered = surfaces.iter().map(|surface| &model.contacts[surface.contact]);
        if let Some(tied) = covered.find(|own| is_gap && !own.separation) {
            return Err(format!(
                "contact {:?} never opens, so that it has no gap. Give it separation = true",
                tied.name
            ));
        }
        let points: Vec<[f64; 3]> = surfaces.iter().flat_map(|surface| &surface.points).copied().collect();
        let areas: Vec<f64> = surfaces.iter().flat_map(|surface| &surface.areas).copied().collect();
        let length = model.mesh_unit * field.correlation_length;
        let modes = RandomField::new(&points, &areas, field.kernel, length, field.n_modes);
        let n = modes.shares.len();
        if n < field.n_modes {
            return Err(format!("over {} contact points it has {n} modes. Give modes = {n} or fewer", points.len()));
        }
        let deviation = field.deviation * if is_gap { model.mesh_unit } else { 1.0 };
        Ok(PointField { field, deviation, surfaces, modes })
    }

    /// Gives the contacts of a model the gaps or factors at a point, with those that they have.
    fn apply(&self, model: &mut Model, values: &[f64], file: &Path) -> std::result::Result<(), String> {
        let field = self.modes.at(self.field.coefficients(values));
        let mut field = field.iter().map(|z| self.deviation * z);
        for Surface { contact, points, .. } in &self.surfaces {
            let contact = &mut model.contacts[*contact];
            let earlier = numbers(contact, self.field.quantity, points)?;
            let with = |earlier: f64, own: f64| match self.field.quantity {
                FieldQuantity::Gap => earlier + own,
                FieldQuantity::Stiffness => earlier * own.exp(),
            };
            let own = field.by_ref().take(points.len());
            let rows =
                points.iter().zip(earlier).zip(own).map(|((x, earlier), own)| (*x, with(earlier, own))).collect();
            match self.field.quantity {
                FieldQuantity::Gap => contact.gap_field = Some(GapField::of_points(file, rows)),
                FieldQuantity::Stiffness => contact.stiffness_field = Some(StiffnessField::of_points(file, rows)?),
            }
        }
        Ok(())
    }
}

/// What the tables of a contact give its points: gaps (m), or factors.
fn numbers(contact: &Contact, quantity: FieldQuantity, points: &[[f64; 3]]) -> std::result::Result<Vec<f64>, String> {
    match quantity {
        FieldQuantity::Gap => contact.gap_field.as_ref().map_or(Ok(vec![0.0; points.len()]), |own| own.at(points)),
        FieldQuantity::Stiffness => {
            contact.stiffness_field.as_ref().map_or(Ok(vec![1.0; points.len()]), |own| own.at(points))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    const MODEL: &str = "tests/data/pads_on_disc.toml";

    /// A study of the two pads with these tables of fields.
    fn study(fields: &str) -> Study {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("explore.toml");
        let model = std::path::absolute(MODEL).unwrap();
        let head = format!("model = \"{}\"\n[design]\nkind = \"sobol\"\npoints = 2\n", model.display());
        std::fs::write(&file, head + fields).unwrap();
        crate::explore::read(&file).unwrap()
    }

    const BOTH: &str = "[field.film]\ncontact = \"disc / *\"\nof = \"gap\"\ndeviation = 0.002\n\
        correlation_length = 40\nkernel = \"exponential\"\nmodes = 3\n\
        [field.k]\ncontact = \"disc / inner pad\"\nof = \"stiffness\"\ndeviation = 0.3\n\
        correlation_length = 30\nkernel = \"gaussian\"\nmodes = 2\n";

    #[test]
    fn contact_points_have_the_gaps_and_factors_of_the_fields() {
        let comm = Session::start(&[]).unwrap();
        let study = study(BOTH);
        let variants = ModelVariants::read(&comm, &study.model).unwrap();
        let fields = Fields::new(&comm, &study, &variants).unwrap();
        let values = [0.7, -0.4, 1.1, -0.9, 0.5];
        let model = fields.applied(variants.model.clone(), &values).unwrap();
        let brake = variants.brake_of(&comm, model, None).unwrap();
        let plain = variants.brake(&comm, &variants.text, None).unwrap();
        let [film, k] = [(&values[..3], 0), (&values[3..], 1)].map(|(own, i)| fields.all[i].modes.at(own));
        assert_eq!((film.len(), k.len()), (236, plain.interface.pairs[0].points.len()));
        for (i, (own, plain)) in brake.interface.points.iter().zip(&plain.interface.points).enumerate() {
            assert!((own.field_gap - 2e-6 * film[i]).abs() < 1e-18, "the mesh's unit is the millimetre");
            let factor = k.get(i).map_or(1.0, |z| (0.3 * z).exp());
            assert_eq!(own.law.normal_law, plain.law.normal_law.times(factor));
        }
        let nominal = fields.applied(variants.model.clone(), &[0.0, 0.0, 0.0, 0.1, 0.0]).unwrap().contacts;
        assert!(nominal[0].gap_field.is_none() && nominal[1].stiffness_field.is_none(), "as in the model file");
        assert!(nominal[0].stiffness_field.is_some());
        let tables = fields.tables(variants.model.clone(), &values).unwrap();
        let names: Vec<(&str, FieldQuantity)> = tables.iter().map(|own| (own.name.as_str(), own.quantity)).collect();
        let [inner, outer] = ["disc / inner pad", "disc / outer pad"];
        let expected = [(inner, FieldQuantity::Gap), (outer, FieldQuantity::Gap), (inner, FieldQuantity::Stiffness)];
        assert_eq!(names, expected);
        let [first, second] = &fields.shares()[..] else { panic!("two fields") };
        assert!((first.n_points, first.n_modes) == (236, 3));
        assert!([first, second].iter().all(|own| (0.3..1.0).contains(&own.share)), "{first:?} {second:?}");
    }

    #[test]
    fn two_fields_of_a_contact_are_added() {
        let comm = Session::start(&[]).unwrap();
        let study =
            study(&(BOTH.to_owned() + &BOTH.replace("[field.film]", "[field.a]").replace("[field.k]", "[field.b]")));
        let variants = ModelVariants::read(&comm, &study.model).unwrap();
        let fields = Fields::new(&comm, &study, &variants).unwrap();
        let rows = |values: &[f64]| fields.tables(variants.model.clone(), values).unwrap();
        let one = rows(&[0.7, -0.4, 1.1, -0.9, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let both = rows(&[0.7, -0.4, 1.1, -0.9, 0.5, 0.7, -0.4, 1.1, -0.9, 0.5]);
        assert_eq!(both.len(), 3);
        assert!((both[0].rows[5].1 - 2.0 * one[0].rows[5].1).abs() < 1e-18);
        assert!((both[2].rows[5].1 - one[2].rows[5].1.powi(2)).abs() < 1e-12);
    }

    #[test]
    fn fields_that_cannot_be_are_refused() {
        let comm = Session::start(&[]).unwrap();
        let message = |old: &str, new: &str| {
            let study = study(&BOTH.replacen(old, new, 1));
            let variants = ModelVariants::read(&comm, &study.model).unwrap();
            Fields::new(&comm, &study, &variants).err().unwrap().to_string()
        };
        let missing = message("disc / inner pad", "disc / iner pad");
        assert!(missing.contains("field \"k\": there is no contact \"disc / iner pad\". Did you mean"), "{missing}");
        let smooth = message("30\nkernel = \"gaussian\"\nmodes = 2", "3e5\nkernel = \"gaussian\"\nmodes = 9");
        assert!(smooth.contains("modes. Give modes = "), "{smooth}");
    }
}
