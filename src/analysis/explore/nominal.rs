//! The nominal point: its modes, by which those of others are recognised, and their derivatives.
//!
//! Each group of ranks solves it, as each needs an equilibrium to start from and vectors for its derivatives. All
//! groups recognise modes by those of the first one, so that a number means the same mode in all of them; and each
//! checks that its own are the same.

use serde::{Deserialize, Serialize};

use num_complex::Complex64;

use crate::analysis::observer::Observer;
use crate::explore::{Gradient, PointMode, PointResult};
use crate::native::Block;
use crate::output::folder::Folder;
use crate::{Error, Result};

use super::Run;
use super::checkpoint::Points;
use super::groups::Groups;
use super::point::{PointSolution, Request, WeightedModes};

/// Eigenvalues of two groups differ less, of the largest one: equilibria and modes converge further.
const SAME_MODE: f64 = 1e-6;

impl Run<'_> {
    /// The modes of the nominal point; where an earlier run has not finished it, the point itself and its derivatives,
    /// too; where the files of an earlier run lack something, that. Collective.
    pub(super) fn nominal(&self, points: &mut Points, observer: &mut dyn Observer) -> Result<Option<WeightedModes>> {
        let kept = points.nominal();
        let earlier = points.get(0).cloned();
        let lacks_gradients = self.request.follow.is_some() && self.study.gradients && points.gradients.is_empty();
        let lacks = points.n_states() == 0 || lacks_gradients || self.request.follow.is_some() && kept.is_none();
        let has_modes = |point: &PointResult| point.modes().is_some_and(|modes| !modes.is_empty());
        if earlier.as_ref().is_some_and(|point| !lacks || !has_modes(point)) {
            return Ok(kept);
        }
        let request = Request { gradients: lacks_gradients, ..self.request };
        let (own, mut found) = self.groups.agree(self.point(0, &request, None, None, observer))?;
        let world = &self.groups.world;
        let point = world.broadcast_value(0, earlier.clone().unwrap_or_else(|| own.clone()));
        let n_found = world.sum(usize::from(found.is_some()));
        world.agree(require_found(n_found, world.size(), earlier.is_some()))?;
        world.agree(require_same(point.modes().unwrap_or_default(), own.modes().unwrap_or_default()))?;
        if let Some(found) = &mut found {
            self.keep(found, points, observer)?;
        }
        if earlier.is_none() {
            let state = found.as_ref().map(|found| found.displacements.clone());
            let shapes = found.as_mut().map(|found| std::mem::take(&mut found.shapes));
            self.groups.agree(points.commit(0, point, shapes.unwrap_or_default(), state))?;
            self.folder.iter().for_each(Folder::keep);
            self.report(points, observer);
        }
        let Some(found) = found else { return Ok(None) };
        points.keep_state(0, Some(found.displacements));
        Ok(found.weighted)
    }

    /// Keeps what belongs to the nominal point, before the point: the first group's modes, and the derivatives where
    /// they are missing. Collective.
    fn keep(&self, found: &mut PointSolution, points: &mut Points, observer: &mut dyn Observer) -> Result<()> {
        if let Some(nominal) = found.weighted.take() {
            let nominal = shared(&self.groups, nominal)?;
            self.groups.agree(points.keep_nominal(&nominal))?;
            found.weighted = Some(nominal);
        }
        let Some(vectors) = &found.for_gradients else { return Ok(()) };
        let gradients = self.groups.agree(self.gradients(vectors, &found.displacements, observer))?;
        self.groups.agree(points.keep_gradients(in_order(self.groups.join(gradients))))
    }
}

/// A rank's part of the nominal modes, for a message.
#[derive(Serialize, Deserialize)]
struct NominalPart {
    left: Vec<f64>,
    right: Vec<f64>,
    own: Vec<Complex64>,
}

