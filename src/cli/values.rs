//! Values, bands and laws as people type them.

use std::ops::RangeInclusive;

use crate::model::{InstabilityCriterion, LARGEST_FRICTION, NormalLaw, Rayleigh, UnitSystem, spaced};
use crate::structure::PartDamping;

/// Values of friction or of any parameter, no two of them the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Values(pub Vec<f64>);

/// `0.5`, `0.2,0.5` or `FROM:TO:STEP`, the end included.
pub fn parse(text: &str) -> Result<Values, String> {
    let Values(values) = values(text)?;
    if let Some(mu) = values.iter().find(|mu| !(0.0..=LARGEST_FRICTION).contains(*mu)) {
        return Err(format!("friction {mu} is out of range: 0 to {LARGEST_FRICTION}"));
    }
    Ok(Values(values))
}

/// How numbers are given.
const FORMS: &str = "expected one value, a list 0.2,0.5 or a range FROM:TO:STEP";

/// As [`parse`], of any numbers.
pub fn values(text: &str) -> Result<Values, String> {
    let values = match text.split(':').collect::<Vec<_>>()[..] {
        [list] => {
            list.split(',').map(number).collect::<Result<Vec<_>, _>>().map_err(|what| format!("{what}; {FORMS}"))?
        }
        [from, to, step] => range(text, number(from)?, number(to)?, number(step)?)?,
        _ => return Err(FORMS.into()),
    };
    match values.iter().enumerate().find(|(i, value)| values[..*i].contains(value)) {
        Some((_, value)) => Err(format!("{value} is given twice")),
        None => Ok(Values(values)),
    }
}

/// A range whose steps reach its end.
fn range(text: &str, from: f64, to: f64, step: f64) -> Result<Vec<f64>, String> {
    let values = spaced(from, to, step)
        .ok_or_else(|| format!("the range {text} has no value, or too many: give FROM:TO:STEP"))?;
    match values.last() {
        Some(last) if (last - to).abs() > 1e-6 * step.abs() => {
            Err(format!("the steps of {text} do not reach {to}: the last value is {last}. Give another end or step"))
        }
        _ => Ok(values),
    }
}

/// `FROM:TO` in Hz.
pub fn band(text: &str) -> Result<[f64; 2], String> {
    let (from, to) = text.split_once(':').ok_or("expected FROM:TO in Hz")?;
    let band = [number(from)?, number(to)?];
    if band[0] < 0.0 || band[0] >= band[1] {
        return Err("the band is empty: FROM must be at least 0 and below TO".into());
    }
    Ok(band)
}

/// One coefficient of friction.
pub fn single(text: &str) -> Result<f64, String> {
    match parse(text)?.0[..] {
        [mu] => Ok(mu),
        _ => Err("expected one value".into()),
    }
}

/// A frequency in Hz.
pub fn frequency(text: &str) -> Result<f64, String> {
    match number(text)? {
        f if f > 0.0 => Ok(f),
        f => Err(format!("{f} Hz is not above 0")),
    }
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("{text:?} is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("{text:?} is not finite")) }
}

/// `damping_ratio:X` or `growth_rate:X`.
pub fn criterion(text: &str) -> Result<InstabilityCriterion, String> {
    let wanted = "expected damping_ratio:-0.001 (a fraction: -0.1 %) or growth_rate:5 (1/s)";
    let (kind, limit) = text.split_once(':').ok_or(wanted)?;
    let criterion = match kind {
        "damping_ratio" => InstabilityCriterion::DampingRatio(number(limit)?),
        "growth_rate" => InstabilityCriterion::GrowthRate(number(limit)?),
        _ => return Err(wanted.into()),
    };
    criterion.mistake().map_or(Ok(criterion), |mistake| Err(mistake.into()))
}

/// A number of things, 1 or more.
pub fn count(text: &str) -> Result<usize, String> {
    text.trim().parse().ok().filter(|n| *n > 0).ok_or_else(|| format!("{text:?} is not a whole number above 0"))
}

/// A system of units, such as mm-t-s.
pub fn units(text: &str) -> Result<UnitSystem, String> {
    UnitSystem::named(text)
}

/// `linear:K` or `cubic:K1,K3`, of node-to-node contacts, in N/m and N/m3.
pub fn law(text: &str) -> Result<NormalLaw, String> {
    let wanted = "give linear:K in N/m, or cubic:K1,K3 in N/m and N/m3";
    let (kind, numbers) = text.split_once(':').ok_or_else(|| format!("the law has no coefficients: {wanted}"))?;
    let values: Vec<f64> = numbers.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let are_good = values.len() == numbers.split(',').count() && values.iter().all(|k| *k > 0.0 && k.is_finite());
    match (kind, &values[..]) {
        ("linear", &[stiffness]) if are_good => Ok(NormalLaw::Linear { stiffness }),
        ("cubic", &[k1, k3]) if are_good => Ok(NormalLaw::Cubic { k1, k3 }),
        ("linear", _) => Err(format!("a linear law needs one coefficient above 0: {wanted}")),
        ("cubic", _) => Err(format!("a cubic law needs two coefficients above 0: {wanted}")),
        _ => Err(format!("unknown law {kind:?}: {wanted}")),
    }
}

/// `PART=ALPHA,BETA`, coefficients of 0 or more.
pub fn damping(text: &str) -> Result<PartDamping, String> {
    let wanted = "expected PART=ALPHA,BETA, such as disc=5,1e-7 (1/s and s)";
    // Names may have an equals sign.
    let (part, numbers) = text.rsplit_once('=').ok_or(wanted)?;
    let (alpha, beta) = numbers.split_once(',').ok_or(wanted)?;
    let rayleigh = Rayleigh { alpha: number(alpha)?, beta: number(beta)? };
    if rayleigh.alpha < 0.0 || rayleigh.beta < 0.0 {
        return Err(format!("the damping {numbers} is negative"));
    }
    Ok(PartDamping { part: part.into(), rayleigh })
}

/// Factors beyond these are slips of the pen: rounding errors are all that their equilibria have.
const FACTORS: RangeInclusive<f64> = 1e-6..=1e6;

/// A factor on what the model has.
pub fn factor(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(factor) if FACTORS.contains(&factor) => Ok(factor),
        _ => Err(format!("{text:?} is not a number from 1e-6 to 1e6: give a multiple of what the model has")),
    }
}

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value > 0.0 => Ok(value),
        value => Err(format!("{value} is not above 0")),
    }
}

