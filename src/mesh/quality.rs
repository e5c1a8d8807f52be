//! How well shaped the elements are, part by part.

#![allow(non_snake_case)] // symbols of the formulas

use super::Mesh;
use super::jacobian;
use nalgebra::Matrix3;

/// Shape of a part's tetrahedra.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Name of the part.
    pub part: String,
    /// Number of its tetrahedra.
    pub n_tets: usize,
    /// Smallest scaled Jacobian ([`scaled_jacobian`]).
    pub min: f64,
    /// Median scaled Jacobian.
    pub median: f64,
    /// Smallest ratio of a tetrahedron's least to its greatest `det J`: 1 with straight edges, towards 0 as midsides stray.
    pub min_ratio: f64,
    /// The tetrahedron with the smallest scaled Jacobian (index into the mesh's).
    pub worst: u32,
}

/// Quality of each part, in the order of the mesh's parts; parts without tetrahedra are left out.
pub fn quality(mesh: &Mesh) -> Vec<Quality> {
    let mut by_part: Vec<Vec<(f64, f64, u32)>> = vec![Vec::new(); mesh.parts.len()];
    for (tet, &part) in mesh.tet_part.iter().enumerate() {
        let x = mesh.tet_nodes(tet);
        by_part[part as usize].push((scaled_jacobian(&x), ratio(&x), tet as u32));
    }
    let parts = by_part.into_iter().enumerate().filter(|(_, tets)| !tets.is_empty());
    parts.map(|(part, tets)| summary(mesh, part, tets)).collect()
}

fn summary(mesh: &Mesh, part: usize, mut tets: Vec<(f64, f64, u32)>) -> Quality {
    tets.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    Quality {
        part: mesh.parts[part].clone(),
        n_tets: tets.len(),
        min: tets[0].0,
        median: tets[tets.len() / 2].0,
        min_ratio: tets.iter().map(|tet| tet.1).fold(f64::INFINITY, f64::min),
        worst: tets[0].2,
    }
}

/// The scaled Jacobian: over the corners, the least of `sqrt 2 det J / (|t_1| |t_2| |t_3|)`.
///
/// t_1, t_2, t_3 are the tangents of the (curved) edges at the corner, whose determinant is `det J` too. 1 for a regular tetrahedron,
/// towards 0 as it flattens, negative where it is inverted.
pub fn scaled_jacobian(x: &[[f64; 3]; 10]) -> f64 {
    let corners = jacobian::at_corners(x);
    let scaled = corners.iter().enumerate().map(|(i, J)| {
        let lengths: f64 = (0..4).filter(|&k| k != i).map(|k| tangent_length(J, i, k)).product();
        2.0_f64.sqrt() * J.determinant() / lengths
    });
    scaled.fold(f64::INFINITY, f64::min)
}

/// `|dx/dL_k - dx/dL_i|`, from the Jacobian's columns `dx/dL_k - dx/dL_0`.
fn tangent_length(J: &Matrix3<f64>, i: usize, k: usize) -> f64 {
    match (i, k) {
        (0, k) => J.column(k - 1).norm(),
        (i, 0) => J.column(i - 1).norm(),
        (i, k) => (J.column(k - 1) - J.column(i - 1)).norm(),
    }
}

/// Least over greatest `det J` at nodes and quadrature points.
fn ratio(x: &[[f64; 3]; 10]) -> f64 {
    let determinants = jacobian::determinants(x);
    let least = determinants.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = determinants.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    least / greatest
}

#[cfg(test)]
mod tests {
    use super::super::jacobian::straight;
    use super::*;

    const REGULAR: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];

    #[test]
    fn a_regular_tetrahedron_scores_one_and_a_corner_of_a_cube_less() {
        assert!((scaled_jacobian(&straight(REGULAR)) - 1.0).abs() < 1e-14);
        let cube = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        // At the corners of the slanted face: sqrt 2 / (1 * sqrt 2 * sqrt 2).
        assert!((scaled_jacobian(&straight(cube)) - 0.5_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn flat_and_inverted_elements_score_nothing_and_less() {
        let mut corners = REGULAR;
        corners.swap(0, 1);
        assert!((scaled_jacobian(&straight(corners)) + 1.0).abs() < 1e-14);
        let flat = REGULAR.map(|[x, y, z]| [x, y, 1e-6 * z]);
        assert!(scaled_jacobian(&straight(flat)) < 1e-5);
    }

    #[test]
    fn parts_are_summed_up_apart() {
        let cube = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut bent = straight(cube);
        bent[4][0] = 0.45;
        let nodes = [straight(REGULAR), bent].concat();
        let tets = vec![std::array::from_fn(|i| i as u32), std::array::from_fn(|i| i as u32 + 10)];
        let parts = vec!["a".to_owned(), "b".to_owned()];
        let mesh = Mesh { nodes, tets, tet_part: vec![1, 0], parts, ..Mesh::default() };
        let [a, b] = &quality(&mesh)[..] else { panic!("two parts") };
        assert_eq!((a.part.as_str(), a.n_tets, a.worst), ("a", 1, 1));
        assert!(a.min_ratio < 0.9 && (b.min_ratio - 1.0).abs() < 1e-14);
        assert!((b.min - 1.0).abs() < 1e-14 && b.min == b.median);
    }
}
