//! Families with known branches, solved densely: what the tests of this module run on.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::{Family, Options};
use crate::Result;
use crate::model::InstabilityCriterion;
use crate::native::lapack::{Eigen, eigen};

pub type Real = DMatrix<f64>;

/// `lambda^2 M + lambda C(p) + K(p)`; all solutions are kept, or those within `window` (rad/s).
pub struct Model<F: FnMut(f64) -> [Real; 3]> {
    pub matrices: F,
    pub window: [f64; 2],
    /// The values solved.
    pub solved: Vec<f64>,
}

/// Modes with right and left vectors, a column each, and the matrices.
pub struct Modes {
    lambdas: Vec<Complex64>,
    right: DMatrix<Complex64>,
    left: DMatrix<Complex64>,
    mc: [DMatrix<Complex64>; 2],
}

impl<F: FnMut(f64) -> [Real; 3]> Model<F> {
    pub fn new(matrices: F) -> Model<F> {
        Model { matrices, window: [f64::NEG_INFINITY, f64::INFINITY], solved: Vec::new() }
    }
}

/// Undamped, unit mass, stiffness `k(p)` by rows.
pub fn undamped<const N: usize>(k: impl Fn(f64) -> [[f64; N]; N]) -> Model<impl FnMut(f64) -> [Real; 3]> {
    Model::new(move |p| [Real::identity(N, N), Real::zeros(N, N), rows(k(p))])
}

pub fn rows<const N: usize>(a: [[f64; N]; N]) -> Real {
    Real::from_row_slice(N, N, a.as_flattened())
}

/// `[0 I; -M^-1 K  -M^-1 C]`, whose vectors are `(x, lambda x)`.
fn companion(m: &Real, c: &Real, k: &Real) -> DMatrix<Complex64> {
    let n = m.nrows();
    let inverse = m.clone().try_inverse().unwrap();
    let mut a = Real::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n)).copy_from(&(-&inverse * k));
    a.view_mut((n, n), (n, n)).copy_from(&(-&inverse * c));
    a.map(Complex64::from)
}

/// Scales the upper halves of state vectors to `x^H M x = 1`.
fn scaled(vectors: DMatrix<Complex64>, m: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let mut x = vectors.rows(0, m.nrows()).into_owned();
    x.column_iter_mut().for_each(|mut v| {
        let mass = (m * &v).dotc(&v).norm();
        v /= Complex64::from(mass.sqrt());
    });
    x
}

/// Left vectors: right vectors of the transposed problem at the conjugate eigenvalues, each paired with its own.
fn left_of(lambdas: &[Complex64], transposed: Eigen) -> DMatrix<Complex64> {
    let mut free: Vec<usize> = (0..lambdas.len()).collect();
    let order: Vec<usize> = lambdas
        .iter()
        .map(|lambda| {
            let distance = |j: usize| (transposed.values[j] - lambda.conj()).norm();
            let best = (0..free.len()).min_by(|&i, &j| distance(free[i]).total_cmp(&distance(free[j]))).unwrap();
            free.remove(best)
        })
        .collect();
    transposed.vectors.select_columns(&order)
}

impl<F: FnMut(f64) -> [Real; 3]> Family for Model<F> {
    type Modes = Modes;

    fn solve(&mut self, value: f64) -> Result<Modes> {
        self.solved.push(value);
        let [m, c, k] = (self.matrices)(value);
        let Eigen { mut values, vectors } = eigen(companion(&m, &c, &k)).unwrap();
        // Real eigenvalues of a real matrix are real.
        let rounding = 1e-13 * values.iter().fold(0.0_f64, |largest, z| largest.max(z.norm()));
        values.iter_mut().filter(|z| z.im.abs() <= rounding).for_each(|z| z.im = 0.0);
        let transposed = eigen(companion(&m.transpose(), &c.transpose(), &k.transpose())).unwrap();
        let left = left_of(&values, transposed);
        let [m, c] = [m, c].map(|a| a.map(Complex64::from));
        let kept: Vec<usize> =
            (0..values.len()).filter(|&i| (self.window[0]..=self.window[1]).contains(&values[i].im)).collect();
        Ok(Modes {
            lambdas: kept.iter().map(|&i| values[i]).collect(),
            right: scaled(vectors.select_columns(&kept), &m),
            left: scaled(left.select_columns(&kept), &m),
            mc: [m, c],
        })
    }

    fn eigenvalues<'m>(&self, modes: &'m Modes) -> &'m [Complex64] {
        &modes.lambdas
    }

    fn products(&mut self, left: &Modes, right: &Modes) -> Result<DMatrix<Complex64>> {
        let [m, c] = &left.mc;
        let (with_m, with_c) = (left.left.adjoint() * m * &right.right, left.left.adjoint() * c * &right.right);
        let entry = |i, j| (left.lambdas[i] + right.lambdas[j]) * with_m[(i, j)] + with_c[(i, j)];
        Ok(DMatrix::from_fn(left.lambdas.len(), right.lambdas.len(), entry))
    }
}

/// The whole spectrum, noise 1e-6 of omega, Hopf points to 1e-3.
pub fn options() -> Options {
    Options {
        band: [f64::NEG_INFINITY, f64::INFINITY],
        tolerance: 1e-3,
        criterion: InstabilityCriterion::default(),
        rigid: 1e-9,
    }
}

/// Values from `from` to `to` about a step apart, rounded.
pub fn values(from: f64, to: f64, step: f64) -> Vec<f64> {
    let n = ((to - from) / step).round().abs() as usize;
    (0..=n).map(|i| ((from + (to - from) * i as f64 / n as f64) * 1e12).round() / 1e12).collect()
}
