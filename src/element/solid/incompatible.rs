//! C3D8I: the 8-node hexahedron with incompatible modes.
//!
//! Three modes `1 - xi_k^2` with three amplitudes each let the element bend without shear. They end at the element, so
//! their amplitudes `a` are eliminated:
//!
//! ```text
//!   u = sum_a N_a u_a + sum_k (1 - xi_k^2) a_k
//!   grad (1 - xi_k^2) = (detJ_0/detJ) J_0^-T (-2 xi_k e_k)        _0: at the centre
//!   [K_uu K_ua; K_au K_aa]  -->  K = K_uu - K_ua K_aa^-1 K_au
//! ```
//!
//! The factor `detJ_0/detJ` and the Jacobian at the centre make the modes' mean strain vanish on any hexahedron, and
//! with it the patch test is passed: Taylor, Beresford and Wilson, *A non-conforming element for stress analysis*,
//! IJNME 10 (1976), 1211. The modes have no mass, as in Abaqus; CalculiX keeps them as dofs with mass, and up to
//! version 2.22 leaves the factor out.

use super::HEXAHEDRON_8_NODES;
use super::geometric::sum_geometric;
use super::recovery::{strain, stress};
use super::stiffness::sum_products;
use super::table::{inverse_transposed, jacobian, physical_gradients, positions};
use crate::element::quadrature::HEXAHEDRON_8;
use crate::element::shape;
use nalgebra::{SMatrix, SVector};

/// Nodes and modes.
const N: usize = 11;
/// Their dofs.
const M: usize = 33;

/// As [`super::stiffness`].
pub fn stiffness(x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], k: &mut [f64]) {
    eliminate(&full_stiffness(elasticity, &points(positions(x))), k);
}

/// As [`super::geometric_stiffness`]: with the amplitudes `a = -K_aa^-1 K_au u` in the displacements, and
/// `T^T K_g T`, `T = [I; -K_aa^-1 K_au]`, which is what eliminating `a` from `K + K_g` leaves to the first order in the
/// stress.
pub fn geometric_stiffness(x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], u: &[[f64; 3]], k: &mut [f64]) {
    let points = points(positions(x));
    let full = SMatrix::<f64, M, M>::from_column_slice(&full_stiffness(elasticity, &points));
    let (au, aa) = (full.fixed_view::<9, 24>(24, 0), full.fixed_view::<9, 9>(24, 24).into_owned());
    let modes = -aa.lu().solve(&au).unwrap_or_else(|| SMatrix::repeat(f64::NAN));
    let nodal = SVector::<f64, 24>::from_column_slice(u.as_flattened());
    let amplitudes = modes * nodal;
    let all: [[f64; 3]; N] = std::array::from_fn(|a| match a {
        0..8 => u[a],
        _ => std::array::from_fn(|i| amplitudes[3 * (a - 8) + i]),
    });
    let stresses = points.gradients.map(|gradients| stress(elasticity, &strain(&all, &gradients)));
    let scalar = sum_geometric(&points.gradients, &points.factors, &stresses);
    let kg = SMatrix::<f64, M, M>::from_fn(|r, c| if r % 3 == c % 3 { scalar[r / 3][c / 3] } else { 0.0 });
    let mut t = SMatrix::<f64, M, 24>::zeros();
    t.fixed_view_mut::<24, 24>(0, 0).fill_with_identity();
    t.fixed_view_mut::<9, 24>(24, 0).copy_from(&modes);
    k.copy_from_slice((t.transpose() * kg * t).as_slice());
}

/// The points of the rule with the gradients of nodes and modes, and `w detJ`.
struct Points {
    gradients: [[[f64; 3]; N]; 8],
    factors: [f64; 8],
}

fn points(x: &[[f64; 3]; 8]) -> Points {
    let table = &HEXAHEDRON_8_NODES.stiffness;
    let centre = shape::HEXAHEDRON_8.gradients([0.0; 3]);
    let (inverse, det_centre) = inverse_transposed(&jacobian(x, centre.first_chunk().expect("eight nodes")));
    let (mut gradients, mut factors) = ([[[0.0; 3]; N]; 8], [0.0; 8]);
    for (q, point) in HEXAHEDRON_8.iter().enumerate() {
        let (physical, det) = physical_gradients(x, &table.gradients[q]);
        gradients[q][..8].copy_from_slice(&physical);
        for k in 0..3 {
            // (detJ_0/detJ) J_0^-T (-2 xi_k e_k)
            let factor = -2.0 * point.at[k] * det_centre / det;
            gradients[q][8 + k] = inverse.map(|row| factor * row[k]);
        }
        factors[q] = point.weight * det;
    }
    Points { gradients, factors }
}

/// `K` of nodes and modes.
fn full_stiffness(elasticity: &[[f64; 6]; 6], points: &Points) -> [f64; M * M] {
    let mut full = [0.0; M * M];
    sum_products::<N, M, 8>(elasticity, &points.gradients, &points.factors, &mut full);
    full
}

/// `K = K_uu - K_ua K_aa^-1 K_au`, symmetric to the last bit.
fn eliminate(full: &[f64; M * M], k: &mut [f64]) {
    let full = SMatrix::<f64, M, M>::from_column_slice(full);
    let (uu, ua, aa) =
        (full.fixed_view::<24, 24>(0, 0), full.fixed_view::<24, 9>(0, 24), full.fixed_view::<9, 9>(24, 24));
    // K_aa is positive definite wherever detJ > 0; elsewhere the result is no stiffness, as for any inverted element.
    let solved = aa.into_owned().lu().solve(&ua.transpose()).unwrap_or_else(|| SMatrix::repeat(f64::NAN));
    let condensed = uu - ua * solved;
    for row in 0..24 {
        for column in 0..24 {
            k[24 * row + column] = condensed[(row.min(column), row.max(column))];
        }
    }
}
