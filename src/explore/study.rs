//! The file of a study.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::design::Design;
use super::design_table::{CorrelationTable, DesignTable, beside, correlated, design};
use super::distribution::Distribution;
use super::field::{Field, FieldTable, fields};
use super::key::KeyPath;
use super::template::{CONTACT_STIFFNESS, FRICTION, PRESSURE};
use crate::model::{InstabilityCriterion, located, utf8};
use crate::{Error, Result};

/// A study of many parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The file, as messages name it.
    pub file: PathBuf,
    /// Model file or super-element.
    pub model: PathBuf,
    /// The parameters in the order of the file, then those of the fields.
    pub parameters: Vec<Parameter>,
    /// Random fields over contact points.
    pub fields: Vec<Field>,
    /// How points are chosen.
    pub design: Design,
    /// Reference pairs in place of the contact points of the sliding pairs, where there are any.
    pub contacts: Option<usize>,
    /// Frequency band, Hz; the model's own where there is none.
    pub band: Option<[f64; 2]>,
    /// What counts as an unstable mode; the model's own where there is none.
    pub criterion: Option<InstabilityCriterion>,
    /// Width of the bins of the squeal probability over frequency, Hz.
    pub bin: f64,
    /// How often the straight line to the nominal point is bisected where modes are not recognised without doubt; none
    /// where modes are not followed, which needs their left vectors.
    pub follow: Option<usize>,
    /// Whether the derivatives of the nominal modes are found, which needs their left vectors.
    pub gradients: bool,
}

/// A parameter: numbers of the model, and the values that they take.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name in tables.
    pub name: String,
    /// The numbers that it changes; none of a mode of a random field.
    pub keys: Vec<KeyPath>,
    /// Whether its values are factors on the numbers of the model file.
    pub is_factor: bool,
    /// Its values.
    pub distribution: Distribution,
}

impl Study {
    /// Refuses random fields where the study is not of a model with all of its contact points.
    ///
    /// # Errors
    /// [`Error::Input`] that names the first one.
    pub fn require_no_fields(&self) -> Result<()> {
        let what =
            "a random field needs full contact: super-elements and layouts of reference pairs have none of its points";
        let refuse =
            |field: &Field| Err(Error::input(format!("{}: field {:?}: {what}", self.file.display(), field.name)));
        self.fields.first().map_or(Ok(()), refuse)
    }
}

impl Parameter {
    /// Whether it is the coefficient of a random field's mode.
    pub fn is_of_field(&self) -> bool {
        self.keys.is_empty()
    }

