//! A super-element among the elements of an assembly.
//!
//! It is a family: a member with all that does not depend on the frequency, and one for the stiffness of each
//! viscoelastic law.

use std::borrow::Cow;

use crate::assembly::{Connectivity, ElementMatrices, Elements};
use crate::model::viscoelastic::ViscoelasticLaw;

use super::parts::add;
use super::super_element::SuperElement;

/// The members of a super-element, on all of its coordinates.
pub struct Members<'a> {
    element: &'a SuperElement,
    nodes: Vec<u32>,
    laws: Vec<ViscoelasticLaw>,
    /// The stiffness without that of the laws.
    elastic: Cow<'a, [f64]>,
}

impl<'a> Members<'a> {
    /// The family.
    pub fn new(element: &'a SuperElement) -> Self {
        let mut elastic = Cow::Borrowed(&element.stiffness[..]);
        element.viscoelastic.iter().for_each(|term| add(elastic.to_mut(), -1.0, &term.stiffness));
        let nodes = (0..element.n_coordinates().div_ceil(3) as u32).collect();
        Members { element, nodes, laws: element.viscoelastic.iter().map(|term| term.law.clone()).collect(), elastic }
    }

    /// A matrix on the coordinates as one on all displacements of the nodes.
    fn widen(&self, from: &[f64], to: &mut Vec<f64>) {
        let (n, width) = (self.element.n_coordinates(), 3 * self.nodes.len());
        to.clear();
        to.resize(width * width, 0.0);
        for (row, values) in to.chunks_exact_mut(width).zip(from.chunks_exact(n)) {
            row[..n].copy_from_slice(values);
        }
    }
}

impl Connectivity for Members<'_> {
    fn len(&self) -> usize {
        1 + self.laws.len()
    }

    fn nodes(&self, _: usize) -> &[u32] {
        &self.nodes
    }
}

impl Elements for Members<'_> {
    fn has_structural_damping(&self) -> bool {
        self.element.structural_damping.is_some()
    }

    fn viscoelastic_laws(&self) -> &[ViscoelasticLaw] {
        &self.laws
    }

    fn law_of(&self, e: usize) -> Option<usize> {
        e.checked_sub(1)
    }

    fn is_gyroscopic(&self) -> bool {
        self.element.is_gyroscopic()
    }

    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        [&mut out.m, &mut out.c, &mut out.g].into_iter().for_each(Vec::clear);
        if let Some(law) = self.law_of(e) {
            return self.widen(&self.element.viscoelastic[law].stiffness, &mut out.k);
        }
        self.widen(&self.elastic, &mut out.k);
        self.widen(&self.element.mass, &mut out.m);
        self.widen(&self.element.damping, &mut out.c);
        self.element.structural_damping.iter().for_each(|g| self.widen(g, &mut out.g));
    }
}
