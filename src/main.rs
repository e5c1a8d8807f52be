//! The `squeal` program. Everything is in the library; see [`squeal::cli`].

fn main() {
    squeal::petsc::leave(squeal::cli::main());
}
