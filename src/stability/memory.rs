//! What gives way where the factors and the search do not fit into memory together.

use super::QuadraticProblem;
use super::blocked::Blocked;
use super::sturm::SturmCount;
use crate::equilibrium::LabelledFactor;
use crate::native::{Comm, machine};

/// Whether the ranks together may still take so much memory, MB.
type HasMemory = Box<dyn Fn(&Comm, f64) -> bool>;

/// Memory of a symmetric factor over that of an LU on the same pattern, in double and in single precision: 3.0 GB over
/// 5.3 GB on the full demo brake, or over 2.8 GB.
const SYMMETRIC_OVER_LU: [f64; 2] = [0.6, 1.1];

/// Decides by the memory that is left.
pub(super) struct MemoryBudget {
    /// Whether the ranks together may still take so many MB. Collective.
    pub has_mb: HasMemory,
}

impl Default for MemoryBudget {
    fn default() -> Self {
        MemoryBudget { has_mb: Box::new(machine::has_mb) }
    }
}

impl MemoryBudget {
    /// Before the symmetric factor is made: where it does not fit, the start of the next search goes, then the LU.
    /// Collective.
    pub fn before_count(&self, problem: &QuadraticProblem, factor: &mut LabelledFactor, blocked: &mut Blocked) {
        let needed_mb = symmetric_over_lu(factor) * factor.factor().stats().used_mb;
        let has_mb = || (self.has_mb)(problem.comm(), needed_mb);
        if !has_mb() {
            blocked.drop_start();
            if !has_mb() {
                factor.release();
            }
        }
    }

    /// Before the LU is analysed: where it does not fit beside the symmetric factor and a search that needs so many MB,
    /// that factor goes; and the LU is kept out of core unless it leaves so much. Collective.
    pub fn before_factor(
        &self,
        problem: &QuadraticProblem,
        factor: &mut LabelledFactor,
        sturm: &mut SturmCount,
        search_mb: f64,
    ) {
        let lu_mb = sturm.stats().used_mb / symmetric_over_lu(factor);
        if !(self.has_mb)(problem.comm(), lu_mb + search_mb) {
            sturm.release();
        }
        factor.leave_mb(search_mb);
    }

    /// Before a blocked search that needs so many MB: its start goes, then the symmetric factor; gives whether it fits
    /// now. Collective.
    pub fn before_search(
        &self,
        problem: &QuadraticProblem,
        blocked: &mut Blocked,
        sturm: &mut SturmCount,
        search_mb: f64,
    ) -> bool {
        let has_mb = || (self.has_mb)(problem.comm(), search_mb);
        if has_mb() {
            return true;
        }
        blocked.drop_start();
        has_mb() || {
            sturm.release();
            has_mb()
        }
    }
}

/// For an LU in the factor's precision.
fn symmetric_over_lu(factor: &LabelledFactor) -> f64 {
    SYMMETRIC_OVER_LU[usize::from(!factor.factor().is_exact())]
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::rc::Rc;

    use super::*;
    use crate::native::{Precision, Session};
    use crate::stability::testing::Blocks;
    use crate::stability::{EigenOptions, Eigensolver, Search, SearchRequest};

    /// Answers one question after the other, and keeps what was asked for, MB.
    fn budget(answers: &[bool]) -> (MemoryBudget, Rc<RefCell<Vec<f64>>>) {
        let (answers, asked) = (RefCell::new(answers.to_vec()), Rc::new(RefCell::new(Vec::new())));
        let kept = asked.clone();
        let has_mb = move |_: &Comm, mb: f64| {
            kept.borrow_mut().push(mb);
            answers.borrow_mut().remove(0)
        };
        (MemoryBudget { has_mb: Box::new(has_mb) }, asked)
    }

    /// A factor, a count and a blocked search, all made for a problem.
    struct Made {
        factor: LabelledFactor,
        sturm: SturmCount,
        blocked: Blocked,
    }

    fn with_all_made<T>(comm: &Comm, look: impl FnOnce(&QuadraticProblem, Made) -> T) -> T {
        let blocks = Blocks::new(comm, 6);
        let options = EigenOptions::always_blocked();
        let (mut factor, mut sturm) = (LabelledFactor::new(Precision::Double), SturmCount::default());
        let mut blocked = Blocked::new(options, blocks.system.dofs.labels());
        blocks.with(0.5, &[], |problem| {
            let request = SearchRequest { n_modes: 8, end: 5.0, shift: 0.0, attempt: 0 };
            let search = Search { problem, factor: &mut factor, request, progress: &mut |_| () };
            blocked.search(search).unwrap().unwrap();
            sturm.n_below(problem, 5.0).unwrap();
            let made = Made { factor, sturm, blocked };
            assert_eq!(state(&made), [true; 3]);
            look(problem, made)
        })
    }

    /// Whether the factor, the count's factor and the start are there.
    fn state(made: &Made) -> [bool; 3] {
        [made.factor.factor().is_made(), made.sturm.is_made(), made.blocked.has_start()]
    }

    #[test]
    fn before_a_count_the_start_goes_and_then_the_factor() {
        let comm = Session::start(&[]).unwrap();
        for (answers, left) in [
            (&[true][..], [true, true, true]),
            (&[false, true], [true, true, false]),
            (&[false, false], [false, true, false]),
        ] {
            with_all_made(&comm, |problem, mut made| {
                budget(answers).0.before_count(problem, &mut made.factor, &mut made.blocked);
                assert_eq!(state(&made), left);
            });
        }
    }

    #[test]
    fn before_a_factor_the_count_goes_where_both_and_the_search_do_not_fit() {
        let comm = Session::start(&[]).unwrap();
        for (fits, left) in [(true, [true; 3]), (false, [true, false, true])] {
            with_all_made(&comm, |problem, mut made| {
                let (budget, asked) = budget(&[fits]);
                let symmetric_mb = made.sturm.stats().used_mb;
                budget.before_factor(problem, &mut made.factor, &mut made.sturm, 1000.0);
                assert_eq!(state(&made), left);
                assert_eq!(asked.borrow()[..], [symmetric_mb / 0.6 + 1000.0]);
            });
        }
    }

    #[test]
    fn before_a_search_the_start_goes_and_then_the_count() {
        let comm = Session::start(&[]).unwrap();
        for (answers, fits, left) in [
            (&[true][..], true, [true, true, true]),
            (&[false, true], true, [true, true, false]),
            (&[false, false, true], true, [true, false, false]),
            (&[false, false, false], false, [true, false, false]),
        ] {
            with_all_made(&comm, |problem, mut made| {
                let (budget, _) = budget(answers);
                assert_eq!(budget.before_search(problem, &mut made.blocked, &mut made.sturm, 10.0), fits);
                assert_eq!(state(&made), left);
            });
        }
    }

    #[test]
    fn a_search_needs_memory_by_modes_and_dofs() {
        let blocked = Blocked::new(EigenOptions::default(), Vec::new());
        // 100 modes: 172 Krylov columns, 15 rounds of 32, 200 vectors, 260 of the start; 96 + 600 for left vectors.
        let columns = 172 + 480 + 200 + 260 + 696;
        let mb = 8.0 * (columns * 1_000_000) as f64 / (1024.0 * 1024.0);
        assert!((blocked.needs_mb(100, 1_000_000) / mb - 1.0).abs() < 1e-12);
    }
}
