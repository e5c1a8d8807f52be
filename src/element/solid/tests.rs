//! Properties of all kinds of element, on distorted and curved ones.

use super::*;
use crate::algebra::{apply, cofactor_columns, cross, dot, sub};
use crate::element::quadrature::QuadraturePoint;
use crate::element::samples::{Random, collapsed_gauss, curved, distorted, triclinic};
use nalgebra::DMatrix;

fn stiffness_of(kind: ElementKind, x: &[[f64; 3]], elasticity: &[[f64; 6]; 6]) -> DMatrix<f64> {
    let n = 3 * kind.n_nodes();
    let mut k = vec![0.0; n * n];
    stiffness(kind, x, elasticity, &mut k);
    DMatrix::from_row_slice(n, n, &k)
}

fn mass_of(shape: Shape, x: &[[f64; 3]], density: f64) -> DMatrix<f64> {
    let n = shape.n_nodes();
    let mut m = vec![0.0; n * n];
    scalar_mass(shape, x, density, &mut m);
    DMatrix::from_row_slice(n, n, &m)
}

/// Gradients `dN_a/dx` and `detJ` at any point of any element.
fn gradients(shape: Shape, x: &[[f64; 3]], at: [f64; 3]) -> (Vec<[f64; 3]>, f64) {
    let reference = &shape.interpolation().gradients(at)[..x.len()];
    let mut j = [[0.0; 3]; 3];
    for (x, g) in x.iter().zip(reference) {
        (0..9).for_each(|i| j[i / 3][i % 3] += x[i / 3] * g[i % 3]);
    }
    let (cofactors, det) = cofactor_columns(&j);
    let physical = |g: &[f64; 3]| [0, 1, 2].map(|i| (0..3).map(|k| cofactors[k][i] * g[k]).sum::<f64>() / det);
    (reference.iter().map(physical).collect(), det)
}

/// `K = sum_q w detJ B^T D B` written as plain matrix products on any list of points.
fn plain_stiffness(
    shape: Shape,
    x: &[[f64; 3]],
    elasticity: &[[f64; 6]; 6],
    rule: &[QuadraturePoint<3>],
) -> DMatrix<f64> {
    let d = DMatrix::from_fn(6, 6, |i, j| elasticity[i][j]);
    let n = shape.n_nodes();
    let mut k = DMatrix::zeros(3 * n, 3 * n);
    for q in rule {
        let (g, det) = gradients(shape, x, q.at);
        let mut b = DMatrix::zeros(6, 3 * n);
        for a in 0..n {
            let [gx, gy, gz] = g[a];
            let rows = [[gx, 0., 0.], [0., gy, 0.], [0., 0., gz], [gy, gx, 0.], [0., gz, gy], [gz, 0., gx]];
            (0..18).for_each(|at| b[(at / 3, 3 * a + at % 3)] = rows[at / 3][at % 3]);
        }
        k += b.transpose() * &d * &b * (q.weight * det);
    }
    k
}

#[test]
fn kernels_equal_plain_matrix_products_for_a_triclinic_material() {
    let rules: [(ElementKind, &[QuadraturePoint<3>]); 7] = [
        (ElementKind::C3D4, &TETRAHEDRON_1),
        (ElementKind::C3D6, &WEDGE_2),
        (ElementKind::C3D8, &HEXAHEDRON_8),
        (ElementKind::C3D10, &TETRAHEDRON_4),
        (ElementKind::C3D15, &WEDGE_9),
        (ElementKind::C3D20, &HEXAHEDRON_27),
        (ElementKind::C3D20R, &HEXAHEDRON_8),
    ];
    let mut random = Random::seeded(11);
    for (kind, rule) in rules {
        let (x, d) = (curved(kind.shape(), &mut random, 0.06), triclinic(&mut random));
        let plain = plain_stiffness(kind.shape(), &x, &d, rule);
        assert!((stiffness_of(kind, &x, &d) - &plain).norm() < 1e-13 * plain.norm(), "{kind:?}");
    }
}

