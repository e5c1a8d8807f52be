//! Order statistics of numbers that are spread over ranks.

use crate::native::Comm;

/// Numbers between -1 and 1, each on one rank.
pub struct Ranked<'a> {
    comm: &'a Comm,
    own: Vec<f64>,
    n: usize,
}

impl Ranked<'_> {
    /// The numbers of this rank and all others. Collective.
    pub fn new(comm: &Comm, mut own: Vec<f64>) -> Ranked<'_> {
        own.sort_unstable_by(f64::total_cmp);
        let n = comm.sum(own.len());
        Ranked { comm, own, n }
    }

    /// How many there are over all ranks.
    pub fn n_numbers(&self) -> usize {
        self.n
    }

    /// The number that has k below it, to round-off: by bisection, with a count over all ranks at each step.
    /// Collective.
    pub fn nth(&self, k: usize) -> f64 {
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (low + high);
            let up_to = self.comm.sum(self.own.partition_point(|&x| x <= middle));
            if up_to > k { high = middle } else { low = middle }
        }
        high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn the_nth_is_that_of_the_sorted_list() {
        let comm = Session::start(&[]).unwrap();
        let ranked = Ranked::new(&comm, vec![0.5, -0.25, 0.125, 0.5, 0.75]);
        for (k, value) in [-0.25, 0.125, 0.5, 0.5, 0.75].into_iter().enumerate() {
            assert!((ranked.nth(k) - value).abs() < 1e-15, "{k}");
        }
        assert_eq!(ranked.n_numbers(), 5);
    }
}
