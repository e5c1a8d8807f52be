//! Two results, mode by mode: which modes are the same, and by how much they differ. Pure: plain data in, plain data
//! out.
//!
//! The results may be of a full model, of one with fewer contacts, of a super-element, of another mesh. Their shapes
//! are compared where both are known ([`CommonPoints`]). How much two complex shapes x and y have in common, whatever
//! their scales, is the modal assurance criterion
//!
//! ```text
//! MAC = |x^H y|^2 / ((x^H x) (y^H y))        1: one shape, 0: orthogonal
//! ```
//!
//! Modes whose eigenvalues nearly agree, such as the doublets of a disc, have no shapes of their own: any mixture is as
//! good. They are compared as subspaces ([`MacTable`]). Who is whose partner is then an optimal assignment over shape
//! and eigenvalue; modes that have too little in common with every partner left stay without one.

mod common_points;
mod instabilities;
mod mac;
mod pairing;
mod study;

pub use common_points::CommonPoints;
pub use instabilities::CurvePoint;
pub use mac::{MacTable, groups_of_near, mac_with_span};
pub use study::{Errors, Onset, Sizes, StudiedModel, Study, n_contacts};

use num_complex::Complex64;
use serde::Serialize;

use crate::results::{ModeData, Results, Value};
use crate::{Error, Result};

/// What two results, A and B, have in common at each friction value that both have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The band of both, Hz.
    #[serde(rename = "band_hz")]
    pub band: [f64; 2],
    /// Points at which shapes were compared.
    #[serde(rename = "points")]
    pub n_points: usize,
    /// Whether B's shapes were interpolated to A's points.
    pub interpolated: bool,
    /// The reference of growth rate errors, 1/s: the largest growth rate of A at these friction values or, where
    /// nothing grows, the largest modulus of one.
    #[serde(rename = "largest_growth_rate_per_s")]
    pub largest_growth: f64,
    /// One value after the other, rising.
    pub values: Vec<ComparisonAtValue>,
}

/// One friction value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonAtValue {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Modes that are the same, by A's frequency.
    pub pairs: Vec<ModePair>,
    /// Modes of A and of B without partner.
    pub unmatched: [Vec<ComparedMode>; 2],
}

/// A mode of A and its partner of B.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModePair {
    /// That of A.
    pub a: ComparedMode,
    /// That of B.
    pub b: ComparedMode,
    /// `f_B / f_A - 1`
    pub frequency_error: f64,
    /// `(a_B - a_A) / a_largest`
    pub growth_error: f64,
    /// Modal assurance criterion, of subspaces where the mode is one of several with nearly one eigenvalue.
    pub mac: f64,
}

/// A mode of A or of B.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedMode {
    /// Its number at the friction value, from 1.
    pub mode: usize,
    /// Hz.
    #[serde(rename = "frequency_hz")]
    pub frequency: f64,
    /// 1/s.
    #[serde(rename = "growth_rate_per_s")]
    pub growth_rate: f64,
    /// Whether it grows.
    pub unstable: bool,
}

/// Two friction values are one within this.
const SAME_FRICTION: f64 = 1e-9;

/// Compares two results at all friction values that both have.
///
/// ```no_run
/// use squeal::comparison::compare;
/// use squeal::results::file;
///
/// let (full, reduced) = (file::read("full/results.h5".as_ref())?, file::read("reduced/results.h5".as_ref())?);
/// for value in &compare(&full, &reduced)?.values {
///     println!("mu = {}: {} modes are the same", value.friction, value.pairs.len());
/// }
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] where they have no friction value, no band or no surface in common.
pub fn compare(a: &Results, b: &Results) -> Result<Comparison> {
    let band = common_band(a.about.band, b.about.band)?;
    let common = common_values(a, b)?;
    let points = CommonPoints::new(a, b)?;
    let of_a: Vec<f64> = common.iter().flat_map(|[a, _]| &a.modes).map(ModeData::growth_rate).collect();
    let fastest = of_a.iter().copied().fold(0.0, f64::max);
    let largest = of_a.iter().fold(f64::MIN_POSITIVE, |most, growth| most.max(growth.abs()));
    let largest_growth =
        if common.iter().any(|[a, _]| a.modes.iter().any(|mode| mode.unstable)) { fastest } else { largest };
    let values = common.iter().map(|values| ComparisonAtValue::new(*values, &points, band, largest_growth)).collect();
    Ok(Comparison { band, n_points: points.len(), interpolated: points.are_interpolated(), largest_growth, values })
}

