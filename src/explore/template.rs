//! A model file in which the parameters of a study are replaced by their values.

use std::path::Path;

use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, value};

use super::key::{Address, KeyPath, at, number, set};
use super::study::Parameter;
use crate::model::{self, InstabilityCriterion, Model};
use crate::{Error, Result};

/// What a model is before any parameter changes it.
#[derive(Debug, Clone, Copy)]
pub struct Nominal<'a> {
    /// The model.
    pub model: &'a Model,
    /// Names of the contacts whose friction coefficient a sweep changes.
    pub swept: &'a [String],
}

/// A model file whose numbers can be changed.
pub struct Template {
    document: DocumentMut,
    targets: Vec<Target>,
    swept: Vec<String>,
    /// Friction coefficient of the first swept pair.
    friction: f64,
}

/// What a parameter changes.
enum Target {
    /// Places with their nominal numbers.
    Numbers { places: Vec<(Address, f64)>, is_factor: bool },
    /// The friction coefficient of all swept pairs.
    Friction,
    /// No number of the model file: a mode of a random field.
    FieldMode,
}

/// Keys that models and super-elements share, as the options of `squeal stability` do.
pub(super) const FRICTION: &str = "friction";
pub(super) const PRESSURE: &str = "pressure";
pub(super) const CONTACT_STIFFNESS: &str = "contact_stiffness";

impl Template {
    /// Finds the numbers of the parameters in the text of a model file.
    ///
    /// # Errors
    /// [`Error::Input`] where a key matches no number or several different ones without being a factor, or two
    /// parameters change the same one.
    pub fn new(text: &str, parameters: &[Parameter], nominal: Nominal) -> Result<Template> {
        let document: DocumentMut =
            text.parse().map_err(|reason| Error::input(format!("{}: {reason}", nominal.model.file.display())))?;
        let swept = nominal.swept.to_vec();
        let target = |parameter: &Parameter| target(document.as_item(), parameter, &swept);
        let targets = parameters.iter().map(target).collect::<Result<Vec<_>>>()?;
        refuse_doubled(document.as_item(), parameters, &targets, &swept)?;
        let friction = friction_coefficients(nominal.model, &swept);
        Ok(Template { document, targets, friction: friction.first().copied().unwrap_or(0.0), swept })
    }

    /// Refuses the friction of all swept contacts as a parameter where `model`, which has the nominal point, has
    /// several values.
    ///
    /// # Errors
    /// [`Error::Input`] there.
    pub fn require_one_friction(&self, model: &Model) -> Result<()> {
        if !self.targets.iter().any(|target| matches!(target, Target::Friction)) {
            return Ok(());
        }
        let advice = "Give each a parameter of its own, such as contact.NAME.friction";
        let friction = friction_coefficients(model, &self.swept);
        require_one_number("the friction coefficients of the swept contacts", &friction, advice)
    }

    /// The parameters' values in the model file; 1 of factors.
    pub fn nominal(&self) -> Vec<f64> {
        let of = |target: &Target| match target {
            Target::Numbers { is_factor: true, .. } => 1.0,
            Target::Numbers { places, .. } => places[0].1,
            Target::Friction => self.friction,
            Target::FieldMode => 0.0,
        };
        self.targets.iter().map(of).collect()
    }

    /// The text of the model file with other values of the parameters, and a sweep of the one friction coefficient that
    /// follows from them. Where no parameter is it, it is `friction`, of all swept pairs, else the model file's. `file`
    /// is what messages call it.
    ///
    /// # Errors
    /// [`Error::Input`] where the model file with these values is not valid.
    pub fn text(&self, values: &[f64], mut friction: Option<f64>, file: &Path) -> Result<String> {
        let mut document = self.document.clone();
        for (target, value) in self.targets.iter().zip(values) {
            match target {
                Target::FieldMode => {}
                Target::Friction => friction = Some(*value),
                Target::Numbers { places, is_factor } => {
                    for (place, own) in places {
                        set(document.as_item_mut(), place, if *is_factor { value * own } else { *value });
                    }
                }
            }
        }
        document.remove("sweep");
        let model = model::parse(&document.to_string(), file)?;
        if let Some((contacts, friction)) = self.sweep(&model, friction) {
            document.insert("sweep", Item::Table(sweep_table(contacts, friction)));
        }
        Ok(document.to_string())
    }

