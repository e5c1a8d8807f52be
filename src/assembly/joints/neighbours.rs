//! The stiffness of the elements beside nodes and surfaces, by which penalties are scaled.

use std::collections::{BTreeMap, BTreeSet};

use crate::Result;
use crate::algebra::{norm, sub};
use crate::assembly::Solids;
use crate::contact::search::Team;
use crate::mesh::{Mesh, Numbering};
use crate::model::{Material, Model};

/// The elements beside some nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Neighbourhood {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Distance from a node to the farthest of an element's nodes, m.
    pub size: f64,
}

/// The elements beside each of some nodes.
pub struct Neighbours {
    of_node: BTreeMap<u32, Neighbourhood>,
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
        let mut of_node: BTreeMap<u32, Neighbourhood> = nodes.map(|n| (n, Neighbourhood::default())).collect();
        if of_node.is_empty() {
            return Ok(Neighbours { of_node });
        }
        let solids = Solids::new(model, mesh)?;
        for (e, element) in mesh.elements.iter().enumerate() {
            // The owner of a node has all elements around it.
            for &node in element.nodes.iter().filter(|n| numbering.owns(**n)) {
                let Some(around) = of_node.get_mut(&node) else { continue };
                let [young, _] = solids.part(e).material.youngs();
                let x = |n: u32| mesh.nodes[n as usize];
                let distances = element.nodes.iter().map(|&n| norm(sub(x(n), x(node))));
                around.young = if around.young > 0.0 { around.young.min(young) } else { young };
                around.size = distances.fold(around.size, f64::max);
            }
        }
        // Local numbers rise with global ones, so that all of the team list the nodes in one order.
        let mut values: Vec<[f64; 2]> = of_node.values().map(|around| [around.young, around.size]).collect();
        team.largest(values.as_flattened_mut());
        of_node.values_mut().zip(values).for_each(|(around, [young, size])| *around = Neighbourhood { young, size });
        Ok(Neighbours { of_node })
    }

    /// The largest modulus and size beside any of some nodes.
    pub fn around(&self, nodes: &[u32]) -> Neighbourhood {
        let all = nodes.iter().filter_map(|n| self.of_node.get(n));
        all.fold(Neighbourhood::default(), |most, own| Neighbourhood {
            young: most.young.max(own.young),
            size: most.size.max(own.size),
        })
    }
}

/// The smallest Young's modulus of the parts that some surfaces lie on, Pa.
pub fn softest(model: &Model, mesh: &Mesh, surfaces: [&str; 2]) -> f64 {
    let parts: BTreeSet<u32> = surfaces.iter().filter_map(|name| mesh.parts_of_surface(name)).flatten().collect();
    let material = |part: &u32| {
        let name = &mesh.parts[*part as usize];
        model.parts.iter().find(|own| own.name == *name).map(|own| &own.material)
    };
    parts.iter().filter_map(material).map(|material: &Material| material.youngs()[0]).fold(f64::INFINITY, f64::min)
}
