//! Three-vectors and 3x3 matrices as plain arrays, small enough to be inlined everywhere. Any module may use it.

pub(crate) mod complex;

/// `a . b`
pub(crate) const fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`
pub(crate) const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - b`
pub(crate) const fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s a`
pub(crate) const fn scale(s: f64, a: [f64; 3]) -> [f64; 3] {
    [s * a[0], s * a[1], s * a[2]]
}

/// `|a|`
pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The matrix `[a]x` with `[a]x b = a x b`.
pub(crate) const fn skew(a: [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]
}

/// `A B`
pub(crate) fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let row = |i: usize| {
        let entry = |j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        [entry(0), entry(1), entry(2)]
    };
    [row(0), row(1), row(2)]
}

/// The least and the largest number; infinity and minus infinity of none.
pub(crate) fn span(numbers: impl IntoIterator<Item = f64>) -> [f64; 2] {
    numbers.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// `A v`
#[cfg(test)]
pub(crate) fn apply(a: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [dot(a[0], v), dot(a[1], v), dot(a[2], v)]
}

/// Columns of the cofactor matrix, `cof J = detJ J^-T`, and `detJ`.
///
/// With the columns `j_k` of `J`: `cof J = [j_1 x j_2, j_2 x j_0, j_0 x j_1]`, `detJ = j_0 . (j_1 x j_2)`.
#[inline]
pub(crate) const fn cofactor_columns(j: &[[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    let j0 = [j[0][0], j[1][0], j[2][0]];
    let j1 = [j[0][1], j[1][1], j[2][1]];
    let j2 = [j[0][2], j[1][2], j[2][2]];
    let first = cross(j1, j2);
    ([first, cross(j2, j0), cross(j0, j1)], dot(j0, first))
}
