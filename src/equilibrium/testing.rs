//! Small structures with contact for the tests of equilibrium and stability: blocks on springs, each pressed on a belt.

use nalgebra::DMatrix;

use crate::assembly::{Connectivity, ElementMatrices, Elements, System};
use crate::contact::{
    ContactPair, ContactPoint, FrictionLaw, GapOperator, Interface, PointLaw, Statistics, Tangential, TangentialKind,
};
use crate::mesh::Numbering;
use crate::model::NormalLaw;
use crate::native::{Comm, Mck};

/// Contact stiffness of a block, N/m.
pub const CONTACT: f64 = 400.0;

/// One element on all nodes.
struct Whole {
    nodes: Vec<u32>,
    matrices: Mck<DMatrix<f64>>,
}

impl Connectivity for Whole {
    fn len(&self) -> usize {
        1
    }
    fn nodes(&self, _: usize) -> &[u32] {
        &self.nodes
    }
}

impl Elements for Whole {
    fn has_structural_damping(&self) -> bool {
        self.matrices.g.is_some()
    }

    fn matrices(&self, _: usize, out: &mut ElementMatrices) {
        let [m, c, k] = self.matrices.as_ref().map(|a| a.transpose().as_slice().to_vec()).into_array();
        let g = self.matrices.g.as_ref().map_or_else(Vec::new, |g| g.transpose().as_slice().to_vec());
        *out = ElementMatrices { k, m, c, g };
    }
}

/// A system of nodes with three dofs each on dense matrices.
pub fn system(comm: &Comm, matrices: Mck<DMatrix<f64>>, points: &GapOperator, loads: &[(u32, [f64; 3])]) -> System {
    let n = matrices.m.nrows() / 3;
    let whole = Whole { nodes: (0..n as u32).collect(), matrices };
    let (nodes, held) = (Numbering::even(n, 0, 1), vec![[false; 3]; n]);
    let mut system = System::assemble(comm, &nodes, &held, &[&whole], &[points]).unwrap();
    system.add_load(loads).unwrap();
    system
}

/// `n` blocks of unit mass. Springs hold block i in x, y and z and couple x with z; the belt moves along x, and closed
/// contact adds `[[0, mu k], [0, k]]` in x and z, so that friction couples two modes of each block. Neighbours are
/// coupled weakly.
pub fn blocks(n: usize) -> Mck<DMatrix<f64>> {
    let mut k = DMatrix::zeros(3 * n, 3 * n);
    for i in 0..n {
        let at = |axis: usize| (3 * i + axis, 3 * i + axis);
        let stiffer = 1.0 + 0.3 * i as f64;
        k[at(0)] += 700.0 * stiffer;
        k[at(1)] += 5000.0 * stiffer;
        k[at(2)] += 300.0 * stiffer;
        k[(3 * i, 3 * i + 2)] -= 150.0;
        k[(3 * i + 2, 3 * i)] -= 150.0;
        for axis in (0..3).filter(|_| i > 0) {
            let (a, b) = (3 * i + axis, 3 * (i - 1) + axis);
            k[(a, a)] += 20.0;
            k[(b, b)] += 20.0;
            k[(a, b)] -= 20.0;
            k[(b, a)] -= 20.0;
        }
    }
    let m = DMatrix::identity(3 * n, 3 * n);
    Mck { c: 0.02 * &m + 1e-5 * &k, m, k, g: None }
}

/// The belt under the blocks: one point each against the ground, normal z, sliding along x.
pub fn belt(n: usize, tangential: Tangential) -> Interface {
    let mut interface = Interface::default();
    let eye = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for i in 0..n {
        interface.gap_operator.push(&[i as u32], &[eye]);
        let law = PointLaw {
            weight: 1.0,
            normal: [0.0, 0.0, 1.0],
            gap: 0.0,
            correction: 0.0,
            wear: 0.0,
            touching: true,
            separation: true,
            normal_law: NormalLaw::Linear { stiffness: CONTACT },
            tangential,
        };
        interface.points.push(ContactPoint {
            pair: 0,
            places: vec![],
            nodes: vec![i as u32],
            position: [0.0; 3],
            field_gap: 0.0,
            law,
        });
    }
    interface.pairs.push(ContactPair {
        name: "belt".into(),
        slave: "blocks".into(),
        master: "belt".into(),
        law: NormalLaw::Linear { stiffness: CONTACT },
        friction: 0.3,
        friction_law: FrictionLaw::Constant,
        kind: match tangential {
            Tangential::StickSlip { .. } => TangentialKind::StickSlip,
            _ => TangentialKind::Sliding,
        },
        separation: true,
        swept: true,
        wear: None,
        points: 0..n,
        statistics: Statistics::default(),
    });
    interface
}

/// Sliding along x.
pub const ALONG_X: Tangential = Tangential::Sliding { direction: [1.0, 0.0, 0.0], speed: 2.0 };

/// Blocks on a belt under loads: the first `n_open` are pulled off, all others pressed on.
pub fn blocks_on_belt(comm: &Comm, n: usize, n_open: usize, tangential: Tangential) -> (System, Interface) {
    let interface = belt(n, tangential);
    let force = |i: usize| [0.0, 0.0, if i < n_open { 5.0 } else { -10.0 }];
    let loads: Vec<(u32, [f64; 3])> = (0..n).map(|i| (i as u32, force(i))).collect();
    (system(comm, blocks(n), &interface.gap_operator, &loads), interface)
}
