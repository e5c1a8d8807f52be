//! The assembled system: M, C, K and the numbering of its equations.

use super::{BlockRows, DofMap, Pattern};
use crate::Result;
use crate::contact::Trace;
use crate::petsc::{Comm, Gather, Matrix, Vector, partition};

/// Anything that couples lists of nodes.
pub trait Connectivity {
    /// Number of members.
    fn len(&self) -> usize;
    /// Whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The nodes of member `e`.
    fn nodes(&self, e: usize) -> &[u32];
}

/// A family of elements: members with nodes and dense matrices.
pub trait Elements: Connectivity {
    /// Overwrites `out` with member e's matrices. Rows are node-major: three displacements a node.
    fn matrices(&self, e: usize, out: &mut ElementMatrices);
}

/// Dense row-major `(3n)^2` matrices of one element.
#[derive(Debug, Clone, Default)]
pub struct ElementMatrices {
    /// Stiffness, N/m.
    pub k: Vec<f64>,
    /// Mass, kg.
    pub m: Vec<f64>,
    /// Damping, N s/m.
    pub c: Vec<f64>,
}

impl ElementMatrices {
    /// Room for n nodes, all zero.
    pub fn reset(&mut self, n_nodes: usize) {
        let size = 9 * n_nodes * n_nodes;
        for matrix in [&mut self.k, &mut self.m, &mut self.c] {
            matrix.clear();
            matrix.resize(size, 0.0);
        }
    }
}

/// M, C and K of a structure without its contacts, on a pattern that has room for them.
pub struct System {
    /// Numbering of the equations.
    pub dofs: DofMap,
    /// Stiffness, N/m.
    pub k: Matrix,
    /// Mass, kg.
    pub m: Matrix,
    /// Damping, N s/m.
    pub c: Matrix,
    /// External forces, N.
    pub load: Vector,
}

impl System {
    /// Numbers the equations, then assembles M, C and K of all families. `held` says which displacements of each node are zero;
    /// `contacts` take part in the pattern only. Collective.
    ///
    /// # Errors
    /// METIS's and PETSc's.
    pub fn assemble(
        comm: &Comm,
        held: &[[bool; 3]],
        families: &[&dyn Elements],
        contacts: &[&dyn Connectivity],
    ) -> Result<System> {
        let mut couplings: Vec<&dyn Connectivity> = contacts.to_vec();
        couplings.extend(families.iter().map(|&f| f as &dyn Connectivity));
        let pattern = Pattern::new(held.len(), &couplings);
        let owner = match comm.size() {
            1 => vec![0; held.len()],
            size => {
                let (offsets, neighbours) = pattern.graph();
                partition(&offsets, &neighbours, size)?
            }
        };
        let dofs = DofMap::new(owner, held, comm.rank(), comm.size());
        let [k, m, c] = sum(comm, &pattern, &dofs, families)?;
        let load = Vector::zeros(comm, dofs.n_local())?;
        Ok(System { dofs, k, m, c, load })
    }

    /// Adds forces (N) at nodes to the load; those at held displacements go into the support.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_load(&mut self, forces: &[(u32, [f64; 3])]) -> Result<()> {
        let (owned, dofs) = (self.dofs.owned(), &self.dofs);
        self.load.local_mut(|load| {
            for (node, force) in forces {
                for (equation, f) in dofs.equations(*node).into_iter().zip(force) {
                    if owned.contains(&equation) {
                        load[(equation - owned.start) as usize] += f;
                    }
                }
            }
        })
    }

    /// A vector of zeros in the system's layout.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zeros(&self) -> Result<Vector> {
        Vector::zeros(self.k.comm(), self.dofs.n_local())
    }

    /// All nodal values of several vectors, on every rank; zero where held. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn nodal(&self, vectors: &[&Vector]) -> Result<Vec<Vec<[f64; 3]>>> {
        let all: Vec<i32> = (0..self.dofs.n_global() as i32).collect();
        let mut gather = Gather::new(&self.load, &all)?;
        vectors.iter().map(|v| gather.run(v, |values| self.dofs.nodal(values))).collect()
    }
}

/// One pass over the elements that touch this rank's rows.
fn sum(comm: &Comm, pattern: &Pattern, dofs: &DofMap, families: &[&dyn Elements]) -> Result<[Matrix; 3]> {
    let mut sums = BlockRows::<3>::new(pattern, dofs);
    let mut element = ElementMatrices::default();
    for family in families {
        for e in 0..family.len() {
            let nodes = family.nodes(e);
            if nodes.iter().any(|&n| dofs.owns(n)) {
                family.matrices(e, &mut element);
                sums.add(dofs, nodes, [&element.k, &element.m, &element.c]);
            }
        }
    }
    let csr = sums.csr(dofs);
    let matrix = |values: &[f64]| Matrix::from_csr(comm, &csr.offsets, &csr.columns, values);
    let [k, m, c] = &csr.values;
    Ok([matrix(k)?, matrix(m)?, matrix(c)?])
}

/// Contact points couple the nodes that their relative displacement depends on.
impl Connectivity for Trace {
    fn len(&self) -> usize {
        Trace::len(self)
    }

    fn nodes(&self, a: usize) -> &[u32] {
        self.point(a).0
    }
}