    /// The key that models and super-elements share, where the parameter is one of those.
    pub fn shared_key(&self) -> Option<&str> {
        match &self.keys[..] {
            [key] => [FRICTION, PRESSURE, CONTACT_STIFFNESS].into_iter().find(|shared| key.segments() == [*shared]),
            _ => None,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    model: String,
    band: Option<[f64; 2]>,
    unstable: Option<InstabilityCriterion>,
    bin: Option<f64>,
    #[serde(default = "yes")]
    follow: bool,
    bisections: Option<usize>,
    #[serde(default = "yes")]
    gradients: bool,
    contacts: Option<usize>,
    design: DesignTable,
    #[serde(default)]
    correlation: Vec<CorrelationTable>,
    #[serde(default)]
    parameter: BTreeMap<Spanned<String>, ParameterTable>,
    #[serde(default)]
    field: BTreeMap<Spanned<String>, FieldTable>,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterTable {
    key: OneOrMore,
    #[serde(default)]
    factor: bool,
    values: Option<Vec<f64>>,
    uniform: Option<[f64; 2]>,
    loguniform: Option<[f64; 2]>,
    normal: Option<NormalTable>,
    lognormal: Option<LogNormalTable>,
}

#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum OneOrMore {
    One(String),
    More(Vec<String>),
}

impl OneOrMore {
    pub fn texts(&self) -> &[String] {
        match self {
            OneOrMore::One(text) => std::slice::from_ref(text),
            OneOrMore::More(texts) => texts,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalTable {
    mean: f64,
    deviation: f64,
    from: Option<f64>,
    to: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LogNormalTable {
    mean: f64,
    deviation: f64,
}

/// Width of frequency bins where none is given, Hz.
const BIN: f64 = 500.0;
/// Bisections of the line to the nominal point where none are given: three more solutions a point at most.
const BISECTIONS: usize = 2;
/// n of them take `2^n - 1` solutions a point.
const MAX_BISECTIONS: usize = 6;

/// Reads and checks the file of a study; the model that it names is looked for beside it.
///
/// # Errors
/// [`Error::Input`] with file and line.
pub fn read(path: &Path) -> Result<Study> {
    let bytes = std::fs::read(path)
        .map_err(|reason| Error::input(format!("{}: cannot read the file of the study: {reason}", path.display())))?;
    parse(utf8(path, &bytes)?, path)
}

/// The study of a text.
pub(super) fn parse(text: &str, path: &Path) -> Result<Study> {
    let line = |offset: usize| 1 + text[..offset.min(text.len())].matches('\n').count();
    let at = |offset: usize, what: String| Error::input(located(path, line(offset), what));
    let keys: Keys = toml::from_str(text).map_err(|error| {
        let advice = "A study has model, [design] with kind, and [parameter.NAME] with key and values, uniform, \
                      loguniform, normal or lognormal";
        at(error.span().map_or(0, |span| span.start), format!("{}. {advice}", error.message().trim_end()))
    })?;
    let mut parameters = parameters(keys.parameter).map_err(|(offset, what)| at(offset, what))?;
    let fields = fields(keys.field, &mut parameters).map_err(|(offset, what)| at(offset, what))?;
    let design = design(&keys.design, &parameters, path)
        .and_then(|design| correlated(design, &keys.correlation, &parameters))
        .map_err(|what| at(keys.design.kind.span().start, what.to_string()))?;
    let bin = keys.bin.unwrap_or(BIN);
    let [from, to] = keys.band.unwrap_or([0.0, 1.0]);
    let mistakes = [
        keys.unstable.and_then(InstabilityCriterion::mistake),
        parameters
            .is_empty()
            .then_some("there is no parameter. Add a [parameter.NAME] with its key, or a [field.NAME]"),
        (bin.is_nan() || bin <= 0.0).then_some("bin is not above 0. Give the width of the frequency bins in Hz"),
        (!(0.0..to).contains(&from)).then_some("band is not [from, to] with 0 <= from < to. Give both ends in Hz"),
    ];
    let mistakes = mistakes.into_iter().flatten().map(str::to_owned).chain(shared_twice(&parameters));
    if let Some(what) = mistakes.into_iter().next() {
        return Err(Error::input(format!("{}: {what}", path.display())));
    }
    let study = Study {
        file: path.to_owned(),
        model: beside(path, &keys.model),
        parameters,
        fields,
        design,
        contacts: keys.contacts,
        band: keys.band,
        criterion: keys.unstable,
        bin,
        follow: follow(keys.follow, keys.bisections, path)?,
        gradients: keys.gradients && keys.follow,
    };
    study.contacts.map_or(Ok(()), |_| study.require_no_fields())?;
    Ok(study)
}

/// What is wrong where two parameters have one of the keys that models and super-elements share.
fn shared_twice(parameters: &[Parameter]) -> Option<String> {
    parameters.iter().enumerate().find_map(|(i, own)| {
        let key = own.shared_key()?;
        let first = parameters[..i].iter().find(|earlier| earlier.shared_key() == Some(key))?;
        let names = format!("parameters {:?} and {:?}", first.name, own.name);
        Some(format!("{names} both have the key {key}. Leave one of them out"))
    })
}

/// How often the line to the nominal point may be bisected; none where modes are not followed.
fn follow(follow: bool, bisections: Option<usize>, path: &Path) -> Result<Option<usize>> {
    let n = bisections.unwrap_or(BISECTIONS);
    if n > MAX_BISECTIONS || bisections.is_some() && !follow {
        let what = format!("bisections is a number from 0 to {MAX_BISECTIONS}, and goes with follow = true");
        return Err(Error::input(format!("{}: {what}", path.display())));
    }
    Ok(follow.then_some(n))
}

/// The parameters of the tables in the order of the file, or what is wrong with its place in the text.
fn parameters(
    tables: BTreeMap<Spanned<String>, ParameterTable>,
) -> std::result::Result<Vec<Parameter>, (usize, String)> {
    let mut tables: Vec<(Spanned<String>, ParameterTable)> = tables.into_iter().collect();
    tables.sort_by_key(|(name, _)| name.span().start);
    let own = |(name, table): (Spanned<String>, ParameterTable)| {
        let wrong = |what: String| (name.span().start, format!("parameter {:?}: {what}", name.get_ref()));
        parameter(name.get_ref(), &table).map_err(wrong)
    };
    tables.into_iter().map(own).collect()
}

fn parameter(name: &str, table: &ParameterTable) -> std::result::Result<Parameter, String> {
    let keys = table
        .key
        .texts()
        .iter()
        .map(|key| KeyPath::parse(key))
        .collect::<Result<Vec<_>>>()
        .map_err(|e| e.to_string())?;
    let distribution = distribution(table)?;
    let parameter = Parameter { name: name.to_owned(), keys, is_factor: table.factor, distribution };
    match (parameter.shared_key(), parameter.keys.is_empty()) {
        (Some(key), _) if table.factor => {
            Err(format!("factor does not go with {key}: pressure and contact_stiffness are factors, friction is not"))
        }
        (_, true) => Err("key is an empty list. Name the keys of the model file that it changes".into()),
        _ => Ok(parameter),
    }
}

fn distribution(table: &ParameterTable) -> std::result::Result<Distribution, String> {
    let normal = |own: &NormalTable| Distribution::Normal {
        mean: own.mean,
        deviation: own.deviation,
        from: own.from.unwrap_or(f64::NEG_INFINITY),
        to: own.to.unwrap_or(f64::INFINITY),
    };
    let lognormal = |own: &LogNormalTable| Distribution::LogNormal { mean: own.mean, deviation: own.deviation };
    let sorted = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values
    };
    let given = [
        table.values.clone().map(sorted).map(Distribution::Values),
        table.uniform.map(|[from, to]| Distribution::Uniform { from, to }),
        table.loguniform.map(|[from, to]| Distribution::LogUniform { from, to }),
        table.normal.as_ref().map(normal),
        table.lognormal.as_ref().map(lognormal),
    ];
    let mut given = given.into_iter().flatten();
    let (Some(found), None) = (given.next(), given.next()) else {
        return Err("give one of values, uniform, loguniform, normal and lognormal".into());
    };
    let is_valid = match &found {
        Distribution::Values(values) => !values.is_empty() && values.iter().all(|value| value.is_finite()),
        Distribution::Uniform { from, to } => from < to && from.is_finite() && to.is_finite(),
        Distribution::LogUniform { from, to } => 0.0 < *from && from < to && to.is_finite(),
        Distribution::Normal { deviation, from, to, mean } => *deviation > 0.0 && from < to && mean.is_finite(),
        Distribution::LogNormal { mean, deviation } => *mean > 0.0 && *deviation > 0.0,
    };
    let advice = "Give values = [0.3, 0.4], uniform = [from, to] with from < to, loguniform = [from, to] with \
                  0 < from < to, normal = { mean, deviation, from, to } (from and to may be missing), or lognormal = \
                  { mean, deviation }; deviations are above 0";
    is_valid.then_some(found).ok_or_else(|| format!("no values can be like this. {advice}"))
}

#[cfg(test)]
mod tests {
    use super::super::{Correlation, DesignKind};
    use super::*;

    const TEXT: &str = "model = \"brake.toml\"\nbin = 250\n[design]\nkind = \"sobol\"\npoints = 8\nseed = 3\n\
        [parameter.mu]\nkey = \"friction\"\nuniform = [0.3, 0.6]\n\
        [parameter.E]\nkey = [\"material.lining.young\", \"material.lining.young_axial\"]\nfactor = true\n\
        normal = { mean = 1, deviation = 0.1, from = 0.5 }\n";

    fn message(old: &str, new: &str) -> String {
        assert!(TEXT.contains(old));
        parse(&TEXT.replacen(old, new, 1), "a/explore.toml".as_ref()).unwrap_err().to_string()
    }

    #[test]
    fn a_file_is_read() {
        let study = parse(TEXT, "a/explore.toml".as_ref()).unwrap();
        assert_eq!((study.model.as_path(), study.bin, study.follow), ("a/brake.toml".as_ref(), 250.0, Some(2)));
        assert_eq!(study.design, Design { kind: DesignKind::Sobol { n_points: 8 }, seed: 3, correlation: None });
        let [mu, modulus] = &study.parameters[..] else { panic!("two parameters, in the order of the file") };
        assert_eq!((mu.name.as_str(), mu.shared_key(), mu.is_factor), ("mu", Some("friction"), false));
        assert_eq!((modulus.keys.len(), modulus.shared_key(), modulus.is_factor), (2, None, true));
        assert!(matches!(modulus.distribution, Distribution::Normal { from: 0.5, to: f64::INFINITY, .. }));
        let follow = |keys: &str| parse(&TEXT.replace("bin = 250", keys), "explore.toml".as_ref()).unwrap().follow;
        assert_eq!((follow("bisections = 5"), follow("follow = false")), (Some(5), None));
    }

    /// Quantiles rise: so a range goes from the smallest to the largest value, in whatever order they are given.
    #[test]
    fn values_are_sorted() {
        let text = TEXT.replace("uniform = [0.3, 0.6]", "values = [0.5, 0.2, 0.4]");
        let mu = &parse(&text, "explore.toml".as_ref()).unwrap().parameters[0];
        assert_eq!((&mu.distribution, mu.range()), (&Distribution::Values(vec![0.2, 0.4, 0.5]), [0.2, 0.5]));
    }

    #[test]
    fn mistakes_have_their_line_and_advice() {
        for (old, new, parts) in [
            ("sobol", "sobel", ["explore.toml:4", "Did you mean \"sobol\""]),
            ("points = 8", "levels = 8", ["explore.toml:4", "levels does not go with"]),
            ("points = 8", "points = 8\nstart = 4", ["explore.toml:4", "start does not go with"]),
            ("sobol\"\npoints = 8", "adaptive\"\npoints = 8\nstart = 9", ["explore.toml:4", "start from 1 to points"]),
            ("sobol", "adaptive\"\nresolution = 2 #", ["explore.toml:4", "resolution between 0 and 1"]),
            ("sobol\"\npoints = 8", "adaptive\"\npoints = 4097", ["at most 4096 points", "Give fewer points"]),
            ("points = 8", "", ["explore.toml:4", "needs points"]),
            ("[0.3, 0.6]", "[0.6, 0.3]", ["explore.toml:7", "from < to"]),
            ("uniform = [0.3, 0.6]", "", ["parameter \"mu\"", "give one of values"]),
            ("uniform", "unifrom", ["explore.toml:9", "unknown field"]),
            ("key = \"friction\"", "key = \"friction\"\nfactor = true", ["parameter \"mu\"", "friction is not"]),
            ("[parameter.E]", "[parameter.a]\nkey = \"friction\"\nvalues = [1]\n[parameter.E]", ["\"mu\" and", "both"]),
            ("bin = 250", "bisections = 7", ["explore.toml", "from 0 to 6"]),
            ("bin = 250", "follow = false\nbisections = 2", ["explore.toml", "goes with follow = true"]),
            ("bin = 250", "bin = 0", ["explore.toml", "bin is not above 0. Give"]),
            ("bin = 250", "band = [3000, 0]", ["explore.toml", "band is not [from, to]"]),
            ("\"friction\"", "\"a..b\"", ["explore.toml:7", "no key of a model file"]),
        ] {
            let message = message(old, new);
            assert!(parts.iter().all(|part| message.contains(part)), "{parts:?} in {message}");
        }
    }

    #[test]
    fn correlations_name_two_parameters() {
        let with = |between: &str, coefficient: f64| {
            let text = format!("{TEXT}[[correlation]]\nbetween = {between}\ncoefficient = {coefficient}\n");
            parse(&text, "a/explore.toml".as_ref())
        };
        let expected = Correlation::new(2, &[([1, 0], 0.5)]);
        assert_eq!(with("[\"E\", \"mu\"]", 0.5).unwrap().design.correlation, expected);
        let message = |between: &str, coefficient| with(between, coefficient).unwrap_err().to_string();
        assert!(message("[\"e\", \"mu\"]", 0.5).contains("no parameter \"e\". Did you mean \"E\""));
        assert!(message("[\"E\", \"mu\"]", 1.5).contains("between -1 and 1"));
        assert!(message("[\"E\", \"E\"]", 0.5).contains("no parameters can have"));
    }

    #[test]
    fn a_list_has_a_column_for_each_parameter() {
        let place = tempfile::tempdir().unwrap();
        let text = TEXT.replace("\"sobol\"\npoints = 8", "\"list\"\nfile = \"p.csv\"");
        let read = |points: &str| {
            std::fs::write(place.path().join("p.csv"), points).unwrap();
            parse(&text, &place.path().join("explore.toml"))
        };
        let found = read("E, note, mu\n1.5, a, 0.4\n1, b, 0.5\n").unwrap();
        assert_eq!(found.design.kind, DesignKind::List(vec![vec![0.4, 1.5], vec![0.5, 1.0]]));
        let missing = read("e,mu\n1,2\n").unwrap_err().to_string();
        assert!(missing.contains("there is no column \"E\"") && missing.contains("Did you mean"), "{missing}");
        assert!(read("E,mu\n1,two\n").unwrap_err().to_string().contains("row 2 has \"two\""));
    }
}
