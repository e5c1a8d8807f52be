//! Interpolation between the nodes of a reference element: shape functions from two tables.
//!
//! An element is given by its nodes `xi_a` and by the monomials `p_m = xi^i eta^j zeta^k` that span its shape
//! functions. All else follows:
//!
//! ```text
//!   N_a(xi) = sum_m C_ma p_m(xi),    C the inverse of V_am = p_m(xi_a),    so that N_a(xi_b) = delta_ab
//! ```
//!
//! No power is above 2: linear and quadratic (serendipity) elements.

/// Shape functions on a reference element of dimension `D` with up to `MAX` nodes.
///
/// What comes as an array of `MAX` entries has one entry a node, and zeros after the last node.
#[derive(Debug)]
pub struct Interpolation<const D: usize, const MAX: usize> {
    n: usize,
    nodes: [[f64; D]; MAX],
    powers: [[u8; D]; MAX],
    coefficients: [[f64; MAX]; MAX],
}

impl<const D: usize, const MAX: usize> Interpolation<D, MAX> {
    /// From the first `n` nodes and the first `n` monomials (the power of each coordinate, 0 to 2).
    ///
    /// # Panics
    /// At compile time, where the monomials are not independent at the nodes.
    pub(super) const fn new(n: usize, nodes: &[[f64; D]], powers: &[[u8; D]]) -> Self {
        let (mut own_nodes, mut own_powers) = ([[0.0; D]; MAX], [[0; D]; MAX]);
        let mut matrix = [[0.0; MAX]; MAX];
        let mut a = 0;
        while a < n {
            own_nodes[a] = nodes[a];
            own_powers[a] = powers[a];
            let factors = factors(nodes[a], [0; D]);
            let mut m = 0;
            while m < n {
                matrix[a][m] = product(&factors, &powers[m]);
                m += 1;
            }
            a += 1;
        }
        Interpolation { n, nodes: own_nodes, powers: own_powers, coefficients: inverse(matrix, n) }
    }

    /// Reference coordinates of the nodes.
    pub fn nodes(&self) -> &[[f64; D]] {
        &self.nodes[..self.n]
    }

    /// Reference coordinates of one node.
    pub(super) const fn node(&self, a: usize) -> [f64; D] {
        self.nodes[a]
    }

    /// Shape functions `N_a` at a point.
    pub const fn shape(&self, at: [f64; D]) -> [f64; MAX] {
        self.derivative(at, [0; D])
    }

    /// Gradients `dN_a/dxi_k` at a point, one row a node.
    pub const fn gradients(&self, at: [f64; D]) -> [[f64; D]; MAX] {
        let mut gradients = [[0.0; D]; MAX];
        let mut k = 0;
        while k < D {
            let mut order = [0; D];
            order[k] = 1;
            let along = self.derivative(at, order);
            let mut a = 0;
            while a < self.n {
                gradients[a][k] = along[a];
                a += 1;
            }
            k += 1;
        }
        gradients
    }

    /// `sum_m C_ma d p_m`, where `d` differentiates by coordinate k `order[k]` times.
    const fn derivative(&self, at: [f64; D], order: [usize; D]) -> [f64; MAX] {
        let factors = factors(at, order);
        let mut sum = [0.0; MAX];
        let mut m = 0;
        while m < self.n {
            let value = product(&factors, &self.powers[m]);
            let mut a = 0;
            while a < self.n && value != 0.0 {
                sum[a] += self.coefficients[m][a] * value;
                a += 1;
            }
            m += 1;
        }
        sum
    }

    /// The monomials `p_m` at a point, differentiated by coordinate k `order[k]` times.
    #[inline]
    pub fn monomials(&self, at: [f64; D], order: [usize; D]) -> impl Iterator<Item = f64> + '_ {
        let factors = factors(at, order);
        self.powers[..self.n].iter().map(move |powers| product(&factors, powers))
    }

    /// The coefficients of `N_a` by monomials: entry m is `C_ma` for all nodes a.
    pub fn coefficients(&self) -> &[[f64; MAX]] {
        &self.coefficients[..self.n]
    }
}

/// For each coordinate x the derivatives of `1, x, x^2`, of the order asked for.
#[inline]
const fn factors<const D: usize>(at: [f64; D], order: [usize; D]) -> [[f64; 3]; D] {
    let mut factors = [[0.0; 3]; D];
    let mut k = 0;
    while k < D {
        factors[k] = match order[k] {
            0 => [1.0, at[k], at[k] * at[k]],
            1 => [0.0, 1.0, 2.0 * at[k]],
            _ => [0.0, 0.0, 2.0],
        };
        k += 1;
    }
    factors
}

/// One factor a coordinate, multiplied.
#[inline]
const fn product<const D: usize>(factors: &[[f64; 3]; D], powers: &[u8; D]) -> f64 {
    let mut value = 1.0;
    let mut k = 0;
    while k < D {
        value *= factors[k][powers[k] as usize];
        k += 1;
    }
    value
}

