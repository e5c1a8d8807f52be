//! Which points of the parameter space are analysed.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::correlation::Correlation;
use super::distribution::Distribution;
use crate::{Error, Result};

/// How points are chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum DesignKind {
    /// All combinations of the parameters' levels.
    Grid {
        /// Levels of a parameter that has no list of values.
        n_levels: usize,
    },
    /// Each parameter at its levels, the others at the model file's values.
    OneAtATime {
        /// Levels of a parameter that has no list of values.
        n_levels: usize,
    },
    /// These points.
    List(Vec<Vec<f64>>),
    /// Latin hypercube: of n points one in each of n equally probable intervals of each parameter. Source: McKay,
    /// Beckman, Conover, Technometrics 21 (1979).
    LatinHypercube {
        /// Number of points.
        n_points: usize,
    },
    /// The Sobol sequence with Owen's scrambling. Source: Burley, JCGT 9 (2020).
    Sobol {
        /// Number of points; powers of two fill the space evenly.
        n_points: usize,
    },
    /// Points for Sobol indices: for each of n base points A the point itself, a second one B, and A with one
    /// parameter of B, parameter by parameter. Source: Saltelli et al., Comput. Phys. Commun. 181 (2010).
    Saltelli {
        /// Number n of base points; there are n (k + 2) points for k parameters.
        n_base: usize,
    },
    /// A grid of two parameters, and points of its edges at which a mode turns unstable ([`super::HopfCurves`]).
    Map {
        /// Levels of each parameter.
        n_levels: usize,
    },
    /// Points that close in on the boundary between stable and unstable ([`super::BoundaryPair`]).
    Adaptive(AdaptiveRule),
}

/// How far an adaptive design goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveRule {
    /// Number of points at most.
    pub n_points: usize,
    /// Points of the Sobol sequence that it begins with.
    pub n_start: usize,
    /// Distance in the unit cube at which points of opposite verdict are near enough.
    pub resolution: f64,
}

/// A choice of points that a seed repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// How they are chosen.
    pub kind: DesignKind,
    /// Where chance begins.
    pub seed: u32,
    /// How the parameters of a Latin hypercube or a Sobol sequence depend on each other.
    pub correlation: Option<Correlation>,
}

/// More points than this in one study are taken for a mistake; the Sobol sequence has no more.
const MAX_POINTS: usize = 1 << 16;
/// Half of the distance of two numbers of a Sobol sequence in single precision: points are in the middle of their cell.
const HALF_CELL: f64 = 0.5 / (1 << 24) as f64;

