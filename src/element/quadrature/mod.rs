//! Quadrature on the reference tetrahedron and triangle.
//!
//! The reference tetrahedron has its corners at the origin and the three unit points, the triangle at the origin and
//! two unit points; weights add up to the reference volume 1/6 and area 1/2:
//!
//! ```text
//!   integral of f over the element  =  sum_q  w_q  f(xi_q) detJ(xi_q)
//! ```
//!
//! Every rule is positive (all weights > 0), so that a mass matrix is positive definite on any element whose Jacobian
//! is.
//!
//! | rule | points | exact to degree | used for |
//! |---|---|---|---|
//! | [`TETRAHEDRON_4`] | 4 | 2 | stiffness: `B^T D B` of a straight-edged tet10 has degree 2 |
//! | [`TETRAHEDRON_14`] | 14 | 5 | mass: `N_a N_b` of a straight-edged tet10 has degree 4 |
//! | [`TRIANGLE_7`] | 7 | 5 | loads: `N_a (a_xi x a_eta)` of a curved tri6 has degree 4 |
//!
//! Rules are stored as orbits of the symmetry group in barycentric coordinates (`tables`) and unrolled at compile time.

mod tables;

pub use tables::{TETRAHEDRON_4, TETRAHEDRON_14, TRIANGLE_7};

/// A quadrature point on a reference element of dimension `D`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadraturePoint<const D: usize> {
    /// Reference coordinates: the barycentric coordinates of corners 1..=D.
    pub at: [f64; D],
    /// Weight.
    pub weight: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: u32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// Largest relative error over all monomials of a degree:
    /// `integral x^a y^b z^c = a! b! c! / (a + b + c + D)!` over the reference simplex.
    fn monomial_error<const D: usize>(rule: &[QuadraturePoint<D>], degree: u32) -> f64 {
        let mut worst = 0.0_f64;
        for code in 0..(degree + 1).pow(D as u32) {
            let power: [u32; D] = std::array::from_fn(|i| code / (degree + 1).pow(i as u32) % (degree + 1));
            if power.iter().sum::<u32>() != degree {
                continue;
            }
            let exact = power.iter().map(|&p| factorial(p)).product::<f64>() / factorial(degree + D as u32);
            let value = |q: &QuadraturePoint<D>| (0..D).map(|i| q.at[i].powi(power[i] as i32)).product::<f64>();
            let sum: f64 = rule.iter().map(|q| q.weight * value(q)).sum();
            worst = worst.max((sum / exact - 1.0).abs());
        }
        worst
    }

    fn assert_degree<const D: usize>(rule: &[QuadraturePoint<D>], exact_to: u32) {
        for degree in 0..=exact_to {
            let error = monomial_error(rule, degree);
            assert!(error < 2e-14, "degree {degree}: {error:e}");
        }
        let next = monomial_error(rule, exact_to + 1);
        assert!(next > 1e-4, "also exact to degree {}: the table says less than it could", exact_to + 1);
    }

    #[test]
    fn tetrahedron_4_is_exact_to_degree_2() {
        assert_degree(&TETRAHEDRON_4, 2);
    }

    #[test]
    fn tetrahedron_14_is_exact_to_degree_5() {
        assert_degree(&TETRAHEDRON_14, 5);
    }

    #[test]
    fn triangle_7_is_exact_to_degree_5() {
        assert_degree(&TRIANGLE_7, 5);
    }

    #[test]
    fn all_points_lie_inside_and_all_weights_are_positive() {
        fn check<const D: usize>(rule: &[QuadraturePoint<D>]) {
            for q in rule {
                assert!(q.weight > 0.0 && q.at.iter().all(|&x| x > 0.0) && q.at.iter().sum::<f64>() < 1.0);
            }
        }
        check(&TETRAHEDRON_4);
        check(&TETRAHEDRON_14);
        check(&TRIANGLE_7);
    }
}
