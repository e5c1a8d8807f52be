//! Reduced contact: reference nodes in place of the contact points of the sliding pairs.
//!
//! A reference node follows the cell of contact points that it stands for as their mean rigid motion ([`coupling`]);
//! its partner is the point of the master on which it projects. With the blocks `U_n` of the cell and the shape
//! functions `N_j` of the master's facet
//!
//! ```text
//! g = sum_n U_n u_n - sum_j N_j u_j          weight: the area of the cell
//! ```
//!
//! so that reduced contact is another gap operator and nothing else. Source: Fazio, Nacivet, Sinou (ISMA 2014), section
//! 3.

use std::collections::{HashMap, HashSet};

use pathfinding::undirected::connected_components::separate_components;

use crate::algebra::product;
use crate::contact::interface::ContactPair;
use crate::contact::search::{Landing, land};
use crate::contact::{ContactPoint, Interface, PointLaw, Statistics, sliding};
use crate::element::coupling::{self, Cloud, mean_motion};
use crate::mesh::{Mesh, Surface};
use crate::model::{Contact, Model};
use crate::{Error, Result};

use super::layout::{self, Points};

/// The interface with `n_contacts` reference pairs, shared by area among the sliding pairs; all other pairs stay as
/// they are.
///
/// # Errors
/// [`Error::Input`] with file, line and pair: nothing slides, fewer than three contact points a reference node, a cell
/// on a line, or a stiffness field of a sliding pair.
pub fn reduce(model: &Model, mesh: &Mesh, full: &Interface, n_contacts: usize) -> Result<Interface> {
    refuse_stiffness_fields(model, full)?;
    let areas: Vec<f64> = full.pairs.iter().filter(|p| p.is_sliding()).map(|p| p.statistics.weight).collect();
    let refuse = |what: String| Err(Error::input(format!("{}: {what}", model.file.display())));
    if areas.is_empty() {
        return refuse("no contact pair slides, so there is none to reduce. Add the [[rotation]] of the disc".into());
    }
    if n_contacts < areas.len() {
        let n = areas.len();
        return refuse(format!("{n_contacts} reference pairs for {n} sliding contacts. Give at least one each"));
    }
    let mut shares = layout::apportion(n_contacts, &areas).into_iter();
    let mut reduced = Interface::default();
    for (i, pair) in full.pairs.iter().enumerate() {
        let first = reduced.points.len();
        if pair.is_sliding() {
            let site = Site { model, mesh, full, pair, number: i };
            site.add(&mut reduced, shares.next().expect("a share for each sliding pair"))?;
        } else {
            for a in pair.points.clone() {
                let (nodes, blocks) = full.gap_operator.point(a);
                reduced.gap_operator.push(nodes, blocks);
                reduced.points.push(full.points[a].clone());
            }
        }
        let touching = reduced.points[first..].iter().filter(|point| point.law.touching).count();
        let statistics = Statistics { touching, ..pair.statistics.clone() };
        reduced.pairs.push(ContactPair { points: first..reduced.points.len(), statistics, ..pair.clone() });
    }
    Ok(reduced)
}

/// Refuses stiffness fields of sliding pairs: all reference nodes of a pair have one law.
fn refuse_stiffness_fields(model: &Model, full: &Interface) -> Result<()> {
    let pairs = model.contacts.iter().zip(&full.pairs).filter(|(_, pair)| pair.is_sliding());
    let has_field = |contact: &Contact| contact.stiffness_field.is_some();
    let Some((contact, _)) = pairs.into_iter().find(|(contact, _)| has_field(contact)) else { return Ok(()) };
    let what = "a reference pair has the law of its pair. Use full contact, or leave out stiffness_factor";
    Err(model.error(contact.place, format_args!("contact {:?}: {what}", contact.name)))
}

/// A sliding pair to be reduced.
struct Site<'a> {
    model: &'a Model,
    mesh: &'a Mesh,
    full: &'a Interface,
    pair: &'a ContactPair,
    /// Its number among the contacts of the model.
    number: usize,
}

