//! The modes of one value, ready to be compared with others.

use nalgebra::{DMatrix, Dyn, LU};
use num_complex::Complex64;

use super::Family;
use crate::{Error, Result};

/// A solved value.
pub struct Node<M> {
    pub value: f64,
    pub modes: M,
    pub lambdas: Vec<Complex64>,
    /// `G_aa`, left against right vectors of this value.
    own: DMatrix<Complex64>,
    factor: LU<Complex64, Dyn, Dyn>,
}

/// Below this fraction of `2 |lambda|` a self-product is rounding.
const DEFECTIVE: f64 = 1e-6;

impl<M> Node<M> {
    /// Solves at a value.
    pub fn solve<F: Family<Modes = M>>(family: &mut F, value: f64) -> Result<Node<M>> {
        let modes = family.solve(value)?;
        let lambdas = family.eigenvalues(&modes).to_vec();
        let own = family.products(&modes, &modes)?;
        let factor = own.clone().lu();
        Ok(Node { value, modes, lambdas, own, factor })
    }

    /// Whether two modes have become one vector, so that the modes of this value do not span what they should: the
    /// least singular value of `G_ij / (2 sqrt|lambda_i lambda_j|)` is zero.
    pub fn is_defective(&self) -> bool {
        let scale = |i: usize| (2.0 * self.lambdas[i].norm()).max(self.own[(i, i)].norm()).sqrt();
        let n = self.lambdas.len();
        if n == 0 {
            return false;
        }
        let scaled = DMatrix::from_fn(n, n, |i, j| self.own[(i, j)] / (scale(i) * scale(j)));
        scaled.iter().any(|z| !z.is_finite()) || scaled.singular_values().iter().any(|&sigma| sigma < DEFECTIVE)
    }

    /// `T = G_aa^-1 G_ab`: right vectors of another value in the basis of this one's.
    pub fn coordinates_of<F: Family<Modes = M>>(&self, other: &Node<M>, family: &mut F) -> Result<DMatrix<Complex64>> {
        let products = family.products(&self.modes, &other.modes)?;
        if products.is_empty() {
            return Ok(products);
        }
        self.factor.solve(&products).ok_or_else(|| {
            Error::not_converged(format!(
                "the modes at {} cannot be told apart: left and right vectors of one of them are orthogonal",
                self.value
            ))
        })
    }
}
