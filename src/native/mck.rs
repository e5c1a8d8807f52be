//! One value each for mass, damping and stiffness.

/// What M, C and K have each: matrices, references to them, projections, versions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Mck<T> {
    /// Mass.
    pub m: T,
    /// Damping.
    pub c: T,
    /// Stiffness.
    pub k: T,
}

impl<T> Mck<T> {
    /// The same of all three.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Mck<U> {
        Mck { m: f(self.m), c: f(self.c), k: f(self.k) }
    }

    /// The same of all three, unless it fails.
    ///
    /// # Errors
    /// The first of `f`'s.
    pub fn try_map<U, E>(self, mut f: impl FnMut(T) -> Result<U, E>) -> Result<Mck<U>, E> {
        Ok(Mck { m: f(self.m)?, c: f(self.c)?, k: f(self.k)? })
    }

    /// Pairs with another triple.
    pub fn zip<U>(self, other: Mck<U>) -> Mck<(T, U)> {
        Mck { m: (self.m, other.m), c: (self.c, other.c), k: (self.k, other.k) }
    }

    /// References to all three.
    pub fn as_ref(&self) -> Mck<&T> {
        Mck { m: &self.m, c: &self.c, k: &self.k }
    }

    /// In the order M, C, K: coefficients of the powers 2, 1 and 0 of lambda.
    pub fn into_array(self) -> [T; 3] {
        [self.m, self.c, self.k]
    }
}

impl<T> From<[T; 3]> for Mck<T> {
    fn from([m, c, k]: [T; 3]) -> Mck<T> {
        Mck { m, c, k }
    }
}