    /// Contacts of the sweep, and their friction coefficient: all swept pairs where they have one value, else the first
    /// alone, and the others keep their own.
    fn sweep(&self, model: &Model, given: Option<f64>) -> Option<(&[String], f64)> {
        if let Some(friction) = given {
            return Some((&self.swept, friction));
        }
        let values = friction_coefficients(model, &self.swept);
        let first = *values.first()?;
        let n = if values.iter().all(|value| *value == first) { self.swept.len() } else { 1 };
        Some((&self.swept[..n], first))
    }
}

/// The text of a model file whose mesh has another path, with the band of a study (Hz), and what counts as an unstable
/// mode where the study gives one. Gap fields, which are beside the model file `file`, get their whole path.
///
/// # Errors
/// [`Error::Input`] where the text is no model file.
pub fn standing_alone(
    text: &str,
    file: &Path,
    mesh: &str,
    band: [f64; 2],
    criterion: Option<InstabilityCriterion>,
) -> Result<String> {
    let mut document: DocumentMut = text.parse().map_err(|reason| Error::input(format!("no model file: {reason}")))?;
    let table = document.get_mut("mesh").and_then(Item::as_table_like_mut);
    let table = table.ok_or_else(|| Error::input("the model file has no [mesh]"))?;
    table.insert("file", value(mesh));
    let stability = document.get_mut("stability").and_then(Item::as_table_like_mut);
    stability.into_iter().for_each(|table| {
        table.insert("band", value(band.into_iter().collect::<Array>()));
        if let Some(criterion) = criterion {
            table.insert("unstable", value(InlineTable::from_iter([criterion.entry()])));
        }
    });
    let contacts = document.get_mut("contact").and_then(Item::as_array_of_tables_mut);
    for contact in contacts.into_iter().flat_map(|list| list.iter_mut()) {
        for key in ["gap", "stiffness_factor"] {
            let Some(field) = contact.get_mut(key) else { continue };
            let own = file.parent().unwrap_or(Path::new("")).join(field.as_str().unwrap_or_default());
            *field = value(std::path::absolute(&own).map_err(Error::io(&own))?.display().to_string());
        }
    }
    Ok(document.to_string())
}

fn target(document: &Item, parameter: &Parameter, swept: &[String]) -> Result<Target> {
    let of_parameter = |error: Error| Error::input(format!("parameter {:?}: {error}", parameter.name));
    let find = |keys: &[KeyPath], is_factor: bool| {
        let found = keys.iter().map(|key| key.find(document, is_factor)).collect::<Result<Vec<_>>>();
        let own = |place: Address| {
            let own = number(at(document, &place)).expect("a number was found");
            (place, own)
        };
        let places: Vec<(Address, f64)> = found.map_err(of_parameter)?.concat().into_iter().map(own).collect();
        if !is_factor {
            let numbers: Vec<f64> = places.iter().map(|(_, own)| *own).collect();
            let advice = "Give factor = true, or each a parameter of its own";
            require_one_number("the numbers of its keys", &numbers, advice).map_err(of_parameter)?;
        }
        Ok(Target::Numbers { places, is_factor })
    };
    if let Some(key) = parameter.keys.iter().find(|key| key.segments()[0] == "sweep") {
        let what = format!("key {}: a point of a study has no sweep. Give the key friction", key.text());
        return Err(of_parameter(Error::input(what)));
    }
    match parameter.shared_key() {
        _ if parameter.is_of_field() => Ok(Target::FieldMode),
        Some(FRICTION) if swept.is_empty() => {
            let what = "no contact slides, so that there is no friction coefficient";
            Err(of_parameter(Error::input(format!("{what}. Add the [[rotation]] of the disc"))))
        }
        Some(FRICTION) => Ok(Target::Friction),
        Some(key) => {
            let keys = shared(key, swept)?;
            let present = |key: &KeyPath| key.find(document, true).is_ok();
            let present: Vec<KeyPath> = keys.iter().filter(|key| present(key)).cloned().collect();
            find(if present.is_empty() { &keys } else { &present }, true)
        }
        None => find(&parameter.keys, parameter.is_factor),
    }
}

/// The paths of a key that models share with super-elements.
fn shared(key: &str, swept: &[String]) -> Result<Vec<KeyPath>> {
    let paths: Vec<String> = match key {
        PRESSURE => ["force", "moment", "pressure"].map(|kind| format!("load.*.{kind}")).to_vec(),
        _ => swept
            .iter()
            .flat_map(|name| ["linear", "cubic"].map(|law| format!("contact.\"{name}\".law.{law}")))
            .collect(),
    };
    paths.iter().map(|path| KeyPath::parse(path)).collect()
}

