//! Laws of viscoelastic materials: how the stiffness depends on frequency and temperature.
//!
//! A law multiplies the elasticity of its material, the static one, by a complex factor `r(s)`, s the eigenvalue, with
//! `r(0) = 1`, and the same for all strains: Poisson's ratio is constant. With Young's modulus E at rest:
//!
//! ```text
//! maxwell             r(s) = 1 + sum_k (E_k / E) s tau_k / (1 + s tau_k)
//! fractional Zener    r(s) = (1 + (E_u / E) (s tau)^alpha) / (1 + (s tau)^alpha)
//! table               r(s) = (E'(f) / E) (1 + i eta(f)),  f = Im s / 2 pi
//! ```
//!
//! Sources: generalised Maxwell model (Wiechert); fractional Zener model of four parameters E, E_u, tau, alpha (Bagley
//! and Torvik, AIAA Journal 21, 1983, pages 741-748).

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::grid::{Grid, GridInterval, columns};
use super::item::Item;
use super::keys;
use crate::Result;

/// The factor on the static stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ViscoelasticLaw {
    /// A spring beside springs in series with dashpots.
    Maxwell(Vec<MaxwellElement>),
    /// A spring beside a spring in series with a fractional element.
    FractionalZener(FractionalZener),
    /// As a table has it.
    Table(ModulusTable),
}

/// A spring in series with a dashpot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MaxwellElement {
    /// `E_k / E`, the spring's modulus over that at rest.
    pub ratio: f64,
    /// `tau_k`, s.
    pub relaxation_time: f64,
}

/// The fractional Zener model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FractionalZener {
    /// `E_u / E`, the modulus at high frequency over that at rest.
    pub unrelaxed_ratio: f64,
    /// `tau`, s.
    pub relaxation_time: f64,
    /// alpha, above 0, at most 1.
    pub order: f64,
}

/// Modulus and loss factor over the frequency: `ln E'` and eta are linear in `ln f`, constant beyond the ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModulusTable {
    /// Rising frequencies, Hz; one where nothing depends on it.
    pub frequencies: Vec<f64>,
    /// `E' / E`, the first 1: the modulus at rest is that of the lowest frequency.
    pub ratios: Vec<f64>,
    /// eta.
    pub loss_factors: Vec<f64>,
}

impl ViscoelasticLaw {
    /// `r(s)` for s (1/s) with `Im s >= 0`. A table has no loss where s is real.
    pub fn factor(&self, s: Complex64) -> Complex64 {
        match self {
            ViscoelasticLaw::Maxwell(elements) => {
                let element = |own: &MaxwellElement| {
                    let x = s * own.relaxation_time;
                    own.ratio * x / (1.0 + x)
                };
                1.0 + elements.iter().map(element).sum::<Complex64>()
            }
            ViscoelasticLaw::FractionalZener(zener) => {
                let x = zener.fractional(s);
                (1.0 + zener.unrelaxed_ratio * x) / (1.0 + x)
            }
            ViscoelasticLaw::Table(table) => table.factor(s),
        }
    }

    /// `dr / ds`; of a table the derivative along the imaginary axis, as if s kept its real part.
    pub fn slope(&self, s: Complex64) -> Complex64 {
        match self {
            ViscoelasticLaw::Maxwell(elements) => {
                let element = |own: &MaxwellElement| {
                    let tau = own.relaxation_time;
                    own.ratio * tau / ((1.0 + s * tau) * (1.0 + s * tau))
                };
                elements.iter().map(element).sum()
            }
            ViscoelasticLaw::FractionalZener(zener) if s != Complex64::ZERO => {
                // dr/dx = (E_u / E - 1) / (1 + x)^2, dx/ds = alpha x / s
                let x = zener.fractional(s);
                (zener.unrelaxed_ratio - 1.0) / ((1.0 + x) * (1.0 + x)) * zener.order * x / s
            }
            ViscoelasticLaw::FractionalZener(_) => Complex64::ZERO,
            ViscoelasticLaw::Table(table) => table.slope(s),
        }
    }
}

impl ViscoelasticLaw {
    /// Whether another law is of the same kind, and each of its numbers differs by no more than a part of itself.
    pub fn is_close(&self, other: &ViscoelasticLaw, part: f64) -> bool {
        let (own, other_numbers) = (self.numbers(), other.numbers());
        let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= part * a.abs();
        std::mem::discriminant(self) == std::mem::discriminant(other)
            && own.len() == other_numbers.len()
            && own.iter().zip(&other_numbers).all(is_close)
    }