#[test]
fn four_points_integrate_a_straight_tetrahedron_exactly() {
    let mut random = Random::seeded(12);
    let (x, d) = (distorted(Shape::Tetrahedron10, &mut random), triclinic(&mut random));
    let exact = plain_stiffness(Shape::Tetrahedron10, &x, &d, &collapsed_gauss(6));
    assert!((stiffness_of(ElementKind::C3D10, &x, &d) - &exact).norm() < 1e-13 * exact.norm());
}

#[test]
fn curved_elements_have_six_rigid_modes_and_the_others_have_energy() {
    let mut random = Random::seeded(13);
    for kind in ElementKind::ALL.into_iter().flat_map(|kind| [kind; 5]) {
        let k = stiffness_of(kind, &curved(kind.shape(), &mut random, 0.06), &triclinic(&mut random));
        assert_eq!(k, k.transpose(), "exactly symmetric");
        let mut eigenvalues: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        // Eight points give a 20-node hexahedron a rank of 48 of its 54 modes; two points on the axis of a wedge do not
        // feel its torsion.
        let n_zero = match kind {
            ElementKind::C3D20R => 12,
            ElementKind::C3D6 => 7,
            _ => 6,
        };
        let largest = eigenvalues[eigenvalues.len() - 1];
        assert!(eigenvalues[..n_zero].iter().all(|value| value.abs() < 1e-13 * largest), "{kind:?}");
        assert!(eigenvalues[n_zero] > 1e-5 * largest, "{kind:?} {eigenvalues:?}");
    }
}

#[test]
fn rigid_motions_need_no_force_and_linear_fields_have_their_exact_energy() {
    let mut random = Random::seeded(14);
    for kind in ElementKind::ALL {
        let (x, d) = (distorted(kind.shape(), &mut random), triclinic(&mut random));
        let k = stiffness_of(kind, &x, &d);
        let (shift, turn) = (random.vector(), random.vector());
        let n = k.nrows();
        let rigid = DMatrix::from_fn(n, 1, |dof, _| shift[dof % 3] + cross(turn, x[dof / 3])[dof % 3]);
        assert!((&k * &rigid).norm() < 1e-13 * k.norm() * rigid.norm(), "{kind:?}");
        // u = H x: energy = 1/2 strain . D strain volume
        let h = [random.vector(), random.vector(), random.vector()];
        let u = DMatrix::from_fn(n, 1, |dof, _| dot(h[dof % 3], x[dof / 3]));
        let e = [h[0][0], h[1][1], h[2][2], h[0][1] + h[1][0], h[1][2] + h[2][1], h[2][0] + h[0][2]];
        let density: f64 = (0..6).map(|r| e[r] * (0..6).map(|c| d[r][c] * e[c]).sum::<f64>()).sum();
        let exact = density * volume(kind.shape(), &x);
        assert!(((u.transpose() * &k * &u)[(0, 0)] / exact - 1.0).abs() < 1e-11, "{kind:?}");
    }
}

/// A cantilever's end rotated by a moment: u = (-x y, x^2/2, 0) with poisson = 0 is pure bending. C3D8I has its energy,
/// a fully integrated C3D8 of aspect ratio 4 has nine times as much.
#[test]
fn incompatible_modes_bend_without_shear() {
    let d = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { [200.0, 100.0][i / 3] } else { 0.0 }));
    let x: Vec<[f64; 3]> =
        Shape::Hexahedron8.interpolation().nodes().iter().map(|&[x, y, z]| [4.0 * x, y, z]).collect();
    let u = DMatrix::from_fn(24, 1, |dof, _| {
        let [px, py, _] = x[dof / 3];
        [-px * py, 0.5 * px * px, 0.0][dof % 3]
    });
    let exact = 200.0 * 8.0 * 4.0 / 3.0; // E integral of y^2
    let energy = |kind| (u.transpose() * stiffness_of(kind, &x, &d) * &u)[(0, 0)] / exact;
    assert!((energy(ElementKind::C3D8I) - 1.0).abs() < 1e-12);
    assert!((energy(ElementKind::C3D8) - 9.0).abs() < 1e-12, "1 + (length/height)^2 G/E");
}

