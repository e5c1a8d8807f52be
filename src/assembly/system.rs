//! The assembled system: M, C, K, G and the numbering of its dofs.

use std::borrow::Cow;
use std::time::Instant;

use super::axes::AxisSum;
use super::scatter::{Places, Scatter};
use super::{DofMap, Pattern};
use crate::Result;
use crate::mesh::Numbering;
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::native::{Comm, Gather, Matrix, Mck, Vector};

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
    /// Whether a mass matrix of the family couples displacements along different axes, and so has `(3n)^2` entries.
    fn mass_couples_axes(&self) -> bool {
        true
    }
    /// Whether a member may have structural damping: the same on all ranks.
    fn has_structural_damping(&self) -> bool {
        false
    }
    /// The viscoelastic laws of the members: the same on all ranks.
    fn viscoelastic_laws(&self) -> &[ViscoelasticLaw] {
        &[]
    }
    /// Which of the laws multiplies the stiffness of member `e`; none where that does not depend on the frequency.
    fn law_of(&self, _e: usize) -> Option<usize> {
        None
    }
    /// Whether the damping of a member may have a skew part: the same on all ranks.
    fn is_gyroscopic(&self) -> bool {
        false
    }
    /// Overwrites `out` with member e's matrices. Rows are node-major: three displacements a node.
    fn matrices(&self, e: usize, out: &mut ElementMatrices);
}

/// Dense row-major matrices of one element with n nodes.
#[derive(Debug, Clone, Default)]
pub struct ElementMatrices {
    /// Stiffness, N/m: `(3n)^2` entries.
    pub k: Vec<f64>,
    /// Mass, kg: `(3n)^2` entries, or `n^2` where it is the same on each axis and couples none, or no entries.
    pub m: Vec<f64>,
    /// Damping, N s/m: `(3n)^2` entries, or none.
    pub c: Vec<f64>,
    /// Structural damping, N/m, the imaginary part of the stiffness: `(3n)^2` entries, or none.
    pub g: Vec<f64>,
}

impl ElementMatrices {
    /// The mass with `(3n)^2` entries, or none: `m_ab delta_ij` at (3a + i, 3b + j) where it is the same on each axis.
    pub fn mass_on_all_axes(&self) -> Cow<'_, [f64]> {
        if self.m.len() == self.k.len() || self.m.is_empty() {
            return Cow::Borrowed(&self.m);
        }
        let n = self.m.len().isqrt();
        let entry = |at: usize| {
            let [row, column] = [at / (3 * n), at % (3 * n)];
            if row % 3 == column % 3 { self.m[n * (row / 3) + column / 3] } else { 0.0 }
        };
        Cow::Owned((0..9 * n * n).map(entry).collect())
    }
}

/// The stiffness of all elements of a viscoelastic material: at rest it is in K, at the eigenvalue s it is `r(s)` times
/// that.
pub struct ViscoelasticStiffness {
    /// r.
    pub law: ViscoelasticLaw,
    /// At rest, N/m, on the pattern of K.
    pub stiffness: Matrix,
}

/// M, C, K and G of a structure without its contacts, on a pattern that has room for them.
pub struct System {
    /// Numbers of the free dofs.
    pub dofs: DofMap,
    /// Stiffness, N/m.
    pub k: Matrix,
    /// Mass, kg.
    pub m: Matrix,
    /// Damping, N s/m, and gyroscopic terms where a part has the inertia of its rotation.
    pub c: Matrix,
    /// Whether C has gyroscopic terms, and so is not symmetric.
    pub is_gyroscopic: bool,
    /// Structural damping, N/m: `sum g_e K_e` of stiffnesses with loss factors `g_e`; none where all of these are 0.
    pub g: Option<Matrix>,
    /// What of K depends on the frequency: a matrix for each viscoelastic law.
    pub viscoelastic: Vec<ViscoelasticStiffness>,
    /// External forces, N.
    pub load: Vector,
    /// Those of them that no load factor multiplies, N.
    pub constant_load: Vector,
    /// What it took to find which entries there are, s; the rest went into their values.
    pub pattern_seconds: f64,
}

