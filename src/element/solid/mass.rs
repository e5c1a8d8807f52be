//! The consistent mass matrix and the integrals that describe a rigid body.

use super::table::Table;
use crate::algebra::sub;
use std::ops::AddAssign;

impl<const N: usize, const P: usize> Table<N, P> {
    /// As [`super::scalar_mass`].
    #[inline]
    pub(super) fn scalar_mass(&self, x: &[[f64; 3]; N], density: f64, m: &mut [f64]) {
        let rows: &mut [[f64; N]; N] = m.as_chunks_mut().0.try_into().expect("one entry a pair of nodes");
        rows.fill([0.0; N]);
        for q in 0..P {
            let n = &self.shapes[q];
            let weight = density * self.weighted_det(x, q);
            for a in 0..N {
                // m_ab += density w detJ N_a N_b
                let factor = weight * n[a];
                for b in a..N {
                    rows[a][b] += factor * n[b];
                }
            }
        }
        for a in 1..N {
            for b in 0..a {
                rows[a][b] = rows[b][a];
            }
        }
    }

    /// As [`super::mass_properties`].
    pub(super) fn mass_properties(&self, x: &[[f64; 3]; N], density: f64) -> MassProperties {
        let origin = x[0];
        let arms = x.map(|p| sub(p, origin));
        let mut about_node = MassProperties::default();
        for q in 0..P {
            let dm = density * self.weighted_det(&arms, q);
            let r: [f64; 3] = std::array::from_fn(|i| (0..N).map(|a| self.shapes[q][a] * arms[a][i]).sum());
            about_node += MassProperties {
                mass: dm,
                first_moment: r.map(|ri| dm * ri),
                second_moment: r.map(|ri| r.map(|rj| dm * ri * rj)),
            };
        }
        about_node.shifted(origin)
    }
}

/// Mass and its moments about the origin; of an element, or with `+=` of a body.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MassProperties {
    /// `integral of rho`, kg.
    pub mass: f64,
    /// `integral of rho x_i`, kg m.
    pub first_moment: [f64; 3],
    /// `integral of rho x_i x_j`, kg m2.
    pub second_moment: [[f64; 3]; 3],
}

impl MassProperties {
    /// Centre of mass, m. Not finite for a body without mass.
    pub fn centre(&self) -> [f64; 3] {
        self.first_moment.map(|s| s / self.mass)
    }

    /// The moments about the origin of a body whose moments about the point `o` are these.
    ///
    /// `x = o + r:  s_i' = s_i + m o_i,  S_ij' = S_ij + s_i o_j + o_i s_j + m o_i o_j`
    fn shifted(&self, o: [f64; 3]) -> MassProperties {
        let (m, s) = (self.mass, self.first_moment);
        let moment = |i: usize, j: usize| self.second_moment[i][j] + s[i] * o[j] + o[i] * s[j] + m * o[i] * o[j];
        MassProperties {
            mass: m,
            first_moment: std::array::from_fn(|i| s[i] + m * o[i]),
            second_moment: std::array::from_fn(|i| std::array::from_fn(|j| moment(i, j))),
        }
    }

    /// Inertia tensor about `point`, kg m2: kinetic energy is `w . I w / 2` for an angular velocity `w` about the
    /// point.
    ///
    /// `I = integral of rho (r.r delta_ij - r_i r_j)` with `r = x - point`, that is `tr(P) delta_ij - P_ij` with
    /// `P_ij = S_ij - s_i p_j - p_i s_j + m p_i p_j`.
    pub fn inertia_about(&self, point: [f64; 3]) -> [[f64; 3]; 3] {
        let (m, s, p) = (self.mass, self.first_moment, point);
        let moment = |i: usize, j: usize| self.second_moment[i][j] - s[i] * p[j] - p[i] * s[j] + m * p[i] * p[j];
        let trace = moment(0, 0) + moment(1, 1) + moment(2, 2);
        let inertia = |i: usize, j: usize| {
            if i == j { trace - moment(i, j) } else { -moment(i, j) }
        };
        std::array::from_fn(|i| std::array::from_fn(|j| inertia(i, j)))
    }
}

impl AddAssign for MassProperties {
    fn add_assign(&mut self, other: Self) {
        self.mass += other.mass;
        for i in 0..3 {
            self.first_moment[i] += other.first_moment[i];
            for j in 0..3 {
                self.second_moment[i][j] += other.second_moment[i][j];
            }
        }
    }
}
