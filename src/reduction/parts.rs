//! The parts of a brake in the coordinates of a super-element, so that energies and damping have their places.
//!
//! ```text
//! M = sum_p M_p + M_rest        K = sum_p K_p + K_rest        M_p = V^T M_part V,  K_p = V^T K_part V
//! C = sum_p (alpha_p M_p + beta_p K_p) + C_rest               G = sum_p g_p K_p + G_rest
//! ```
//!
//! where K_p of a viscoelastic material is that at rest.
//! The rest is what joints add, and contacts that were linearised. A part has exactly the share of an energy that it
//! has in the full space at `u = V q`.

use nalgebra::DMatrix;

use crate::Result;
use crate::assembly::{Elements, System};
use crate::mesh::Numbering;
use crate::model::Rayleigh;
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::native::{Block, Matrix, Mck};

use super::projection::PANEL;
use super::super_element::ViscoelasticTerm;

/// What a part adds to the matrices of a super-element.
#[derive(Debug, Clone, PartialEq)]
pub struct PartMatrices {
    /// The part's name.
    pub name: String,
    /// `V^T M_part V`, column-major, kg.
    pub mass: Vec<f64>,
    /// `V^T K_part V`, N/m, at rest.
    pub stiffness: Vec<f64>,
    /// Its Rayleigh damping.
    pub rayleigh: Rayleigh,
    /// Loss factor of its material.
    pub loss_factor: f64,
    /// The viscoelastic law of its material, where there is one.
    pub law: Option<ViscoelasticLaw>,
}

/// The matrices of a super-element by where they come from.
pub struct MatricesByPart {
    /// Of the parts.
    pub parts: Vec<PartMatrices>,
    /// Of everything else, by rows.
    pub rest: Mck<Vec<f64>>,
    /// What that is.
    pub rest_name: String,
}

impl MatricesByPart {
    /// Whether anything is in no part.
    pub fn has_rest(&self) -> bool {
        let Mck { m, c, k, g } = &self.rest;
        [m, c, k].into_iter().chain(g).flatten().any(|entry| *entry != 0.0)
    }

    /// The sums over all parts and the rest.
    pub fn total(&self) -> Mck<Vec<f64>> {
        let mut total = self.rest.clone();
        for part in &self.parts {
            let Rayleigh { alpha, beta } = part.rayleigh;
            add(&mut total.m, 1.0, &part.mass);
            add(&mut total.k, 1.0, &part.stiffness);
            add(&mut total.c, alpha, &part.mass);
            add(&mut total.c, beta, &part.stiffness);
            if part.loss_factor != 0.0 {
                let n = part.stiffness.len();
                add(total.g.get_or_insert_with(|| vec![0.0; n]), part.loss_factor, &part.stiffness);
            }
        }
        total
    }

    /// The stiffness of each viscoelastic law: the sum over the parts that have it.
    pub fn viscoelastic(&self) -> Vec<ViscoelasticTerm> {
        let mut terms: Vec<ViscoelasticTerm> = Vec::new();
        for (part, law) in self.parts.iter().filter_map(|part| Some((part, part.law.as_ref()?))) {
            match terms.iter_mut().find(|term| term.law == *law) {
                Some(term) => add(&mut term.stiffness, 1.0, &part.stiffness),
                None => terms.push(ViscoelasticTerm { law: law.clone(), stiffness: part.stiffness.clone() }),
            }
        }
        terms
    }
}

/// `sum += factor a`
pub fn add(sum: &mut [f64], factor: f64, a: &[f64]) {
    if factor != 0.0 {
        sum.iter_mut().zip(a).for_each(|(sum, a)| *sum += factor * a);
    }
}

/// Where elements stand: on the nodes of a structure whose vectors a basis has.
pub struct Place<'a> {
    /// Numbers of the nodes.
    pub nodes: &'a Numbering,
    /// Which displacements of each node are prescribed.
    pub held: &'a [[bool; 3]],
    /// V.
    pub basis: &'a Block,
}

impl Place<'_> {
    /// `V^T A V` of M, C, K and G of some families of elements, by rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn project(&self, families: &[&dyn Elements]) -> Result<Mck<Vec<f64>>> {
        let (system, own) = self.assemble(families)?;
        let Mck { m, c, k, g } = system.matrices();
        let project = |a: &Matrix| own.project(a);
        let c = if system.is_gyroscopic { own.project_by_rows(c)? } else { project(c)? };
        Ok(Mck { m: project(m)?, c, k: project(k)?, g: g.map(project).transpose()? })
    }

    /// `V^T A V` of M and K of the elements of a part. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn project_part(&self, part: &crate::model::Part, family: &dyn Elements) -> Result<PartMatrices> {
        let (system, own) = self.assemble(&[family])?;
        Ok(PartMatrices {
            name: part.name.clone(),
            mass: own.project(&system.m)?,
            stiffness: own.project(&system.k)?,
            rayleigh: part.rayleigh,
            loss_factor: part.material.loss_factor,
            law: part.material.viscoelastic.clone(),
        })
    }

    fn assemble(&self, families: &[&dyn Elements]) -> Result<(System, OwnRows<'_>)> {
        let system = System::assemble(self.basis.comm(), self.nodes, self.held, families, &[])?;
        let rows = rows_of(families, &system);
        let own = self.basis.of_rows(&rows);
        Ok((system, OwnRows { basis: self.basis, own, rows }))
    }
}

