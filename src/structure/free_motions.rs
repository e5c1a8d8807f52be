//! Unconstrained bodies: rigid-body motions that no support, joint or contact resists.
//!
//! Every body of parts that share nodes has six rigid motions `q` about its centroid, rotations scaled by its size.
//! Each support, closed contact point and row of a joint is a linear functional of them, `s = R q`; motions with
//! `R q = 0` are free. They are the null space of the Gram matrix `R^T R`, in which every source (the supports of a
//! body along an axis, a contact pair, a joint) has the same say whatever its number of points and the model's unit of
//! length.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use pathfinding::undirected::connected_components::separate_components;

use crate::algebra::cross;
use crate::assembly::Joints;
use crate::contact::interface::Interface;
use crate::contact::law::Tangential;
use crate::mesh::{Mesh, Numbering};
use crate::native::Comm;

/// A motion that nothing resists.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotion {
    /// Parts of the body by which the motion is described.
    pub parts: Vec<String>,
    /// Translation of its centroid, relative to its largest motion.
    pub translation: [f64; 3],
    /// Rotation times the body's size, relative to its largest motion.
    pub rotation: [f64; 3],
    /// Parts of the other bodies that it takes along.
    pub others: Vec<Vec<String>>,
}

/// Eigenvalues of the Gram matrix below this fraction of the largest count as zero: a support that gives way by three
/// thousandths of the motion. A piston that spins in its bore is resisted by the facets of a coarse mesh with 1e-10 to
/// 1e-6, where supports give 1e-2 and more.
const FREE: f64 = 1e-5;

/// A component of a motion that messages name, relative to the largest.
const NOTICEABLE: f64 = 0.1;

/// Bodies: parts that share nodes move together.
pub(super) struct Bodies {
    /// Body of each node.
    pub of_node: Vec<usize>,
    /// Names of the parts of each body.
    parts: Vec<Vec<String>>,
    centroid: Vec<[f64; 3]>,
    size: Vec<f64>,
}