    fn numbers(&self) -> Vec<f64> {
        match self {
            ViscoelasticLaw::Maxwell(elements) => {
                elements.iter().flat_map(|own| [own.ratio, own.relaxation_time]).collect()
            }
            ViscoelasticLaw::FractionalZener(own) => vec![own.unrelaxed_ratio, own.relaxation_time, own.order],
            ViscoelasticLaw::Table(own) => [&own.frequencies[..], &own.ratios, &own.loss_factors].concat(),
        }
    }

    /// Whether its numbers are those of a material: for laws that do not come from a model file.
    pub fn is_sound(&self) -> bool {
        let is_positive = |x: &f64| *x > 0.0 && x.is_finite();
        match self {
            ViscoelasticLaw::Maxwell(elements) => {
                elements.iter().all(|own| is_positive(&own.ratio) && is_positive(&own.relaxation_time))
            }
            ViscoelasticLaw::FractionalZener(own) => {
                let numbers = [own.unrelaxed_ratio, own.relaxation_time, own.order];
                numbers.iter().all(is_positive) && own.unrelaxed_ratio > 1.0 && own.order <= 1.0
            }
            ViscoelasticLaw::Table(ModulusTable { frequencies, ratios, loss_factors }) => {
                let rises = frequencies.is_sorted_by(|a, b| a < b) && frequencies.iter().chain(ratios).all(is_positive);
                let n = frequencies.len();
                let is_loss = |x: &f64| *x >= 0.0 && x.is_finite();
                n > 0 && rises && [ratios.len(), loss_factors.len()] == [n; 2] && loss_factors.iter().all(is_loss)
            }
        }
    }
}

impl FractionalZener {
    /// `(s tau)^alpha`, 0 at 0.
    fn fractional(&self, s: Complex64) -> Complex64 {
        if s == Complex64::ZERO { s } else { (s * self.relaxation_time).powf(self.order) }
    }
}

impl ModulusTable {
    fn factor(&self, s: Complex64) -> Complex64 {
        let (ratio, loss_factor, _) = self.at(s.im / TAU);
        if s.im > 0.0 { ratio * Complex64::new(1.0, loss_factor) } else { Complex64::ONE }
    }

    /// `dr/ds = -i dr/d omega`
    fn slope(&self, s: Complex64) -> Complex64 {
        if s.im <= 0.0 {
            return Complex64::ZERO;
        }
        // ln r = ln E' + ln (1 + i eta), d ln f = d omega / omega
        let (ratio, loss_factor, [d_ratio, d_loss]) = self.at(s.im / TAU);
        let logarithmic = ratio * (d_ratio * Complex64::new(1.0, loss_factor) + Complex64::I * d_loss);
        -Complex64::I * logarithmic / s.im
    }

    /// `E' / E`, eta, and the derivatives of `ln E'` and eta with `ln f` at a frequency, Hz.
    fn at(&self, frequency: f64) -> (f64, f64, [f64; 2]) {
        let logarithms: Vec<f64> = self.frequencies.iter().map(|f| f.ln()).collect();
        let interval = GridInterval::around(&logarithms, frequency.max(0.0).ln());
        let ratios = [interval.lower, interval.upper].map(|i| self.ratios[i].ln());
        let losses = [interval.lower, interval.upper].map(|i| self.loss_factors[i]);
        let slopes = [ratios, losses].map(|[lower, upper]| interval.slope(lower, upper));
        (interval.between(ratios[0], ratios[1]).exp(), interval.between(losses[0], losses[1]), slopes)
    }
}

/// What a table may depend on.
const VARIABLES: [&str; 2] = ["frequency", "temperature"];

/// Reads the key `viscoelastic` of an isotropic material: Young's modulus at rest (Pa) and the law. `young` is the
/// material's own, where it is given: laws have it, tables have theirs.
///
/// # Errors
/// Input errors for moduli, times, orders and tables that no law can have.
pub fn law(item: &Item, raw: &Spanned<keys::Viscoelastic>, young: Option<f64>) -> Result<(f64, ViscoelasticLaw)> {
    let require = |holds: bool, what: &str, advice: &str| item.require_at(&raw.span(), holds, what, advice);
    match raw.get_ref() {
        keys::Viscoelastic::Table(table) => {
            require(young.is_none(), "young is in the viscoelastic table, too", "Leave young out")?;
            tabular(item, raw, table)
        }
        keys::Viscoelastic::Maxwell(keys::MaxwellTable { maxwell }) => {
            let young = *item.required(&young, "young", AT_REST)?;
            let holds = maxwell.iter().flatten().all(|x| *x > 0.0 && x.is_finite()) && !maxwell.is_empty();
            require(holds, &format!("viscoelastic has maxwell = {maxwell:?}"), MAXWELL)?;
            let element =
                |&[modulus, relaxation_time]: &[f64; 2]| MaxwellElement { ratio: modulus / young, relaxation_time };
            Ok((young, ViscoelasticLaw::Maxwell(maxwell.iter().map(element).collect())))
        }
        &keys::Viscoelastic::FractionalZener(keys::ZenerTable { unrelaxed, relaxation_time, order }) => {
            let young = *item.required(&young, "young", AT_REST)?;
            let numbers = [unrelaxed, relaxation_time, order].into_iter().all(f64::is_finite);
            let holds = numbers && unrelaxed > young && relaxation_time > 0.0 && order > 0.0 && order <= 1.0;
            let what = format!(
                "viscoelastic has unrelaxed = {unrelaxed:e}, relaxation_time = {relaxation_time:e}, order = {order}"
            );
            require(holds, &what, ZENER)?;
            let zener = FractionalZener { unrelaxed_ratio: unrelaxed / young, relaxation_time, order };
            Ok((young, ViscoelasticLaw::FractionalZener(zener)))
        }
    }
}