/// Options of PETSc, names with their dash.
pub type PetscOptions = Vec<(String, String)>;

/// `-name value` pairs for PETSc's option database.
pub fn petsc_options(texts: &[String]) -> Result<PetscOptions, String> {
    let mut pairs = PetscOptions::new();
    for word in texts.iter().flat_map(|text| text.split_whitespace()) {
        match (word.starts_with('-') && word.parse::<f64>().is_err(), pairs.last_mut()) {
            (true, _) => pairs.push((word.into(), String::new())),
            (false, Some((_, value))) if value.is_empty() => *value = word.into(),
            _ => return Err(format!("--petsc takes options like \"-name value\"; {word:?} has no -name before it")),
        }
    }
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_include_their_end() {
        let Values(values) = parse("0.1:0.9:0.1").unwrap();
        assert_eq!(values, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
        assert_eq!(parse("0.5").unwrap().0, [0.5]);
        assert_eq!(parse("0.9:0.1:-0.4").unwrap().0, [0.9, 0.5, 0.1]);
    }

    #[test]
    fn nonsense_is_refused_with_a_reason() {
        for text in ["", "a", "0.1:0.9", "0.1:0.5:0.3", "0.1:0.9:-0.1", "0.1:0.9:0", "-0.1", "3", "nan", "0.4,0.4"] {
            assert!(parse(text).is_err(), "{text}");
        }
        assert!(band("6000:0").is_err() && band("0:0").is_err() && band("5").is_err());
        assert_eq!(band("0:6000").unwrap(), [0.0, 6000.0]);
    }

    #[test]
    fn damping_has_a_part_and_two_coefficients() {
        let Ok(PartDamping { part, rayleigh }) = damping("pad=left=5,1e-7") else { panic!("it is right") };
        assert_eq!((part.as_str(), rayleigh), ("pad=left", Rayleigh { alpha: 5.0, beta: 1e-7 }));
        for text in ["disc", "disc=5", "disc=a,1", "disc=-1,0"] {
            assert!(damping(text).is_err(), "{text}");
        }
    }

    #[test]
    fn criteria_have_their_kind_and_a_limit_that_can_be() {
        assert_eq!(criterion("damping_ratio:-0.001"), Ok(InstabilityCriterion::DampingRatio(-0.001)));
        assert_eq!(criterion("growth_rate:5"), Ok(InstabilityCriterion::GrowthRate(5.0)));
        for (text, reason) in [
            ("0.1", "expected damping_ratio:"),
            ("zeta:0.1", "expected damping_ratio:"),
            ("growth_rate:x", "is not a number"),
            ("growth_rate:-1", "must be 0 or above"),
            ("damping_ratio:0.1", "not above 0"),
        ] {
            assert!(criterion(text).unwrap_err().contains(reason), "{text}");
        }
    }

    #[test]
    fn counts_are_whole_numbers_above_zero() {
        assert_eq!(count("104"), Ok(104));
        for text in ["abc", "0", "-3", "1.5"] {
            assert_eq!(count(text), Err(format!("{text:?} is not a whole number above 0")));
        }
    }

    #[test]
    fn laws_need_their_coefficients() {
        assert_eq!(law("cubic:1e8,2e18").unwrap(), NormalLaw::Cubic { k1: 1e8, k3: 2e18 });
        assert_eq!(law("linear:3").unwrap(), NormalLaw::Linear { stiffness: 3.0 });
        for (text, reason) in [
            ("cubic", "no coefficients"),
            ("cubic:1e8", "two coefficients"),
            ("cubic:1e8,x", "two coefficients"),
            ("cubic:1e8,-1", "two coefficients"),
            ("linear:1,2", "one coefficient"),
            ("square:1", "unknown law"),
        ] {
            assert!(law(text).unwrap_err().contains(reason), "{text}");
        }
        assert!(["0", "nan", "-1", "1e300", "2e6"].iter().all(|text| factor(text).is_err()));
        assert_eq!(["1.5", "1e6"].map(factor), [Ok(1.5), Ok(1e6)]);
    }
}
