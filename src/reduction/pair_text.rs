//! Contact pairs in the text of a super-element's file.

use serde::{Deserialize, Serialize};

use crate::contact::interface::{ArchardWear, ContactPair, Statistics, TangentialKind};
use crate::contact::{FrictionLaw, Tangential};
use crate::model::{NormalLaw, is_pressure_table};

use super::super_element::{NodeContact, SuperElement};

/// A pair.
#[derive(Serialize, Deserialize)]
pub(super) struct PairText {
    name: String,
    slave: String,
    master: String,
    #[serde(default)]
    pub(super) kind: KindText,
    /// One number: linear, N/m3; two: cubic, N/m3 and N/m5.
    law: Vec<f64>,
    friction: f64,
    separation: bool,
    swept: bool,
    area: f64,
    n_contacts: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    wear: Option<ArchardWear>,
    /// Without a user's own function.
    #[serde(default)]
    friction_law: FrictionLaw,
}

/// What acts in the tangent plane of a pair.
#[derive(Serialize, Deserialize, Clone, Copy, Default)]
#[serde(rename_all = "snake_case")]
pub(super) enum KindText {
    #[default]
    Sliding,
    Frictionless,
    /// With this stiffness while it sticks, N/m3.
    StickSlip(f64),
}

impl KindText {
    fn of(pair: &ContactPair, contacts: &[NodeContact]) -> KindText {
        let stick = |contact: &NodeContact| match contact.point.law.tangential {
            Tangential::StickSlip { stick } => Some(stick),
            _ => None,
        };
        match (pair.kind, contacts[pair.points.clone()].iter().find_map(stick)) {
            (TangentialKind::Sliding, _) => KindText::Sliding,
            (_, Some(stick)) => KindText::StickSlip(stick),
            (_, None) => KindText::Frictionless,
        }
    }

    fn kind(self) -> TangentialKind {
        match self {
            KindText::Sliding => TangentialKind::Sliding,
            KindText::Frictionless => TangentialKind::Frictionless,
            KindText::StickSlip(_) => TangentialKind::StickSlip,
        }
    }

    /// What acts at a point under which the master slides along a direction with a speed.
    pub(super) fn tangential(self, direction: [f64; 3], speed: f64) -> Tangential {
        match self {
            KindText::StickSlip(stick) => Tangential::StickSlip { stick },
            KindText::Sliding if speed != 0.0 => Tangential::Sliding { direction, speed },
            _ => Tangential::Frictionless,
        }
    }
}

pub(super) fn pair_texts(element: &SuperElement) -> Vec<PairText> {
    let of = |pair: &ContactPair| PairText {
        name: pair.name.clone(),
        slave: pair.slave.clone(),
        master: pair.master.clone(),
        kind: KindText::of(pair, &element.contacts),
        law: match &pair.law {
            NormalLaw::Linear { stiffness } => vec![*stiffness],
            NormalLaw::Cubic { k1, k3 } => vec![*k1, *k3],
            NormalLaw::Table { rows } => rows.concat(),
        },
        friction: pair.friction,
        separation: pair.separation,
        swept: pair.swept,
        area: pair.statistics.area,
        n_contacts: pair.points.len(),
        wear: pair.wear,
        friction_law: pair.friction_law.storable(),
    };
    element.pairs.iter().map(of).collect()
}

pub(super) fn pairs(texts: &[PairText]) -> Vec<ContactPair> {
    let mut first = 0;
    let of = |text: &PairText| {
        let points = first..first + text.n_contacts;
        first = points.end;
        ContactPair {
            name: text.name.clone(),
            slave: text.slave.clone(),
            master: text.master.clone(),
            law: match text.law[..] {
                [k1, k3] => NormalLaw::Cubic { k1, k3 },
                ref rows if is_pressure_table(rows.as_chunks().0) => {
                    NormalLaw::Table { rows: rows.as_chunks().0.to_vec() }
                }
                [stiffness] => NormalLaw::Linear { stiffness },
                _ => NormalLaw::Linear { stiffness: f64::NAN },
            },
            friction: text.friction,
            friction_law: text.friction_law.clone(),
            kind: text.kind.kind(),
            separation: text.separation,
            swept: text.swept,
            wear: text.wear,
            points,
            statistics: Statistics { area: text.area, ..Statistics::default() },
        }
    };
    texts.iter().map(of).collect()
}
