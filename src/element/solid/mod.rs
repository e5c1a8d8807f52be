//! Matrices and integrals of solid elements, all from one family of tables.
//!
//! Geometry and displacement share the shape functions, `x = sum_a N_a x_a`, `u = sum_a N_a u_a`. A `Family` holds
//! the shape functions and gradients of a shape at the points of two rules; stiffness, mass, volume and mean strain are
//! sums over these points. Two kinds have a stiffness of their own: `incompatible` (C3D8I) and `mean_strain` (C3D8R).
//!
//! ```
//! use squeal::element::Shape;
//! use squeal::element::solid::mass_properties;
//!
//! let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let shape = Shape::Tetrahedron10;
//! let steel = mass_properties(shape, &shape.straight(&corners), 7800.0);
//! assert!((steel.mass - 1300.0).abs() < 1e-9 && (steel.centre()[0] - 0.25).abs() < 1e-12);
//! ```
//!
//! What the rules leave exact:
//!
//! | integral | constant `detJ` (straight tetrahedra, parallelepipeds) | distorted and curved |
//! |---|---|---|
//! | stiffness | exact; C3D20R and C3D8R reduced on purpose | six modes without energy; C3D6 has 7, C3D20R 12 |
//! | linear field (patch test) | exact | exact on straight edges, all kinds |
//! | mass | exact | total and row sums exact; C3D10's entries to degree 5 |
//! | volume, first moment | exact | exact on straight edges, volume on curved ones too |
//!
//! On curved edges a patch of C3D10 leaves a residual that grows with the square of the midsides' offset (1e-3 of the
//! element forces for offsets up to 4 % of the edge; and since that offset shrinks with the element, it vanishes on
//! refinement): `patch` measures it.

mod geometric;
mod incompatible;
mod mass;
mod mean_strain;
#[cfg(test)]
mod patch;
mod recovery;
mod rotation;
mod stiffness;
mod table;
#[cfg(test)]
mod tests;

use super::quadrature::{
    HEXAHEDRON_8, HEXAHEDRON_27, TETRAHEDRON_1, TETRAHEDRON_4, TETRAHEDRON_14, WEDGE_2, WEDGE_9, WEDGE_21,
};
use super::{ElementKind, Shape, shape};
pub use mass::MassProperties;
pub use recovery::von_mises;
pub use rotation::ConvectiveInertia;
use table::Family;
pub use table::jacobian;

static TETRAHEDRON_4_NODES: Family<4, 12, 1, 4> = Family::new(&shape::TETRAHEDRON_4, &TETRAHEDRON_1, &TETRAHEDRON_4);
static TETRAHEDRON_10_NODES: Family<10, 30, 4, 14> =
    Family::new(&shape::TETRAHEDRON_10, &TETRAHEDRON_4, &TETRAHEDRON_14);
static WEDGE_6_NODES: Family<6, 18, 2, 21> = Family::new(&shape::WEDGE_6, &WEDGE_2, &WEDGE_21);
static WEDGE_15_NODES: Family<15, 45, 9, 21> = Family::new(&shape::WEDGE_15, &WEDGE_9, &WEDGE_21);
static HEXAHEDRON_8_NODES: Family<8, 24, 8, 8> = Family::new(&shape::HEXAHEDRON_8, &HEXAHEDRON_8, &HEXAHEDRON_8);
static HEXAHEDRON_20_NODES: Family<20, 60, 27, 27> = Family::new(&shape::HEXAHEDRON_20, &HEXAHEDRON_27, &HEXAHEDRON_27);
static HEXAHEDRON_20_REDUCED: Family<20, 60, 8, 27> = Family::new(&shape::HEXAHEDRON_20, &HEXAHEDRON_8, &HEXAHEDRON_27);

/// Evaluates an expression with the family of a kind. The family is a constant there, so that the compiler can see its
/// tables: through a pointer the mass of a 10-node tetrahedron takes half as long again.
macro_rules! with_family {
    ($kind:expr, $family:ident => $value:expr) => {
        match $kind {
            ElementKind::C3D4 => with_family!(@ TETRAHEDRON_4_NODES, $family => $value),
            ElementKind::C3D6 => with_family!(@ WEDGE_6_NODES, $family => $value),
            ElementKind::C3D8 | ElementKind::C3D8I | ElementKind::C3D8R => {
                with_family!(@ HEXAHEDRON_8_NODES, $family => $value)
            }
            ElementKind::C3D10 => with_family!(@ TETRAHEDRON_10_NODES, $family => $value),
            ElementKind::C3D15 => with_family!(@ WEDGE_15_NODES, $family => $value),
            ElementKind::C3D20 => with_family!(@ HEXAHEDRON_20_NODES, $family => $value),
            ElementKind::C3D20R => with_family!(@ HEXAHEDRON_20_REDUCED, $family => $value),
        }
    };
    (@ $static:ident, $family:ident => $value:expr) => {{
        let $family = &$static;
        $value
    }};
}