/// Numbers that one value takes the place of are equal.
fn require_one_number(what: &str, numbers: &[f64], advice: &str) -> Result<()> {
    let Some(other) = numbers.iter().find(|number| **number != numbers[0]) else { return Ok(()) };
    Err(Error::input(format!("{what} differ in the model file ({} and {other}). {advice}", numbers[0])))
}

fn refuse_doubled(document: &Item, parameters: &[Parameter], targets: &[Target], swept: &[String]) -> Result<()> {
    let mut seen: Vec<(Address, &str)> = Vec::new();
    for (parameter, target) in parameters.iter().zip(targets) {
        let places = match target {
            Target::Numbers { places, .. } => places.iter().map(|(place, _)| place.clone()).collect(),
            Target::Friction => friction_places(document, swept)?,
            Target::FieldMode => Vec::new(),
        };
        for place in places {
            if let Some((_, first)) = seen.iter().find(|(other, _)| *other == place) {
                let what = format!("parameters {first:?} and {:?} change the same number", parameter.name);
                return Err(Error::input(format!("{what}. Leave one of them out")));
            }
            seen.push((place, &parameter.name));
        }
    }
    Ok(())
}

/// The friction coefficients of contacts of a model.
fn friction_coefficients(model: &Model, contacts: &[String]) -> Vec<f64> {
    let own = |name: &String| model.contacts.iter().find(|own| own.name == *name).map(|own| own.friction);
    contacts.iter().filter_map(own).collect()
}

/// The friction coefficients of the swept contacts that the model file has.
fn friction_places(document: &Item, swept: &[String]) -> Result<Vec<Address>> {
    let keys = swept.iter().map(|name| KeyPath::parse(&format!("contact.\"{name}\".friction")));
    let keys = keys.collect::<Result<Vec<KeyPath>>>()?;
    Ok(keys.iter().filter_map(|key| key.find(document, false).ok()).flatten().collect())
}

/// `[sweep]` with one friction coefficient.
fn sweep_table(contacts: &[String], friction: f64) -> Table {
    let mut sweep = InlineTable::new();
    sweep.insert("contacts", contacts.iter().collect::<Array>().into());
    sweep.insert("values", [friction].into_iter().collect::<Array>().into());
    let mut table = Table::new();
    table.insert("friction", value(sweep));
    table
}

#[cfg(test)]
mod tests {
    use super::super::Distribution;
    use super::*;

    const FILE: &str = "tests/data/pads_on_disc.toml";

    fn template(parameters: &[(&str, &str, bool)]) -> Result<Template> {
        let parameter = |(name, key, is_factor): &(&str, &str, bool)| Parameter {
            name: (*name).to_owned(),
            keys: vec![KeyPath::parse(key).unwrap()],
            is_factor: *is_factor,
            distribution: Distribution::Values(vec![1.0]),
        };
        let parameters: Vec<Parameter> = parameters.iter().map(parameter).collect();
        let model = model::read(FILE.as_ref()).unwrap();
        let swept = ["disc / inner pad", "disc / outer pad"].map(String::from);
        let text = std::fs::read_to_string(FILE).unwrap();
        Template::new(&text, &parameters, Nominal { model: &model, swept: &swept })
    }

    fn changed(parameters: &[(&str, &str, bool)], values: &[f64]) -> Model {
        let text = template(parameters).unwrap().text(values, None, FILE.as_ref()).unwrap();
        model::parse(&text, FILE.as_ref()).unwrap()
    }

    #[test]
    fn numbers_change_where_the_parameters_are() {
        let parameters =
            [("E", "material.lining.young", true), ("rho", "material.iron.density", false), ("mu", "friction", false)];
        assert_eq!(template(&parameters).unwrap().nominal(), [1.0, 7100.0, 0.4]);
        let model = changed(&parameters, &[0.5, 7000.0, 0.45]);
        assert_eq!((model.frictions.as_slice(), model.swept.len()), (&[0.45][..], 2));
        let part = |name: &str| &model.parts.iter().find(|part| part.name == name).unwrap().material;
        assert_eq!(part("disc").density, 7000.0);
        let plain = changed(&[], &[]);
        assert_ne!(part("lining_inner"), &plain.parts.iter().find(|p| p.name == "lining_inner").unwrap().material);
        assert_eq!(plain.frictions, [0.4], "a point has one friction coefficient");
    }

    #[test]
    fn a_friction_coefficient_of_one_pair_leaves_the_other_alone() {
        let model = changed(&[("mu", "contact.*inner*.friction", false)], &[0.6]);
        assert_eq!((model.swept, model.frictions), (vec!["disc / inner pad".to_owned()], vec![0.6]));
        assert_eq!(model.contacts[1].friction, 0.4);
    }

