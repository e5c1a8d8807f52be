//! A shape's tables at the points of its rules, and what is computed with them.

use super::recovery::{strain, stress};
use super::{ConvectiveInertia, MassProperties};
use crate::algebra::{cofactor_columns, dot};
use crate::element::MAX_NODES;
use crate::element::interpolation::Interpolation;
use crate::element::quadrature::QuadraturePoint;

/// Weights, shape functions and reference gradients at `Q` points of an element with `N` nodes.
pub struct Table<const N: usize, const Q: usize> {
    pub(super) weights: [f64; Q],
    pub(super) shapes: [[f64; N]; Q],
    pub(super) gradients: [[[f64; 3]; N]; Q],
}

impl<const N: usize, const Q: usize> Table<N, Q> {
    /// At the points of a rule; made at compile time.
    const fn new(interpolation: &Interpolation<3, MAX_NODES>, rule: &[QuadraturePoint<3>; Q]) -> Self {
        let mut table = Table { weights: [0.0; Q], shapes: [[0.0; N]; Q], gradients: [[[0.0; 3]; N]; Q] };
        let mut q = 0;
        while q < Q {
            table.weights[q] = rule[q].weight;
            let (shapes, gradients) = (interpolation.shape(rule[q].at), interpolation.gradients(rule[q].at));
            let mut a = 0;
            while a < N {
                table.shapes[q][a] = shapes[a];
                table.gradients[q][a] = gradients[a];
                a += 1;
            }
            q += 1;
        }
        table
    }

    /// `w detJ` at point `q`.
    #[inline]
    pub(super) fn weighted_det(&self, x: &[[f64; 3]; N], q: usize) -> f64 {
        self.weights[q] * cofactor_columns(&jacobian(x, &self.gradients[q])).1
    }
}

/// `N` nodes and `M = 3N` dofs, `Q` points for the stiffness and `P` points for the mass.
pub struct Family<const N: usize, const M: usize, const Q: usize, const P: usize> {
    pub(super) stiffness: Table<N, Q>,
    pub(super) mass: Table<N, P>,
    at_nodes: Table<N, N>,
}

impl<const N: usize, const M: usize, const Q: usize, const P: usize> Family<N, M, Q, P> {
    pub(super) const fn new(
        interpolation: &Interpolation<3, MAX_NODES>,
        stiffness: &[QuadraturePoint<3>; Q],
        mass: &[QuadraturePoint<3>; P],
    ) -> Self {
        assert!(M == 3 * N);
        let mut nodes = [QuadraturePoint { at: [0.0; 3], weight: 0.0 }; N];
        let mut a = 0;
        while a < N {
            nodes[a].at = interpolation.node(a);
            a += 1;
        }
        Family {
            stiffness: Table::new(interpolation, stiffness),
            mass: Table::new(interpolation, mass),
            at_nodes: Table::new(interpolation, &nodes),
        }
    }
}

/// The positions of a family's nodes.
#[inline]
pub fn positions<const N: usize>(x: &[[f64; 3]]) -> &[[f64; 3]; N] {
    x.try_into().expect("one position a node")
}

/// What any family computes; the functions of the parent module say what each is.
impl<const N: usize, const M: usize, const Q: usize, const P: usize> Family<N, M, Q, P> {
    #[inline]
    pub(super) fn stiffness(&self, x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], k: &mut [f64]) {
        super::stiffness::integrate::<N, M, Q>(positions(x), elasticity, &self.stiffness, k);
    }

    pub(super) fn geometric(&self, x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], u: &[[f64; 3]]) -> [[f64; N]; N] {
        let u = positions::<N>(u);
        self.stiffness.geometric(positions(x), |gradients| stress(elasticity, &strain(u, gradients)))
    }

    pub(super) fn convective_inertia(
        &self,
        x: &[[f64; 3]],
        density: f64,
        flow: impl Fn([f64; 3]) -> [f64; 3],
    ) -> ConvectiveInertia {
        self.mass.convective_inertia(positions(x), density, flow)
    }

    #[inline]
    pub(super) fn scalar_mass(&self, x: &[[f64; 3]], density: f64, m: &mut [f64]) {
        self.mass.scalar_mass(positions(x), density, m);
    }

    pub(super) fn volume(&self, x: &[[f64; 3]]) -> f64 {
        let x = positions(x);
        (0..P).map(|q| self.mass.weighted_det(x, q)).sum()
    }

    pub(super) fn mass_properties(&self, x: &[[f64; 3]], density: f64) -> MassProperties {
        self.mass.mass_properties(positions(x), density)
    }

    pub(super) fn mean_strain(&self, x: &[[f64; 3]], u: &[[f64; 3]]) -> [f64; 6] {
        self.stiffness.mean_strain(positions(x), positions(u))
    }

    /// The least `detJ` over the nodes and the points of the stiffness rule; NaN where one is.
    pub(super) fn smallest_determinant(&self, x: &[[f64; 3]]) -> f64 {
        let x = positions::<N>(x);
        let gradients = self.at_nodes.gradients.iter().chain(&self.stiffness.gradients);
        let determinants = gradients.map(|gradients| cofactor_columns(&jacobian(x, gradients)).1);
        determinants.fold(f64::INFINITY, |least, det| if det < least || det.is_nan() { det } else { least })
    }
}

/// Jacobian `J_ik = d x_i / d xi_k = sum_a x_a,i dN_a/dxi_k` from the reference gradients at a point.
#[inline]
pub fn jacobian<const N: usize>(x: &[[f64; 3]; N], gradients: &[[f64; 3]; N]) -> [[f64; 3]; 3] {
    let mut j = [[0.0; 3]; 3];
    for a in 0..N {
        for i in 0..3 {
            for k in 0..3 {
                j[i][k] += x[a][i] * gradients[a][k];
            }
        }
    }
    j
}

/// Gradients `dN_a/dx_i` and `detJ`, from the reference gradients at a point.
///
/// `dN_a/dx = J^-T dN_a/dxi = sum_k (column k of cof J) dN_a/dxi_k / detJ`
#[inline]
pub fn physical_gradients<const N: usize>(x: &[[f64; 3]; N], reference: &[[f64; 3]; N]) -> ([[f64; 3]; N], f64) {
    let (inverse, det) = inverse_transposed(&jacobian(x, reference));
    (reference.map(|g| inverse.map(|row| dot(row, g))), det)
}

/// `J^-T` and `detJ`.
#[inline]
pub fn inverse_transposed(jacobian: &[[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    let (cofactors, det) = cofactor_columns(jacobian);
    let inverse_det = 1.0 / det;
    // row i: the i-th components of the cofactor columns over detJ
    (std::array::from_fn(|i| std::array::from_fn(|k| cofactors[k][i] * inverse_det)), det)
}