fn common_band(a: [f64; 2], b: [f64; 2]) -> Result<[f64; 2]> {
    let band = [a[0].max(b[0]), a[1].min(b[1])];
    if band[0] < band[1] {
        return Ok(band);
    }
    Err(Error::input(format!("no common band: {}-{} Hz and {}-{} Hz", a[0], a[1], b[0], b[1])))
}

/// The values of each common friction coefficient.
fn common_values<'r>(a: &'r Results, b: &'r Results) -> Result<Vec<[&'r Value; 2]>> {
    let partner =
        |value: &Value| b.values.iter().find(|other| (other.friction - value.friction).abs() <= SAME_FRICTION);
    let mut common: Vec<[&Value; 2]> =
        a.values.iter().filter_map(|value| partner(value).map(|other| [value, other])).collect();
    common.sort_by(|[p, _], [q, _]| p.friction.total_cmp(&q.friction));
    if common.is_empty() {
        let list = |results: &Results| {
            let list: Vec<String> =
                results.values.iter().filter(|value| value.asked).map(|value| value.friction.to_string()).collect();
            if list.is_empty() { "none".to_owned() } else { list.join(", ") }
        };
        let what = format!("no common friction: {} and {}", list(a), list(b));
        return Err(Error::input(format!("{what}. Run one of them at the friction values of the other (--friction)")));
    }
    Ok(common)
}

impl ComparisonAtValue {
    fn new([a, b]: [&Value; 2], points: &CommonPoints, band: [f64; 2], largest_growth: f64) -> ComparisonAtValue {
        let [lambdas_a, lambdas_b] = [a, b].map(|value| value.modes.iter().map(|mode| mode.lambda).collect::<Vec<_>>());
        let shapes_a: Vec<Vec<Complex64>> = a.modes.iter().map(|mode| points.of_a(&mode.sampled)).collect();
        let shapes_b: Vec<Vec<Complex64>> = b.modes.iter().map(|mode| points.of_b(&mode.sampled)).collect();
        let mac_table = MacTable::new([&lambdas_a, &lambdas_b], [&shapes_a, &shapes_b]);
        let found = pairing::pairs(&mac_table, [&lambdas_a, &lambdas_b]);
        let pair = |&[i, j]: &[usize; 2]| {
            let modes = [ComparedMode::new(i, &a.modes[i]), ComparedMode::new(j, &b.modes[j])];
            ModePair::new(modes, mac_table.mac(i, j), largest_growth)
        };
        let inside = |f: f64| (band[0]..=band[1]).contains(&f);
        let any_inside = |pair: &ModePair| inside(pair.a.frequency) || inside(pair.b.frequency);
        let pairs = found.iter().map(pair).filter(any_inside).collect();
        let unmatched = [0, 1].map(|side| {
            let modes = &[a, b][side].modes;
            let alone = |i: &usize| found.iter().all(|pair| pair[side] != *i) && inside(modes[*i].frequency());
            (0..modes.len()).filter(alone).map(|i| ComparedMode::new(i, &modes[i])).collect()
        });
        ComparisonAtValue { friction: a.friction, pairs, unmatched }
    }
}

impl ModePair {
    fn new([a, b]: [ComparedMode; 2], mac: f64, largest_growth: f64) -> ModePair {
        let frequency_error = (b.frequency - a.frequency) / a.frequency.max(f64::MIN_POSITIVE);
        let growth_error = (b.growth_rate - a.growth_rate) / largest_growth;
        ModePair { a, b, frequency_error, growth_error, mac }
    }

    /// Whether it grows in A or in B.
    pub fn is_unstable(&self) -> bool {
        self.a.unstable || self.b.unstable
    }
}

impl ComparedMode {
    /// The mode of an index.
    fn new(i: usize, data: &ModeData) -> ComparedMode {
        ComparedMode {
            mode: i + 1,
            frequency: data.frequency(),
            growth_rate: data.growth_rate(),
            unstable: data.unstable,
        }
    }
}

#[cfg(test)]
mod tests;