impl System {
    /// Numbers the free dofs, then assembles M, C, K and G of all families. `constrained` says which displacements of
    /// each node are zero; `contacts` take part in the pattern only. Collective.
    ///
    /// ```no_run
    /// use squeal::Session;
    /// use squeal::assembly::System;
    /// use squeal::structure::FullModel;
    ///
    /// let comm = Session::start(&[])?;
    /// let brake = FullModel::read(&comm, "brake.toml".as_ref())?;
    /// let families = brake.families()?;
    /// let contacts = &brake.interface.gap_operator;
    /// let system = System::assemble(&comm, &brake.nodes, &brake.held, &families.list(), &[contacts])?;
    /// println!("{} dofs", system.dofs.n_global());
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// PETSc's.
    pub fn assemble(
        comm: &Comm,
        nodes: &Numbering,
        constrained: &[[bool; 3]],
        families: &[&dyn Elements],
        contacts: &[&dyn Connectivity],
    ) -> Result<System> {
        let mut couplings: Vec<&dyn Connectivity> = contacts.to_vec();
        couplings.extend(families.iter().map(|&f| f as &dyn Connectivity));
        let start = Instant::now();
        let pattern = Pattern::new(nodes, &couplings);
        let dofs = DofMap::new(nodes, constrained);
        let (scatter, rows) = Scatter::new(&pattern, &dofs);
        let k = Matrix::zeros(comm, rows)?;
        let mass = match families.iter().any(|family| family.mass_couples_axes()) {
            true => None,
            false => Some(AxisSum::new(&pattern, &dofs)),
        };
        let m = mass.as_ref().map_or_else(|| k.zeros_like(), |mass| Matrix::zeros(comm, mass.rows()))?;
        let (c, pattern_seconds) = (k.zeros_like()?, start.elapsed().as_secs_f64());
        let [k, m, c] = sum([k, m, c], mass, &scatter, families)?;
        let g = structural_damping(&k, &scatter, families)?;
        let viscoelastic = viscoelastic(&k, &scatter, families)?;
        let [load, constant_load] = [Vector::zeros(comm, dofs.n_local())?, Vector::zeros(comm, dofs.n_local())?];
        let is_gyroscopic = families.iter().any(|family| family.is_gyroscopic());
        Ok(System { dofs, k, m, c, is_gyroscopic, g, viscoelastic, load, constant_load, pattern_seconds })
    }

    /// M, C, K and G.
    pub fn matrices(&self) -> Mck<&Matrix> {
        Mck { m: &self.m, c: &self.c, k: &self.k, g: self.g.as_ref() }
    }

    /// A vector of zeros in the system's layout.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zeros(&self) -> Result<Vector> {
        Vector::zeros(self.k.comm(), self.dofs.n_local())
    }

    /// Values of several vectors at the nodes that this rank has; zero where constrained. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn nodal(&self, vectors: &[&Vector]) -> Result<Vec<Vec<[f64; 3]>>> {
        let all: Vec<i32> = self.dofs.all().collect();
        let gather = Gather::new(&self.load, &all)?;
        vectors.iter().map(|v| gather.run(v, |values| self.dofs.nodal(values))).collect()
    }
}

