//! The weight of a hanging rod against its exact displacement.

use squeal::analysis::Sweep;
use squeal::element::ElementKind;
use squeal::mesh::Mesh;
use squeal::native::Session;

use crate::support::block::Block;
use crate::support::brake;

const LENGTH: f64 = 0.3;
const YOUNG: f64 = 2e9;
const DENSITY: f64 = 7800.0;
const G: f64 = 9.81;

const ROD: &str = r#"
[material.soft]
young = 2e9
poisson = 0.0
density = 7800
[part.rod]
material = "soft"
[[fix]]
nodes = "rod_z0"
axes = "z"
[[fix]]
nodes = "rod_x0"
axes = "x"
[[fix]]
nodes = "rod_y0"
axes = "y"
[[load]]
gravity = [0, 0, 9.81]
[stability]
band = [0, 1000]
"#;

/// `u = rho g x (2 L - x) / 2E` at the distance x from the support, to round-off in quadratic elements.
#[test]
fn a_hanging_rod_has_its_exact_displacement() {
    let comm = Session::start(&[]).unwrap();
    for kind in [ElementKind::C3D10, ElementKind::C3D15, ElementKind::C3D20, ElementKind::C3D20R] {
        let mut mesh = Mesh::default();
        let map = |s: [f64; 3]| [0.02 * s[0], 0.03 * s[1], LENGTH * s[2]];
        Block { part: "rod", cells: [1, 1, 3], wraps: false, map: &map }.add_solids_to(&mut mesh, kind);
        let rod = brake(ROD, mesh);
        let system = rod.assemble(&comm, &rod.families().unwrap()).unwrap();
        let equilibrium = Sweep::new(&system, &rod.interface, false).unwrap().equilibrium(0.0, &mut ()).unwrap();
        let u = rod.displacements(&system, &equilibrium.u).unwrap();
        let exact = |z: f64| DENSITY * G * z * (2.0 * LENGTH - z) / (2.0 * YOUNG);
        let off = rod.mesh.nodes.iter().zip(&u).map(|(x, u)| (u[2] - exact(x[2])).abs()).fold(0.0, f64::max);
        println!("{kind:?}: {:.1e} of {:.1e}", off, exact(LENGTH));
        assert!(off < 1e-10 * exact(LENGTH), "{kind:?}: {off}");
    }
}