    #[test]
    fn a_given_friction_coefficient_stands_where_no_parameter_has_it() {
        let sweep = |parameters: &[(&str, &str, bool)], values: &[f64]| {
            let text = template(parameters).unwrap().text(values, Some(0.3), FILE.as_ref()).unwrap();
            let model = model::parse(&text, FILE.as_ref()).unwrap();
            (model.swept.len(), model.frictions)
        };
        assert_eq!(sweep(&[], &[]), (2, vec![0.3]));
        assert_eq!(sweep(&[("mu", "friction", false)], &[0.5]), (2, vec![0.5]));
    }

    #[test]
    fn keys_of_super_elements_are_factors_of_models() {
        let model = changed(&[("p", "pressure", false), ("k", "contact_stiffness", false)], &[2.0, 0.5]);
        let law = model.contacts[0].law.clone().unwrap();
        assert_eq!(law, crate::model::NormalLaw::Linear { stiffness: 1e13 });
        assert!(format!("{:?}", model.loads[0].kind).contains("8000"), "{:?}", model.loads[0].kind);
    }

    #[test]
    fn values_that_no_model_can_have_are_refused_with_the_readers_message() {
        let message = template(&[("rho", "material.iron.density", false)]).unwrap().text(&[-1.0], None, FILE.as_ref());
        let message = message.unwrap_err().to_string();
        assert!(message.contains("pads_on_disc.toml:11") && message.contains("density"), "{message}");
    }

    #[test]
    fn a_model_file_may_stand_elsewhere() {
        let text = std::fs::read_to_string(FILE).unwrap();
        let worn = text.replacen("[[contact]]\n", "[[contact]]\ngap = \"worn.csv\"\n", 1);
        let worn = standing_alone(&worn, FILE.as_ref(), "a.msh", [0.0, 500.0], None).unwrap();
        let gap = std::path::absolute("tests/data/worn.csv").unwrap();
        assert!(worn.contains(&format!("gap = \"{}\"", gap.display())), "{worn}");
        for criterion in [InstabilityCriterion::GrowthRate(5.0), InstabilityCriterion::DampingRatio(-0.001)] {
            let mesh = "../data/pads_on_disc.msh";
            let text = standing_alone(&text, FILE.as_ref(), mesh, [0.0, 500.0], Some(criterion)).unwrap();
            let model = model::parse(&text, "tests/data/worst.toml".as_ref()).unwrap();
            assert_eq!(model.mesh_file, Path::new("tests/data/../data/pads_on_disc.msh"));
            assert_eq!((model.band, model.criterion), ([0.0, 500.0], criterion));
        }
    }

    #[test]
    fn friction_has_one_parameter_of_all_pairs_or_one_of_each() {
        let message = |of: &[(&str, &str, bool)]| template(of).err().map(|error| error.to_string());
        let (mu, inner) = (("mu", "friction", false), ("inner", "contact.*inner*.friction", false));
        for both in [[mu, inner], [inner, mu], [mu, ("again", "friction", false)]] {
            assert!(message(&both).unwrap().contains("change the same number"), "{both:?}");
        }
        assert_eq!(message(&[inner, ("outer", "contact.*outer*.friction", false)]), None);
        let swept = message(&[("mu", "sweep.friction.values.1", false)]).unwrap();
        assert!(swept.contains("Give the key friction"), "a point has no sweep: {swept}");
    }

    #[test]
    fn one_value_takes_the_place_of_one_number() {
        let message = |key: &str, is_factor| template(&[("p", key, is_factor)]).err().map(|error| error.to_string());
        let differ = message("material.*.density", false).unwrap();
        assert!(differ.contains("parameter \"p\": the numbers of its keys differ"), "{differ}");
        assert_eq!((message("material.*.density", true), message("contact.*.law.linear", false)), (None, None));
        assert!(require_one_number("numbers", &[0.4, 0.4], "").is_ok());
        let error = require_one_number("numbers", &[0.4, 0.4, 0.5], "Give one").unwrap_err().to_string();
        assert!(error.contains("numbers differ in the model file (0.4 and 0.5). Give one"), "{error}");
    }

    #[test]
    fn a_number_has_one_parameter() {
        let twice = [("a", "material.lining.young", false), ("b", "material.*.young", true)];
        let message = template(&twice).err().unwrap().to_string();
        assert!(message.contains("\"a\" and \"b\" change the same number"), "{message}");
        let message = template(&[("a", "material.lining.yuong", false)]).err().unwrap().to_string();
        assert!(message.contains("parameter \"a\"") && message.contains("Did you mean \"young\""), "{message}");
    }
}
