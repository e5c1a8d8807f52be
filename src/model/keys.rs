//! The keys of a model file as serde sees them; `example.toml` explains each. Values are unchecked, their places are
//! kept. `schema.json` has the same keys for editors.

use super::item::{Number, Vector};
use super::{Inertia, InstabilityCriterion};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt::{self, Formatter};
use toml::Spanned;

/// A string and where it stands.
pub type Text = Spanned<String>;
/// Tables `[kind.<name>]`; sorted by name, so the order of the file is that of the spans.
pub type Named<T> = BTreeMap<Text, T>;

/// A number, or one for each axis or plane.
#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "expected a number, or three of them in brackets")]
pub enum OneOrThree {
    One(f64),
    Three([f64; 3]),
}

/// A coefficient, or how it depends on sliding speed, pressure and temperature.
#[derive(Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "expected a number, \"rough\", { static = 0.6, kinetic = 0.4, decay = 0.5 }, the same with stribeck_speed = 0.1 in \
                 place of decay, or { by = [\"speed\"], table = [[0.6, 0], [0.4, 2]] }"
)]
pub enum Friction {
    Constant(f64),
    Word(FrictionWord),
    Decay(DecayTable),
    Stribeck(StribeckTable),
    Table(FrictionRows),
}

/// How the modulus of a material depends on frequency and temperature.
#[derive(Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "expected { by = [\"frequency\"], table = [[2e6, 0.3, 100], [9e6, 0.9, 3000]] }, { maxwell = [[5e6, 1e-4]] } or \
                 { unrelaxed = 1e9, relaxation_time = 1e-7, order = 0.6 }"
)]
pub enum Viscoelastic {
    Table(ViscoelasticRows),
    Maxwell(MaxwellTable),
    FractionalZener(ZenerTable),
}

/// Friction without a number.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FrictionWord {
    Rough,
}

/// A contact law, or `"auto"`: the program proposes one.
pub enum Law {
    Auto,
    Given(LawTable),
}

impl<'de> Deserialize<'de> for Law {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Law, D::Error> {
        struct LawVisitor;

        impl<'de> Visitor<'de> for LawVisitor {
            type Value = Law;