/// The rows of this rank that belong to the nodes of some families, rising.
fn rows_of(families: &[&dyn Elements], system: &System) -> Vec<usize> {
    let owned = system.dofs.owned();
    let all = families.iter().flat_map(|family| (0..family.len()).flat_map(|e| family.nodes(e)));
    let mut nodes: Vec<u32> = all.copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let dofs = nodes.into_iter().flat_map(|node| system.dofs.node_dofs(node));
    dofs.filter(|dof| owned.contains(dof)).map(|dof| (dof - owned.start) as usize).collect()
}

/// A basis, and those of its rows in which some matrices have entries.
struct OwnRows<'a> {
    basis: &'a Block,
    own: Block,
    rows: Vec<usize>,
}

impl OwnRows<'_> {
    /// `(V^T A V)^T`, column by column: by rows.
    fn project_by_rows(&self, a: &Matrix) -> Result<Vec<f64>> {
        let n = self.basis.n_columns();
        let mut columns = Vec::with_capacity(n * n);
        for first in (0..n).step_by(PANEL) {
            let last = (first + PANEL).min(n);
            columns.extend(self.own.gram(&self.basis.columns(first..last).multiplied_by(a)?.of_rows(&self.rows)));
        }
        Ok(DMatrix::from_vec(n, n, columns).transpose().as_slice().to_vec())
    }

    /// `V^T A V` of a symmetric matrix.
    fn project(&self, a: &Matrix) -> Result<Vec<f64>> {
        let n = self.basis.n_columns();
        let mut product = DMatrix::zeros(n, n);
        for first in (0..n).step_by(PANEL) {
            let last = (first + PANEL).min(n);
            let images = self.basis.columns(first..last).multiplied_by(a)?.of_rows(&self.rows);
            let columns = self.own.leading_gram(last, &images);
            for (j, column) in (first..last).zip(columns.chunks_exact(last)) {
                for (i, &value) in column[..=j].iter().enumerate() {
                    (product[(i, j)], product[(j, i)]) = (value, value);
                }
            }
        }
        Ok(product.as_slice().to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::viscoelastic::MaxwellElement;

    fn part(mass: f64, stiffness: f64, rayleigh: Rayleigh, loss_factor: f64) -> PartMatrices {
        let (name, mass, stiffness) = (String::new(), vec![mass], vec![stiffness]);
        PartMatrices { name, mass, stiffness, rayleigh, loss_factor, law: None }
    }

    #[test]
    fn parts_of_one_law_are_one_term() {
        let law = |ratio: f64| Some(ViscoelasticLaw::Maxwell(vec![MaxwellElement { ratio, relaxation_time: 1e-5 }]));
        let part = |stiffness: f64, law| PartMatrices { law, ..part(1.0, stiffness, Rayleigh::default(), 0.0) };
        let parts = vec![part(30.0, law(2.0)), part(7.0, None), part(20.0, law(3.0)), part(12.0, law(2.0))];
        let rest = Mck::from([vec![0.0], vec![0.0], vec![0.0]]);
        let terms = MatricesByPart { parts, rest, rest_name: String::new() }.viscoelastic();
        let found: Vec<(f64, Option<ViscoelasticLaw>)> =
            terms.iter().map(|term| (term.stiffness[0], Some(term.law.clone()))).collect();
        assert_eq!(found, [(42.0, law(2.0)), (20.0, law(3.0))]);
    }

    #[test]
    fn the_matrices_are_the_sums_of_the_parts_and_the_rest() {
        let parts = vec![
            part(2.0, 30.0, Rayleigh { alpha: 0.5, beta: 0.1 }, 0.0),
            part(1.0, 20.0, Rayleigh { alpha: 0.0, beta: 0.2 }, 0.01),
        ];
        let rest = Mck::from([[4.0], [0.5], [7.0]].map(|a| a.to_vec()));
        let total = MatricesByPart { parts, rest, rest_name: String::new() }.total();
        assert_eq!([&total.m, &total.k], [&[7.0], &[57.0]]);
        assert!((total.c[0] - (0.5 + 1.0 + 3.0 + 4.0)).abs() < 1e-15);
        assert!((total.g.expect("a part has a loss factor")[0] - 0.2).abs() < 1e-15);
        let rest = Mck::from([vec![0.0], vec![0.0], vec![0.0]]);
        let none = MatricesByPart { parts: Vec::new(), rest, rest_name: String::new() };
        assert!(!none.has_rest() && none.total().g.is_none());
    }
}
