//! Connectors, ties, rigid sets, masses and equations: their names are in the mesh.

use super::ModelCheck;
use crate::model::{Equation, GROUND};

impl ModelCheck<'_> {
    /// Names of sets and surfaces exist; a term of an equation has one node.
    pub(super) fn joints(&mut self) {
        let model = self.model;
        for connector in &model.connectors {
            for end in connector.between.iter().filter(|end| *end != GROUND) {
                self.node_set(end, connector.place, &format!("connector {:?}", connector.name));
            }
        }
        for tie in &model.ties {
            for surface in [&tie.slave, &tie.master] {
                self.skin(surface, tie.place, &format!("tie {:?}", tie.name));
            }
        }
        for set in &model.rigid_sets {
            self.node_set(&set.nodes, set.place, &format!("rigid {:?}", set.name));
        }
        for mass in &model.masses {
            self.node_set(&mass.nodes, mass.place, &format!("mass {:?}", mass.name));
        }
        model.equations.iter().for_each(|equation| self.equation(equation));
    }

    fn equation(&mut self, equation: &Equation) {
        let item = format!("equation {:?}", equation.name);
        for term in &equation.terms {
            if !self.node_set(&term.node, equation.place, &item) {
                continue;
            }
            let n = self.mesh.node_set(&term.node).map_or(0, |nodes| nodes.len());
            if n != 1 {
                let what = format!("{:?} has {n} nodes, but a term of an equation is of one ({item})", term.node);
                self.complain(equation.place, format!("{what}. Name a physical point, or a node set of one node"));
            }
        }
    }
}