/// The forces `K_e u_e` (N) of all elements of which a node is `chosen`, at each of their nodes.
pub fn element_forces(
    families: &[&dyn Elements],
    chosen: impl Fn(u32) -> bool,
    u: impl Fn(u32) -> [f64; 3],
    mut add: impl FnMut(u32, [f64; 3]),
) {
    let mut element = ElementMatrices::default();
    for family in families {
        for e in (0..family.len()).filter(|&e| family.nodes(e).iter().any(|&n| chosen(n))) {
            let nodes = family.nodes(e);
            family.matrices(e, &mut element);
            let values: Vec<f64> = nodes.iter().flat_map(|&n| u(n)).collect();
            let product = |row: &[f64]| row.iter().zip(&values).map(|(k, u)| k * u).sum::<f64>();
            let forces: Vec<f64> = element.k.chunks_exact(values.len()).map(product).collect();
            nodes.iter().zip(forces.as_chunks().0).for_each(|(&n, force)| add(n, *force));
        }
    }
}

/// K, M and C by one pass over the elements that touch this rank's rows; M by way of `mass` where it does not couple
/// axes.
fn sum(
    [mut k, mut m, mut c]: [Matrix; 3],
    mass: Option<AxisSum>,
    scatter: &Scatter,
    families: &[&dyn Elements],
) -> Result<[Matrix; 3]> {
    match mass {
        Some(mut mass) => {
            Matrix::change_values(&mut [&mut k, &mut c, &mut m], |values| {
                pass(scatter, families, |element, places| {
                    places.add(&element.k, &mut values[0]);
                    places.add(&element.c, &mut values[1]);
                    mass.add(places, &element.m);
                });
                mass.values_into(&mut values[2]);
            })?;
        }
        None => Matrix::change_values(&mut [&mut k, &mut c, &mut m], |values| {
            pass(scatter, families, |element, places| {
                places.add(&element.k, &mut values[0]);
                places.add(&element.c, &mut values[1]);
                places.add(&element.mass_on_all_axes(), &mut values[2]);
            });
        })?,
    }
    Ok([k, m, c])
}

/// `G`, on the pattern of K, by a pass of its own, which structures without loss factors do not take.
fn structural_damping(k: &Matrix, scatter: &Scatter, families: &[&dyn Elements]) -> Result<Option<Matrix>> {
    let damped: Vec<&dyn Elements> = families.iter().copied().filter(|own| own.has_structural_damping()).collect();
    if damped.is_empty() {
        return Ok(None);
    }
    let mut g = k.zeros_like()?;
    Matrix::change_values(&mut [&mut g], |values| {
        pass(scatter, &damped, |element, places| places.add(&element.g, &mut values[0]));
    })?;
    Ok(Some(g))
}

/// The stiffness at rest of each viscoelastic law, on the pattern of K, by a pass over its elements alone.
fn viscoelastic(k: &Matrix, scatter: &Scatter, families: &[&dyn Elements]) -> Result<Vec<ViscoelasticStiffness>> {
    let mut all = Vec::new();
    for family in families {
        for (i, law) in family.viscoelastic_laws().iter().enumerate() {
            let mut stiffness = k.zeros_like()?;
            Matrix::change_values(&mut [&mut stiffness], |values| {
                let is_member = |family: &dyn Elements, e: usize| family.law_of(e) == Some(i);
                pass_some(scatter, &[*family], is_member, |element, places| places.add(&element.k, &mut values[0]));
            })?;
            all.push(ViscoelasticStiffness { law: law.clone(), stiffness });
        }
    }
    Ok(all)
}

/// Visits the elements that touch this rank's rows.
fn pass(scatter: &Scatter, families: &[&dyn Elements], visit: impl FnMut(&ElementMatrices, &Places)) {
    pass_some(scatter, families, |_, _| true, visit);
}

