//! Left vectors of the modes: `y^H P(lambda) = 0`.
//!
//! With `v = conj(y)` that is `P(lambda)^T v = 0`, the transposed problem at an eigenvalue that is known. Friction alone makes
//! K differ from its transpose, so the right vectors are a start. What is missing is outside their span and comes from
//! corrections `d = A^-T P(lambda)^T v` with the factor that the right vectors have used, `A = P(shift)`: of a component of the k-th mode of
//! the transposed problem about `1 - (lambda / lambda_k)^2` is in d. All corrections extend one common space, in which the
//! vectors are sought anew; what two corrections have in common, and what is small against the largest, is left out.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use num_complex::Complex64;

use super::{Mode, Pencil};
use crate::petsc::{Block, Factor, Matrix, dense};
use crate::{Error, Result};

/// A vector is accepted where its correction is this small, relative, in the norm of M.
const ACCURACY: f64 = 1e-8;
/// Rounds of corrections at most.
const ROUNDS: usize = 25;
/// Directions smaller than this against the round's largest wait for a later round.
const SIGNIFICANT: f64 = 0.03;
/// Directions that M-orthogonalisation leaves so little of are rounding.
const INDEPENDENT: f64 = 1e-10;

/// Left vectors of `modes`, columns `2i` and `2i + 1` the real and imaginary part of mode i, `y^H M y = 1`. `factor` is that
/// of the pencil at a real shift. Gives the number of solves, too. Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] where a vector does not come to its accuracy.
pub fn left_vectors(pencil: &Pencil, factor: &Factor, modes: &[Mode]) -> Result<(Block, usize)> {
    let lambdas: Vec<Complex64> = modes.iter().map(|mode| mode.lambda).collect();
    let start = right_vectors(pencil.m, modes)?;
    if modes.is_empty() {
        return Ok((start, 0));
    }
    let mut space = Space::new(pencil);
    space.extend(start.clone(), INDEPENDENT)?;
    let mut v = space.coordinates(&start)?;
    let (mut n_solves, mut open) = (0, (0..modes.len()).collect::<Vec<usize>>());
    for _ in 0..ROUNDS {
        v = space.solve(&lambdas, &v);
        let corrections = space.residuals(&lambdas, &v, &open).solved_by_transpose(factor)?;
        n_solves += corrections.n_columns();
        let sizes = sizes(pencil.m, &corrections)?;
        let missed: Vec<usize> = (0..open.len()).filter(|&place| sizes[place] > ACCURACY).collect();
        if missed.is_empty() {
            return Ok((conjugated(space.basis.combined(v.as_slice(), v.ncols())), n_solves));
        }
        open = missed.iter().map(|&place| open[place]).collect();
        space.extend(corrections, SIGNIFICANT)?;
    }
    Err(Error::NotConverged(format!(
        "left vectors of the modes: after {ROUNDS} rounds of corrections {} of {} are not accurate. A narrower band may help \
         ([stability] band)",
        open.len(),
        modes.len()
    )))
}

/// Right vectors in the same form, `x^H M x = 1`. Collective.
///
/// # Errors
/// PETSc's.
pub fn right_vectors(m: &Matrix, modes: &[Mode]) -> Result<Block> {
    let mut block = Block::zeros(m.comm(), m.n_local(), 2 * modes.len());
    for (j, part) in modes.iter().flat_map(|mode| [&mode.re, &mode.im]).enumerate() {
        part.local(|values| block.column_mut(j).copy_from_slice(values))?;
    }
    let sizes = sizes(m, &block)?;
    for (j, size) in sizes.into_iter().flat_map(|size| [size, size]).enumerate() {
        block.column_mut(j).iter_mut().for_each(|x| *x /= size);
    }
    Ok(block)
}

/// `sqrt(d^H M d)` of complex columns.
fn sizes(m: &Matrix, columns: &Block) -> Result<Vec<f64>> {
    let product = columns.multiplied_by(m)?;
    let square = |j: usize| columns.column(j).iter().zip(product.column(j)).map(|(a, b)| a * b).sum();
    let mut squares: Vec<f64> = (0..columns.n_columns()).map(square).collect();
    m.comm().sum_all(&mut squares);
    Ok(squares.chunks(2).map(|pair| pair.iter().sum::<f64>().max(0.0).sqrt()).collect())
}

/// Turns the sign of the imaginary parts.
fn conjugated(mut block: Block) -> Block {
    for j in (1..block.n_columns()).step_by(2) {
        block.column_mut(j).iter_mut().for_each(|x| *x = -*x);
    }
    block
}

/// A real M-orthonormal basis with the transposed problem projected on it.
struct Space<'a> {
    pencil: &'a Pencil<'a>,
    basis: Block,
    /// `M V`, `C V`, `K^T V`.
    products: [Block; 3],
    /// `V^T` times them.
    projected: [DMatrix<f64>; 3],
}

fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> DMatrix<f64> {
    DMatrix::from_vec(rows, columns, values)
}