impl Site<'_> {
    fn refuse(&self, reason: &dyn std::fmt::Display) -> Error {
        let advice = "Give a smaller number of contacts, or a finer mesh of the slave";
        let what = format!("contact {:?}: {reason}. {advice}", self.pair.name);
        self.model.error(self.model.contacts[self.number].place, what)
    }

    /// Appends the pair's reference nodes.
    fn add(&self, reduced: &mut Interface, n: usize) -> Result<()> {
        let own = &self.full.points[self.pair.points.clone()];
        let positions: Vec<[f64; 3]> = own.iter().map(|point| point.position).collect();
        let areas: Vec<f64> = own.iter().map(|point| point.law.weight).collect();
        let pieces = pieces(&self.mesh.surfaces[&self.pair.slave], own);
        let points = Points { positions: &positions, areas: &areas, pieces: &pieces };
        let cells = layout::cells(&points, n).map_err(|reason| self.refuse(&reason))?;
        let points_of = |cell: &Vec<usize>| cell.iter().map(|&a| &own[a]).collect::<Vec<_>>();
        let centre_of = |cell| (centre(&points_of(cell)), outward(&points_of(cell)));
        let centres: Vec<([f64; 3], [f64; 3])> = cells.iter().map(centre_of).collect();
        let master = &self.mesh.surfaces[&self.pair.master];
        let first = reduced.points.len();
        for ((cell, (position, _)), landing) in cells.iter().zip(&centres).zip(land(&centres, master, &self.mesh.nodes))
        {
            let landing =
                landing.ok_or_else(|| self.refuse(&"a reference node has no facet of the master before it"))?;
            let cell: Vec<usize> = cell.iter().map(|a| self.pair.points.start + a).collect();
            self.push(reduced, &cell, *position, &landing)?;
        }
        self.add_gap_field(&mut reduced.points[first..], cells.iter().map(points_of));
        Ok(())
    }

    /// Gives the reference nodes the gaps of the contact's field: that of a row where a node stands, as the field of a
    /// worn layout has them, else the mean over the area of the node's cell, which keeps the volume.
    fn add_gap_field<'a>(&self, nodes: &mut [ContactPoint], cells: impl Iterator<Item = Vec<&'a ContactPoint>>) {
        let Some(field) = &self.model.contacts[self.number].gap_field else { return };
        for (node, cell) in nodes.iter_mut().zip(cells) {
            let volume: f64 = cell.iter().map(|point| point.law.weight * point.field_gap).sum();
            let area: f64 = cell.iter().map(|point| point.law.weight).sum();
            node.set_field_gap(field.of_row_at(node.position).unwrap_or(volume / area));
        }
    }

    /// Appends one reference node, which follows a cell of points: `g = sum_a U_a sum_i N_ai u_i - sum_j N_j u_j`.
    fn push(&self, reduced: &mut Interface, cell: &[usize], x: [f64; 3], landing: &Landing) -> Result<()> {
        let points: Vec<&ContactPoint> = cell.iter().map(|&a| &self.full.points[a]).collect();
        let (positions, weights) = cloud(&points);
        let motion =
            mean_motion(Cloud { nodes: &positions, weights: &weights }, x).map_err(|reason| self.refuse(&reason))?;
        let (mut nodes, mut blocks) = (Vec::new(), Vec::new());
        for (&a, mean) in cell.iter().zip(&motion.displacement) {
            let (own, shapes) = self.full.gap_operator.point(a);
            let n_slaves = self.full.points[a].nodes.len();
            nodes.extend_from_slice(&own[..n_slaves]);
            blocks.extend(shapes[..n_slaves].iter().map(|shape| product(mean, shape)));
        }
        let slaves = distinct(&nodes);
        nodes.extend_from_slice(&landing.master.nodes);
        let master = |n: &f64| std::array::from_fn(|i| std::array::from_fn(|j| if i == j { -n } else { 0.0 }));
        blocks.extend(landing.master.shape.iter().map(master));
        reduced.gap_operator.push(&nodes, &blocks);
        reduced.points.push(ContactPoint {
            pair: points[0].pair,
            places: points.iter().flat_map(|point| point.places.iter().copied()).collect(),
            nodes: slaves,
            position: x,
            field_gap: 0.0,
            law: self.law(&points, x, landing),
        });
        Ok(())
    }

    /// The cell's law with its whole area, at the reference node.
    fn law(&self, cell: &[&ContactPoint], x: [f64; 3], landing: &Landing) -> PointLaw {
        let weight: f64 = cell.iter().map(|point| point.law.weight).sum();
        let rotation = self.model.sliding(&self.model.contacts[cell[0].pair], self.mesh);
        let rotation = rotation.expect("a sliding pair has a rotation");
        PointLaw {
            weight,
            normal: landing.normal,
            gap: landing.gap,
            touching: cell.iter().any(|point| point.law.touching),
            tangential: sliding(rotation, x, landing.normal, weight.sqrt()),
            ..cell[0].law.clone()
        }
    }
}

/// The nodes in the order in which they come first, each once.
fn distinct(nodes: &[u32]) -> Vec<u32> {
    let mut seen = HashSet::new();
    nodes.iter().copied().filter(|&n| seen.insert(n)).collect()
}

