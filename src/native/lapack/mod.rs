//! Small dense algebra by BLAS and LAPACK, column-major: [products](multiply), [eigenvalues](eigen()),
//! [factors](solve_complex).

mod eigen;
mod factor;
mod product;

pub use eigen::{Eigen, eigen, generalised_eigen, symmetric_eigen};
pub(in crate::native) use factor::DenseFactor;
pub use factor::solve_complex;
pub use product::{add_product, add_product_with_transpose, multiply, subtract_product};
