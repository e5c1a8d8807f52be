//! The stiffness of the elements beside nodes, by which penalties are scaled.

use std::collections::BTreeMap;

use crate::Result;
use crate::algebra::{norm, sub};
use crate::assembly::Solids;
use crate::contact::search::Team;
use crate::mesh::{Mesh, Numbering};
use crate::model::Model;

/// What a penalty needs of the elements beside some nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AdjacentElements {
    /// Largest Young's modulus of an element, in its stiffest direction, Pa.
    pub young: f64,
    /// Largest distance from a node to another node of its element, m.
    pub size: f64,
}

/// The elements beside each of some nodes.
pub struct Neighbours {
    of_node: BTreeMap<u32, AdjacentElements>,
}

impl Neighbours {
    /// Those of the nodes of a mesh of which each of the team has a piece; all of the team find the same.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) where a part has no material.
    pub fn new(
        model: &Model,
        mesh: &Mesh,
        numbering: &Numbering,
        nodes: impl Iterator<Item = u32>,
        team: &dyn Team,
    ) -> Result<Neighbours> {
        let mut of_node: BTreeMap<u32, AdjacentElements> = nodes.map(|n| (n, AdjacentElements::default())).collect();
        if of_node.is_empty() {
            return Ok(Neighbours { of_node });
        }
        let solids = Solids::new(model, mesh)?;
        for (e, element) in mesh.elements.iter().enumerate() {
            // The owner of a node has all elements around it.
            for &node in element.nodes.iter().filter(|n| numbering.owns(**n)) {
                let Some(around) = of_node.get_mut(&node) else { continue };
                let [_, young] = solids.part(e).material.youngs();
                let x = |n: u32| mesh.nodes[n as usize];
                let distances = element.nodes.iter().map(|&n| norm(sub(x(n), x(node))));
                around.young = around.young.max(young);
                around.size = distances.fold(around.size, f64::max);
            }
        }
        // Local numbers rise with global ones, so that all of the team list the nodes in one order.
        let mut values: Vec<[f64; 2]> = of_node.values().map(|around| [around.young, around.size]).collect();
        team.largest(values.as_flattened_mut());
        of_node.values_mut().zip(values).for_each(|(around, [young, size])| *around = AdjacentElements { young, size });
        Ok(Neighbours { of_node })
    }

    /// The largest modulus and size beside any of some nodes.
    pub fn around(&self, nodes: &[u32]) -> AdjacentElements {
        let all = nodes.iter().filter_map(|n| self.of_node.get(n));
        all.fold(AdjacentElements::default(), |most, own| AdjacentElements {
            young: most.young.max(own.young),
            size: most.size.max(own.size),
        })
    }
}
