//! The JSON schema has the keys of the model file and no others, and every model file satisfies it.

use jsonschema::Validator;
use serde::de::value::Error;
use serde::de::{DeserializeOwned, Error as _, Visitor};
use serde::forward_to_deserialize_any;
use serde_json::Value;

use crate::model::{EXAMPLE, InstabilityCriterion, SCHEMA, keys};

/// Takes the names that a type asks for.
struct Names<'a>(&'a mut &'static [&'static str]);

impl<'de> serde::Deserializer<'de> for Names<'_> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("neither a table nor a choice"))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        *self.0 = fields;
        self.deserialize_any(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        *self.0 = variants;
        self.deserialize_any(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct
        seq tuple tuple_struct map identifier ignored_any
    }
}

/// The keys of a table, or the names of a choice.
pub fn names<T: DeserializeOwned>() -> &'static [&'static str] {
    let mut names: &'static [&'static str] = &[];
    assert!(T::deserialize(Names(&mut names)).is_err());
    names
}

fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

fn validator() -> Validator {
    jsonschema::draft202012::new(&schema()).unwrap()
}

/// What the schema has against a model file; nothing where it satisfies it.
fn complaints(text: &str) -> Vec<String> {
    let document = serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap();
    validator().iter_errors(&document).map(|error| error.to_string()).collect()
}

fn sorted(names: impl Iterator<Item = impl ToString>) -> Vec<String> {
    let mut names: Vec<String> = names.map(|name| name.to_string()).collect();
    names.sort();
    names
}

#[test]
fn the_schema_has_the_keys_of_each_table_and_no_others() {
    let schema = schema();
    let criterion = ("InstabilityCriterion", names::<InstabilityCriterion>());
    for (table, keys) in keys::tables().into_iter().chain([criterion]) {
        let own = if table == "File" { &schema } else { &schema["$defs"][table] };
        let properties = own["properties"].as_object().unwrap_or_else(|| panic!("the schema lacks {table}"));
        assert_eq!(sorted(properties.keys()), sorted(keys.iter()), "{table}");
        assert_eq!(own["additionalProperties"], false, "{table}");
        assert!(properties.values().all(|key| key.get("description").or(key.get("$ref")).is_some()), "{table}");
    }
}

#[test]
fn every_table_of_the_schema_is_one_of_the_model_file() {
    let tables: Vec<&str> = keys::tables().into_iter().map(|(table, _)| table).collect();
    let definitions = schema()["$defs"].as_object().unwrap().clone();
    let others: Vec<&String> = definitions.keys().filter(|name| !tables.contains(&name.as_str())).collect();
    assert_eq!(others, ["Viscoelastic", "Friction", "InstabilityCriterion", "Band"]);
}

#[test]
fn all_model_files_of_the_repository_satisfy_the_schema() {
    let mut n_files = 0;
    for folder in ["meshes", "tests/data", "docs/manual/first-brake"] {
        let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        for path in paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml")) {
            let text = std::fs::read_to_string(&path).unwrap();
            // The study of `squeal explore` names a model file.
            if text.lines().any(|line| line.starts_with("model = ")) {
                continue;
            }
            let complaints = complaints(&text);
            assert!(complaints.is_empty(), "{}: {complaints:?}", path.display());
            n_files += 1;
        }
    }
    assert!(n_files > 8, "{n_files}");
    assert!(complaints(EXAMPLE).is_empty(), "{:?}", complaints(EXAMPLE));
}

#[test]
fn what_the_program_refuses_the_schema_refuses() {
    for (good, bad) in [
        ("density = 7100", "densty = 7100"),
        ("young = 110e9", "young = \"110 GPa\""),
        ("kind = \"transverse\"", "kind = \"transvers\""),
        ("poisson_axial = 0.10", ""),
        ("law = \"auto\"  ", "law = \"aut\"  "),
        ("law = { cubic = [2e13, 1e22] }", "law = { cubic = [2e13] }"),
        ("stick = 1e13", "stick = -1e13"),
        ("axes = \"xyz\"", "axes = \"xyw\""),
        ("band = [0, 6000]", "band = [6000]"),
        ("pressure = 4e6", ""),
        ("inertia = \"none\"", "inertia = \"fixed\""),
        ("prestress = false", "prestress = 0"),
        ("contacts = 104", "contacts = 10.4"),
        ("unstable = { damping_ratio = -0.001 }", "unstable = { damping = -0.001 }"),
    ] {
        assert_eq!(EXAMPLE.matches(good).count(), 1, "{good}");
        let text = EXAMPLE.replace(good, bad);
        assert!(crate::model::parse(&text, "brake.toml".as_ref()).is_err(), "{bad:?} is accepted");
        assert!(!complaints(&text).is_empty(), "{bad:?} satisfies the schema");
    }
}
