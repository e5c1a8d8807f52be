//! C3D8R: the 8-node hexahedron of mean strain, with hourglass stiffness.
//!
//! ```text
//!   b_a = 1/V integral of grad N_a dV                    mean gradients
//!   K   = V B^T D B + kappa sum_h gamma_h gamma_h^T      the second for each axis
//!   gamma_h,a = Gamma_h,a - sum_i b_a,i sum_c x_c,i Gamma_h,c         Gamma_h: the four hourglass patterns
//!   kappa     = 0.005 E V sum_a b_a . b_a
//! ```
//!
//! The mean strain alone leaves twelve hourglass modes without stiffness. The vectors `gamma_h` are orthogonal to all
//! linear fields, so that the patch test is passed: Flanagan and Belytschko, *A uniform strain hexahedron and
//! quadrilateral with orthogonal hourglass control*, IJNME 17 (1981), 679, equations 16 and 49 and the stiffness form
//! of section 5. The factor 0.005 is Abaqus's, and CalculiX's from version 2.23 on; before, it has a tenth of this, and
//! vectors that are orthogonal on parallelepipeds alone. E is Young's modulus of the isotropic material nearest to D
//! (Voigt's mean), so that the element does not depend on the axes.

use super::HEXAHEDRON_8_NODES;
use super::recovery::{strain, stress};
use super::stiffness::sum_products;
use super::table::{physical_gradients, positions};

/// Hourglass stiffness over `E V sum b.b`.
const HOURGLASS: f64 = 0.005;

/// The patterns xi eta, eta zeta, zeta xi and xi eta zeta at the nodes.
const PATTERNS: [[f64; 8]; 4] = [
    [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0, -1.0, -1.0, -1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0],
];

/// As [`super::stiffness`].
pub fn stiffness(x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], k: &mut [f64]) {
    let x = positions::<8>(x);
    let (mean, volume) = mean_gradients(x);
    sum_products::<8, 24, 1>(elasticity, &[mean], &[volume], k);
    let squares: f64 = mean.iter().flatten().map(|b| b * b).sum();
    let kappa = HOURGLASS * young(elasticity) * volume * squares;
    let gamma = PATTERNS.map(|pattern| orthogonal(&pattern, x, &mean));
    for a in 0..8 {
        for b in 0..8 {
            let entry: f64 = gamma.iter().map(|gamma| gamma[a] * gamma[b]).sum();
            (0..3).for_each(|i| k[24 * (3 * a + i) + 3 * b + i] += kappa * entry);
        }
    }
}

/// As [`super::geometric_stiffness`]: the stress of the mean strain at 2 x 2 x 2 points.
pub fn geometric_stiffness(x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], u: &[[f64; 3]]) -> [[f64; 8]; 8] {
    let x = positions::<8>(x);
    let stress = stress(elasticity, &strain(positions::<8>(u), &mean_gradients(x).0));
    HEXAHEDRON_8_NODES.stiffness.geometric(x, |_| stress)
}

/// `b_a` (1/m) and the volume (m3); 2 x 2 x 2 points integrate both exactly.
fn mean_gradients(x: &[[f64; 3]; 8]) -> ([[f64; 3]; 8], f64) {
    let table = &HEXAHEDRON_8_NODES.stiffness;
    let (mut sum, mut volume) = ([[0.0; 3]; 8], 0.0);
    for (reference, weight) in table.gradients.iter().zip(table.weights) {
        let (gradients, det) = physical_gradients(x, reference);
        volume += weight * det;
        for a in 0..8 {
            (0..3).for_each(|i| sum[a][i] += weight * det * gradients[a][i]);
        }
    }
    (sum.map(|row| row.map(|value| value / volume)), volume)
}

/// `gamma_a = Gamma_a - sum_i b_a,i sum_c x_c,i Gamma_c`.
fn orthogonal(pattern: &[f64; 8], x: &[[f64; 3]; 8], mean: &[[f64; 3]; 8]) -> [f64; 8] {
    let moments: [f64; 3] = std::array::from_fn(|i| (0..8).map(|c| x[c][i] * pattern[c]).sum());
    std::array::from_fn(|a| pattern[a] - (0..3).map(|i| mean[a][i] * moments[i]).sum::<f64>())
}

/// Young's modulus of Voigt's mean: `E = 9 K G / (3 K + G)` with the means `K` and `G` of the bulk and shear moduli.
fn young(d: &[[f64; 6]; 6]) -> f64 {
    let (along, across) = (d[0][0] + d[1][1] + d[2][2], d[0][1] + d[1][2] + d[0][2]);
    let bulk = (along + 2.0 * across) / 9.0;
    let shear = (along - across + 3.0 * (d[3][3] + d[4][4] + d[5][5])) / 15.0;
    9.0 * bulk * shear / (3.0 * bulk + shear)
}