#[test]
fn straight_tetrahedron_has_the_known_consistent_matrix() {
    // Over density volume / 420: 6 and 1 between corners, -4 and -6 between a corner and a midside on its edges or not,
    // 32 on the diagonal of midsides, 16 between edges that meet and 8 else.
    let edges: [&[usize]; 6] = [&[0, 1], &[1, 2], &[2, 0], &[0, 3], &[1, 3], &[2, 3]];
    let known = |a: usize, b: usize| match (a.min(b), a.max(b)) {
        (a, b) if b < 4 => [1.0, 6.0][usize::from(a == b)],
        (a, b) if a < 4 => [-6.0, -4.0][usize::from(edges[b - 4].contains(&a))],
        (a, b) if a == b => 32.0,
        (a, b) => [8.0, 16.0][usize::from(edges[a - 4].iter().any(|c| edges[b - 4].contains(c)))],
    };
    let x = distorted(Shape::Tetrahedron10, &mut Random::seeded(21));
    let edge = |c: usize| sub(x[c], x[0]);
    let exact_volume = dot(cross(edge(1), edge(2)), edge(3)) / 6.0;
    let exact = DMatrix::from_fn(10, 10, |a, b| known(a, b) * 7800.0 * exact_volume / 420.0);
    assert!((mass_of(Shape::Tetrahedron10, &x, 7800.0) - &exact).norm() < 2e-14 * exact.norm());
}

#[test]
fn mass_is_symmetric_positive_definite_and_adds_up_to_density_times_volume() {
    let mut random = Random::seeded(22);
    for shape in Shape::ALL.into_iter().flat_map(|shape| [shape; 10]) {
        let x = curved(shape, &mut random, 0.06);
        let m = mass_of(shape, &x, 3.0);
        assert!((m.sum() / (3.0 * volume(shape, &x)) - 1.0).abs() < 1e-14, "{shape:?}");
        assert_eq!(m, m.transpose());
        assert!(m.cholesky().is_some(), "{shape:?}");
    }
}

#[test]
fn mass_of_an_affine_element_is_exact() {
    // On an affine image of the reference element m_ab = rho detJ integral of N_a N_b, here by many more points.
    let line = crate::element::samples::gauss(6);
    let mut random = Random::seeded(23);
    for shape in [Shape::Wedge6, Shape::Wedge15, Shape::Hexahedron8, Shape::Hexahedron20] {
        let map = [random.vector(), random.vector(), random.vector()];
        let map: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| 0.3 * map[i][j] + f64::from(i == j)));
        let x: Vec<[f64; 3]> = shape.interpolation().nodes().iter().map(|&p| apply(&map, p)).collect();
        let m = mass_of(shape, &x, 2.0);
        let mut exact = DMatrix::zeros(m.nrows(), m.nrows());
        for (&(r, wr), &(s, ws), &(t, wt)) in line
            .iter()
            .flat_map(|r| line.iter().map(move |s| (r, s)))
            .flat_map(|(r, s)| line.iter().map(move |t| (r, s, t)))
        {
            let (at, weight) = match shape.n_corners() {
                6 => ([r, s * (1.0 - r), 2.0 * t - 1.0], 2.0 * (1.0 - r) * wr * ws * wt),
                _ => ([r, s, t].map(|v| 2.0 * v - 1.0), 8.0 * wr * ws * wt),
            };
            let (n, det) = (shape.interpolation().shape(at), cofactor_columns(&map).1);
            exact += DMatrix::from_fn(m.nrows(), m.nrows(), |a, b| 2.0 * det * weight * n[a] * n[b]);
        }
        assert!((&m - &exact).norm() < 1e-13 * exact.norm(), "{shape:?}");
    }
}

