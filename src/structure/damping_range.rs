//! Whether the band and the damping are those of a brake.

use std::f64::consts::TAU;

use crate::model::{Model, Rayleigh};

/// Bands of squeal end above this, Hz.
const SMALLEST_END: f64 = 100.0;
/// Damping ratio of a part at a band's end above which it is said: brakes have some percent at most.
const LARGEST_RATIO: f64 = 0.5;

/// Warnings about band and damping.
pub(super) fn warnings(model: &Model) -> Vec<String> {
    let damping = model.parts.iter().filter_map(|part| damping(&part.name, part.rayleigh, model.band[1]));
    band(model.band[1]).into_iter().chain(damping).collect()
}

/// A band's end, Hz.
fn band(end: f64) -> Option<String> {
    (end < SMALLEST_END).then(|| format!("the band ends at {end} Hz. Was it given in kHz? Give Hz, such as [0, 6000]"))
}

/// Rayleigh damping of a part at the band's end f, Hz: `zeta = (alpha / omega + beta omega) / 2`, `omega = 2 pi f`.
fn damping(part: &str, Rayleigh { alpha, beta }: Rayleigh, end: f64) -> Option<String> {
    let omega = TAU * end;
    let ratio = 0.5 * (alpha / omega + beta * omega);
    (ratio > LARGEST_RATIO).then(|| {
        format!(
            "rayleigh of part {part:?} damps {end} Hz by {:.0} % of the critical damping. alpha is in 1/s, beta in s, such as \
             alpha = 5, beta = 1e-7",
            100.0 * ratio
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_in_kilohertz() {
        assert_eq!([band(100.0), band(6000.0)], [None, None]);
        assert!(band(6.0).unwrap().starts_with("the band ends at 6 Hz. Was it given in kHz?"));
    }

    #[test]
    fn damping_that_no_brake_has() {
        let of = |alpha: f64, beta: f64| damping("disc", Rayleigh { alpha, beta }, 6000.0);
        assert_eq!([of(5.0, 1e-7), of(0.0, 0.99 / (TAU * 6000.0)), of(0.99 * TAU * 6000.0, 0.0)], [None, None, None]);
        assert!(of(0.0, 1e-3).unwrap().contains("\"disc\" damps 6000 Hz by 1885 % of the critical damping"));
        assert!(of(1.1 * TAU * 6000.0, 0.0).unwrap().contains("by 55 %"));
    }
}
