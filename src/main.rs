//! The `squeal` program. Everything is in the library; see [`squeal::cli`].

use squeal::native::Allocator;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() {
    std::process::exit(squeal::cli::main());
}
