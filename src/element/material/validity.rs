//! Whether an elasticity is one: symmetric and positive definite.

/// Why a 6x6 matrix is not the elasticity of a stable material. Indices are Voigt rows and columns, from 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// An entry is infinite or not a number.
    #[error("elasticity entry ({}, {}) is not a finite number: check the constants and axes", NAMES[*row], NAMES[*column])]
    NotFinite {
        /// Row.
        row: usize,
        /// Column.
        column: usize,
    },
    /// An entry differs from its mirror image by more than 1e-9 of the diagonal.
    #[error("elasticity is not symmetric: entry ({}, {}) differs from its mirror image", NAMES[*row], NAMES[*column])]
    NotSymmetric {
        /// Row.
        row: usize,
        /// Column.
        column: usize,
    },
    /// Some strain would have no or negative energy: the Cholesky factorisation stops at this row.
    #[error(
        "elasticity is not positive definite (row {}): a modulus is not positive or a Poisson ratio is outside its bounds",
        NAMES[*row]
    )]
    NotPositiveDefinite {
        /// Row at which the factorisation stops.
        row: usize,
    },
}

const NAMES: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Smallest pivot, relative to its diagonal entry, that counts as positive; and the largest asymmetry that is round-off.
const PIVOT: f64 = 1e-12;
const ASYMMETRY: f64 = 1e-9;

/// Checks that an elasticity is finite, symmetric and positive definite.
///
/// # Errors
/// [`MaterialError`] with the offending row; asymmetry and pivots are judged relative to the diagonal, so units do not
/// matter.
pub fn check(elasticity: &[[f64; 6]; 6]) -> Result<(), MaterialError> {
    let d = elasticity;
    for row in 0..6 {
        for column in 0..6 {
            if !d[row][column].is_finite() {
                return Err(MaterialError::NotFinite { row, column });
            }
        }
    }
    for row in 0..6 {
        for column in 0..row {
            let scale = d[row][row].abs().max(d[column][column].abs());
            if (d[row][column] - d[column][row]).abs() > ASYMMETRY * scale {
                return Err(MaterialError::NotSymmetric { row: column, column: row });
            }
        }
    }
    cholesky(d)
}

/// `D = L L^T` row by row; an error where a pivot `D_ii - sum L_ik^2` is not positive.
fn cholesky(d: &[[f64; 6]; 6]) -> Result<(), MaterialError> {
    let mut l = [[0.0; 6]; 6];
    for row in 0..6 {
        for column in 0..row {
            let sum: f64 = (0..column).map(|k| l[row][k] * l[column][k]).sum();
            l[row][column] = (d[row][column] - sum) / l[column][column];
        }
        let pivot = d[row][row] - l[row][..row].iter().map(|entry| entry * entry).sum::<f64>();
        // written so that a NaN fails
        let positive = pivot > PIVOT * d[row][row].abs();
        if !positive {
            return Err(MaterialError::NotPositiveDefinite { row });
        }
        l[row][row] = pivot.sqrt();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::material::isotropic;
    use crate::element::samples::{Random, triclinic};
    use nalgebra::Matrix6;

    #[test]
    fn verdict_agrees_with_the_smallest_eigenvalue() {
        let mut random = Random::seeded(48);
        for _ in 0..200 {
            let mut d = triclinic(&mut random);
            let shift = 3.0 * random.unit();
            (0..6).for_each(|i| d[i][i] -= shift);
            let smallest = Matrix6::from_fn(|i, j| d[i][j]).symmetric_eigenvalues().min();
            assert_eq!(check(&d).is_ok(), smallest > 0.0, "smallest eigenvalue {smallest}");
        }
    }

    #[test]
    fn asymmetry_and_missing_numbers_are_named() {
        let mut d = isotropic(1.0, 0.3);
        d[0][1] += 1e-6;
        assert_eq!(check(&d), Err(MaterialError::NotSymmetric { row: 0, column: 1 }));
        d[4][2] = f64::NAN;
        let error = check(&d).unwrap_err();
        assert_eq!(error, MaterialError::NotFinite { row: 4, column: 2 });
        assert!(error.to_string().contains("(yz, zz)"));
    }

    #[test]
    fn units_do_not_matter() {
        for young in [1e-3, 1.0, 1e12] {
            check(&isotropic(young, 0.499)).unwrap();
        }
    }
}
