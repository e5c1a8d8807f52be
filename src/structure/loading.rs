//! Loads that press nothing: they act on what is fixed, or pull the pads off the disc.

use std::collections::HashSet;

use super::FullModel;
use super::free_motions::Bodies;
use crate::contact::ContactPair;
use crate::model::LoadKind;
use crate::native::Comm;

/// Fraction of a load on fixed dofs above which it is said.
const HELD: f64 = 0.5;
/// Cosine of the angle between a load and a normal above which the load pulls.
const PULLING: f64 = 0.5;

/// Warnings about loads. Collective.
pub(super) fn warnings(full: &FullModel, comm: &Comm) -> Vec<String> {
    let bodies = Bodies::new(comm, &full.mesh, &full.nodes);
    let on_nodes = full.model.loads.iter().filter(|load| !matches!(load.kind, LoadKind::Gravity(_)));
    let held = on_nodes.filter_map(|load| {
        let nodes: HashSet<u32> = full.mesh.node_set(&load.on)?.into_iter().collect();
        on_held(&load.name, full.loads.iter().filter(|(node, _)| nodes.contains(node)), &full.held)
    });
    held.chain(pulled(full, &bodies, comm)).collect()
}

/// A load most of whose nodal forces (N) act on fixed dofs.
fn on_held<'l>(load: &str, forces: impl Iterator<Item = &'l (u32, [f64; 3])>, held: &[[bool; 3]]) -> Option<String> {
    let [mut total, mut lost] = [0.0; 2];
    for (node, force) in forces {
        for (f, is_held) in force.iter().zip(held[*node as usize]) {
            total += f.abs();
            lost += if is_held { f.abs() } else { 0.0 };
        }
    }
    (lost > HELD * total).then(|| {
        let percent = 100.0 * lost / total;
        format!(
            "{percent:.0} % of load {load:?} acts on nodes that are fixed in its direction, and press nothing. Look at the \
             axes of the [[fix]] there"
        )
    })
}

/// Pads that the loads pull off the disc: nothing but contacts with the disc holds them along the load. Collective.
fn pulled(full: &FullModel, bodies: &Bodies, comm: &Comm) -> Vec<String> {
    let body = |surface: &str| {
        let node = full.mesh.surfaces.get(surface)?.facets.first()?.nodes().first()?;
        Some(bodies.of_node[*node as usize])
    };
    let pairs = &full.interface.pairs;
    let slaves: Vec<(&ContactPair, usize)> = pairs.iter().filter_map(|pair| Some((pair, body(&pair.slave)?))).collect();
    let masters: Vec<usize> = pairs.iter().filter_map(|pair| body(&pair.master)).collect();
    let alone = |own: usize| slaves.iter().filter(|(_, body)| *body == own).count() == 1 && !masters.contains(&own);
    let of_pads = slaves.iter().filter(|(pair, own)| pair.is_sliding() && pair.separation && alone(*own));
    of_pads
        .filter_map(|(pair, own)| pulled_off(pair, normal(full, pair), &Body::of(full, bodies, *own, comm)))
        .collect()
}

/// What acts on a body.
struct Body {
    /// Sum of the loads and the weight, N.
    force: [f64; 3],
    /// Whether a support holds it along each axis.
    is_held: [bool; 3],
    /// Whether a joint may hold it.
    has_joints: bool,
}

impl Body {
    /// Collective.
    fn of(full: &FullModel, bodies: &Bodies, own: usize, comm: &Comm) -> Body {
        let is_of = |node: usize| bodies.of_node[node] == own;
        let sum = |forces: &[(u32, [f64; 3])]| {
            let on_body = forces.iter().filter(|(node, _)| is_of(*node as usize));
            on_body.fold([0.0; 3], |sum, (_, f)| [0, 1, 2].map(|i| sum[i] + f[i]))
        };
        // Each rank has all loads, and the weights of its own nodes.
        let (loads, mut weight) = (sum(&full.loads), sum(&full.weights));
        comm.sum_all(&mut weight);
        let force = [0, 1, 2].map(|i| loads[i] + weight[i]);
        let is_held = [0, 1, 2].map(|i| full.held.iter().enumerate().any(|(node, held)| held[i] && is_of(node)));
        let mut joined = full.joints.elements.iter().flat_map(|element| &element.nodes);
        Body { force, is_held, has_joints: joined.any(|&node| is_of(node as usize)) }
    }
}