/// Positions and weights of a cell.
fn cloud(cell: &[&ContactPoint]) -> (Vec<[f64; 3]>, Vec<f64>) {
    cell.iter().map(|point| (point.position, point.law.weight)).unzip()
}

/// Where the reference node stands, m: on a plane face, in that plane.
fn centre(cell: &[&ContactPoint]) -> [f64; 3] {
    let (nodes, weights) = cloud(cell);
    coupling::Cloud { nodes: &nodes, weights: &weights }.centroid()
}

/// The slave's mean outward normal: minus the master's.
fn outward(cell: &[&ContactPoint]) -> [f64; 3] {
    [0, 1, 2].map(|i| -cell.iter().map(|point| point.law.normal[i]).sum::<f64>())
}

/// The connected piece of the slave surface on which each point lies, numbered in the order of the points.
fn pieces(surface: &Surface, points: &[ContactPoint]) -> Vec<usize> {
    let facets: Vec<Vec<u32>> = surface.facets.iter().map(|facet| facet.nodes().to_vec()).collect();
    let (component_of, _) = separate_components(&facets);
    let mut number: HashMap<usize, usize> = HashMap::new();
    let of = |point: &ContactPoint| {
        let next = number.len();
        *number.entry(component_of[&point.nodes[0]]).or_insert(next)
    };
    points.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, norm, sub};
    use crate::contact::search::Alone;
    use crate::contact::testing::{contact, flipped, model, pads_on_disc, patch_of, skin};
    use crate::element::FacetShape;
    use crate::model::GapField;

    fn pads(n: usize) -> Result<(Interface, Interface, Mesh)> {
        let mesh = pads_on_disc();
        let names = ["inner", "outer"];
        let pads = names.map(|name| contact(name, &format!("lining_{name}_face"), &format!("disc_{name}_face")));
        let model = model(pads.to_vec(), true);
        let full = Interface::build(&model, &mesh, &Alone).unwrap();
        reduce(&model, &mesh, &full, n).map(|reduced| (full, reduced, mesh))
    }

    #[test]
    fn every_contact_point_is_in_one_cell_and_areas_add_up() {
        let (full, reduced, _) = pads(44).unwrap();
        for (before, after) in full.pairs.iter().zip(&reduced.pairs) {
            assert_eq!(after.points.len(), 22);
            let own = &reduced.points[after.points.clone()];
            let mut nodes: Vec<u32> = own.iter().flat_map(|point| point.nodes.clone()).collect();
            nodes.sort_unstable();
            let all: Vec<u32> = full.points[before.points.clone()].iter().map(|point| point.nodes[0]).collect();
            assert_eq!(nodes, all);
            let area: f64 = own.iter().map(|point| point.law.weight).sum();
            assert!((area / before.statistics.weight - 1.0).abs() < 1e-12);
        }
    }

    /// A rigid motion of everything moves no reference node against the disc; one of the pads alone moves it as its
    /// place in them moves.
    #[test]
    fn rigid_motions_are_exact() {
        let (_, reduced, mesh) = pads(44).unwrap();
        let (shift, turn) = ([1e-3, -2e-3, 5e-4], [0.01, 0.02, -0.03]);
        let rigid = |x: [f64; 3]| [0, 1, 2].map(|i| shift[i] + cross(turn, x)[i]);
        for (a, point) in reduced.points.iter().enumerate() {
            let all = reduced.gap_operator.gap(a, |n| rigid(mesh.nodes[n as usize]));
            assert!(norm(all) < 1e-15, "{all:?}");
            let pad = |n: u32| if point.nodes.contains(&n) { rigid(mesh.nodes[n as usize]) } else { [0.0; 3] };
            assert!(norm(sub(reduced.gap_operator.gap(a, pad), rigid(point.position))) < 1e-15);
        }
    }

    /// What a cell's nodes get is the force at the reference node, without another moment; the disc gets its opposite
    /// at the same point.
    #[test]
    fn force_and_moment_are_preserved() {
        let (_, reduced, mesh) = pads(12).unwrap();
        let force = [3.0, -1.0, 2.0];
        for (a, point) in reduced.points.iter().enumerate() {
            let mut sums = [[0.0; 3]; 4];
            reduced.gap_operator.spread(a, force, |n, f| {
                let side = if point.nodes.contains(&n) { 0 } else { 2 };
                let moment = cross(sub(mesh.nodes[n as usize], point.position), f);
                (0..3).for_each(|i| {
                    sums[side][i] += f[i];
                    sums[side + 1][i] += moment[i];
                });
            });
            assert!(norm(sub(sums[0], force)) < 1e-13 && norm(sub(sums[2], force.map(|f| -f))) < 1e-13);
            assert!(norm(sums[1]) < 1e-15 && norm(sums[3]) < 1e-15, "{sums:?}");
        }
    }

    /// Reference nodes on pads whose contact points lie inside of quadrilaterals, so that a cell shares nodes with
    /// others.
    #[test]
    fn quadrilaterals_give_rigid_motions_and_forces_exactly() {
        let mut nodes = Vec::new();
        let face = |x: f64, z: f64| move |u: f64, v: f64| [x + 0.05 * u, 0.1 + 0.04 * v, z];
        let pad = flipped(&patch_of(FacetShape::Quadrilateral8, &mut nodes, [6, 5], face(0.0, 0.0)));
        let disc = patch_of(FacetShape::Quadrilateral4, &mut nodes, [7, 7], face(0.0, 0.0));
        let mesh = skin(nodes, vec![("pad_face", "pad", pad), ("disc_face", "disc", disc)]);
        let model = model(vec![contact("pad", "pad_face", "disc_face")], true);
        let full = Interface::build(&model, &mesh, &Alone).unwrap();
        assert_eq!(full.points.len(), 120);
        let reduced = reduce(&model, &mesh, &full, 9).unwrap();
        let places: usize = reduced.points.iter().map(|point| point.places.len()).sum();
        assert_eq!(places, 120);
        let turn = [0.01, 0.02, -0.03];
        for (a, point) in reduced.points.iter().enumerate() {
            let rigid = |n: u32| if point.nodes.contains(&n) { cross(turn, mesh.nodes[n as usize]) } else { [0.0; 3] };
            assert!(norm(sub(reduced.gap_operator.gap(a, rigid), cross(turn, point.position))) < 1e-15);
            let mut moment = [0.0; 3];
            reduced.gap_operator.spread(a, [3.0, -1.0, 2.0], |n, f| {
                let own = cross(sub(mesh.nodes[n as usize], point.position), f);
                (0..3).filter(|_| point.nodes.contains(&n)).for_each(|i| moment[i] += own[i]);
            });
            assert!(norm(moment) < 1e-15, "{moment:?}");
        }
    }

    /// The volume of the gaps is that of the field over the contact points; a row on a reference node is its gap.
    #[test]
    fn a_reference_node_has_the_mean_gap_of_its_cell_or_that_of_its_own_row() {
        let (full, reduced, mesh) = pads(12).unwrap();
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("worn.csv");
        let row = |x: [f64; 3], gap: f64| format!("{:e},{:e},{:e},{gap:e}\n", x[0], x[1], x[2]);
        let of_points = full.points[full.pairs[0].points.clone()].iter();
        let rows: String = of_points.map(|point| row(point.position, 1e-4 * point.position[0].powi(2))).collect();
        let worn = |rows: &str| {
            std::fs::write(&file, format!("x_m,y_m,z_m,gap_m\n{rows}")).unwrap();
            let names = ["inner", "outer"];
            let mut contacts =
                names.map(|name| contact(name, &format!("lining_{name}_face"), &format!("disc_{name}_face")));
            contacts[0].gap_field = Some(GapField::read(&file, "inner").unwrap());
            let model = model(contacts.to_vec(), true);
            let full = Interface::build(&model, &mesh, &Alone).unwrap();
            let worn = reduce(&model, &mesh, &full, 12).unwrap();
            (full, worn)
        };
        let volume = |interface: &Interface, pair: usize| -> f64 {
            let points = interface.points[interface.pairs[pair].points.clone()].iter();
            points.map(|point| point.law.weight * point.field_gap).sum()
        };
        let (full, mean) = worn(&rows);
        assert!(volume(&full, 0) > 0.0 && (volume(&mean, 0) / volume(&full, 0) - 1.0).abs() < 1e-12);
        assert_eq!(volume(&mean, 1), 0.0);
        let (_, own) = worn(&(rows + &row(reduced.points[3].position, 3e-6)));
        assert_eq!(own.points[3].field_gap, 3e-6);
        assert!((own.points[3].law.gap - reduced.points[3].law.gap - 3e-6).abs() < 1e-20);
    }

    #[test]
    fn what_cannot_be_laid_out_is_refused_with_file_line_and_pair() {
        let fine = pads(104).unwrap_err().to_string();
        assert!(fine.contains("brake.toml:12") && fine.contains("\"inner\""), "{fine}");
        assert!(fine.contains("156 contact points") && fine.contains("there are 118"), "{fine}");
        assert!(pads(1).unwrap_err().to_string().contains("at least one each"));
        let still = reduce(&model(vec![], false), &Mesh::default(), &Interface::default(), 6).unwrap_err();
        assert!(still.to_string().contains("no contact pair slides"));
    }
}
