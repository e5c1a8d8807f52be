//! Whether a search has missed a mode.
//!
//! With [`Evidence::SturmCount`] the number of modes below a frequency is known from the symmetric problem. Friction
//! may carry a mode across that frequency, where the two problems then differ by one: the count is then taken again in
//! the widest gap between modes beyond the band's end, and the next value's count begins there. Damping that makes
//! eigenvalues real, such as that of friction at low speed, separates the two problems: a pair of eigenvalues far
//! beyond the frequency becomes one far below it and one still farther away. Then, as with [`Evidence::Repetition`],
//! two searches have to agree.

use std::f64::consts::TAU;
use std::fmt::{self, Display};

use serde::{Deserialize, Serialize};

use super::eigensolver::SearchResult;
use super::sturm::SturmCount;
use super::{EigenOptions, Evidence, QuadraticProblem};
use crate::Result;

/// How many modes the symmetric problem has below a frequency, and how many were found there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// The frequency, Hz: the band's end, or a gap between modes near it.
    #[serde(rename = "below_hz")]
    pub below: f64,
    /// By the Sturm count or another search.
    pub expected: usize,
    /// By the eigensolver.
    pub found: usize,
    /// Where the expected number is from.
    #[serde(default)]
    pub by: CountedBy,
}

/// Where the number of modes that a search should find is from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CountedBy {
    /// The Sturm count of the symmetric problem.
    #[default]
    SturmCount,
    /// Another search, which was for fewer modes.
    AnotherSearch,
}

impl Display for CountedBy {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            CountedBy::SturmCount => "Sturm count",
            CountedBy::AnotherSearch => "another search",
        })
    }
}

impl Count {
    /// Whether no mode is missing.
    pub fn agrees(&self) -> bool {
        self.expected == self.found
    }
}

/// A number of modes before a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    /// The band's end, Hz.
    pub end: f64,
    /// Below this frequency, Hz: the end, or a gap beyond it.
    pub below: f64,
    /// Exact with [`Evidence::SturmCount`].
    pub n: usize,
}

/// Counts the modes of one problem after the other.
#[derive(Default)]
pub(super) struct ModeCounter {
    pub sturm: SturmCount,
    /// Where the last count was taken beyond the band's end, Hz.
    gap: Option<f64>,
}

impl ModeCounter {
    /// The next count begins where this one was taken, as it would for who took it.
    pub fn resume(&mut self, count: &Count) {
        self.gap = Some(count.below);
    }

    /// About how many modes there are below the end of a band (Hz) or the gap beyond it where the last count was taken.
    /// Collective.
    pub fn expect(&mut self, problem: &QuadraticProblem, options: &EigenOptions, end: f64) -> Result<Expected> {
        let near = end..options.band_margins[0] * end;
        let below = self.gap.filter(|gap| near.contains(gap)).unwrap_or(end);
        let n = match options.evidence {
            Evidence::Repetition { .. } if problem.n_dofs() <= Evidence::ALL_UP_TO => problem.n_dofs(),
            Evidence::Repetition { estimated: false } => options.n_guessed,
            _ => self.sturm.n_below(problem, below)?,
        };
        Ok(Expected { end, below, n })
    }

    /// How many modes were found below the frequency of the expectation or in a gap beyond it, and how many there
    /// should be; none where the search did not get there. `before` is the count of the search before. Collective.
    pub fn count(
        &mut self,
        problem: &QuadraticProblem,
        evidence: Evidence,
        search: &SearchResult,
        expected: Expected,
        before: Option<Count>,
    ) -> Result<Option<Count>> {
        let Expected { end, below, n } = expected;
        if search.reach <= below {
            return Ok(None);
        }
        let count = Count { below, expected: n, found: search.n_below(below), by: CountedBy::SturmCount };
        match evidence {
            Evidence::Repetition { estimated } => {
                let unknown = Count { expected: usize::MAX, by: CountedBy::AnotherSearch, ..count };
                let alone = if estimated { count } else { unknown };
                Ok(Some(repeated(count, search, before).unwrap_or(alone)))
            }
            Evidence::SturmCount if count.agrees() => Ok(Some(count)),
            Evidence::SturmCount if search.is_overdamped(below) => {
                Ok(Some(repeated(count, search, before).unwrap_or(count)))
            }
            Evidence::SturmCount => self.count_in_gap(problem, search, end).map(|other| Some(other.unwrap_or(count))),
        }
    }

