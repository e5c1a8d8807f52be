//! What holds each body: rigid motions that no support, connector or contact resists.
//!
//! Every body of parts that share nodes has six rigid motions `q` about its centroid, rotations scaled by its size. Each
//! support, connector and closed contact point is a linear functional of them, `s = R q`; motions with `R q = 0` are free.
//! They are the null space of the Gram matrix `R^T R`.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::algebra::cross;
use crate::assembly::Link;
use crate::contact::interface::Interface;
use crate::contact::law::Tangential;
use crate::mesh::Mesh;

/// A motion that nothing resists.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotion {
    /// Parts of the body that moves most.
    pub parts: Vec<String>,
    /// Translation of its centroid, relative to the largest motion.
    pub translation: [f64; 3],
    /// Rotation times the body's size, relative to the largest motion.
    pub rotation: [f64; 3],
}

/// Eigenvalues of the Gram matrix below this fraction of the largest count as zero.
const FREE: f64 = 1e-10;

/// Bodies: parts that share nodes move together.
struct Bodies {
    /// Body of each node.
    of_node: Vec<usize>,
    /// Names of the parts of each body.
    parts: Vec<Vec<String>>,
    centroid: Vec<[f64; 3]>,
    size: Vec<f64>,
}

impl Bodies {
    fn new(mesh: &Mesh) -> Bodies {
        let mut root: Vec<usize> = (0..mesh.parts.len()).collect();
        let mut part_of = vec![usize::MAX; mesh.nodes.len()];
        for (tet, &part) in mesh.tets.iter().zip(&mesh.tet_part) {
            for &n in tet {
                let known = std::mem::replace(&mut part_of[n as usize], part as usize);
                if known != usize::MAX {
                    join(&mut root, known, part as usize);
                }
            }
        }
        let roots: Vec<usize> = (0..root.len()).map(|p| find(&root, p)).collect();
        let mut distinct = roots.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let body = |part: usize| distinct.binary_search(&roots[part]).expect("every root is listed");
        let of_node: Vec<usize> = part_of.iter().map(|&p| body(p)).collect();
        let mut parts = vec![Vec::new(); distinct.len()];
        (0..mesh.parts.len()).for_each(|p| parts[body(p)].push(mesh.parts[p].clone()));
        let (centroid, size) = extents(mesh, &of_node, distinct.len());
        Bodies { of_node, parts, centroid, size }
    }

    /// Adds the row of the functional `sum_n v_n . u_n` to `row`.
    fn accumulate(&self, row: &mut [f64], mesh: &Mesh, node: u32, v: [f64; 3]) {
        let body = self.of_node[node as usize];
        let x = mesh.nodes[node as usize];
        let r = [0, 1, 2].map(|i| (x[i] - self.centroid[body][i]) / self.size[body]);
        // u = a + b x r, so that v.u = v.a + (r x v).b
        let moment = cross(r, v);
        for i in 0..3 {
            row[6 * body + i] += v[i];
            row[6 * body + 3 + i] += moment[i];
        }
    }
}

fn find(root: &[usize], mut part: usize) -> usize {
    while root[part] != part {
        part = root[part];
    }
    part
}

fn join(root: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b)] = a.min(b);
}

fn extents(mesh: &Mesh, of_node: &[usize], n: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
    let (mut sum, mut count, mut square) = (vec![[0.0; 3]; n], vec![0.0; n], vec![0.0; n]);
    for (x, &body) in mesh.nodes.iter().zip(of_node) {
        (0..3).for_each(|i| sum[body][i] += x[i]);
        count[body] += 1.0;
    }
    let centroid: Vec<[f64; 3]> = sum.iter().zip(&count).map(|(s, n)| s.map(|s| s / n)).collect();
    for (x, &body) in mesh.nodes.iter().zip(of_node) {
        square[body] += (0..3).map(|i| (x[i] - centroid[body][i]).powi(2)).sum::<f64>();
    }
    (centroid, square.iter().zip(&count).map(|(s, n)| (s / n).sqrt()).collect())
}

