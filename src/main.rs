//! The `squeal` program. Everything is in the library; see [`squeal::cli`].

fn main() {
    std::process::exit(squeal::cli::main());
}