impl Design {
    /// The points: values of the parameters, in their order. `nominal` are the model file's values.
    ///
    /// ```
    /// use squeal::explore::{Design, DesignKind, Distribution};
    ///
    /// let friction = Distribution::Uniform { from: 0.3, to: 0.7 };
    /// let design = Design { kind: DesignKind::Grid { n_levels: 3 }, seed: 1, correlation: None };
    /// assert_eq!(design.points(&[&friction], &[0.4])?, [[0.3], [0.5], [0.7]]);
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] for more than 65536 points, more dimensions than the Sobol sequence has.
    pub fn points(&self, parameters: &[&Distribution], nominal: &[f64]) -> Result<Vec<Vec<f64>>> {
        let n = self.n_points(parameters);
        if n == 0 || n > MAX_POINTS {
            let advice = "Give fewer levels or parameters, or kind = \"sobol\" with a number of points";
            return Err(Error::input(format!("a study has 1 to {MAX_POINTS} points, not {n}. {advice}")));
        }
        Ok(match &self.kind {
            DesignKind::Grid { n_levels } | DesignKind::Map { n_levels } => grid(parameters, *n_levels),
            DesignKind::OneAtATime { n_levels } => one_at_a_time(parameters, nominal, *n_levels),
            DesignKind::List(points) => points.clone(),
            DesignKind::LatinHypercube { n_points } => {
                values(parameters, self.correlated(latin_hypercube(*n_points, parameters.len(), self.seed)))
            }
            DesignKind::Adaptive(rule) => values(parameters, self.sobol(rule.n_start, parameters.len())?),
            DesignKind::Sobol { n_points } => {
                values(parameters, self.correlated(self.sobol(*n_points, parameters.len())?))
            }
            DesignKind::Saltelli { n_base } => {
                let base = self.sobol(*n_base, 2 * parameters.len())?;
                values(parameters, base.iter().flat_map(|row| saltelli(row)).collect())
            }
        })
    }

    /// What it is called.
    pub fn name(&self) -> &'static str {
        match self.kind {
            DesignKind::Grid { .. } => "grid",
            DesignKind::Map { .. } => "map",
            DesignKind::OneAtATime { .. } => "one parameter at a time",
            DesignKind::List(_) => "list of points",
            DesignKind::LatinHypercube { .. } => "Latin hypercube",
            DesignKind::Sobol { .. } => "Sobol sequence",
            DesignKind::Saltelli { .. } => "points for Sobol indices",
            DesignKind::Adaptive(_) => "adaptive",
        }
    }

    /// Whether the points represent the distributions of the parameters, so that their fractions are probabilities.
    pub fn is_sample(&self) -> bool {
        !matches!(self.kind, DesignKind::Grid { .. } | DesignKind::Map { .. } | DesignKind::OneAtATime { .. })
    }

    /// Points that a design starts with before it adds others, and that its fractions are of; none of a design that
    /// adds none.
    pub fn n_start(&self) -> Option<usize> {
        match self.kind {
            DesignKind::Adaptive(rule) => Some(rule.n_start),
            DesignKind::Map { n_levels } => Some(n_levels * n_levels),
            _ => None,
        }
    }

    /// Points at most; of a map those of its grid.
    pub fn n_points(&self, parameters: &[&Distribution]) -> usize {
        let levels = |n: usize| parameters.iter().map(move |parameter| parameter.levels(n).len());
        match &self.kind {
            DesignKind::Grid { n_levels } | DesignKind::Map { n_levels } => {
                levels(*n_levels).fold(1, usize::saturating_mul)
            }
            DesignKind::OneAtATime { n_levels } => levels(*n_levels).sum(),
            DesignKind::List(points) => points.len(),
            DesignKind::LatinHypercube { n_points } | DesignKind::Sobol { n_points } => *n_points,
            DesignKind::Saltelli { n_base } => n_base.saturating_mul(parameters.len() + 2),
            DesignKind::Adaptive(rule) => rule.n_points,
        }
    }

    fn correlated(&self, points: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        match &self.correlation {
            None => points,
            Some(correlation) => points.iter().map(|point| correlation.apply(point)).collect(),
        }
    }

    /// Points of the unit cube.
    pub(super) fn sobol(&self, n: usize, n_dimensions: usize) -> Result<Vec<Vec<f64>>> {
        let most = sobol_burley::NUM_DIMENSIONS as usize;
        if n_dimensions > most {
            let what = format!("the Sobol sequence has {most} dimensions, and the study needs {n_dimensions}");
            return Err(Error::input(format!("{what}. Give kind = \"latin-hypercube\", or fewer parameters")));
        }
        let at = |i: usize, d: usize| f64::from(sobol_burley::sample(i as u32, d as u32, self.seed)) + HALF_CELL;
        Ok((0..n).map(|i| (0..n_dimensions).map(|d| at(i, d)).collect()).collect())
    }
}

/// The values of the parameters at points of the unit cube.
fn values(parameters: &[&Distribution], points: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let value = |(parameter, u): (&&Distribution, &f64)| parameter.quantile(*u);
    points.iter().map(|point| parameters.iter().zip(point).map(value).collect()).collect()
}

/// The last parameter varies first.
fn grid(parameters: &[&Distribution], n_levels: usize) -> Vec<Vec<f64>> {
    let combine = |points: Vec<Vec<f64>>, parameter: &&Distribution| {
        let levels = parameter.levels(n_levels);
        let extended =
            |point: Vec<f64>| levels.iter().map(move |level| [&point[..], &[*level]].concat()).collect::<Vec<_>>();
        points.into_iter().flat_map(extended).collect()
    };
    parameters.iter().fold(vec![Vec::new()], combine)
}

fn one_at_a_time(parameters: &[&Distribution], nominal: &[f64], n_levels: usize) -> Vec<Vec<f64>> {
    let with = |i: usize, level: f64| {
        let mut point = nominal.to_vec();
        point[i] = level;
        point
    };
    let of = |(i, parameter): (usize, &&Distribution)| {
        parameter.levels(n_levels).into_iter().map(|level| with(i, level)).collect::<Vec<_>>()
    };
    parameters.iter().enumerate().flat_map(of).collect()
}

/// `u_ij = (pi_j(i) + r_ij) / n` with a permutation for each dimension.
fn latin_hypercube(n: usize, n_dimensions: usize, seed: u32) -> Vec<Vec<f64>> {
    let mut chance = Pcg64::seed_from_u64(u64::from(seed));
    let mut points = vec![vec![0.0; n_dimensions]; n];
    for d in 0..n_dimensions {
        let mut strata: Vec<usize> = (0..n).collect();
        strata.shuffle(&mut chance);
        for (point, stratum) in points.iter_mut().zip(strata) {
            point[d] = (stratum as f64 + chance.random::<f64>()) / n as f64;
        }
    }
    points
}