const AT_REST: &str = "Give Young's modulus at rest in Pa: the viscoelastic law adds to it";
const MAXWELL: &str = "Give rows [modulus in Pa, relaxation time in s], all above 0";
const ZENER: &str = "Give the modulus at high frequency, unrelaxed, in Pa and above young, a relaxation_time above 0 in s, \
                     and an order above 0, up to 1";
const ROWS: &str = "A row is [Young's modulus in Pa, loss factor, value, ...] in the order of `by`, modulus and frequency above 0, \
                    loss factor 0 or above; every combination of the values once";

/// A table of modulus and loss factor over frequency and temperature, at the material's temperature.
fn tabular(
    item: &Item,
    raw: &Spanned<keys::Viscoelastic>,
    table: &keys::ViscoelasticRows,
) -> Result<(f64, ViscoelasticLaw)> {
    let keys::ViscoelasticRows { by, table: rows, temperature } = table;
    let refuse = |what: String, advice: &str| item.error(&raw.span(), what, advice);
    let names: Vec<&str> = by.iter().map(String::as_str).collect();
    let columns =
        columns(VARIABLES, &names, 2).filter(|columns| columns.iter().any(Option::is_some)).ok_or_else(|| {
            let advice = "Give by = [\"frequency\"], or both of \"frequency\" and \"temperature\", each once";
            refuse(format!("the viscoelastic table is by {by:?}"), advice)
        })?;
    if columns[1].is_some() != temperature.is_some() {
        let advice = "Give temperature = ... beside a table by temperature, in the table's unit, and only there";
        return Err(refuse("the table and the temperature do not go together".into(), advice));
    }
    let is_wrong = |row: &&Vec<f64>| {
        let is_row = row.len() == by.len() + 2 && row.iter().all(|x| x.is_finite());
        !is_row || row[0] <= 0.0 || row[1] < 0.0 || columns[0].is_some_and(|frequency| row[frequency] <= 0.0)
    };
    if let Some(row) = rows.iter().find(is_wrong) {
        return Err(refuse(format!("the viscoelastic table has the row {row:?}"), ROWS));
    }
    let grid = Grid::new(rows, columns).filter(|_| !rows.is_empty()).ok_or_else(|| {
        let what = "the viscoelastic table is empty, or has a combination of values not at all or twice";
        refuse(what.into(), ROWS)
    })?;
    Ok(at_temperature(grid, temperature.unwrap_or(0.0)))
}

