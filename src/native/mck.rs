//! One value each for mass, damping and stiffness, and for structural damping where there is any.

use num_complex::Complex64;

/// What M, C and K have each, and G where a stiffness has a loss factor: matrices, references to them, projections,
/// versions. They are the terms of `P(lambda) = lambda^2 M + lambda C + K + i G`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Mck<T> {
    /// Mass.
    pub m: T,
    /// Damping.
    pub c: T,
    /// Stiffness.
    pub k: T,
    /// Structural damping, the imaginary part of the stiffness; none where no stiffness has a loss factor.
    pub g: Option<T>,
}

impl<T> Mck<T> {
    /// The same of all.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Mck<U> {
        Mck { m: f(self.m), c: f(self.c), k: f(self.k), g: self.g.map(f) }
    }

    /// The same of all, unless it fails.
    ///
    /// # Errors
    /// The first of `f`'s.
    pub fn try_map<U, E>(self, mut f: impl FnMut(T) -> Result<U, E>) -> Result<Mck<U>, E> {
        Ok(Mck { m: f(self.m)?, c: f(self.c)?, k: f(self.k)?, g: self.g.map(f).transpose()? })
    }

    /// Pairs with others; G where both have one.
    pub fn zip<U>(self, other: Mck<U>) -> Mck<(T, U)> {
        Mck { m: (self.m, other.m), c: (self.c, other.c), k: (self.k, other.k), g: self.g.zip(other.g) }
    }

    /// References to all.
    pub fn as_ref(&self) -> Mck<&T> {
        Mck { m: &self.m, c: &self.c, k: &self.k, g: self.g.as_ref() }
    }

    /// M, C and K without G: coefficients of the powers 2, 1 and 0 of lambda.
    pub fn into_array(self) -> [T; 3] {
        [self.m, self.c, self.k]
    }

    /// The terms of `P(lambda)` with what each is multiplied by: `lambda^2 M`, `lambda C`, `1 K` and `i G`.
    pub fn terms(self, lambda: Complex64) -> impl Iterator<Item = (Complex64, T)> {
        let g = self.g.map(|g| (Complex64::I, g));
        [(lambda * lambda, self.m), (lambda, self.c), (Complex64::ONE, self.k)].into_iter().chain(g)
    }
}

impl<T> From<[T; 3]> for Mck<T> {
    fn from([m, c, k]: [T; 3]) -> Mck<T> {
        Mck { m, c, k, g: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structural_damping_is_an_imaginary_stiffness() {
        let lambda = Complex64::new(-1.0, 3.0);
        let sum = |matrices: Mck<f64>| matrices.terms(lambda).map(|(power, x)| power * x).sum::<Complex64>();
        let real = Mck::from([2.0, 5.0, 7.0]);
        assert_eq!(sum(real), 2.0 * lambda * lambda + 5.0 * lambda + 7.0);
        assert_eq!(sum(Mck { g: Some(0.5), ..real }) - sum(real), Complex64::new(0.0, 0.5));
    }

    #[test]
    fn what_has_no_structural_damping_gets_none() {
        let (with, without) = (Mck { g: Some(4), ..Mck::from([1, 2, 3]) }, Mck::from([5, 6, 7]));
        assert_eq!((with.zip(with).g, with.zip(without).g), (Some((4, 4)), None));
        assert_eq!((with.map(|x| 2 * x).g, without.map(|x| 2 * x).g), (Some(8), None));
        assert_eq!(with.try_map(|x| if x < 4 { Ok(x) } else { Err(x) }), Err(4));
    }
}