/// The inverse of the leading `n` rows and columns: Gauss and Jordan with row pivots.
const fn inverse<const MAX: usize>(mut matrix: [[f64; MAX]; MAX], n: usize) -> [[f64; MAX]; MAX] {
    let mut inverse = [[0.0; MAX]; MAX];
    let mut row = 0;
    while row < n {
        inverse[row][row] = 1.0;
        row += 1;
    }
    let mut column = 0;
    while column < n {
        let pivot = largest(&matrix, column, n);
        matrix.swap(column, pivot);
        inverse.swap(column, pivot);
        let factor = 1.0 / matrix[column][column];
        scale(&mut matrix[column], factor);
        scale(&mut inverse[column], factor);
        let (pivot_row, pivot_inverse) = (matrix[column], inverse[column]);
        let mut row = 0;
        while row < n {
            let factor = if row == column { 0.0 } else { matrix[row][column] };
            if factor != 0.0 {
                subtract(&mut matrix[row], factor, &pivot_row);
                subtract(&mut inverse[row], factor, &pivot_inverse);
            }
            row += 1;
        }
        column += 1;
    }
    inverse
}

/// The row at or below the diagonal with the largest entry in a column.
const fn largest<const MAX: usize>(matrix: &[[f64; MAX]; MAX], column: usize, n: usize) -> usize {
    let (mut best, mut row) = (column, column + 1);
    while row < n {
        if matrix[row][column].abs() > matrix[best][column].abs() {
            best = row;
        }
        row += 1;
    }
    assert!(matrix[best][column].abs() > 1e-6, "the monomials are independent at the nodes");
    best
}

const fn scale<const MAX: usize>(row: &mut [f64; MAX], factor: f64) {
    let mut column = 0;
    while column < MAX {
        row[column] *= factor;
        column += 1;
    }
}

/// `row -= factor other`.
const fn subtract<const MAX: usize>(row: &mut [f64; MAX], factor: f64, other: &[f64; MAX]) {
    let mut column = 0;
    while column < MAX {
        row[column] -= factor * other[column];
        column += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::samples::Random;
    use crate::element::{FacetShape, Shape};

    fn check<const D: usize, const MAX: usize>(element: &Interpolation<D, MAX>, random: &mut Random) {
        let n = element.nodes().len();
        for (a, &node) in element.nodes().iter().enumerate() {
            let shape = element.shape(node);
            assert!((0..n).all(|b| (shape[b] - if a == b { 1.0 } else { 0.0 }).abs() < 1e-14));
            assert!(shape[n..].iter().all(|&value| value == 0.0));
        }
        let h = 0.01; // central differences are exact for powers up to 2
        for _ in 0..20 {
            let at: [f64; D] = std::array::from_fn(|_| random.signed());
            assert!((element.shape(at).iter().sum::<f64>() - 1.0).abs() < 1e-13);
            let gradients = element.gradients(at);
            for k in 0..D {
                let moved = |step: f64| std::array::from_fn(|i| at[i] + if i == k { step } else { 0.0 });
                let (ahead, behind) = (element.shape(moved(h)), element.shape(moved(-h)));
                assert!((0..n).all(|a| ((ahead[a] - behind[a]) / (2.0 * h) - gradients[a][k]).abs() < 1e-11));
                // x_k itself is interpolated exactly, so geometry and linear fields are
                let x: f64 = element.shape(at).iter().zip(element.nodes()).map(|(n, x)| n * x[k]).sum();
                assert!((x - at[k]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn shape_functions_interpolate_and_their_gradients_are_their_differences() {
        let mut random = Random::seeded(1);
        Shape::ALL.iter().for_each(|shape| check(shape.interpolation(), &mut random));
        FacetShape::ALL.iter().for_each(|shape| check(shape.interpolation(), &mut random));
    }

    #[test]
    fn monomials_and_coefficients_make_the_shape_functions_and_second_derivatives() {
        let facet = FacetShape::Quadrilateral8.interpolation();
        let (at, h) = ([0.3, -0.4], 1e-3);
        let combine = |order| {
            let mut sum = [0.0; 8];
            for (value, row) in facet.monomials(at, order).zip(facet.coefficients()) {
                (0..8).for_each(|a| sum[a] += value * row[a]);
            }
            sum
        };
        assert_eq!(combine([0, 0]), facet.shape(at));
        let (ahead, behind) = (facet.gradients([at[0] + h, at[1]]), facet.gradients([at[0] - h, at[1]]));
        for a in 0..8 {
            assert!(((ahead[a][0] - behind[a][0]) / (2.0 * h) - combine([2, 0])[a]).abs() < 1e-11);
            assert!(((ahead[a][1] - behind[a][1]) / (2.0 * h) - combine([1, 1])[a]).abs() < 1e-11);
        }
    }
}
