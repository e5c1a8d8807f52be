//! Order of convergence of displacements on a problem whose solution is chosen: linear elasticity on the unit cube.
//!
//! ```text
//!     u = a sin(pi x) sin(pi y) sin(pi z)        zero on all six faces, which are held
//!     f = -(lambda + mu) grad div u - mu lap u   loads each element by 14 points
//! ```
//!
//! Source: the method of manufactured solutions (Roache, J. Fluids Eng. 124 (2002)); a quadratic element's displacement
//! has order 3 in L2 (Strang and Fix, An Analysis of the Finite Element Method).
//!
//! Goal: error in L2 on 3, 6 and 12 cells a side falls with an order of 2.9 to 3.2 between the finest two [3.02, then
//! 3.06; relative errors 3.7e-2, 4.6e-3, 5.5e-4].

use std::f64::consts::PI;

use crate::support::block::Block;
use crate::support::{brake, nodes_where};
use squeal::element::quadrature::TETRAHEDRON_14;
use squeal::element::{Shape, solid};
use squeal::mesh::Mesh;
use squeal::native::{Comm, Factor, FactorKind, Session};

const YOUNG: f64 = 210e9;
const POISSON: f64 = 0.3;
const AMPLITUDE: [f64; 3] = [1.0, -0.5, 0.8];

const MODEL: &str = r#"
[material.steel]
young = 210e9
poisson = 0.3
density = 7850
[part.cube]
material = "steel"
[[fix]]
nodes = "skin"
axes = "xyz"
[stability]
band = [0, 1]
"#;

fn solution(x: [f64; 3]) -> [f64; 3] {
    let s: f64 = x.iter().map(|x| (PI * x).sin()).product();
    AMPLITUDE.map(|a| a * s)
}

/// `-(lambda + mu) grad div u - mu lap u`; with `S = sin sin sin`, `lap S = -3 pi^2 S`.
fn body_force(x: [f64; 3]) -> [f64; 3] {
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let lambda = 2.0 * mu * POISSON / (1.0 - 2.0 * POISSON);
    let (s, c) = (x.map(|x| (PI * x).sin()), x.map(|x| (PI * x).cos()));
    let all: f64 = s.iter().product();
    let second = |i: usize, j: usize| if i == j { -all } else { c[i] * c[j] * s[3 - i - j] };
    std::array::from_fn(|i| {
        let grad_div: f64 = (0..3).map(|j| AMPLITUDE[j] * second(i, j)).sum();
        -PI * PI * ((lambda + mu) * grad_div - 3.0 * mu * AMPLITUDE[i] * all)
    })
}

/// Calls `visit(e, N, x, w detJ)` at each integration point.
fn integrate(mesh: &Mesh, mut visit: impl FnMut(usize, &[f64], [f64; 3], f64)) {
    let shape = Shape::Tetrahedron10;
    for e in 0..mesh.elements.len() {
        let x = mesh.element_nodes(e);
        let volume = solid::volume(shape, &x); // straight edges: detJ is constant
        for point in &TETRAHEDRON_14 {
            let n = shape.interpolation().shape(point.at);
            let position = [0, 1, 2].map(|i| x.iter().zip(n).map(|(x, n)| n * x[i]).sum());
            visit(e, &n[..10], position, 6.0 * volume * point.weight);
        }
    }
}

/// Error in L2 over the norm of the solution, on n^3 cells.
fn error(comm: &Comm, n: usize) -> f64 {
    let mut mesh = Mesh::default();
    Block { part: "cube", cells: [n; 3], wraps: false, map: &|x| x }.add_to(&mut mesh);
    let skin = nodes_where(&mesh, |x| x.iter().any(|&x| x == 0.0 || x == 1.0));
    mesh.node_sets.insert("skin".into(), skin);
    let mut brake = brake(MODEL, mesh);
    let mut loads = Vec::new();
    integrate(&brake.mesh, |e, shape, x, weight| {
        let f = body_force(x);
        let nodes = brake.mesh.elements.get(e).nodes.iter();
        loads.extend(nodes.zip(shape).map(|(&n, shape)| (n, f.map(|f| weight * shape * f))));
    });
    brake.loads = loads;
    let families = brake.families().unwrap();
    let mut system = brake.assemble(comm, &families).unwrap();
    system.k.declare_symmetric().unwrap();
    let mut factor = Factor::new(FactorKind::Symmetric);
    factor.factorise(&system.k).unwrap();
    let mut u = system.zeros().unwrap();
    factor.solve(&system.load, &mut u).unwrap();
    let u = system.nodal(&[&u]).unwrap().remove(0);
    let (mut off, mut norm) = (0.0, 0.0);
    integrate(&brake.mesh, |e, shape, x, weight| {
        let exact = solution(x);
        for i in 0..3 {
            let nodes = brake.mesh.elements.get(e).nodes.iter();
            let value: f64 = nodes.zip(shape).map(|(&n, shape)| shape * u[n as usize][i]).sum();
            off += weight * (value - exact[i]).powi(2);
            norm += weight * exact[i].powi(2);
        }
    });
    (off / norm).sqrt()
}

#[test]
fn displacements_converge_with_order_three() {
    let comm = Session::start(&[]).unwrap();
    let errors = [3, 6, 12].map(|n| error(&comm, n));
    let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    println!("errors {errors:?}, orders {orders:?}");
    assert!(errors[2] < 6e-4, "{errors:?}");
    assert!((2.9..3.2).contains(&orders[1]), "{orders:?}");
}
