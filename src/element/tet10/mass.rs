//! The consistent mass matrix and the integrals that describe a rigid body.

use super::shape::{GRADIENTS_14, jacobian, shapes_at};
use crate::algebra::{cofactor_columns, sub};
use crate::element::quadrature::TETRAHEDRON_14;
use std::ops::AddAssign;

static SHAPES_14: [[f64; 10]; 14] = shapes_at(&TETRAHEDRON_14);

/// Fills `m` (10x10, row-major, kg) with the consistent mass, the same for each of the three axes.
///
/// `m_ab = integral of density N_a N_b = sum_q density w detJ N_a N_b` by 14 points; `x` in m, `density` in kg/m3. The
/// full 30x30 matrix is `m_ab delta_ij` at dofs `(3a + i, 3b + j)`. Exactly symmetric, and positive definite wherever
/// `detJ > 0`. Exact for straight edges; on curved ones the sum of all entries (the mass) still is.
pub fn scalar_mass(x: &[[f64; 3]; 10], density: f64, m: &mut [f64; 100]) {
    m.fill(0.0);
    for q in 0..14 {
        let n = &SHAPES_14[q];
        let weight = density * weighted_det(x, q);
        for a in 0..10 {
            // m_ab += density w detJ N_a N_b
            let factor = weight * n[a];
            for b in a..10 {
                m[10 * a + b] += factor * n[b];
            }
        }
    }
    for a in 1..10 {
        for b in 0..a {
            m[10 * a + b] = m[10 * b + a];
        }
    }
}

/// Volume, m3: `sum_q w detJ`, exact for curved edges too (`detJ` has degree 3).
pub fn volume(x: &[[f64; 3]; 10]) -> f64 {
    (0..14).map(|q| weighted_det(x, q)).sum()
}