impl<'a> Space<'a> {
    fn new(pencil: &'a Pencil<'a>) -> Space<'a> {
        let none = Block::zeros(pencil.k.comm(), pencil.k.n_local(), 0);
        let empty = DMatrix::zeros(0, 0);
        let products = [none.clone(), none.clone(), none.clone()];
        Space { pencil, basis: none, products, projected: [empty.clone(), empty.clone(), empty] }
    }

    /// Adds what is new in some columns, in directions whose size is more than `least` of the largest.
    fn extend(&mut self, columns: Block, least: f64) -> Result<()> {
        let new = self.orthonormalised(columns, least)?;
        let pencil = self.pencil;
        let products =
            [new.multiplied_by(pencil.m)?, new.multiplied_by(pencil.c)?, new.multiplied_by_transpose(pencil.k)?];
        let (n, k) = (self.basis.n_columns(), new.n_columns());
        for (i, product) in products.iter().enumerate() {
            let mut grown = DMatrix::zeros(n + k, n + k);
            grown.view_mut((0, 0), (n, n)).copy_from(&self.projected[i]);
            grown.view_mut((0, n), (n, k)).copy_from(&matrix(n, k, self.basis.gram(product)));
            grown.view_mut((n, 0), (k, n)).copy_from(&matrix(k, n, new.gram(&self.products[i])));
            grown.view_mut((n, n), (k, k)).copy_from(&matrix(k, k, new.gram(product)));
            self.projected[i] = grown;
            self.products[i].append(product);
        }
        self.basis.append(&new);
        Ok(())
    }

    /// An M-orthonormal basis of the new directions in some columns, twice over for rounding.
    fn orthonormalised(&self, mut columns: Block, least: f64) -> Result<Block> {
        for least in [least, INDEPENDENT] {
            let overlap = self.products[0].gram(&columns);
            columns.axpy(-1.0, &self.basis.combined(&overlap, columns.n_columns()));
            let n = columns.n_columns();
            let gram = columns.gram(&columns.multiplied_by(self.pencil.m)?);
            let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(matrix(n, n, gram));
            let largest = eigenvalues.max();
            let kept: Vec<usize> = (0..n).filter(|&i| eigenvalues[i] > least * least * largest).collect();
            // V <- V Q / sqrt(D)    with V^T M V = Q D Q^T
            let mut turn = eigenvectors.select_columns(&kept);
            turn.column_iter_mut().zip(&kept).for_each(|(mut q, &i)| q /= eigenvalues[i].sqrt());
            columns = columns.combined(turn.as_slice(), kept.len());
        }
        Ok(columns)
    }

    /// `V^T M columns`.
    fn coordinates(&self, columns: &Block) -> Result<DMatrix<f64>> {
        Ok(matrix(self.basis.n_columns(), columns.n_columns(), self.products[0].gram(columns)))
    }

    /// Null vectors of the projected `P(lambda_i)^T`, by inverse iteration from the vectors so far: so two vectors of one
    /// eigenvalue stay two.
    fn solve(&self, lambdas: &[Complex64], so_far: &DMatrix<f64>) -> DMatrix<f64> {
        let n = self.basis.n_columns();
        let mut v = DMatrix::zeros(n, 2 * lambdas.len());
        v.rows_mut(0, so_far.nrows()).copy_from(so_far);
        for (i, &lambda) in lambdas.iter().enumerate() {
            let mut matrix = DMatrix::from_element(n, n, Complex64::default());
            for (power, projected) in [lambda * lambda, lambda, 1.0.into()].into_iter().zip(&self.projected) {
                matrix.zip_apply(projected, |z, x| *z += power * x);
            }
            let mut x = DVector::from_fn(n, |row, _| Complex64::new(v[(row, 2 * i)], v[(row, 2 * i + 1)]));
            // Where lambda is an eigenvalue to the last digit, the vector so far is kept.
            let start = x.clone();
            if !dense::solve_complex(n, matrix.as_mut_slice(), x.as_mut_slice()) || !x.norm().is_normal() {
                x = start;
            }
            let x = x.normalize();
            v.set_column(2 * i, &x.map(|z| z.re));
            v.set_column(2 * i + 1, &x.map(|z| z.im));
        }
        v
    }

    /// `P(lambda_i)^T v_i` of the chosen modes, in real and imaginary parts.
    fn residuals(&self, lambdas: &[Complex64], v: &DMatrix<f64>, modes: &[usize]) -> Block {
        let n_columns = 2 * modes.len();
        let mut sum = Block::zeros(self.pencil.k.comm(), self.pencil.k.n_local(), n_columns);
        let powers: [fn(Complex64) -> Complex64; 3] = [|lambda| lambda * lambda, |lambda| lambda, |_| 1.0.into()];
        for (product, power) in self.products.iter().zip(powers) {
            let mut coefficients = DMatrix::zeros(v.nrows(), n_columns);
            for (place, &i) in modes.iter().enumerate() {
                for row in 0..v.nrows() {
                    let z = power(lambdas[i]) * Complex64::new(v[(row, 2 * i)], v[(row, 2 * i + 1)]);
                    (coefficients[(row, 2 * place)], coefficients[(row, 2 * place + 1)]) = (z.re, z.im);
                }
            }
            sum.axpy(1.0, &product.combined(coefficients.as_slice(), n_columns));
        }
        sum
    }
}
