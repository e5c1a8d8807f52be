//! Random numbers that do not depend on the number of ranks.
//!
//! No generator of a crate does that by itself: a stream gives each rank other numbers when the rows are shared out
//! otherwise. Here a number is a hash of the dof's label and of the vector's count, so that one rank and several search
//! with the same vectors, and modes agree to the accuracy of the eigensolver (tests/parallel.rs).

use std::f64::consts::TAU;

/// A stream of numbers, and of vectors whose entries hang on the equations' labels alone.
pub struct Noise<'a> {
    labels: &'a [u64],
    state: u64,
}

impl<'a> Noise<'a> {
    /// The stream that always starts alike; `labels` name this rank's equations.
    pub fn new(labels: &'a [u64]) -> Noise<'a> {
        Noise { labels, state: 0 }
    }

    fn next(&mut self) -> u64 {
        self.state += 1;
        mix(self.state)
    }

    /// A normal deviate (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (unit(self.next()), unit(self.next()));
        (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
    }

    /// A vector with entries in [-1, 1), another at each call. Not collective.
    pub fn fill(&mut self, vector: &mut [f64]) {
        let key = self.next();
        for (x, label) in vector.iter_mut().zip(self.labels) {
            *x = 2.0 * unit(mix(key ^ mix(*label))) - 1.0;
        }
    }
}

/// splitmix64 (Steele, Lea and Flood, OOPSLA 2014).
fn mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// [0, 1) by the upper 53 bits.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_hang_on_labels_alone() {
        let (mut all, mut part) = ([0.0; 4], [0.0; 2]);
        Noise::new(&[7, 8, 9, 10]).fill(&mut all);
        Noise::new(&[9, 10]).fill(&mut part);
        assert_eq!(all[2..], part);
        assert!(all.iter().all(|x| (-1.0..1.0).contains(x)) && all[0] != all[1]);
    }

    #[test]
    fn deviates_have_mean_zero_and_variance_one() {
        let mut noise = Noise::new(&[]);
        let sample: Vec<f64> = (0..40_000).map(|_| noise.normal()).collect();
        let moment = |power: i32| sample.iter().map(|x| x.powi(power)).sum::<f64>() / sample.len() as f64;
        // Three standard errors: 3/200, 3 sqrt(2)/200.
        assert!(moment(1).abs() < 0.015 && (moment(2) - 1.0).abs() < 0.021);
    }
}