/// Fills `k` (row-major, `(3n)^2`, dof `3a + i`, N/m) with the stiffness of an element, `integral of B^T D B`.
///
/// `x` are the positions of the `n` nodes, m; `elasticity` in Pa, symmetric (Voigt xx yy zz xy yz zx, engineering
/// shear). The matrix is exactly symmetric. A degenerate element (`detJ = 0` at a point) gives entries that are not
/// finite, a turned one a negative semidefinite matrix: reading a mesh refuses both.
///
/// # Panics
/// If `x` or `k` has not the kind's size, as all functions of this module.
pub fn stiffness(kind: ElementKind, x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], k: &mut [f64]) {
    match kind {
        ElementKind::C3D8I => incompatible::stiffness(x, elasticity, k),
        ElementKind::C3D8R => mean_strain::stiffness(x, elasticity, k),
        _ => with_family!(kind, family => family.stiffness(x, elasticity, k)),
    }
}

/// Fills `k` (row-major, `(3n)^2`, N/m) with the geometric stiffness of an element, `integral of grad N_a . sigma grad
/// N_b` on each axis, `sigma` the stress (Pa) of the nodal displacements `u` (m) at each point of the stiffness rule.
///
/// It is symmetric. A rigid rotation turns the internal forces f: `K_g (theta x r) = theta x f`.
pub fn geometric_stiffness(
    kind: ElementKind,
    x: &[[f64; 3]],
    elasticity: &[[f64; 6]; 6],
    u: &[[f64; 3]],
    k: &mut [f64],
) {
    match kind {
        ElementKind::C3D8I => incompatible::geometric_stiffness(x, elasticity, u, k),
        ElementKind::C3D8R => spread(mean_strain::geometric_stiffness(x, elasticity, u).as_flattened(), &IDENTITY, k),
        _ => with_family!(kind, family => spread(family.geometric(x, elasticity, u).as_flattened(), &IDENTITY, k)),
    }
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Writes `a_ab t_ij` at `(3a + i, 3b + j)` of `out`, from the `n x n` numbers `a`.
pub fn spread(a: &[f64], t: &[[f64; 3]; 3], out: &mut [f64]) {
    let n = a.len().isqrt();
    assert_eq!(out.len(), 9 * n * n, "an element matrix has one entry a pair of dofs");
    for (at, value) in out.iter_mut().enumerate() {
        let [row, column] = [at / (3 * n), at % (3 * n)];
        *value = a[n * (row / 3) + column / 3] * t[row % 3][column % 3];
    }
}

/// The inertia of an element through which its material flows: [`ConvectiveInertia`].
///
/// `flow(x)` is the material's velocity (m/s) at a point; `density` in kg/m3.
pub fn convective_inertia(
    shape: Shape,
    x: &[[f64; 3]],
    density: f64,
    flow: impl Fn([f64; 3]) -> [f64; 3],
) -> ConvectiveInertia {
    with_family!(ElementKind::default_for(shape), family => family.convective_inertia(x, density, flow))
}

/// Fills `m` (`n` x `n`, row-major, kg) with the consistent mass, the same for each of the three axes.
///
/// `m_ab = integral of density N_a N_b`; `x` in m, `density` in kg/m3. The full matrix is `m_ab delta_ij` at dofs
/// `(3a + i, 3b + j)`. Exactly symmetric, and positive definite wherever `detJ > 0`.
pub fn scalar_mass(shape: Shape, x: &[[f64; 3]], density: f64, m: &mut [f64]) {
    with_family!(ElementKind::default_for(shape), family => family.scalar_mass(x, density, m));
}

/// Volume, m3: `sum_q w detJ`, exact.
pub fn volume(shape: Shape, x: &[[f64; 3]]) -> f64 {
    with_family!(ElementKind::default_for(shape), family => family.volume(x))
}

/// Mass, first and second moments of an element, by the points of the mass matrix.
///
/// So they are what `u^T M u` gives for rigid motions, to round-off. Moments are summed about node 0 and then shifted
/// to the origin, so that a small element far from it loses no digits to the sum.
pub fn mass_properties(shape: Shape, x: &[[f64; 3]], density: f64) -> MassProperties {
    with_family!(ElementKind::default_for(shape), family => family.mass_properties(x, density))
}

/// Stress, Pa, of the mean strain over the points of the stiffness rule, `D sum_q w B_q u / sum_q w`.
///
/// `x` and the nodal displacements `u` in m. Voigt order xx yy zz xy yz zx. Incompatible modes add no mean strain where
/// `detJ` is constant, and are left out.
pub fn mean_stress(kind: ElementKind, x: &[[f64; 3]], elasticity: &[[f64; 6]; 6], u: &[[f64; 3]]) -> [f64; 6] {
    recovery::stress(elasticity, &with_family!(kind, family => family.mean_strain(x, u)))
}

/// Whether the element is turned inside out somewhere, or flat: `detJ <= 0` at a node or at a point of the stiffness
/// rule.
pub fn is_inverted(shape: Shape, x: &[[f64; 3]]) -> bool {
    let least = smallest_determinant(shape, x);
    least.is_nan() || least <= 0.0
}

/// The least `detJ` over the nodes and the points of the stiffness rule; NaN where one is.
pub(super) fn smallest_determinant(shape: Shape, x: &[[f64; 3]]) -> f64 {
    with_family!(ElementKind::default_for(shape), family => family.smallest_determinant(x))
}
