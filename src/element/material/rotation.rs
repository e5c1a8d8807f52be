//! Frames, and the rotation of an elasticity between them (Bond's matrix).
//!
//! ```text
//!   stress_global = Q stress_local Q^T     with the local axes as columns of Q
//!   in Voigt form:  s_global = M s_local,  e_local = M^T e_global  (energy is the same)
//!   D_global = M D_local M^T
//! ```
//!
//! `M` is Bond's stress matrix, in our Voigt order: with pairs (i, k) of row I and (m, n) of column J,
//! `M_IJ = Q_im Q_kn` for a normal column (m = n) and `Q_im Q_kn + Q_in Q_km` for a shear column.
//! Source: Auld, *Acoustic Fields and Waves in Solids* I (1973), section 3.D (there in the order yz zx xy).

use crate::element::algebra::{cross, dot, norm, scale, sub};

/// The pair of axes of each Voigt index.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// An elasticity given in the frame `axes`, in global axes.
///
/// The rows of `axes` are the local x, y, z as orthonormal vectors in global coordinates. `D_global = M D_local M^T`;
/// the upper triangle is computed and mirrored, so the result is exactly symmetric.
pub fn rotate(elasticity: &[[f64; 6]; 6], axes: &[[f64; 3]; 3]) -> [[f64; 6]; 6] {
    let bond = bond(axes);
    let half: [[f64; 6]; 6] = bond.map(|row| std::array::from_fn(|j| (0..6).map(|k| row[k] * elasticity[k][j]).sum()));
    let mut rotated = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in i..6 {
            rotated[i][j] = (0..6).map(|k| half[i][k] * bond[j][k]).sum();
            rotated[j][i] = rotated[i][j];
        }
    }
    rotated
}

/// Bond's matrix `M` for stress, from the frame with the local axes as rows (`Q_im = axes[m][i]`).
fn bond(axes: &[[f64; 3]; 3]) -> [[f64; 6]; 6] {
    let q = |i: usize, m: usize| axes[m][i];
    PAIRS.map(|(i, k)| {
        PAIRS.map(|(m, n)| if m == n { q(i, m) * q(k, m) } else { q(i, m) * q(k, n) + q(i, n) * q(k, m) })
    })
}

/// An orthonormal right-handed frame (rows x, y, z) whose z is along `axis`, of any length but zero.
///
/// Its x and y are some directions of the plane: for laws that do not distinguish them. A zero axis gives NaN.
pub fn frame_about(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let z = scale(1.0 / norm(axis), axis);
    // The coordinate direction least along z is never parallel to it.
    let least = (0..3).min_by(|&i, &j| z[i].abs().total_cmp(&z[j].abs())).unwrap_or(0);
    let mut helper = [0.0; 3];
    helper[least] = 1.0;
    let across = cross(helper, z);
    let x = scale(1.0 / norm(across), across);
    [x, cross(z, x), z]
}

/// An orthonormal right-handed frame (rows x, y, z): x along `first`, y in the plane of `first` and `second`.
///
/// None when the two are parallel (sine below 1e-10), zero or not finite.
pub fn frame(first: [f64; 3], second: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let x = scale(1.0 / norm(first), first);
    let toward = scale(1.0 / norm(second), second);
    let rest = sub(toward, scale(dot(toward, x), x));
    let sine = norm(rest);
    // written so that a NaN fails
    (sine > 1e-10).then(|| {
        let y = scale(1.0 / sine, rest);
        [x, y, cross(x, y)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::samples::{Random, triclinic};

    /// Voigt index of a pair.
    const VOIGT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

    /// `C_ijkl = Q_ip Q_jq Q_kr Q_ls C'_pqrs`, the definition.
    fn rotated_tensor(d: &[[f64; 6]; 6], axes: &[[f64; 3]; 3], ij: (usize, usize), kl: (usize, usize)) -> f64 {
        let q = |i: usize, m: usize| axes[m][i];
        let mut sum = 0.0;
        for p in 0..81 {
            let (p, r, s, t) = (p / 27, p / 9 % 3, p / 3 % 3, p % 3);
            sum += q(ij.0, p) * q(ij.1, r) * q(kl.0, s) * q(kl.1, t) * d[VOIGT[p][r]][VOIGT[s][t]];
        }
        sum
    }

    #[test]
    fn rotation_is_that_of_the_fourth_order_tensor() {
        let mut random = Random::seeded(45);
        for _ in 0..10 {
            let (d, axes) = (triclinic(&mut random), frame(random.vector(), random.vector()).unwrap());
            let rotated = rotate(&d, &axes);
            for (i, &ij) in PAIRS.iter().enumerate() {
                for (j, &kl) in PAIRS.iter().enumerate() {
                    assert!((rotated[i][j] - rotated_tensor(&d, &axes, ij, kl)).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn rotation_there_and_back_is_the_identity() {
        let mut random = Random::seeded(46);
        let (d, axes) = (triclinic(&mut random), frame(random.vector(), random.vector()).unwrap());
        let transposed = std::array::from_fn(|i| std::array::from_fn(|j| axes[j][i]));
        let back = rotate(&rotate(&d, &axes), &transposed);
        for i in 0..6 {
            for j in 0..6 {
                assert!((back[i][j] - d[i][j]).abs() < 1e-13);
            }
        }
    }

    fn assert_right_handed(axes: &[[f64; 3]; 3]) {
        for i in 0..3 {
            for j in 0..3 {
                assert!((dot(axes[i], axes[j]) - if i == j { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
        }
        assert!(dot(cross(axes[0], axes[1]), axes[2]) > 0.0);
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let mut random = Random::seeded(47);
        for _ in 0..50 {
            let (a, b) = (random.vector(), random.vector());
            let about = frame_about(a);
            assert_right_handed(&about);
            assert!((dot(about[2], a) - norm(a)).abs() < 1e-14);
            let pair = frame(a, b).unwrap();
            assert_right_handed(&pair);
            assert!(dot(pair[0], a) > 0.0 && dot(pair[1], b) > 0.0 && dot(pair[2], b).abs() < 1e-14);
        }
        for axis in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]] {
            assert_right_handed(&frame_about(axis));
        }
    }

    #[test]
    fn parallel_or_zero_directions_make_no_frame() {
        assert_eq!(frame([1.0, 2.0, 3.0], [-2.0, -4.0, -6.0]), None);
        assert_eq!(frame([0.0; 3], [1.0, 0.0, 0.0]), None);
        assert_eq!(frame([1.0, 0.0, 0.0], [0.0; 3]), None);
    }
}
