//! The `squeal` program. Everything is in the library; see [`squeal::cli`].

use squeal::cli::Allocator;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() {
    std::process::exit(squeal::cli::main());
}