/// Mean normal of a pair, along which its gap opens.
fn normal(full: &FullModel, pair: &ContactPair) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for point in &full.interface.points[pair.points.clone()] {
        (0..3).for_each(|i| sum[i] += point.law.weight * point.law.normal[i]);
    }
    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
    sum.map(|x| x / length)
}

/// A pad whose load pulls along the normal of its only contact, where nothing else holds it.
fn pulled_off(pair: &ContactPair, normal: [f64; 3], body: &Body) -> Option<String> {
    let along: f64 = (0..3).map(|i| normal[i] * body.force[i]).sum();
    let size = body.force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let is_held = body.has_joints || (0..3).any(|i| body.is_held[i] && normal[i].abs() > PULLING);
    (!is_held && along > PULLING * size).then(|| {
        format!("the loads pull {} off {} with {along:.1} N. Look at the signs of the loads", pair.slave, pair.master)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::testing::{ALONG_X, belt};
    use crate::native::Session;
    use crate::structure::ModelVariants;

    #[test]
    fn a_load_on_fixed_nodes_is_said() {
        let forces = [(0, [0.0, 0.0, 2.0]), (1, [1.0, 0.0, 2.0])];
        let said = |held: [[bool; 3]; 2]| on_held("back", forces.iter(), &held);
        let (guided, fixed) = ([true, true, false], [true; 3]);
        assert_eq!(said([guided, guided]), None);
        assert_eq!(said([guided, [false, false, true]]), None, "2 of 5");
        assert!(said([fixed, guided]).unwrap().starts_with("60 % of load \"back\""));
        assert!(said([fixed, fixed]).unwrap().starts_with("100 % of load \"back\""));
        assert_eq!(on_held("nothing", [].iter(), &[]), None);
    }

    /// The inner pad is pulled off by 1 N, the outer one pressed by 1 N; gravity along z does the opposite.
    #[test]
    fn weights_count_as_loads_do() {
        let comm = Session::start(&[]).unwrap();
        let variants = ModelVariants::read(&comm, "tests/data/pads_on_disc.toml".as_ref()).unwrap();
        let text = variants.text.replace("[0, 0, 4000]", "[0, 0, -1]").replace("[0, 0, -4000]", "[0, 0, -1]");
        let pulled = |gravity: f64| {
            let load = format!("[[load]]\ngravity = [0, 0, {gravity}]\n[stability]");
            let brake = variants.brake(&comm, &text.replace("[stability]", &load), None).unwrap();
            let pads = ["lining_inner_face", "lining_outer_face"];
            let said = warnings(&brake, &comm);
            pads.map(|pad| said.iter().any(|warning| warning.starts_with(&format!("the loads pull {pad} off"))))
        };
        assert_eq!(pulled(0.0), [true, false]);
        assert_eq!(pulled(1e4), [false, true]);
        assert_eq!(pulled(-1e4), [true, false]);
    }

    #[test]
    fn a_load_that_pulls_is_said_unless_something_else_holds_the_pad() {
        let pair = &belt(1, ALONG_X).pairs[0];
        let said = |force: f64, is_held: [bool; 3], has_joints: bool| {
            pulled_off(pair, [0.0, 0.0, 1.0], &Body { force: [0.1, 0.0, force], is_held, has_joints })
        };
        assert_eq!(
            said(4.0, [true, true, false], false).unwrap().split(" with").next(),
            Some("the loads pull blocks off belt")
        );
        assert_eq!(said(-4.0, [true, true, false], false), None);
        assert_eq!(said(0.0, [true, true, false], false), None);
        assert_eq!(said(4.0, [true; 3], false), None);
        assert_eq!(said(4.0, [true, true, false], true), None);
    }
}
