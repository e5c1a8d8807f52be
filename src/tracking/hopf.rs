//! Where to solve for a Hopf point that the interpolated modes predict.

/// What led to the solves between two values asked for.
#[derive(Clone, Copy, Default)]
pub struct HopfSearch {
    /// How often the step has been divided.
    pub depth: usize,
    /// The root that the last solve aimed at.
    pub aim: Option<Aim>,
}

/// A root of a branch's growth rate that is sought.
#[derive(Clone, Copy)]
pub struct Aim {
    pub branch: usize,
    /// Where it was expected.
    root: f64,
    /// Widths of the interval before the last solve and before the one before that.
    widths: [f64; 2],
}

impl HopfSearch {
    /// The value to solve at for a root predicted between a and b.
    ///
    /// At first that is nearly half a tolerance before the root; then, if the model was right, as much behind it, and
    /// the bracket is closed. Where the root has moved since the last solve, part of that is added, away from the
    /// nearer end; and where two solves have not halved the interval, it is bisected.
    pub fn aim(&self, branch: usize, root: f64, [a, b]: [f64; 2], tolerance: f64) -> (f64, Aim) {
        let (width, near) = ((b - a).abs(), 0.4 * tolerance);
        let Some(last) = self.aim.filter(|aim| aim.branch == branch) else {
            let before = (root - a).abs() > 0.5 * tolerance;
            let value = root + near.copysign(if before { a - b } else { b - a });
            return (value, Aim { branch, root, widths: [width, f64::INFINITY] });
        };
        if width > 0.5 * last.widths[1] {
            return (0.5 * (a + b), Aim { branch, root, widths: [width, f64::INFINITY] });
        }
        let end = if (root - a).abs() < (b - root).abs() { b } else { a };
        let ahead = near.max(0.3 * (root - last.root).abs()).min(0.5 * (end - root).abs());
        let value = root + ahead.copysign(end - root);
        let expected = if ahead > near { value } else { root };
        (value, Aim { branch, root: expected, widths: [width, last.widths[0]] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Aims at the root of a function with a straight line through both ends, as a model would, until the bracket is
    /// closed.
    fn solves(function: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], tolerance: f64) -> usize {
        let mut search = HopfSearch::default();
        for n_solves in 0.. {
            if b - a <= tolerance {
                return n_solves;
            }
            let (f, g) = (function(a), function(b));
            let (value, aim) = search.aim(3, a + (b - a) * f / (f - g), [a, b], tolerance);
            assert!(a < value && value < b, "{a} {value} {b}");
            search.aim = Some(aim);
            *(if (function(value) > 0.0) == (g > 0.0) { &mut b } else { &mut a }) = value;
        }
        unreachable!()
    }

    #[test]
    fn straight_lines_take_two_solves_and_bent_ones_no_more_than_bisection() {
        assert_eq!(solves(|x| x - 0.3141, [0.0, 1.0], 1e-3), 2);
        for power in [2, 3, 5] {
            assert!(solves(|x| x.powi(power) - 0.1, [0.0, 1.0], 1e-3) < 10);
        }
    }

    #[test]
    fn a_new_branch_is_not_misled_by_the_last() {
        let aim = Aim { branch: 1, root: 0.9, widths: [1.0, 2.5] };
        let search = HopfSearch { depth: 2, aim: Some(aim) };
        assert!((search.aim(2, 0.5, [0.0, 1.0], 1e-3).0 - 0.4996).abs() < 1e-12);
        assert!((search.aim(1, 0.4, [0.0, 1.0], 1e-3).0 - 0.55).abs() < 1e-12);
    }
}