#[test]
fn rigid_rotation_has_the_kinetic_energy_of_the_inertia_tensor() {
    let mut random = Random::seeded(24);
    for shape in Shape::ALL.into_iter().flat_map(|shape| [shape; 4]) {
        let x = curved(shape, &mut random, 0.06);
        let (m, properties) = (mass_of(shape, &x, 7800.0), mass_properties(shape, &x, 7800.0));
        let (spin, point) = (random.vector(), random.vector());
        let v = DMatrix::from_fn(x.len(), 3, |a, i| cross(spin, sub(x[a], point))[i]);
        let exact = dot(spin, apply(&properties.inertia_about(point), spin));
        assert!(((v.transpose() * &m * &v).trace() / exact - 1.0).abs() < 1e-12, "{shape:?}");
    }
}

#[test]
fn moments_are_exact_on_straight_tetrahedra_and_the_first_on_curved_ones() {
    let mut random = Random::seeded(25);
    let shape = Shape::Tetrahedron10;
    for (x, tolerance) in [(distorted(shape, &mut random), 1e-13), (curved(shape, &mut random, 0.05), 5e-6)] {
        let ours = mass_properties(shape, &x, 1.0);
        let mut exact = MassProperties::default();
        for q in collapsed_gauss(8) {
            let (n, dm) = (shape.interpolation().shape(q.at), q.weight * gradients(shape, &x, q.at).1);
            let p: [f64; 3] = [0, 1, 2].map(|i| x.iter().zip(n).map(|(x, n)| n * x[i]).sum());
            exact += MassProperties {
                mass: dm,
                first_moment: p.map(|pi| dm * pi),
                second_moment: p.map(|pi| p.map(|pj| dm * pi * pj)),
            };
        }
        assert!((ours.mass / exact.mass - 1.0).abs() < 1e-13);
        for i in 0..3 {
            assert!((ours.first_moment[i] - exact.first_moment[i]).abs() < 1e-13 * exact.mass);
            for j in 0..3 {
                assert!((ours.second_moment[i][j] - exact.second_moment[i][j]).abs() < tolerance * exact.mass);
            }
        }
    }
}

#[test]
fn inertia_about_the_centre_does_not_depend_on_where_the_element_stands() {
    let near = curved(Shape::Hexahedron20, &mut Random::seeded(27), 0.05);
    let far: Vec<[f64; 3]> = near.iter().map(|p| [p[0] + 10.0, p[1] - 20.0, p[2] + 30.0]).collect();
    let inertia = |x: &[[f64; 3]]| {
        let properties = mass_properties(Shape::Hexahedron20, x, 1.0);
        properties.inertia_about(properties.centre())
    };
    let (near, far) = (inertia(&near), inertia(&far));
    (0..3).for_each(|i| assert!((near[i][i] / far[i][i] - 1.0).abs() < 1e-10));
}

#[test]
fn turned_elements_and_midsides_pulled_through_are_inverted() {
    for shape in Shape::ALL {
        let mut x = shape.interpolation().nodes().to_vec();
        assert!(!is_inverted(shape, &x));
        x.iter_mut().for_each(|x| x[0] = -x[0]);
        assert!(is_inverted(shape, &x), "{shape:?}");
        x.iter_mut().for_each(|x| x[0] = -x[0]);
        x[0][1] = f64::NAN;
        assert!(is_inverted(shape, &x), "a coordinate that is not a number is not taken for a good element");
    }
    let mut x = Shape::Tetrahedron10.interpolation().nodes().to_vec();
    x[4] = [0.2, 0.0, 0.0];
    assert!(is_inverted(Shape::Tetrahedron10, &x));
    x[4] = [0.4, 0.0, 0.0];
    assert!(!is_inverted(Shape::Tetrahedron10, &x));
}