/// Visits those of them that are wanted.
fn pass_some(
    scatter: &Scatter,
    families: &[&dyn Elements],
    is_wanted: impl Fn(&dyn Elements, usize) -> bool,
    mut visit: impl FnMut(&ElementMatrices, &Places),
) {
    let (mut element, mut places) = (ElementMatrices::default(), Places::default());
    for family in families {
        for e in (0..family.len()).filter(|&e| is_wanted(*family, e)) {
            let nodes = family.nodes(e);
            if nodes.iter().any(|&n| scatter.owns(n)) {
                family.matrices(e, &mut element);
                places.find(scatter, nodes);
                visit(&element, &places);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    /// Springs between neighbours of a chain of nodes, with one number for the mass or with a full matrix.
    struct Chain {
        nodes: Vec<[u32; 2]>,
        mass_couples_axes: bool,
        loss_factor: Option<f64>,
    }

    impl Connectivity for Chain {
        fn len(&self) -> usize {
            self.nodes.len()
        }
        fn nodes(&self, e: usize) -> &[u32] {
            &self.nodes[e]
        }
    }

    impl Elements for Chain {
        fn mass_couples_axes(&self) -> bool {
            self.mass_couples_axes
        }
        fn has_structural_damping(&self) -> bool {
            self.loss_factor.is_some()
        }
        fn matrices(&self, e: usize, out: &mut ElementMatrices) {
            out.k = (0..36).map(|at| (1 + e + at) as f64).collect();
            out.m = vec![2.0, 1.0, 1.0, 2.0];
            (out.c, out.g) = (Vec::new(), Vec::new());
            if let Some(loss_factor) = self.loss_factor {
                out.g = out.k.iter().map(|k| loss_factor * k).collect();
            }
            if self.mass_couples_axes {
                out.m = out.mass_on_all_axes().into_owned();
            }
        }
    }

    /// A mass that comes as one number for all axes, or as a full matrix with the same entries, is the same.
    #[test]
    fn both_ways_of_the_mass_agree() {
        let comm = Session::start(&[]).unwrap();
        let mut constrained = [[false; 3]; 4];
        constrained[1] = [false, true, false];
        let product = |mass_couples_axes: bool| {
            let chain = Chain { nodes: vec![[2, 0], [0, 1], [1, 3]], mass_couples_axes, loss_factor: None };
            let system = System::assemble(&comm, &Numbering::even(4, 0, 1), &constrained, &[&chain], &[]).unwrap();
            let x: Vec<f64> = (0..11).map(f64::from).collect();
            let (x, mut y) = (Vector::from_local(&comm, &x).unwrap(), system.zeros().unwrap());
            system.m.multiply(&x, &mut y).unwrap();
            (y.to_vec().unwrap(), system.m.n_entries().unwrap())
        };
        let (alone, n_alone) = product(false);
        let (coupled, n_coupled) = product(true);
        assert_eq!(alone, coupled);
        // Ten pairs of nodes with 2 or 3 free axes: one entry an axis that both have free, or one for each two axes.
        assert_eq!((n_alone, n_coupled), (25.0, 73.0));
        // The row of node 3, axis x: node 1's dof 3 and its own, 8.
        assert_eq!(alone[8], 3.0 + 2.0 * 8.0);
    }

    /// Families without loss factors add nothing, and nothing is assembled where no family has any.
    #[test]
    fn structural_damping_is_assembled_where_a_family_has_it() {
        let comm = Session::start(&[]).unwrap();
        let chain = |loss_factor: Option<f64>| Chain {
            nodes: vec![[2, 0], [0, 1], [1, 3]],
            mass_couples_axes: false,
            loss_factor,
        };
        let assemble = |families: &[&dyn Elements]| {
            System::assemble(&comm, &Numbering::even(4, 0, 1), &[[false; 3]; 4], families, &[]).unwrap()
        };
        let (plain, damped) = (chain(None), chain(Some(0.2)));
        assert!(assemble(&[&plain]).g.is_none());
        let (alone, both) = (assemble(&[&damped]), assemble(&[&plain, &damped]));
        for system in [&alone, &both] {
            let mut rest = system.g.as_ref().unwrap().duplicate().unwrap();
            rest.axpy(-0.2, &alone.k).unwrap();
            assert!(rest.norm_inf().unwrap() < 1e-12 * alone.k.norm_inf().unwrap());
        }
    }
}
