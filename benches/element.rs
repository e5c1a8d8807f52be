//! Microseconds of a tetrahedron's stiffness and mass: `cargo bench --bench element`.
//!
//! Not a timed test: it prints figures and judges nothing.

use std::hint::black_box;
use std::time::Instant;

use squeal::element::tet10::{EDGES, scalar_mass, stiffness, straight};

/// Straight elements whose midsides are moved a little, each in its own way.
fn elements() -> Vec<[[f64; 3]; 10]> {
    let unit = straight([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let bent = |e: usize| {
        let mut x = unit;
        (0..EDGES.len()).for_each(|a| x[4 + a][e % 3] += 0.05 * ((7 * e + a) as f64).sin());
        x
    };
    (0..1000).map(bent).collect()
}

/// Prints the best of thirty passes.
fn measure(name: &str, elements: &[[[f64; 3]; 10]], mut work: impl FnMut(&[[f64; 3]; 10])) {
    let pass = |_| {
        let start = Instant::now();
        elements.iter().for_each(&mut work);
        start.elapsed().as_secs_f64() / elements.len() as f64
    };
    let best = (0..30).map(pass).fold(f64::INFINITY, f64::min);
    println!("{name}: {:.2} us an element, {:.0} tetrahedra/s", best * 1e6, 1.0 / best);
}

fn main() {
    let elements = elements();
    let elasticity = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 2e11 } else { 1e10 }));
    let (mut k, mut m) = ([0.0; 900], [0.0; 100]);
    measure("stiffness", &elements, |x| stiffness(x, &elasticity, black_box(&mut k)));
    measure("mass", &elements, |x| scalar_mass(x, 7800.0, black_box(&mut m)));
}
