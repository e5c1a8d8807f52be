//! The weight of parts and point masses.
//!
//! ```text
//! f_a = integral of rho N_a g = sum_b m_ab g        of an element, since sum_b N_b = 1
//! ```
//!
//! A point mass weighs on the mean motion of its node set, as it moves with it.

use crate::Result;
use crate::element::solid;
use crate::mesh::{Mesh, Numbering};
use crate::model::{Load, LoadKind, Model};

use super::joints::Sets;

/// The nodal forces (N) of gravity at the nodes that this rank owns.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where the node set of a point mass is missing.
pub fn weights(model: &Model, mesh: &Mesh, nodes: &Numbering, sets: &Sets) -> Result<Vec<(u32, [f64; 3])>> {
    if !model.loads.iter().any(|load| matches!(load.kind, LoadKind::Gravity(_))) {
        return Ok(Vec::new());
    }
    let mut sums = vec![[0.0; 3]; mesh.nodes.len()];
    let mut add = |node: u32, force: [f64; 3]| (0..3).for_each(|i| sums[node as usize][i] += force[i]);
    element_weights(model, mesh, &mut add);
    for mass in &model.masses {
        let force = acceleration(model, &mass.name).map(|g| mass.mass * g);
        let motion = sets.motion(&mass.nodes, mass.at);
        let refuse = |message| model.error(mass.place, format_args!("mass {:?}: {message}", mass.name));
        motion.map_err(refuse)?.spread(force, [0.0; 3]).into_iter().for_each(|(node, force)| add(node, force));
    }
    Ok((0..).zip(sums).filter(|(node, force)| nodes.owns(*node) && *force != [0.0; 3]).collect())
}

/// The sum of what acts on a part or point mass, m/s2.
fn acceleration(model: &Model, name: &str) -> [f64; 3] {
    let own = model.loads.iter().filter(|load: &&Load| load.is_gravity_on(name));
    own.fold([0.0; 3], |sum, load| match load.kind {
        LoadKind::Gravity(g) => [0, 1, 2].map(|i| sum[i] + g[i]),
        _ => sum,
    })
}

fn element_weights(model: &Model, mesh: &Mesh, add: &mut dyn FnMut(u32, [f64; 3])) {
    let density =
        |part: &String| model.parts.iter().find(|own| own.name == *part).map_or(0.0, |own| own.material.density);
    let parts: Vec<(f64, [f64; 3])> =
        mesh.parts.iter().map(|part| (density(part), acceleration(model, part))).collect();
    let mut m = Vec::new();
    for (e, element) in mesh.elements.iter().enumerate() {
        let ((density, g), n) = (parts[element.part as usize], element.nodes.len());
        m.resize(n * n, 0.0);
        solid::scalar_mass(element.shape(), &mesh.element_nodes(e), density, &mut m);
        for (&node, row) in element.nodes.iter().zip(m.chunks_exact(n)) {
            let mass: f64 = row.iter().sum();
            add(node, g.map(|g| mass * g));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, norm, sub};
    use crate::contact::testing::model;
    use crate::element::ElementKind;
    use crate::element::samples::{Random, curved};
    use crate::model::{EXAMPLE, Part, Place, PointMass, parse};

    const G: [f64; 3] = [1.0, -2.0, -9.81];

    /// An element of a part "disc", one of a part "hub", and a mass of 3 kg on the hub's first nodes.
    fn brake(kind: ElementKind, on: &[&str]) -> (Model, Mesh) {
        let mut random = Random::seeded(7);
        let mut mesh = Mesh { parts: vec!["disc".into(), "hub".into()], ..Mesh::default() };
        for part in 0..2 {
            let first = mesh.nodes.len() as u32;
            mesh.nodes.extend(curved(kind.shape(), &mut random, 0.02));
            let nodes: Vec<u32> = (first..mesh.nodes.len() as u32).collect();
            mesh.elements.push(kind, part, &nodes);
        }
        let first = mesh.element_nodes(0).len() as u32;
        mesh.node_sets.insert("rim".into(), vec![first, first + 1, first + 2]);
        let own = parse(EXAMPLE, "brake.toml".as_ref()).unwrap().parts;
        let part = |name: &str| Part { name: name.into(), ..own[0].clone() };
        let place = Place::default();
        let (name, nodes) = ("bolt".to_owned(), "rim".to_owned());
        let masses = vec![PointMass { name, nodes, at: None, mass: 3.0, inertia: [0.0; 6], place }];
        let load = |on: &&str| Load { name: (*on).into(), on: (*on).into(), kind: LoadKind::Gravity(G), place };
        let (parts, loads) = (vec![part("disc"), part("hub")], on.iter().map(load).collect());
        (Model { parts, masses, loads, ..model(Vec::new(), false) }, mesh)
    }

    /// Force and moment about the origin.
    fn wrench(model: &Model, mesh: &Mesh, nodes: &Numbering) -> [[f64; 3]; 2] {
        let mut sum = [[0.0; 3]; 2];
        for (node, force) in weights(model, mesh, nodes, &Sets::new(model, mesh, nodes).unwrap()).unwrap() {
            let moment = cross(mesh.nodes[node as usize], force);
            (0..3).for_each(|i| (sum[0][i], sum[1][i]) = (sum[0][i] + force[i], sum[1][i] + moment[i]));
        }
        sum
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        norm(sub(a, b)) <= 1e-12 * norm(b)
    }

    #[test]
    fn every_kind_of_element_weighs_its_mass_at_its_centre() {
        for kind in ElementKind::ALL {
            let (model, mesh) = brake(kind, &["disc"]);
            let density = model.parts[0].material.density;
            let properties = solid::mass_properties(kind.shape(), &mesh.element_nodes(0), density);
            let [force, moment] = wrench(&model, &mesh, &Numbering::even(mesh.nodes.len(), 0, 1));
            assert!(close(force, G.map(|g| properties.mass * g)), "{kind:?} {force:?}");
            assert!(close(moment, cross(properties.first_moment, G)), "{kind:?} {moment:?}");
        }
    }

    #[test]
    fn gravity_without_a_name_acts_on_parts_and_masses_and_two_gravities_add_up() {
        let force = |on: &[&str]| {
            let (model, mesh) = brake(ElementKind::C3D8, on);
            wrench(&model, &mesh, &Numbering::even(mesh.nodes.len(), 0, 1))[0]
        };
        let [disc, hub, bolt] = [force(&["disc"]), force(&["hub"]), force(&["bolt"])];
        assert!(close(bolt, G.map(|g| 3.0 * g)) && !close(disc, hub), "{bolt:?} {disc:?} {hub:?}");
        let all = [0, 1, 2].map(|i| disc[i] + hub[i] + bolt[i]);
        assert!(close(force(&[""]), all) && close(force(&["disc", "hub", "bolt"]), all));
        assert!(close(force(&["", "bolt"]), [0, 1, 2].map(|i| all[i] + bolt[i])));
        assert_eq!(force(&[]), [0.0; 3]);
    }

    #[test]
    fn each_node_weighs_on_the_rank_that_owns_it() {
        let (model, mesh) = brake(ElementKind::C3D8, &[""]);
        let of = |rank: usize, size: usize| wrench(&model, &mesh, &Numbering::even(mesh.nodes.len(), rank, size))[0];
        let [first, second] = [of(0, 2), of(1, 2)];
        assert!(close([0, 1, 2].map(|i| first[i] + second[i]), of(0, 1)) && !close(first, of(0, 1)));
    }
}