            fn expecting(&self, out: &mut Formatter) -> fmt::Result {
                out.write_str("\"auto\", { linear = 2e13 } or { cubic = [2e13, 1e22] }")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Law, E> {
                if text == "auto" { Ok(Law::Auto) } else { Err(E::invalid_value(Unexpected::Str(text), &self)) }
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Law, A::Error> {
                LawTable::deserialize(MapAccessDeserializer::new(map)).map(Law::Given)
            }
        }

        deserializer.deserialize_any(LawVisitor)
    }
}

/// Tables of the file, in which every key must be known.
macro_rules! tables {
    ($($(#[$attribute:meta])* pub struct $name:ident { $($keys:tt)* })*) => {
        $(#[derive(Deserialize)]
        #[serde(deny_unknown_fields, expecting = "a table")]
        $(#[$attribute])*
        pub struct $name { $($keys)* })*

        /// All tables and their keys.
        #[cfg(test)]
        pub fn tables() -> Vec<(&'static str, &'static [&'static str])> {
            vec![$((stringify!($name), super::tests::schema::names::<$name>())),*]
        }
    };
}

tables! {
    pub struct File {
        pub title: Option<String>,
        pub mesh: Spanned<MeshTable>,
        #[serde(default)]
        pub material: Named<MaterialTable>,
        #[serde(default)]
        pub part: Named<PartTable>,
        #[serde(default)]
        pub fix: Vec<Spanned<FixTable>>,
        #[serde(default)]
        pub rotation: Vec<Spanned<RotationTable>>,
        #[serde(default)]
        pub contact: Vec<Spanned<ContactTable>>,
        #[serde(default)]
        pub connector: Vec<Spanned<ConnectorTable>>,
        #[serde(default)]
        pub tie: Vec<Spanned<TieTable>>,
        #[serde(default)]
        pub rigid: Vec<Spanned<RigidTable>>,
        #[serde(default)]
        pub mass: Vec<Spanned<MassTable>>,
        #[serde(default)]
        pub equation: Vec<Spanned<EquationTable>>,
        #[serde(default)]
        pub load: Vec<Spanned<LoadTable>>,
        pub stability: Spanned<StabilityTable>,
        pub sweep: Option<Spanned<SweepTable>>,
        pub reduction: Option<Spanned<ReductionTable>>,
    }

    pub struct MeshTable {
        pub file: Text,
        pub unit: Text,
    }

    /// All kinds of material together; `materials` knows which keys belong to which kind.
    pub struct MaterialTable {
        pub kind: Option<Text>,
        pub density: Number,
        pub young: Option<Spanned<OneOrThree>>,
        pub poisson: Option<Spanned<OneOrThree>>,
        pub axis: Option<Vector>,
        pub young_axial: Option<Number>,
        pub poisson_axial: Option<Number>,
        pub shear_axial: Option<Number>,
        pub shear: Option<Vector>,
        pub x_axis: Option<Vector>,
        pub y_axis: Option<Vector>,
        pub elasticity: Option<Spanned<[[f64; 6]; 6]>>,
        pub loss_factor: Option<Number>,
        pub viscoelastic: Option<Spanned<Viscoelastic>>,
    }

    pub struct ViscoelasticRows {
        pub by: Vec<String>,
        pub table: Vec<Vec<f64>>,
        pub temperature: Option<f64>,
    }

    pub struct MaxwellTable {
        pub maxwell: Vec<[f64; 2]>,
    }

    #[derive(Clone, Copy)]
    pub struct ZenerTable {
        pub unrelaxed: f64,
        pub relaxation_time: f64,
        pub order: f64,
    }

    pub struct PartTable {
        pub material: Text,
        #[serde(default)]
        pub rayleigh: RayleighTable,
        #[serde(default)]
        pub elements: Vec<Text>,
    }

    #[derive(Default)]
    pub struct RayleighTable {
        pub alpha: Option<Number>,
        pub beta: Option<Number>,
    }

    pub struct FixTable {
        pub nodes: String,
        pub axes: Text,
        pub displacement: Option<Vector>,
    }

    pub struct RotationTable {
        pub part: Text,
        pub axis: Vector,
        pub through: Option<Vector>,
        pub speed: Number,
        #[serde(default)]
        pub inertia: Inertia,
    }

    pub struct ContactTable {
        pub name: Option<String>,
        pub slave: String,
        pub master: String,
        pub law: Spanned<Law>,
        pub friction: Spanned<Friction>,
        pub stick: Option<Number>,
        pub separation: Option<bool>,
        pub search: Option<Number>,
        pub adjust: Option<Number>,
        pub clearance: Option<Number>,
        pub gap: Option<Text>,
        pub gap_image: Option<Spanned<GapImageTable>>,
        pub stiffness_factor: Option<Text>,
        pub wear: Option<Number>,
    }

    pub struct GapImageTable {
        pub plane: String,
        pub lower_left: [f64; 2],
        pub upper_right: [f64; 2],
        pub black: f64,
        pub white: f64,
    }

    #[derive(Clone, Copy)]
    pub struct DecayTable {
        #[serde(rename = "static")]
        pub at_rest: f64,
        pub kinetic: f64,
        pub decay: f64,
    }

    #[derive(Clone, Copy)]
    pub struct StribeckTable {
        #[serde(rename = "static")]
        pub at_rest: f64,
        pub kinetic: f64,
        pub stribeck_speed: f64,
        #[serde(default = "one")]
        pub exponent: f64,
        #[serde(default)]
        pub viscous: f64,
    }

    pub struct FrictionRows {
        pub by: Vec<String>,
        pub table: Vec<Vec<f64>>,
        pub temperature: Option<f64>,
    }

    pub struct LawTable {
        pub linear: Option<Number>,
        pub cubic: Option<Spanned<[f64; 2]>>,
        pub table: Option<Spanned<Vec<[f64; 2]>>>,
    }

    pub struct ConnectorTable {
        pub name: Option<String>,
        pub between: Spanned<[String; 2]>,
        pub at: Option<Vector>,
        pub x_axis: Option<Vector>,
        pub y_axis: Option<Vector>,
        pub stiffness: Vector,
        pub rotational_stiffness: Option<Vector>,
        pub damping: Option<Vector>,
        pub loss_factor: Option<Number>,
    }

    pub struct TieTable {
        pub name: Option<String>,
        pub slave: String,
        pub master: String,
        pub search: Option<Number>,
        pub stiffness: Option<Number>,
    }

    pub struct RigidTable {
        pub name: Option<String>,
        pub nodes: String,
    }

    pub struct MassTable {
        pub name: Option<String>,
        pub nodes: String,
        pub mass: Number,
        pub at: Option<Vector>,
        pub inertia: Option<Spanned<[f64; 6]>>,
    }

    pub struct EquationTable {
        pub name: Option<String>,
        pub terms: Spanned<Vec<EquationTermTable>>,
    }

    pub struct EquationTermTable {
        pub node: String,
        pub axis: Text,
        pub coefficient: Number,
    }

    pub struct LoadTable {
        pub name: Option<String>,
        pub on: Option<String>,
        pub force: Option<Vector>,
        pub moment: Option<Vector>,
        pub at: Option<Vector>,
        pub spread: Option<Text>,
        pub pressure: Option<Number>,
        pub gravity: Option<Vector>,
    }

    pub struct StabilityTable {
        pub band: Spanned<[f64; 2]>,
        #[serde(default)]
        pub friction_damping: bool,
        pub prestress: Option<bool>,
        pub unstable: Option<Spanned<InstabilityCriterion>>,
    }

    pub struct SweepTable {
        pub friction: Spanned<FrictionSweepTable>,
    }

    pub struct FrictionSweepTable {
        pub contacts: Option<Vec<Text>>,
        pub values: Option<Vec<Number>>,
        pub from: Option<Number>,
        pub to: Option<Number>,
        pub step: Option<Number>,
    }

    pub struct ReductionTable {
        pub contacts: Spanned<usize>,
        pub band: Spanned<[f64; 2]>,
    }
}

fn one() -> f64 {
    1.0
}
