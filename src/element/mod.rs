//! Elements: pure functions from coordinates and constants to matrices.