/// The nominal modes of the first group on all groups. Collective.
fn shared(groups: &Groups, own: WeightedModes) -> Result<WeightedModes> {
    if groups.n_groups() == 1 {
        return Ok(own);
    }
    let [left, right] = [&own.left, &own.right].map(|block| block.values().to_vec());
    let part = groups.first_groups(NominalPart { left, right, own: own.own.clone() });
    let is_alike = part.left.len() == own.left.values().len() && part.right.len() == own.right.values().len();
    let what = "groups of ranks divide the dofs otherwise, so that they cannot compare modes. Use one group";
    groups.world.agree(if is_alike { Ok(()) } else { Err(Error::input(what)) })?;
    if groups.number() == 0 || part.left.is_empty() {
        return Ok(own);
    }
    let block = |like: &Block, values| Block::from_columns(&groups.own, like.n_local(), values);
    Ok(WeightedModes { left: block(&own.left, part.left), right: block(&own.right, part.right), own: part.own })
}

/// That the nominal point has a result on all ranks or on none; on all where an earlier run has one.
fn require_found(n_found: usize, n_ranks: usize, has_earlier: bool) -> Result<()> {
    let what = match n_found {
        0 if !has_earlier => return Ok(()),
        0 => {
            "the nominal point, which an earlier run has finished, does not converge on these ranks. Continue with the \
              --ranks-per-point of that run"
                .to_owned()
        }
        n if n == n_ranks => return Ok(()),
        n => format!(
            "the nominal point converges on {n} of {n_ranks} ranks only. Use fewer groups by a larger --ranks-per-point"
        ),
    };
    Err(Error::not_converged(what))
}

/// That a group has found the modes of the first group or of an earlier run, in their order.
fn require_same(expected: &[PointMode], own: &[PointMode]) -> Result<()> {
    let advice = "Use one group of ranks, or continue with the --ranks-per-point of the earlier run";
    let differ =
        |what: String| Err(Error::not_converged(format!("the nominal modes of groups differ: {what}. {advice}")));
    if expected.len() != own.len() {
        return differ(format!("{} and {} modes", expected.len(), own.len()));
    }
    let largest = expected.iter().fold(0.0_f64, |most, mode| most.max(mode.lambda.norm()));
    let distances = expected.iter().zip(own).map(|(a, b)| (a.lambda - b.lambda).norm());
    match (1..).zip(distances).find(|(_, distance)| distance.is_nan() || *distance > SAME_MODE * largest) {
        Some((number, distance)) => differ(format!("mode {number} by {distance:.2e} rad/s")),
        None => Ok(()),
    }
}

/// Derivatives in the order of their parameters.
fn in_order(mut numbered: Vec<(usize, Gradient)>) -> Vec<Gradient> {
    numbered.sort_by_key(|(parameter, _)| *parameter);
    numbered.into_iter().map(|(_, gradient)| gradient).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ErrorKind;

    fn modes(frequencies: &[f64]) -> Vec<PointMode> {
        let mode = |&omega: &f64| PointMode {
            lambda: Complex64::new(-1.0, omega),
            unstable: false,
            backward_error: 0.0,
            link: None,
        };
        frequencies.iter().map(mode).collect()
    }

    #[test]
    fn a_nominal_point_that_some_ranks_lose_ends_the_study() {
        let message = |n, has_earlier| require_found(n, 4, has_earlier).unwrap_err().to_string();
        assert!(require_found(4, 4, true).is_ok() && require_found(4, 4, false).is_ok());
        assert!(require_found(0, 4, false).is_ok(), "a point that fails on all ranks is recorded");
        assert!(message(0, true).contains("an earlier run"));
        // Whatever ranks they are, those of the first group or others.
        assert!(message(1, false).contains("on 1 of 4 ranks") && message(3, true).contains("on 3 of 4 ranks"));
        assert_eq!(require_found(2, 4, false).unwrap_err().kind(), ErrorKind::NotConverged);
    }

    #[test]
    fn nominal_modes_of_groups_are_compared_by_number_and_value() {
        let first = modes(&[1e3, 1.01e3, 5e4]);
        let message = |own: &[f64]| require_same(&first, &modes(own)).unwrap_err().to_string();
        require_same(&first, &modes(&[1e3 + 1e-3, 1.01e3, 5e4 * (1.0 + 1e-9)])).unwrap();
        assert!(message(&[1e3, 5e4]).contains("3 and 2 modes"));
        assert!(message(&[1.01e3, 1e3, 5e4]).contains("mode 1 by 1.00e1 rad/s"));
        assert!(message(&[1e3, 1.01e3, 5e4 + 0.1]).contains("mode 3"));
        assert!(message(&[1e3, f64::NAN, 5e4]).contains("mode 2"));
    }
}