/// Modulus at rest and table at a temperature: `ln E'` and eta are linear in it.
fn at_temperature(grid: Grid<2>, temperature: f64) -> (f64, ViscoelasticLaw) {
    let Grid { axes: [frequencies, temperatures], rows } = grid;
    let interval = GridInterval::around(&temperatures, temperature);
    let between = |rows: &[Vec<f64>], value: fn(&Vec<f64>) -> f64| {
        interval.between(value(&rows[interval.lower]), value(&rows[interval.upper]))
    };
    let frequency_by_frequency = || rows.chunks(temperatures.len());
    let moduli: Vec<f64> = frequency_by_frequency().map(|rows| between(rows, |row| row[0].ln()).exp()).collect();
    let loss_factors = frequency_by_frequency().map(|rows| between(rows, |row| row[1])).collect();
    let young = moduli[0];
    let ratios = moduli.iter().map(|modulus| modulus / young).collect();
    (young, ViscoelasticLaw::Table(ModulusTable { frequencies, ratios, loss_factors }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> [ViscoelasticLaw; 3] {
        let element = |ratio, relaxation_time| MaxwellElement { ratio, relaxation_time };
        [
            ViscoelasticLaw::Maxwell(vec![element(2.0, 1e-3), element(5.0, 1e-5)]),
            ViscoelasticLaw::FractionalZener(FractionalZener {
                unrelaxed_ratio: 50.0,
                relaxation_time: 1e-5,
                order: 0.6,
            }),
            ViscoelasticLaw::Table(ModulusTable {
                frequencies: vec![100.0, 1e3, 1e4],
                ratios: vec![1.0, 3.0, 20.0],
                loss_factors: vec![0.2, 0.9, 0.5],
            }),
        ]
    }

    #[test]
    fn at_rest_and_at_high_frequency_moduli_are_those_of_the_law() {
        for (law, unrelaxed) in laws().iter().zip([8.0, 50.0, 20.0]) {
            assert_eq!(law.factor(Complex64::ZERO), Complex64::ONE);
            let high = law.factor(Complex64::new(0.0, 1e15));
            assert!((high.re / unrelaxed - 1.0).abs() < 1e-3, "{high}");
        }
    }

    /// `1 + 2 i / (1 + i)` at `omega tau = 1`, and `1 / (1 + i)` of the fractional element of order 1.
    #[test]
    fn factors_are_those_of_the_formulas() {
        let law = ViscoelasticLaw::Maxwell(vec![MaxwellElement { ratio: 2.0, relaxation_time: 1e-3 }]);
        let s = Complex64::new(0.0, 1e3);
        assert!((law.factor(s) - Complex64::new(2.0, 1.0)).norm() < 1e-14);
        // A fractional Zener law of order 1 is a Maxwell law of one element.
        let zener = FractionalZener { unrelaxed_ratio: 3.0, relaxation_time: 1e-3, order: 1.0 };
        let s = Complex64::new(-300.0, 700.0);
        assert!((law.factor(s) - ViscoelasticLaw::FractionalZener(zener).factor(s)).norm() < 1e-13);
    }

    #[test]
    fn a_table_has_its_rows_and_goes_straight_between_them_in_logarithms() {
        let table = &laws()[2];
        let at = |f: f64| table.factor(Complex64::new(-5.0, TAU * f));
        assert!((at(1e3) - 3.0 * Complex64::new(1.0, 0.9)).norm() < 1e-12);
        let middle = (3.0 * 20.0_f64).sqrt() * Complex64::new(1.0, 0.7);
        assert!((at(1e4 / 10_f64.sqrt()) - middle).norm() < 1e-12);
        assert!((at(1.0) - Complex64::new(1.0, 0.2)).norm() < 1e-12);
    }

    #[test]
    fn laws_of_no_material_are_not_sound() {
        assert!(laws().iter().all(ViscoelasticLaw::is_sound));
        let [maxwell, zener, table] = laws();
        let ViscoelasticLaw::Table(table) = table else { panic!("a table") };
        let ViscoelasticLaw::FractionalZener(zener) = zener else { panic!("a fractional law") };
        for wrong in [
            FractionalZener { order: f64::NAN, ..zener },
            FractionalZener { order: 1.1, ..zener },
            FractionalZener { unrelaxed_ratio: 1.0, ..zener },
        ] {
            assert!(!ViscoelasticLaw::FractionalZener(wrong).is_sound(), "{wrong:?}");
        }
        assert!(ViscoelasticLaw::FractionalZener(FractionalZener { order: 1.0, ..zener }).is_sound());
        let ViscoelasticLaw::Maxwell(mut elements) = maxwell else { panic!("Maxwell's law") };
        elements[1].relaxation_time = 0.0;
        assert!(!ViscoelasticLaw::Maxwell(elements).is_sound());
        for wrong in [
            ModulusTable { frequencies: Vec::new(), ratios: Vec::new(), loss_factors: Vec::new() },
            ModulusTable { frequencies: vec![100.0, 1e4, 1e3], ..table.clone() },
            ModulusTable { ratios: vec![1.0, 2.0], ..table.clone() },
            ModulusTable { loss_factors: vec![0.1, -0.2, 0.3], ..table },
        ] {
            assert!(!ViscoelasticLaw::Table(wrong.clone()).is_sound(), "{wrong:?}");
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        const STEP: f64 = 1e-5;
        let s = Complex64::new(-800.0, TAU * 2500.0);
        for law in laws() {
            let step = Complex64::new(0.0, STEP * s.im);
            let difference = (law.factor(s + step) - law.factor(s - step)) / (2.0 * step);
            assert!((law.slope(s) - difference).norm() < 1e-8 * difference.norm(), "{law:?}");
        }
    }
}
