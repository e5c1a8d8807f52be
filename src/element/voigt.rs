//! Voigt's notation: symmetric 3x3 tensors as six numbers, xx yy zz xy yz zx.

/// The pair of axes of each Voigt index.
pub const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];

/// The Voigt index of each pair of axes.
pub const INDEX: [[usize; 3]; 3] = {
    let mut index = [[0; 3]; 3];
    let mut v = 0;
    while v < 6 {
        let [i, j] = PAIRS[v];
        index[i][j] = v;
        index[j][i] = v;
        v += 1;
    }
    index
};
