//! Microseconds of an element's stiffness and mass: `cargo bench --bench element`.
//!
//! Not a timed test: it prints figures and judges nothing.

use std::hint::black_box;
use std::time::Instant;

use squeal::element::solid::{scalar_mass, stiffness};
use squeal::element::{ElementKind, Shape};

/// Elements whose midsides are moved a little, each in its own way.
fn elements(shape: Shape) -> Vec<Vec<[f64; 3]>> {
    let bent = |e: usize| {
        let mut x = shape.interpolation().nodes().to_vec();
        let midsides = x[shape.n_corners()..].iter_mut().enumerate();
        midsides.for_each(|(a, x)| x[e % 3] += 0.05 * ((7 * e + a) as f64).sin());
        x
    };
    (0..1000).map(bent).collect()
}

/// Prints the best of thirty passes.
fn measure(name: &str, elements: &[Vec<[f64; 3]>], mut work: impl FnMut(&[[f64; 3]])) {
    let pass = |_| {
        let start = Instant::now();
        elements.iter().for_each(|x| work(x));
        start.elapsed().as_secs_f64() / elements.len() as f64
    };
    let best = (0..30).map(pass).fold(f64::INFINITY, f64::min);
    println!("{name}: {:.2} us an element, {:.0} elements/s", best * 1e6, 1.0 / best);
}

fn main() {
    let elasticity = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 2e11 } else { 1e10 }));
    for kind in ElementKind::ALL {
        let (n, elements) = (kind.n_nodes(), elements(kind.shape()));
        let (mut k, mut m) = (vec![0.0; 9 * n * n], vec![0.0; n * n]);
        let name = |what: &str| format!("{:6} {what:9}", kind.name());
        measure(&name("stiffness"), &elements, |x| stiffness(kind, x, &elasticity, black_box(&mut k)));
        measure(&name("mass"), &elements, |x| scalar_mass(kind.shape(), x, 7800.0, black_box(&mut m)));
    }
}