    /// The count in the widest gap beyond the band's end; none where there is no gap.
    fn count_in_gap(&mut self, problem: &QuadraticProblem, search: &SearchResult, end: f64) -> Result<Option<Count>> {
        let mut moduli: Vec<f64> = search.pairs.iter().map(|pair| pair.lambda.norm() / TAU).collect();
        moduli.extend(Some(search.reach).filter(|reach| reach.is_finite()));
        moduli.sort_by(f64::total_cmp);
        let Some(below) = widest_gap(&moduli, end) else { return Ok(None) };
        self.gap = Some(below);
        let expected = self.sturm.n_below(problem, below)?;
        Ok(Some(Count { below, expected, found: search.n_below(below), by: CountedBy::SturmCount }))
    }
}

/// The count of a search by the one before; none without it. All eigenvalues that there are need no other search.
fn repeated(count: Count, search: &SearchResult, before: Option<Count>) -> Option<Count> {
    let expected = if search.reach.is_finite() { before.map(|count| count.found) } else { Some(count.found) };
    expected.map(|expected| Count { expected, by: CountedBy::AnotherSearch, ..count })
}

/// The middle of the widest part above `from` of a gap between neighbours: nothing below `from` may stay uncounted.
fn widest_gap(sorted: &[f64], from: f64) -> Option<f64> {
    let parts = sorted.windows(2).filter(|w| w[1] > from).map(|w| [w[0].max(from), w[1]]);
    parts.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0]))).map(|part| 0.5 * (part[0] + part[1]))
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::native::{Comm, Session};
    use crate::stability::testing::{found, masses};

    /// The count of a search in a structure with these frequencies, below 4 Hz, and the counter.
    fn counted(comm: &Comm, frequencies: &[f64], search: &SearchResult) -> (Option<Count>, ModeCounter) {
        let matrices = masses(comm, frequencies);
        let (problem, options) = (QuadraticProblem::symmetric(matrices.as_ref()), EigenOptions::default());
        let mut counter = ModeCounter::default();
        let expected = counter.expect(&problem, &options, 4.0).unwrap();
        (counter.count(&problem, options.evidence, search, expected, None).unwrap(), counter)
    }

    #[test]
    fn a_count_at_the_bands_end_agrees() {
        let comm = Session::start(&[]).unwrap();
        let (count, counter) = counted(&comm, &[1.0, 2.0, 3.0, 5.0], &found(&comm, &[1.0, 2.0, 3.0, 5.0], 5.0));
        assert_eq!(count, Some(Count { below: 4.0, expected: 3, found: 3, by: CountedBy::SturmCount }));
        assert_eq!(counter.gap, None);
    }

    #[test]
    fn a_search_that_did_not_get_there_is_not_counted() {
        let comm = Session::start(&[]).unwrap();
        assert_eq!(counted(&comm, &[1.0, 2.0, 3.0, 5.0], &found(&comm, &[1.0, 2.0, 3.0], 4.0)).0, None);
    }

    #[test]
    fn a_missing_mode_is_noticed() {
        let comm = Session::start(&[]).unwrap();
        let (count, _) = counted(&comm, &[1.0, 2.0, 3.0, 5.0], &found(&comm, &[1.0, 3.0, 5.0], 5.0));
        let count = count.unwrap();
        assert!(!count.agrees() && count.expected == count.found + 1, "{count:?}");
        // The one just below the end, too, however wide the gap is that it leaves.
        let (count, _) = counted(&comm, &[1.0, 2.0, 3.9, 4.1], &found(&comm, &[1.0, 2.0, 4.1], 4.2));
        assert!(!count.unwrap().agrees(), "{count:?}");
    }

    #[test]
    fn a_mode_that_friction_carries_across_the_end_is_counted_in_the_widest_gap_beyond() {
        let comm = Session::start(&[]).unwrap();
        let symmetric = [1.0, 2.0, 3.98, 5.0];
        let (count, mut counter) = counted(&comm, &symmetric, &found(&comm, &[1.0, 2.0, 4.02], 4.12));
        let count = count.unwrap();
        assert!(count.agrees() && count.found == 3 && (count.below - 4.07).abs() < 1e-12, "{count:?}");
        // The next count begins there, unless its band ends elsewhere.
        let matrices = masses(&comm, &symmetric);
        let problem = QuadraticProblem::symmetric(matrices.as_ref());
        let mut below = |end: f64| counter.expect(&problem, &EigenOptions::default(), end).unwrap().below;
        assert_eq!([below(4.0), below(3.0), below(4.5)], [count.below, 3.0, 4.5]);
    }

    #[test]
    fn a_resumed_count_begins_where_the_last_one_was_taken() {
        let comm = Session::start(&[]).unwrap();
        let matrices = masses(&comm, &[1.0, 2.0]);
        let mut counter = ModeCounter::default();
        counter.resume(&Count { below: 4.1, expected: 2, found: 2, by: CountedBy::SturmCount });
        let problem = QuadraticProblem::symmetric(matrices.as_ref());
        let expected = counter.expect(&problem, &EigenOptions::default(), 4.0).unwrap();
        assert_eq!(expected, Expected { end: 4.0, below: 4.1, n: 2 });
    }

    #[test]
    fn where_damping_has_made_eigenvalues_real_two_searches_have_to_agree() {
        let comm = Session::start(&[]).unwrap();
        let matrices = masses(&comm, &[1.0, 2.0, 3.0, 5.0]);
        let problem = QuadraticProblem::symmetric(matrices.as_ref());
        let mut counter = ModeCounter::default();
        let expected = counter.expect(&problem, &EigenOptions::default(), 4.0).unwrap();
        let mut count = |real: &[f64], before: Option<Count>| {
            let mut search = found(&comm, &[1.0, 2.0, 2.5, 3.0, 5.0], 5.0);
            search.pairs.iter_mut().zip(real).for_each(|(pair, &re)| pair.lambda = Complex64::new(re, 0.0));
            counter.count(&problem, Evidence::SturmCount, &search, expected, before).unwrap().unwrap()
        };
        let alone = count(&[-1.0, -2.0], None);
        assert_eq!(alone, Count { below: 4.0, expected: 3, found: 3, by: CountedBy::SturmCount }, "as many by chance");
        let alone = count(&[-1.0, -2.0, -3.0, -4.0], None);
        assert_eq!(alone, Count { below: 4.0, expected: 3, found: 2, by: CountedBy::SturmCount });
        let repeated = count(&[-1.0, -2.0, -3.0, -4.0], Some(alone));
        assert_eq!(repeated, Count { below: 4.0, expected: 2, found: 2, by: CountedBy::AnotherSearch });
        let other = count(&[-1.0, -2.0, -3.0, -4.0], Some(Count { found: 3, ..alone }));
        assert!(!other.agrees() && other.by == CountedBy::AnotherSearch);
        // Neither real eigenvalues beyond the frequency nor growing ones are of damping.
        assert_eq!(count(&[-30.0], Some(Count { found: 4, ..alone })).by, CountedBy::SturmCount);
        assert_eq!(count(&[1.0], Some(Count { found: 4, ..alone })).by, CountedBy::SturmCount);
    }

    #[test]
    fn by_repetition_two_searches_have_to_agree() {
        let comm = Session::start(&[]).unwrap();
        let matrices = masses(&comm, &[1.0, 2.0, 5.0]);
        let problem = QuadraticProblem::symmetric(matrices.as_ref());
        let expected = Expected { end: 4.0, below: 4.0, n: 3 };
        let count = |estimated: bool, reach: f64, before: Option<usize>| {
            let evidence = Evidence::Repetition { estimated };
            let before = before.map(|found| Count { below: 4.0, expected: 0, found, by: CountedBy::AnotherSearch });
            let search = found(&comm, &[1.0, 2.0, 5.0], reach);
            ModeCounter::default().count(&problem, evidence, &search, expected, before).unwrap().unwrap().agrees()
        };
        assert!(!count(false, 5.0, None), "one search alone");
        assert!(count(false, 5.0, Some(2)) && !count(false, 5.0, Some(1)), "the search before");
        assert!(count(false, f64::INFINITY, None), "all eigenvalues");
        assert!(!count(true, 5.0, None), "3 were estimated");
        assert!(count(true, 5.0, Some(2)), "a second search rules the estimate out");
    }

    #[test]
    fn how_many_modes_repetition_begins_with() {
        let comm = Session::start(&[]).unwrap();
        let expected = |n: usize, estimated: bool| {
            let frequencies: Vec<f64> = (0..n).map(|i| 0.11 + 0.1 * i as f64).collect();
            let matrices = masses(&comm, &frequencies);
            let options = EigenOptions { evidence: Evidence::Repetition { estimated }, ..EigenOptions::default() };
            let problem = QuadraticProblem::symmetric(matrices.as_ref());
            ModeCounter::default().expect(&problem, &options, 4.0).unwrap().n
        };
        assert_eq!([expected(100, false), expected(100, true)], [100, 100], "all that there are");
        assert_eq!([expected(101, false), expected(101, true)], [10, 39], "a guess, or the Sturm count");
    }

    #[test]
    fn a_real_eigenvalue_counts_half() {
        let comm = Session::start(&[]).unwrap();
        let mut search = found(&comm, &[1.0, 2.0, 2.0], 9.0);
        (search.pairs[1].lambda, search.pairs[2].lambda) = (Complex64::new(-TAU, 0.0), Complex64::new(-6.0 * TAU, 0.0));
        assert_eq!([search.n_below(0.5), search.n_below(1.5), search.n_below(7.0)], [0, 2, 2]);
        search.pairs.remove(1);
        assert_eq!(search.n_below(7.0), 2, "1.5 rounds up");
    }
}