/// The free motions of a model; none where every body is held. `held` says which displacements are zero.
pub fn free_motions(mesh: &Mesh, interface: &Interface, held: &[[bool; 3]], links: &[Link]) -> Vec<FreeMotion> {
    let bodies = Bodies::new(mesh);
    let width = 6 * bodies.parts.len();
    let mut gram = DMatrix::<f64>::zeros(width, width);
    let mut row = vec![0.0; width];
    let mut resist = |fill: &mut dyn FnMut(&mut [f64])| {
        row.fill(0.0);
        fill(&mut row);
        for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            for (j, b) in row.iter().enumerate() {
                gram[(i, j)] += a * b;
            }
        }
    };
    for (node, held) in held.iter().enumerate() {
        for i in (0..3).filter(|&i| held[i]) {
            resist(&mut |row| bodies.accumulate(row, mesh, node as u32, unit(i)));
        }
    }
    for a in 0..interface.points.len() {
        for direction in resisted_directions(interface, a) {
            resist(&mut |row| {
                interface.trace.spread(a, direction, |node, v| bodies.accumulate(row, mesh, node, v));
            });
        }
    }
    for link in links {
        for (values, _) in link.motion.rows.iter().zip(link.stiffness).filter(|(_, k)| *k > 0.0) {
            resist(&mut |row| {
                for (&node, v) in link.nodes.iter().zip(values.chunks_exact(3)) {
                    bodies.accumulate(row, mesh, node, [v[0], v[1], v[2]]);
                }
            });
        }
    }
    null_space(gram, &bodies)
}

fn unit(i: usize) -> [f64; 3] {
    std::array::from_fn(|j| f64::from(u8::from(i == j)))
}

/// The normal of a closed point, and the tangents where it sticks.
fn resisted_directions(interface: &Interface, a: usize) -> Vec<[f64; 3]> {
    let point = &interface.points[a].law;
    if point.separation && !point.touching {
        return Vec::new();
    }
    match point.tangential {
        Tangential::StickSlip { .. } => (0..3).map(unit).collect(),
        _ => vec![point.normal],
    }
}

fn null_space(gram: DMatrix<f64>, bodies: &Bodies) -> Vec<FreeMotion> {
    let eigen = SymmetricEigen::new(gram);
    let largest = eigen.eigenvalues.max();
    let free = (0..eigen.eigenvalues.len()).filter(|&i| eigen.eigenvalues[i] <= FREE * largest);
    free.map(|i| describe(eigen.eigenvectors.column(i).as_slice(), bodies)).collect()
}

fn describe(q: &[f64], bodies: &Bodies) -> FreeMotion {
    let norm = |body: usize| q[6 * body..6 * body + 6].iter().map(|x| x * x).sum::<f64>();
    let body = (0..bodies.parts.len()).max_by(|&a, &b| norm(a).total_cmp(&norm(b))).expect("a mesh has a part");
    let own = &q[6 * body..6 * body + 6];
    let largest = own.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let scaled = |i: usize| own[i] / largest;
    FreeMotion {
        parts: bodies.parts[body].clone(),
        translation: [scaled(0), scaled(1), scaled(2)],
        rotation: [scaled(3), scaled(4), scaled(5)],
    }
}

impl std::fmt::Display for FreeMotion {
    /// `backplate_inner + lining_inner moves along x, turns about z`
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        const NOTICEABLE: f64 = 0.1;
        let axes = |v: [f64; 3]| -> Vec<&str> {
            ["x", "y", "z"].into_iter().zip(v).filter(|(_, c)| c.abs() > NOTICEABLE).map(|(name, _)| name).collect()
        };
        let (moves, turns) = (axes(self.translation), axes(self.rotation));
        let mut words = Vec::new();
        if !moves.is_empty() {
            words.push(format!("moves along {}", moves.join(", ")));
        }
        if !turns.is_empty() {
            words.push(format!("turns about {}", turns.join(", ")));
        }
        write!(f, "{} {}", self.parts.join(" + "), words.join(" and "))
    }
}
