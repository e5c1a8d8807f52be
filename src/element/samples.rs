//! What the tests of this module share: reproducible random numbers, elements and materials, and a rule that is exact
//! to any degree.

use super::Shape;
use super::quadrature::QuadraturePoint;
use super::solid::smallest_determinant;
use crate::algebra::{cross, sub};

/// A small linear congruential generator (Knuth's MMIX constants): the same numbers on every machine.
pub struct Random(u64);

impl Random {
    pub fn seeded(seed: u64) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        random.unit();
        random
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Components uniform in [-1, 1).
    pub fn vector(&mut self) -> [f64; 3] {
        [self.signed(), self.signed(), self.signed()]
    }
}

/// An element with straight edges and corners moved at random, about a metre across, with `detJ > 0`.
pub fn distorted(shape: Shape, random: &mut Random) -> Vec<[f64; 3]> {
    loop {
        let nodes = &shape.interpolation().nodes()[..shape.n_corners()];
        let corners: Vec<[f64; 3]> = nodes.iter().map(|node| node.map(|value| value + 0.3 * random.signed())).collect();
        let x = shape.straight(&corners);
        if smallest_determinant(shape, &x) > 0.25 {
            return x;
        }
    }
}

/// As [`distorted`], with every midside moved by up to `offset` in each axis.
pub fn curved(shape: Shape, random: &mut Random, offset: f64) -> Vec<[f64; 3]> {
    loop {
        let mut x = distorted(shape, random);
        for value in x[shape.n_corners()..].as_flattened_mut() {
            *value += offset * random.signed();
        }
        if smallest_determinant(shape, &x) > 0.05 {
            return x;
        }
    }
}

/// A rigid motion's displacement at `x`: `u = shift + turn x (x - origin)`.
pub fn rigid_displacement(shift: [f64; 3], turn: [f64; 3], origin: [f64; 3], x: [f64; 3]) -> [f64; 3] {
    let swing = cross(turn, sub(x, origin));
    std::array::from_fn(|i| shift[i] + swing[i])
}

/// A positive definite elasticity without any symmetry of its own: `A A^T + I`, of order one.
pub fn triclinic(random: &mut Random) -> [[f64; 6]; 6] {
    let a: [[f64; 6]; 6] = std::array::from_fn(|_| std::array::from_fn(|_| random.signed()));
    let mut d = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            d[i][j] = (0..6).map(|k| a[i][k] * a[j][k]).sum::<f64>() + if i == j { 1.0 } else { 0.0 };
        }
    }
    d
}

/// Gauss-Legendre points and weights on (0, 1), exact to degree `2n - 1`: Newton on the Legendre recurrence.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut previous, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
        }
        (value, n as f64 * (x * value - previous) / (x * x - 1.0))
    };
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..20 {
                let (value, slope) = legendre(x);
                x -= value / slope;
            }
            let slope = legendre(x).1;
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// A rule on the reference tetrahedron, exact to degree `2n - 3`: the cube's Gauss rule with one face collapsed.
///
/// `(xi, eta, zeta) = (r, s (1-r), t (1-r)(1-s))`, with the volume factor `(1-r)^2 (1-s)`.
pub fn collapsed_gauss(n: usize) -> Vec<QuadraturePoint<3>> {
    let line = gauss(n);
    let mut rule = Vec::with_capacity(n * n * n);
    for &(r, wr) in &line {
        for &(s, ws) in &line {
            for &(t, wt) in &line {
                rule.push(QuadraturePoint {
                    at: [r, s * (1.0 - r), t * (1.0 - r) * (1.0 - s)],
                    weight: wr * ws * wt * (1.0 - r).powi(2) * (1.0 - s),
                });
            }
        }
    }
    rule
}