impl Bodies {
    /// The bodies of a mesh of which this rank has a piece. Collective.
    pub fn new(comm: &Comm, mesh: &Mesh, nodes: &Numbering) -> Bodies {
        let (part_of, meet) = parts_of_nodes(comm, mesh);
        let n_parts = mesh.parts.len();
        let body = bodies_of_parts(n_parts, |a, b| meet[n_parts * a + b] > 0);
        let of_node: Vec<usize> = part_of.iter().map(|&p| body[p]).collect();
        let mut parts = vec![Vec::new(); body.iter().max().map_or(0, |last| last + 1)];
        body.iter().zip(&mesh.parts).for_each(|(&body, name)| parts[body].push(name.clone()));
        let own = nodes.owned().map(|n| (mesh.nodes[n as usize], of_node[n as usize]));
        let (centroid, size) = extents(comm, own, parts.len());
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

/// The body of each part, where parts that meet are one; bodies are numbered by their first parts.
fn bodies_of_parts(n_parts: usize, meet: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let together = |a: usize| (0..n_parts).filter(|&b| a == b || meet(a, b)).collect();
    let groups: Vec<Vec<usize>> = (0..n_parts).map(together).collect();
    let (component_of, _) = separate_components(&groups);
    let mut bodies = Vec::new();
    let body = |part: usize| {
        let component = component_of[&part];
        bodies.iter().position(|known| *known == component).unwrap_or_else(|| {
            bodies.push(component);
            bodies.len() - 1
        })
    };
    (0..n_parts).map(body).collect()
}

/// A part of each node, and for each two parts a number above zero where they share nodes. Collective.
fn parts_of_nodes(comm: &Comm, mesh: &Mesh) -> (Vec<usize>, Vec<u8>) {
    let n_parts = mesh.parts.len();
    // 0 where no element of this rank has the node: nodes that have a name are on ranks without their elements.
    let (mut part_of, mut meet) = (vec![0_usize; mesh.nodes.len()], vec![0_u8; n_parts * n_parts]);
    for element in mesh.elements.iter() {
        let part = element.part as usize;
        for &n in element.nodes {
            let known = std::mem::replace(&mut part_of[n as usize], part + 1);
            if known > 0 {
                meet[n_parts * (known - 1) + part] = 1;
            }
        }
    }
    comm.max_all(&mut meet);
    let mut named: Vec<u32> = mesh.named_nodes().collect();
    named.sort_unstable();
    named.dedup();
    let mut parts: Vec<usize> = named.iter().map(|&n| part_of[n as usize]).collect();
    comm.max_all(&mut parts);
    named.iter().zip(parts).for_each(|(&n, part)| part_of[n as usize] = part);
    (part_of.into_iter().map(|part| part - 1).collect(), meet)
}

/// Centroid and radius of gyration of the nodes of n bodies; each rank adds the nodes that it owns. Collective.
fn extents(comm: &Comm, own: impl Iterator<Item = ([f64; 3], usize)> + Clone, n: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
    let mut sums = vec![[0.0; 4]; n];
    for (x, body) in own.clone() {
        (0..3).for_each(|i| sums[body][i] += x[i]);
        sums[body][3] += 1.0;
    }
    comm.sum_all(sums.as_flattened_mut());
    let centroid: Vec<[f64; 3]> = sums.iter().map(|&[x, y, z, n]| [x / n, y / n, z / n]).collect();
    let mut squares = vec![0.0; n];
    for (x, body) in own {
        squares[body] += (0..3).map(|i| (x[i] - centroid[body][i]).powi(2)).sum::<f64>();
    }
    comm.sum_all(&mut squares);
    (centroid, squares.iter().zip(&sums).map(|(square, sum)| (square / sum[3]).sqrt()).collect())
}

/// The free motions of a model; none where every body is held. `held` says which displacements are zero. Collective:
/// each rank has a piece of the mesh, with all nodes of contacts, supports and joints.
pub fn free_motions(
    comm: &Comm,
    mesh: &Mesh,
    nodes: &Numbering,
    interface: &Interface,
    held: &[[bool; 3]],
    joints: &Joints,
) -> Vec<FreeMotion> {
    let bodies = Bodies::new(comm, mesh, nodes);
    let width = 6 * bodies.parts.len();
    let mut resistance = Resistance { bodies: &bodies, mesh, gram: DMatrix::zeros(width, width) };
    resistance.add_supports(held);
    resistance.add_contacts(interface);
    resistance.add_joints(joints);
    null_space(resistance.gram, &bodies)
}

/// What resists the motions of the bodies.
struct Resistance<'a> {
    bodies: &'a Bodies,
    mesh: &'a Mesh,
    /// `sum_s weight_s R_s^T R_s`
    gram: DMatrix<f64>,
}

impl Resistance<'_> {
    /// Adds a functional `sum_n v_n . u_n`.
    fn add(&mut self, weight: f64, functional: &[(u32, [f64; 3])]) {
        let mut row = DVector::zeros(self.gram.nrows());
        functional.iter().for_each(|&(node, v)| self.bodies.accumulate(row.as_mut_slice(), self.mesh, node, v));
        self.gram.ger(weight, &row, &row, 1.0);
    }

    fn add_supports(&mut self, held: &[[bool; 3]]) {
        let body = |node: usize| self.bodies.of_node[node];
        let axes = |node: usize| (0..3).filter(move |&i| held[node][i]).map(move |i| (node, i));
        let supports: Vec<(usize, usize)> = (0..held.len()).flat_map(axes).collect();
        let mut n_held = vec![[0.0; 3]; self.bodies.parts.len()];
        supports.iter().for_each(|&(node, i)| n_held[body(node)][i] += 1.0);
        for (node, i) in supports {
            self.add(1.0 / n_held[self.bodies.of_node[node]][i], &[(node as u32, unit(i))]);
        }
    }

    fn add_contacts(&mut self, interface: &Interface) {
        for pair in &interface.pairs {
            for a in pair.points.clone() {
                for direction in resisted_directions(interface, a) {
                    let mut functional = Vec::new();
                    interface.gap_operator.spread(a, direction, |node, v| functional.push((node, v)));
                    self.add(1.0 / pair.points.len() as f64, &functional);
                }
            }
        }
    }

