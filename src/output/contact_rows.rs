//! Rotations, contact pairs and layouts of reference nodes in the summary of a model.

use serde::Serialize;

use super::text::joined;
use crate::model::{Inertia, ProposedStiffness};

/// A rotation.
#[derive(Serialize)]
pub struct RotationRow {
    /// The part that turns.
    pub part: String,
    /// Unit vector of the axis.
    pub axis: [f64; 3],
    /// A point of the axis.
    pub through_m: [f64; 3],
    /// Speed, right-handed about the axis.
    pub speed_rad_per_s: f64,
    /// Which inertia forces of the rotation the part has.
    pub inertia: Inertia,
    /// Its fastest point.
    pub speed_max_m_per_s: f64,
    /// `Omega / pi`: a wave of n lengths around the axis splits by n times that, seen from the fixed frame.
    pub splitting_hz: f64,
    /// The same relative to the end of the band of modes.
    pub splitting_of_band: f64,
}

/// A contact pair.
#[derive(Serialize)]
pub struct PairRow {
    /// Its name.
    pub pair: String,
    /// What acts in the tangent plane.
    pub kind: String,
    /// Contact points.
    pub points: usize,
    /// Slave nodes without a master facet opposite.
    pub dropped: usize,
    /// Points without a gap at the start.
    pub touching: usize,
    /// Area of the points, without dropped ones.
    pub area_m2: f64,
    /// Points whose gap was closed (adjust).
    pub adjusted: usize,
    /// The largest gap that was closed.
    pub adjusted_gap_max_m: f64,
    /// Mean sliding speed; none of a pair that does not slide.
    pub sliding_speed_m_per_s: Option<f64>,
    /// Mean distance from the axis of rotation.
    pub radius_m: Option<f64>,
    /// Smallest initial gap.
    pub gap_min_m: f64,
    /// Largest initial gap.
    pub gap_max_m: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Normal stiffness where the program proposes it; none where the user gives a law.
    pub proposed_stiffness_n_per_m3: Option<f64>,
    /// Stick where the program proposes it.
    pub proposed_stick_n_per_m3: Option<f64>,
}

/// The reference nodes of a sliding pair, and how even their cells are.
#[derive(Serialize)]
pub struct LayoutRow {
    /// The pair's name.
    pub pair: String,
    /// Reference nodes.
    pub reference_nodes: usize,
    /// Smallest area of a cell.
    pub cell_area_min_m2: f64,
    /// Mean area of the cells.
    pub cell_area_mean_m2: f64,
    /// Largest area of a cell.
    pub cell_area_max_m2: f64,
    /// Fewest contact points in a cell.
    pub cell_points_min: usize,
    /// Most contact points in a cell.
    pub cell_points_max: usize,
}

impl RotationRow {
    pub(super) fn text(&self) -> String {
        let RotationRow { part, axis: [x, y, z], speed_rad_per_s, .. } = self;
        let through = joined(self.through_m, 1e3, 2, " ");
        let inertia = match self.inertia {
            Inertia::None => "without inertia forces of the rotation",
            Inertia::FixedFrame => "with the inertia forces of a solid of revolution, seen from the fixed frame",
            Inertia::RotatingFrame => "with the inertia forces of a rotor, seen from the rotating frame",
        };
        let (fastest, splitting, percent) = (self.speed_max_m_per_s, self.splitting_hz, 100.0 * self.splitting_of_band);
        format!(
            "{part} turns about {x:.4} {y:.4} {z:.4} through {through} mm at {speed_rad_per_s} rad/s, {inertia}\n\
             {part}: up to {fastest:.2} m/s; waves of n lengths around split by about n x {splitting:.2} Hz, n x {percent:.2} % \
             of the band's end\n"
        )
    }
}

impl PairRow {
    /// Sliding, adjustment and proposals, a line each; nothing where there is none.
    pub(super) fn notes(&self) -> String {
        let name = &self.pair;
        let sliding = self.sliding_speed_m_per_s.zip(self.radius_m).map(|(speed, radius)| {
            format!("{name} slides at {speed:.3} m/s, at a mean radius of {:.2} mm\n", 1e3 * radius)
        });
        let (n, largest) = (self.adjusted, 1e3 * self.adjusted_gap_max_m);
        let adjusted =
            (n > 0).then(|| format!("{name}: gaps of {n} points are closed, the largest {largest:.2e} mm\n"));
        let proposed = self.proposed_stiffness_n_per_m3.map(|stiffness| {
            let (contact, stick) = (name.clone(), self.proposed_stick_n_per_m3);
            format!("{}\n", ProposedStiffness { contact, stiffness, stick })
        });
        sliding.into_iter().chain(adjusted).chain(proposed).collect()
    }
}

impl LayoutRow {
    pub(super) fn text(&self) -> String {
        let LayoutRow { pair, reference_nodes, cell_points_min, cell_points_max, .. } = self;
        let [min, max, mean] =
            [self.cell_area_min_m2, self.cell_area_max_m2, self.cell_area_mean_m2].map(|area| 1e6 * area);
        format!(
            "{pair}: {reference_nodes} reference nodes, cells of {min:.1} to {max:.1} mm2 (mean {mean:.1}) with \
             {cell_points_min} to {cell_points_max} contact points\n"
        )
    }
}