/// The points A, B, A with parameter 1 of B, ... of a row with the 2 k coordinates of A and B.
fn saltelli(row: &[f64]) -> Vec<Vec<f64>> {
    let (a, b) = row.split_at(row.len() / 2);
    let mixed = (0..a.len()).map(|i| {
        let mut point = a.to_vec();
        point[i] = b[i];
        point
    });
    [a.to_vec(), b.to_vec()].into_iter().chain(mixed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Distribution = Distribution::Uniform { from: 0.0, to: 1.0 };

    fn points(kind: DesignKind, n_parameters: usize) -> Vec<Vec<f64>> {
        Design { kind, seed: 7, correlation: None }
            .points(&vec![&UNIT; n_parameters], &vec![0.5; n_parameters])
            .unwrap()
    }

    /// Number of points in each of n equal intervals of a dimension.
    fn strata(points: &[Vec<f64>], dimension: usize, n: usize) -> Vec<usize> {
        let mut counts = vec![0; n];
        points.iter().for_each(|point| counts[(point[dimension] * n as f64) as usize] += 1);
        counts
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_interval() {
        let found = points(DesignKind::LatinHypercube { n_points: 20 }, 3);
        assert!((0..3).all(|d| strata(&found, d, 20) == [1; 20]));
        assert_ne!(
            found,
            Design { kind: DesignKind::LatinHypercube { n_points: 20 }, seed: 8, correlation: None }
                .points(&[&UNIT; 3], &[0.5; 3])
                .unwrap()
        );
        assert_eq!(found, points(DesignKind::LatinHypercube { n_points: 20 }, 3), "a seed repeats it");
    }

    #[test]
    fn the_first_points_of_a_sobol_sequence_balance() {
        let found = points(DesignKind::Sobol { n_points: 64 }, 5);
        for n in [2, 4, 8, 16, 32, 64] {
            for d in 0..5 {
                assert_eq!(strata(&found[..n], d, n), vec![1; n], "the first {n} points, dimension {d}");
            }
        }
        // Two dimensions together: one of 16 points in each cell of 4 x 4.
        let mut cells: Vec<[usize; 2]> =
            found[..16].iter().map(|p| [(4.0 * p[0]) as usize, (4.0 * p[1]) as usize]).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 16);
    }

    #[test]
    fn a_grid_has_all_combinations() {
        let list = Distribution::Values(vec![7.0, 9.0]);
        let design = Design { kind: DesignKind::Grid { n_levels: 3 }, seed: 0, correlation: None };
        let found = design.points(&[&list, &UNIT], &[7.0, 0.5]).unwrap();
        assert_eq!(found, [[7.0, 0.0], [7.0, 0.5], [7.0, 1.0], [9.0, 0.0], [9.0, 0.5], [9.0, 1.0]]);
        assert!(!design.is_sample());
        let error = design.points(&[&UNIT; 20], &[0.5; 20]).unwrap_err().to_string();
        assert!(error.contains("65536"), "{error}");
    }

    #[test]
    fn the_points_of_an_adaptive_design_are_limited_and_the_first_are_those_of_its_start() {
        let rule = |n_points: usize| DesignKind::Adaptive(AdaptiveRule { n_points, n_start: 4, resolution: 0.1 });
        assert_eq!(points(rule(MAX_POINTS), 2), points(DesignKind::Sobol { n_points: 4 }, 2));
        assert_eq!(Design { kind: rule(9), seed: 7, correlation: None }.n_start(), Some(4));
        let map = Design { kind: DesignKind::Map { n_levels: 3 }, seed: 7, correlation: None };
        assert_eq!((map.n_start(), map.is_sample()), (Some(9), false));
        assert_eq!(map.points(&[&UNIT; 2], &[0.5; 2]).unwrap(), points(DesignKind::Grid { n_levels: 3 }, 2));
        let too_many = Design { kind: rule(MAX_POINTS + 1), seed: 7, correlation: None };
        assert!(too_many.points(&[&UNIT], &[0.5]).unwrap_err().to_string().contains("65537"));
    }

    #[test]
    fn one_parameter_at_a_time_leaves_the_others_nominal() {
        let found = points(DesignKind::OneAtATime { n_levels: 2 }, 2);
        assert_eq!(found, [[0.0, 0.5], [1.0, 0.5], [0.5, 0.0], [0.5, 1.0]]);
    }

    #[test]
    fn points_for_indices_differ_in_one_parameter() {
        let found = points(DesignKind::Saltelli { n_base: 4 }, 3);
        assert_eq!(found.len(), 20);
        for block in found.chunks(5) {
            let (a, b) = (&block[0], &block[1]);
            for (i, mixed) in block[2..].iter().enumerate() {
                assert!((0..3).all(|j| mixed[j] == if i == j { b[j] } else { a[j] }));
            }
        }
    }
}
