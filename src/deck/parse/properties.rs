//! Springs, dashpots, masses and rotary inertias.

use super::Parser;
use crate::Result;
use crate::deck::VOIGT_ORDER;
use crate::deck::card::Card;
use crate::deck::types::{Property, PropertyKind};
use crate::model::PointMass;

impl Parser {
    /// The constant of a spring or dashpot, below the displacements that it is between; a mass; an inertia. A spring
    /// has its imaginary stiffness behind the real one.
    pub(super) fn property(&mut self, card: &Card) -> Result<()> {
        let set = self.name_of(card, "ELSET")?;
        let kind = match card.name.as_str() {
            "SPRING" => PropertyKind::Spring,
            "DASHPOT" => PropertyKind::Dashpot,
            "MASS" => PropertyKind::Mass,
            _ => PropertyKind::RotaryInertia,
        };
        let mut rows = Vec::new();
        while let Some(row) = self.lines.row()? {
            rows.push(row.reals::<6>(0, "a number")?);
        }
        let has_dofs = matches!(kind, PropertyKind::Spring | PropertyKind::Dashpot) && rows.len() > 1;
        let dofs = has_dofs.then(|| [0, 1].map(|i| rows[0][i] as u8));
        let missing = || card.error(format_args!("the constant is missing ({})", card.spelled));
        let (&(mut values), others) = rows[usize::from(has_dofs)..].split_first().ok_or_else(missing)?;
        if !others.is_empty() {
            let what = "a second row of constants: they depend on frequency or temperature. Keep one row";
            return Err(card.error(format_args!("{what} ({})", card.spelled)));
        }
        if kind == PropertyKind::Spring && !card.has("COMPLEXSTIFFNESS") {
            // A frequency or temperature.
            values[1] = 0.0;
        }
        if let Some(what) = impossible(kind, values) {
            return Err(card.error(format_args!("{what} ({})", card.spelled)));
        }
        let orientation = card.word("ORIENTATION");
        self.scope().properties.push(Property { kind, set, dofs, values, orientation, place: card.place });
        Ok(())
    }
}

/// What is wrong with the values of a property.
fn impossible(kind: PropertyKind, values: [f64; 6]) -> Option<String> {
    match kind {
        PropertyKind::RotaryInertia => (!PointMass::is_possible(VOIGT_ORDER.map(|i| values[i]))).then(|| {
            let advice = "Give I11, I22, I33, I12, I13, I23; I12 is minus the integral of x y dm";
            format!("{}. {advice}", PointMass::NEGATIVE_MOMENT)
        }),
        PropertyKind::Spring if values[1] < 0.0 || values[1] > 0.0 && values[0] == 0.0 => {
            Some("an imaginary stiffness must be 0 or above, beside a real one".to_owned())
        }
        _ => (values[0] < 0.0).then(|| format!("the constant must be 0 or above, not {}", values[0])),
    }
}
