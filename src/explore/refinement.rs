//! Designs that add points by what the points before have found.

use super::adaptive::BoundarySearch;
use super::hopf::HopfSearch;
use super::result::PointResult;
use super::study::Study;
use crate::Result;

/// The points of such a design as they come.
#[derive(Debug, Clone)]
pub enum Refinement {
    /// Those of an adaptive design.
    Boundary(BoundarySearch),
    /// Those of a map.
    Hopf(HopfSearch),
}

impl Refinement {
    /// With the points of the start; none for a design whose points are known beforehand.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for more dimensions than the Sobol sequence has.
    pub fn new(study: &Study) -> Result<Option<Refinement>> {
        let boundary = BoundarySearch::new(study)?.map(Refinement::Boundary);
        Ok(boundary.or_else(|| HopfSearch::new(study).map(Refinement::Hopf)))
    }

    /// Adds the points of the next round, and gives the values of their parameters; none at the end. `points` are those
    /// of the design so far, which are finished.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for more points than the Sobol sequence has.
    ///
    /// # Panics
    /// Where there are fewer points than were given.
    pub fn next(&mut self, points: &[PointResult]) -> Result<Vec<Vec<f64>>> {
        match self {
            Refinement::Boundary(search) => search.next(points),
            Refinement::Hopf(search) => Ok(search.next(points)),
        }
    }
}