    fn add_joints(&mut self, joints: &Joints) {
        let n_elements = joints.n_elements();
        for element in &joints.elements {
            for (values, _) in element.rows.iter().zip(&element.stiffness).filter(|(_, k)| **k > 0.0) {
                // A rotation has the unit 1/m: taken times the size of the node set, it is a displacement as all
                // others are.
                let size = values.iter().map(|v| v.abs()).sum::<f64>();
                let at_nodes = element.nodes.iter().copied().zip(values.as_chunks().0.iter().copied());
                let weight = size.powi(-2) / n_elements[element.joint] as f64;
                self.add(weight, &at_nodes.collect::<Vec<_>>());
            }
        }
    }
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
    let mut basis: Vec<Vec<f64>> = free.map(|i| eigen.eigenvectors.column(i).as_slice().to_vec()).collect();
    let mut motions: Vec<(usize, &Vec<f64>)> = separate(&mut basis).into_iter().zip(&basis).collect();
    motions.sort_by_key(|(own, _)| *own);
    motions.iter().map(|(own, q)| describe(q, own / 6, bodies)).collect()
}

/// Combines the vectors of a basis so that each has a component of its own, which is 1 in it and 0 in all others:
/// "along x" and "along y" instead of two mixtures. Returns these components. Gauss-Jordan elimination, rotations
/// first, so that a body that turns about a point is said to turn.
fn separate(basis: &mut [Vec<f64>]) -> Vec<usize> {
    let width = basis.first().map_or(0, Vec::len);
    let rotations_first = (0..width).filter(|i| i % 6 >= 3).chain((0..width).filter(|i| i % 6 < 3));
    let order: Vec<usize> = rotations_first.collect();
    let mut own = Vec::new();
    for done in 0..basis.len() {
        let largest = |i: usize, basis: &[Vec<f64>]| {
            let rest = (done..basis.len()).map(|v| (basis[v][i].abs(), v));
            rest.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a vector is left")
        };
        let scale = order.iter().map(|&i| largest(i, basis).0).fold(0.0, f64::max);
        let is_clear = |i: &&usize| largest(**i, basis).0 > NOTICEABLE * scale;
        let pivot = *order.iter().find(is_clear).expect("the largest component is clear");
        basis.swap(done, largest(pivot, basis).1);
        let factor = basis[done][pivot].recip();
        basis[done].iter_mut().for_each(|q| *q *= factor);
        let row = basis[done].clone();
        for other in (0..basis.len()).filter(|&v| v != done) {
            let factor = basis[other][pivot];
            basis[other].iter_mut().zip(&row).for_each(|(q, r)| *q -= factor * r);
        }
        own.push(pivot);
    }
    own
}

/// Tells a motion by one body.
fn describe(q: &[f64], body: usize, bodies: &Bodies) -> FreeMotion {
    let size = |body: usize| q[6 * body..6 * body + 6].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let own = &q[6 * body..6 * body + 6];
    let scaled = |i: usize| own[i] / size(body);
    let moved = (0..bodies.parts.len()).filter(|&other| other != body && size(other) > NOTICEABLE * size(body));
    FreeMotion {
        parts: bodies.parts[body].clone(),
        translation: [scaled(0), scaled(1), scaled(2)],
        rotation: [scaled(3), scaled(4), scaled(5)],
        others: moved.map(|other| bodies.parts[other].clone()).collect(),
    }
}

impl std::fmt::Display for FreeMotion {
    /// `backplate_inner + lining_inner moves along x and turns about z`
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
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
        write!(f, "{} {}", self.parts.join(" + "), words.join(" and "))?;
        match self.others[..] {
            [] => Ok(()),
            _ => write!(
                f,
                ", together with {}",
                self.others.iter().map(|parts| parts.join(" + ")).collect::<Vec<_>>().join(", ")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_that_meet_are_one_body() {
        let met = [(3, 1), (4, 3), (2, 2)];
        assert_eq!(bodies_of_parts(5, |a, b| met.contains(&(a, b))), [0, 1, 2, 1, 1]);
        assert_eq!(bodies_of_parts(3, |_, _| false), [0, 1, 2]);
    }
}
