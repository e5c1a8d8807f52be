//! How much of a Newton step to take.
//!
//! With the step `u - l du` and the residual F, the search looks for a zero of
//!
//! ```text
//! phi(l) = F(u - l du) . du
//! ```
//!
//! between 0 and 1: where F is the gradient of an energy, its minimum along the step. Contact makes phi kinked and
//! stiff, so that a secant alone may jump to and fro: the zero stays between two ends at which phi has different signs.
//! The residual's norm does not serve: a point that closes a little too far has a large force and is nearly right.

use crate::Result;

/// The whole step is taken where it leaves no more than this of `phi(0)`.
const WHOLE_STEP_SHARE: f64 = 0.5;
/// The search ends where no more than this of `phi(0)` is left.
const ZERO_SHARE: f64 = 0.1;
/// Values of phi at most.
const MAX_VALUES: usize = 12;
/// The length of a step along which phi grows.
const GROWING_STEP_LENGTH: f64 = 0.5;
/// The next length keeps away from the ends by this share of what is between them.
const MARGIN: f64 = 0.1;

/// The length of a step, given `phi(0)`: 1 where phi falls and keeps its sign or is small at 1; half where it grows,
/// so that two steps that lead to and fro do not repeat each other; else near its zero. phi is evaluated last at the
/// length that is returned.
///
/// # Errors
/// Those of phi.
pub(super) fn critical_length(at_zero: f64, mut phi: impl FnMut(f64) -> Result<f64>) -> Result<f64> {
    // The ends between which the zero lies.
    let (mut low, mut high) = ((0.0, at_zero), (1.0, phi(1.0)?));
    let is_beyond = |value: f64| !value.is_finite() || value * at_zero < 0.0;
    if !at_zero.is_finite() {
        return Ok(1.0);
    }
    if !is_beyond(high.1) {
        let is_growing = high.1.abs() > at_zero.abs();
        return if is_growing { phi(GROWING_STEP_LENGTH).map(|_| GROWING_STEP_LENGTH) } else { Ok(1.0) };
    }
    if high.1.abs() <= WHOLE_STEP_SHARE * at_zero.abs() {
        return Ok(1.0);
    }
    let mut last = high;
    for _ in 1..MAX_VALUES {
        let length = between(low, high);
        last = (length, phi(length)?);
        if last.1.abs() <= ZERO_SHARE * at_zero.abs() {
            break;
        }
        *(if is_beyond(last.1) { &mut high } else { &mut low }) = last;
    }
    if !last.1.is_finite() {
        phi(low.0)?;
        return Ok(low.0);
    }
    Ok(last.0)
}

/// The zero of the line through two points, not too near to either; the middle where one of them has no value.
fn between((a, at_a): (f64, f64), (b, at_b): (f64, f64)) -> f64 {
    let share = at_a / (at_a - at_b);
    let share = if share.is_finite() && at_b.is_finite() { share.clamp(MARGIN, 1.0 - MARGIN) } else { 0.5 };
    a + share * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The length found, and where phi was evaluated.
    fn search(phi: impl Fn(f64) -> f64) -> (f64, Vec<f64>) {
        let mut lengths = Vec::new();
        let length = critical_length(phi(0.0), |length| {
            lengths.push(length);
            Ok(phi(length))
        });
        (length.unwrap(), lengths)
    }

    #[test]
    fn a_step_that_leaves_half_or_falls_with_one_sign_is_taken_whole() {
        for at_one in [0.0, -0.5, 0.5, 1.0] {
            assert_eq!(search(|length| 1.0 + (at_one - 1.0) * length), (1.0, vec![1.0]), "{at_one}");
            assert_eq!(search(|length| -1.0 - (at_one - 1.0) * length), (1.0, vec![1.0]), "{at_one}");
        }
    }

    #[test]
    fn a_step_along_which_phi_grows_is_halved() {
        assert_eq!(search(|length| 1.0 + 0.1 * length), (0.5, vec![1.0, 0.5]));
        assert_eq!(search(|length| -1.0 - 0.1 * length), (0.5, vec![1.0, 0.5]));
    }

    #[test]
    fn a_step_too_far_ends_at_the_zero() {
        // Exact for a line: 1 - 3 l
        let (length, lengths) = search(|length| 1.0 - 3.0 * length);
        assert!((length - 1.0 / 3.0).abs() < 1e-15 && lengths.len() == 2, "{lengths:?}");
    }

    #[test]
    fn a_kink_does_not_throw_the_search_out() {
        // Contact closes at 0.3, a thousand times as stiff: the zero is at 0.3008.
        let phi = |length: f64| 1.0 - 0.5 * length - 1000.0 * (length - 0.3).max(0.0);
        let (length, lengths) = search(phi);
        assert!((length - 0.3008).abs() < 1e-3 && phi(length).abs() <= ZERO_SHARE, "{length} {lengths:?}");
        assert!(lengths.iter().all(|length| (0.0..=1.0).contains(length)));
        assert_eq!(lengths.last(), Some(&length), "the last value is that of the step");
    }

    #[test]
    fn a_search_without_end_ends() {
        // A jump has no zero.
        let (length, lengths) = search(|length| if length < 0.7 { 1.0 } else { -1.0 });
        assert!(lengths.len() == MAX_VALUES && (length - 0.7).abs() < 0.1, "{length}");
    }

    #[test]
    fn a_step_to_where_there_is_no_value_is_shortened_and_one_from_there_is_not() {
        let (length, lengths) = search(|length| if length > 0.6 { f64::NAN } else { 0.05 - length });
        assert!(length <= 0.6 && lengths[..2] == [1.0, 0.5], "{lengths:?}");
        assert_eq!(search(|_| f64::NAN), (1.0, vec![1.0]));
        // No value near the end: the search ends where there is one.
        let (length, lengths) = search(|length| if length > 0.3 { f64::NAN } else { 1.0 });
        assert!(length <= 0.3 && lengths.last() == Some(&length), "{lengths:?}");
    }
}
