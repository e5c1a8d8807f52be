//! Quadrature on the reference elements.
//!
//! The reference tetrahedron has its corners at the origin and the three unit points, the triangle at the origin and
//! two unit points; the other elements run from -1 to 1. Weights add up to the reference element's volume or area:
//!
//! ```text
//!   integral of f over the element  =  sum_q  w_q  f(xi_q) detJ(xi_q)
//! ```
//!
//! Every rule is positive (all weights > 0), so that a mass matrix is positive definite on any element whose Jacobian
//! is.
//!
//! | rule | points | exact to degree |
//! |---|---|---|
//! | [`TETRAHEDRON_1`] | 1 | 1 |
//! | [`TETRAHEDRON_4`] | 4 | 2 |
//! | [`TETRAHEDRON_14`] | 14 | 5 |
//! | [`TRIANGLE_3`] | 3 | 2 |
//! | [`TRIANGLE_7`] | 7 | 5 |
//! | [`QUADRILATERAL_4`], [`HEXAHEDRON_8`] | 2 along each axis | 3 in each coordinate |
//! | [`QUADRILATERAL_9`], [`HEXAHEDRON_27`] | 3 along each axis | 5 in each coordinate |
//! | [`WEDGE_2`], [`WEDGE_9`], [`WEDGE_21`] | 1 x 2, 3 x 3, 7 x 3 | 1, 2, 5 on the triangle; 3, 5, 5 along |
//!
//! Rules of triangles and tetrahedra are stored as orbits of the symmetry group in barycentric coordinates (`tables`),
//! all others are products of these and of Gauss's rules. All are unrolled at compile time.

mod tables;

pub use tables::{
    HEXAHEDRON_8, HEXAHEDRON_27, QUADRILATERAL_4, QUADRILATERAL_9, TETRAHEDRON_1, TETRAHEDRON_4, TETRAHEDRON_14,
    TRIANGLE_3, TRIANGLE_7, WEDGE_2, WEDGE_9, WEDGE_21,
};

/// A quadrature point on a reference element of dimension `D`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadraturePoint<const D: usize> {
    /// Reference coordinates.
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
    fn triangle_3_is_exact_to_degree_2_and_tetrahedron_1_to_degree_1() {
        assert_degree(&TRIANGLE_3, 2);
        assert_degree(&TETRAHEDRON_1, 1);
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

    /// `integral of x^p` from -1 to 1.
    fn line_moment(p: u32) -> f64 {
        if p % 2 == 1 { 0.0 } else { 2.0 / f64::from(p + 1) }
    }

    /// Whether a rule integrates `x^i y^j z^k` over the cube.
    fn is_exact_on_the_cube<const D: usize>(rule: &[QuadraturePoint<D>], power: [u32; D]) -> bool {
        let value = |q: &QuadraturePoint<D>| (0..D).map(|i| q.at[i].powi(power[i] as i32)).product::<f64>();
        let sum: f64 = rule.iter().map(|q| q.weight * value(q)).sum();
        (sum - power.iter().map(|&p| line_moment(p)).product::<f64>()).abs() < 1e-14
    }

    #[test]
    fn rules_of_the_cube_are_exact_to_degrees_3_and_5_in_each_coordinate() {
        for p in 0..=3 {
            assert!(is_exact_on_the_cube(&HEXAHEDRON_8, [3, p, 2]) && is_exact_on_the_cube(&QUADRILATERAL_4, [p, 2]));
        }
        for p in 0..=5 {
            assert!(is_exact_on_the_cube(&HEXAHEDRON_27, [4, p, 5]) && is_exact_on_the_cube(&QUADRILATERAL_9, [p, 4]));
        }
        assert!(!is_exact_on_the_cube(&HEXAHEDRON_8, [0, 4, 0]) && !is_exact_on_the_cube(&QUADRILATERAL_4, [4, 0]));
        assert!(!is_exact_on_the_cube(&HEXAHEDRON_27, [6, 0, 0]) && !is_exact_on_the_cube(&QUADRILATERAL_9, [0, 6]));
    }

    #[test]
    fn rules_of_the_wedge_are_products() {
        fn check(rule: &[QuadraturePoint<3>], on_triangle: u32, along: u32) {
            for (i, p) in (0..=on_triangle).flat_map(|i| (0..=along).map(move |p| (i, p))) {
                let (j, value) = (on_triangle - i, |q: &QuadraturePoint<3>, i: u32, j: u32| {
                    q.at[0].powi(i as i32) * q.at[1].powi(j as i32) * q.at[2].powi(p as i32)
                });
                let exact = factorial(i) * factorial(j) / factorial(i + j + 2) * line_moment(p);
                let sum: f64 = rule.iter().map(|q| q.weight * value(q, i, j)).sum();
                assert!((sum - exact).abs() < 1e-14);
            }
        }
        check(&WEDGE_2, 1, 3);
        check(&WEDGE_9, 2, 5);
        check(&WEDGE_21, 5, 5);
    }

    #[test]
    fn all_points_lie_inside_and_all_weights_are_positive() {
        fn check<const D: usize>(rule: &[QuadraturePoint<D>]) {
            for q in rule {
                assert!(q.weight > 0.0 && q.at.iter().all(|&x| x > 0.0) && q.at.iter().sum::<f64>() < 1.0);
            }
        }
        check(&TETRAHEDRON_1);
        check(&TETRAHEDRON_4);
        check(&TETRAHEDRON_14);
        check(&TRIANGLE_3);
        check(&TRIANGLE_7);
    }
}