/// `w detJ` at point `q` of the 14-point rule.
#[inline]
fn weighted_det(x: &[[f64; 3]; 10], q: usize) -> f64 {
    TETRAHEDRON_14[q].weight * cofactor_columns(&jacobian(x, &GRADIENTS_14[q])).1
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

/// Mass, first and second moments of an element, by the points of the mass matrix.
///
/// So they are what `u^T M u` gives for rigid motions, to round-off: mass and first moment are exact on curved edges
/// too, the second moment (degree 7 there) on straight ones. Moments are summed about corner 0 and then shifted to the
/// origin, so that a small element far from it loses no digits to the sum.
pub fn mass_properties(x: &[[f64; 3]; 10], density: f64) -> MassProperties {
    let origin = x[0];
    let arms = x.map(|p| sub(p, origin));
    let mut about_corner = MassProperties::default();
    for q in 0..14 {
        let dm = density * weighted_det(&arms, q);
        let r: [f64; 3] = std::array::from_fn(|i| (0..10).map(|a| SHAPES_14[q][a] * arms[a][i]).sum());
        about_corner += MassProperties {
            mass: dm,
            first_moment: r.map(|ri| dm * ri),
            second_moment: r.map(|ri| r.map(|rj| dm * ri * rj)),
        };
    }
    let (m, s) = (about_corner.mass, about_corner.first_moment);
    // x = o + r:  s_i' = s_i + m o_i,  S_ij' = S_ij + s_i o_j + o_i s_j + m o_i o_j
    let shifted = |i: usize, j: usize| {
        about_corner.second_moment[i][j] + s[i] * origin[j] + origin[i] * s[j] + m * origin[i] * origin[j]
    };
    MassProperties {
        mass: m,
        first_moment: std::array::from_fn(|i| s[i] + m * origin[i]),
        second_moment: std::array::from_fn(|i| std::array::from_fn(|j| shifted(i, j))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{apply, cross, dot};
    use crate::element::samples::{Random, collapsed_gauss, curved_tet, straight_tet};
    use crate::element::tet10::{EDGES, gradients, position, shape};
    use nalgebra::DMatrix;

    fn mass(x: &[[f64; 3]; 10], density: f64) -> DMatrix<f64> {
        let mut m = [0.0; 100];
        scalar_mass(x, density, &mut m);
        DMatrix::from_row_slice(10, 10, &m)
    }

    /// Entry of the straight element's matrix over `density volume / 420`: 6 and 1 between corners, -4 and -6 between a
    /// corner and a midside on its edges or not, 32 on the diagonal of midsides, 16 between edges that meet and 8 else.
    fn known(a: usize, b: usize) -> f64 {
        match (a < 4, b < 4) {
            (true, true) => {
                if a == b {
                    6.0
                } else {
                    1.0
                }
            }
            (true, false) => {
                if EDGES[b - 4].contains(&a) {
                    -4.0
                } else {
                    -6.0
                }
            }
            (false, true) => known(b, a),
            (false, false) if a == b => 32.0,
            (false, false) => {
                if EDGES[a - 4].iter().any(|c| EDGES[b - 4].contains(c)) {
                    16.0
                } else {
                    8.0
                }
            }
        }
    }

    #[test]
    fn straight_element_has_the_known_consistent_matrix() {
        let mut random = Random::seeded(21);
        let x = straight_tet(&mut random);
        let edge = |c: usize| sub(x[c], x[0]);
        let exact_volume = dot(cross(edge(1), edge(2)), edge(3)) / 6.0;
        let exact = DMatrix::from_fn(10, 10, |a, b| known(a, b) * 7800.0 * exact_volume / 420.0);
        assert!((mass(&x, 7800.0) - &exact).norm() < 2e-14 * exact.norm());
    }

    #[test]
    fn entries_add_up_to_the_mass_and_rows_to_the_integrals_of_the_shape_functions() {
        let mut random = Random::seeded(22);
        for _ in 0..20 {
            let x = curved_tet(&mut random, 0.08);
            let m = mass(&x, 3.0);
            assert!((m.sum() / (3.0 * volume(&x)) - 1.0).abs() < 1e-14);
            for a in 0..10 {
                let rule = collapsed_gauss(6);
                let det = |at| cofactor_columns(&jacobian(&x, &gradients(at))).1;
                let exact: f64 = rule.iter().map(|q| q.weight * det(q.at) * shape(q.at)[a] * 3.0).sum();
                assert!((m.row(a).sum() - exact).abs() < 1e-14 * m.sum());
            }
        }
    }

    #[test]
    fn mass_is_symmetric_and_positive_definite_on_curved_elements() {
        let mut random = Random::seeded(23);
        for _ in 0..20 {
            let m = mass(&curved_tet(&mut random, 0.08), 1.0);
            assert_eq!(m, m.transpose());
            assert!(m.cholesky().is_some());
        }
    }

    #[test]
    fn rigid_rotation_has_the_kinetic_energy_of_the_inertia_tensor() {
        let mut random = Random::seeded(24);
        for _ in 0..20 {
            let x = curved_tet(&mut random, 0.08);
            let (m, properties) = (mass(&x, 7800.0), mass_properties(&x, 7800.0));
            let (spin, point) = (random.vector(), random.vector());
            let v = DMatrix::from_fn(10, 3, |a, i| cross(spin, sub(x[a], point))[i]);
            let exact = dot(spin, apply(&properties.inertia_about(point), spin));
            assert!(((v.transpose() * &m * &v).trace() / exact - 1.0).abs() < 1e-12);
        }
    }

    /// Moments up to degree 7 in the reference coordinates, by a rule far beyond that.
    fn exact_properties(x: &[[f64; 3]; 10]) -> MassProperties {
        let mut sum = MassProperties::default();
        for q in collapsed_gauss(8) {
            let dm = q.weight * cofactor_columns(&jacobian(x, &gradients(q.at))).1;
            let p = position(x, q.at);
            sum += MassProperties {
                mass: dm,
                first_moment: p.map(|pi| dm * pi),
                second_moment: p.map(|pi| p.map(|pj| dm * pi * pj)),
            };
        }
        sum
    }

    fn second_moment_error(x: &[[f64; 3]; 10]) -> f64 {
        let (ours, exact) = (mass_properties(x, 1.0), exact_properties(x));
        assert!((ours.mass / exact.mass - 1.0).abs() < 1e-13);
        let mut worst = 0.0_f64;
        for i in 0..3 {
            assert!((ours.first_moment[i] - exact.first_moment[i]).abs() < 1e-13 * exact.mass);
            for j in 0..3 {
                worst = worst.max((ours.second_moment[i][j] - exact.second_moment[i][j]).abs() / exact.mass);
            }
        }
        worst
    }

    #[test]
    fn mass_and_first_moment_are_exact_always_and_second_moments_on_straight_elements() {
        let mut random = Random::seeded(25);
        for _ in 0..20 {
            assert!(second_moment_error(&straight_tet(&mut random)) < 1e-13);
            assert!(second_moment_error(&curved_tet(&mut random, 0.05)) < 5e-6);
        }
    }

    #[test]
    fn straight_element_obeys_the_second_moment_identity_of_its_corners() {
        // integral of x_i x_j = V/20 (sum_c x_c,i x_c,j + (sum_c x_c,i)(sum_c x_c,j))
        let x = straight_tet(&mut Random::seeded(26));
        let properties = mass_properties(&x, 2.0);
        for i in 0..3 {
            for j in 0..3 {
                let squares: f64 = (0..4).map(|c| x[c][i] * x[c][j]).sum();
                let sums = (0..4).map(|c| x[c][i]).sum::<f64>() * (0..4).map(|c| x[c][j]).sum::<f64>();
                let exact = properties.mass / 20.0 * (squares + sums);
                assert!((properties.second_moment[i][j] - exact).abs() < 1e-13 * properties.mass);
            }
        }
    }

    #[test]
    fn inertia_about_the_centre_does_not_depend_on_where_the_element_stands() {
        let near = curved_tet(&mut Random::seeded(27), 0.05);
        let far = near.map(|p| [p[0] + 10.0, p[1] - 20.0, p[2] + 30.0]);
        let inertia = |x| {
            let properties = mass_properties(x, 1.0);
            properties.inertia_about(properties.centre())
        };
        let (near, far) = (inertia(&near), inertia(&far));
        for i in 0..3 {
            assert!((near[i][i] / far[i][i] - 1.0).abs() < 1e-10);
        }
    }
}
