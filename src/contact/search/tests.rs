//! What the search finds on planes, cylinders, spheres and the test brake.

use super::*;
use crate::contact::gap_operator::GapOperator;
use crate::contact::testing::{flipped, pads_on_disc, patch, patch_of};
use crate::element::FacetShape;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const ALL: Options = Options { search_distance: Some(f64::INFINITY) };

fn weights(found: &Found) -> f64 {
    found.points.iter().map(|p| p.weight).sum()
}

fn length(x: [f64; 3]) -> f64 {
    Vector3::from(x).norm()
}

/// A unit square at height z that looks up, in `n` by `n` squares.
fn floor(nodes: &mut Vec<[f64; 3]>, n: usize, z: f64) -> Surface {
    patch(nodes, [n, n], |u, v| [u, v, z])
}

#[test]
fn plane_on_plane_is_exact() {
    let mut nodes = Vec::new();
    let slave = flipped(&floor(&mut nodes, 3, 1e-3));
    let master = floor(&mut nodes, 4, 0.0);
    let found = find(&slave, &master, &nodes, &Options::default(), &Alone);
    // 3 edges a facet, those inside counted twice: (3 * 18 + 12)/2
    assert_eq!(found.points.len(), 33);
    assert!(found.n_dropped == 0);
    assert!((found.area - 1.0).abs() < 1e-14 && (weights(&found) - 1.0).abs() < 1e-14);
    for point in &found.points {
        assert!((point.gap - 1e-3).abs() < 1e-16 && (point.distance - 1e-3).abs() < 1e-15);
        assert_eq!(point.normal, [0.0, 0.0, 1.0]);
        assert!((point.master.shape.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}

/// Slave and master of any two shapes: gaps, areas and linear fields are exact.
#[test]
fn plane_on_plane_is_exact_for_all_facets() {
    for (slave_shape, master_shape) in
        FacetShape::ALL.iter().flat_map(|a| FacetShape::ALL.iter().map(move |b| (*a, *b)))
    {
        let mut nodes = Vec::new();
        let plane = |z: f64| move |u: f64, v: f64| [u + 0.1 * v, v, z];
        let slave = flipped(&patch_of(slave_shape, &mut nodes, [3, 2], plane(1e-3)));
        let master = patch_of(master_shape, &mut nodes, [2, 4], plane(0.0));
        let found = find(&slave, &master, &nodes, &ALL, &Alone);
        assert!(found.n_dropped == 0 && (weights(&found) - 1.0).abs() < 1e-14 && (found.area - 1.0).abs() < 1e-14);
        for point in &found.points {
            assert!((point.gap - 1e-3).abs() < 1e-15 && point.weight > 0.0, "{slave_shape:?} {master_shape:?}");
            let at = |side: &Interpolated| -> Vector3<f64> {
                let terms = side.nodes.iter().zip(&side.shape);
                terms.map(|(&n, shape)| *shape * Vector3::from(nodes[n as usize])).sum()
            };
            assert!((at(&point.slave) - Vector3::from(point.position)).norm() < 1e-15);
            let gap: Vector3<f64> = at(&point.slave) - at(&point.master);
            assert!((gap - Vector3::new(0.0, 0.0, 1e-3)).norm() < 1e-14);
        }
    }
}

#[test]
fn overlap_is_a_negative_gap() {
    let mut nodes = Vec::new();
    let slave = flipped(&floor(&mut nodes, 2, -1e-3));
    let master = floor(&mut nodes, 2, 0.0);
    let found = find(&slave, &master, &nodes, &Options::default(), &Alone);
    assert!(found.points.iter().all(|p| (p.gap + 1e-3).abs() < 1e-16));
}

#[test]
fn a_piston_meets_its_bore_and_not_a_closer_wall_that_looks_away() {
    let mut nodes = Vec::new();
    let radius = 0.02;
    let wall = |radius: f64, turn: f64| {
        move |u: f64, v: f64| {
            let angle = TAU * u + turn;
            [radius * angle.cos(), radius * angle.sin(), 0.03 * v]
        }
    };
    let piston = patch(&mut nodes, [24, 5], wall(radius, 0.0));
    let bore = flipped(&patch(&mut nodes, [17, 4], wall(radius, 0.1)));
    let away = patch(&mut nodes, [17, 4], wall(radius + 1e-6, 0.2));
    let mut master = bore.clone();
    master.facets.extend(&away.facets);

    let found = find(&piston, &master, &nodes, &Options::default(), &Alone);
    assert!(found.n_dropped == 0);
    assert!((weights(&found) / (TAU * radius * 0.03) - 1.0).abs() < 1e-4);
    // A quadratic arc of angle a leaves its circle by less than R a^4/100.
    let bulge = radius * (TAU / 17.0).powi(4) / 100.0;
    for point in &found.points {
        assert!(point.facet < bore.facets.len());
        assert!(point.gap.abs() < bulge, "{point:?}");
        let [x, y, _] = point.position;
        let inward = Vector3::new(-x, -y, 0.0) / radius;
        assert!(Vector3::from(point.normal).dot(&inward) > 0.999);
    }
}

/// The cap of a sphere of radius 1 about the origin, up to 0.5 rad from the pole at +z.
fn cap(nodes: &mut Vec<[f64; 3]>, n: usize) -> Surface {
    patch(nodes, [n, n], |u, v| {
        let (a, b) = ((u - 0.5).tan(), (v - 0.5).tan());
        let scale = 1.0 / (1.0 + a * a + b * b).sqrt();
        [a * scale, b * scale, scale]
    })
}

#[test]
fn a_sphere_over_a_plane_has_its_heights_for_gaps() {
    let mut nodes = Vec::new();
    let sphere = cap(&mut nodes, 4);
    let ceiling = flipped(&patch(&mut nodes, [3, 3], |u, v| [2.0 * u - 1.0, 2.0 * v - 1.0, 1.0]));
    let found = find(&sphere, &ceiling, &nodes, &ALL, &Alone);
    assert!(found.n_dropped == 0);
    for point in &found.points {
        assert!((point.gap - (1.0 - point.position[2])).abs() < 1e-15);
    }
}

#[test]
fn a_plane_over_a_sphere_has_radial_gaps_that_converge_with_the_mesh() {
    let mut errors = Vec::new();
    for n in [4, 8] {
        let mut nodes = Vec::new();
        let sphere = cap(&mut nodes, n);
        let plane = flipped(&patch(&mut nodes, [5, 5], |u, v| [0.5 * u - 0.25, 0.5 * v - 0.25, 1.05]));
        let found = find(&plane, &sphere, &nodes, &ALL, &Alone);
        let error = |p: &FoundPoint| (p.gap - (length(p.position) - 1.0)).abs();
        errors.push(found.points.iter().map(error).fold(0.0, f64::max));
    }
    // Quadratic facets: at least third order.
    assert!(errors[0] < 2e-4 && errors[1] < errors[0] / 7.0, "{errors:?}");
}

#[test]
fn points_beyond_an_edge_clamp_to_it_within_the_search_distance() {
    let mut nodes = Vec::new();
    let slave = flipped(&floor(&mut nodes, 10, 0.0));
    let master = patch(&mut nodes, [3, 3], |u, v| [0.52 * u, v, 0.0]);
    let beyond = |p: &FoundPoint| p.position[0] - 0.52;

    let all = find(&slave, &master, &nodes, &ALL, &Alone);
    assert!(all.n_dropped == 0);
    for point in &all.points {
        assert!((point.distance - beyond(point).max(0.0)).abs() < 1e-14);
        assert!(point.gap.abs() < 1e-16);
    }

    // Half the mean edge of the squares' triangles.
    let reach = 0.5 * 0.1 * (2.0 + 2.0_f64.sqrt()) / 3.0;
    let near = find(&slave, &master, &nodes, &Options::default(), &Alone);
    assert!(near.points.iter().all(|p| beyond(p) <= reach));
    assert_eq!(near.points.len(), all.points.iter().filter(|p| beyond(p) <= reach).count());
    assert_eq!(near.points.len() + near.n_dropped, all.points.len());
    let own = Options { search_distance: Some(0.2) };
    let wide = find(&slave, &master, &nodes, &own, &Alone);
    assert!(wide.points.len() > near.points.len());
    assert!(weights(&wide) < wide.area);
}

#[test]
fn a_tie_goes_to_the_lowest_facet_whatever_its_place_in_the_tree() {
    let mut nodes = Vec::new();
    let slave = flipped(&floor(&mut nodes, 6, 0.0));
    let mut master = floor(&mut nodes, 3, 0.0);
    let before = find(&slave, &master, &nodes, &Options::default(), &Alone);
    master.facets.reverse();
    let after = find(&slave, &master, &nodes, &Options::default(), &Alone);
    let last = master.facets.len() - 1;
    let mut ties = 0;
    for (a, b) in before.points.iter().zip(&after.points) {
        assert_eq!(a.place, b.place);
        // The same facet seen in the other order, or a lower one of several.
        assert!(a.facet <= last - b.facet, "{a:?} {b:?}");
        ties += usize::from(a.facet < last - b.facet);
    }
    assert!(ties > 10);
}

#[test]
fn nothing_faces_a_surface_of_the_same_side() {
    let mut nodes = Vec::new();
    let slave = floor(&mut nodes, 2, 0.0);
    let master = floor(&mut nodes, 2, 0.0);
    let found = find(&slave, &master, &nodes, &ALL, &Alone);
    assert!(found.points.is_empty());
    assert_eq!(found.n_dropped, 16);
}

#[test]
fn pads_on_a_disc_have_the_reference_points_and_areas() {
    let mesh = pads_on_disc();
    for side in ["inner", "outer"] {
        let surface = |part: &str| &mesh.surfaces[&format!("{part}_{side}_face")];
        let found = find(surface("lining"), surface("disc"), &mesh.nodes, &Options::default(), &Alone);
        assert_eq!((found.points.len(), found.n_dropped), (118, 0));
        assert!((found.area / 4.495969950628393e-3 - 1.0).abs() < 1e-12);
        assert!((weights(&found) / found.area - 1.0).abs() < 1e-13);
        assert!(found.points.iter().all(|p| p.gap.abs() < 1e-15));
    }
}

/// GapOperator of a slave patch at height `gap` over a master patch, with all nodes.
fn patch_above_patch(gap: f64) -> (Vec<[f64; 3]>, Found, GapOperator) {
    let mut nodes = Vec::new();
    let slave = flipped(&floor(&mut nodes, 3, gap));
    let master = floor(&mut nodes, 4, 0.0);
    let found = find(&slave, &master, &nodes, &ALL, &Alone);
    let mut gap_operator = GapOperator::new();
    for point in &found.points {
        gap_operator.push_projection(&point.slave, &point.master);
    }
    (nodes, found, gap_operator)
}

proptest! {
    #[test]
    fn a_rigid_motion_of_both_bodies_moves_a_gap_only_by_its_own_rotation(
        gap in prop::sample::select(vec![0.0, 0.02]),
        shift in prop::array::uniform3(-1.0..1.0),
        turn in prop::array::uniform3(-1.0..1.0),
    ) {
        let (nodes, found, gap_operator) = patch_above_patch(gap);
        let (shift, turn) = (Vector3::from(shift), Vector3::from(turn));
        let rigid = |n: u32| (shift + turn.cross(&Vector3::from(nodes[n as usize]))).into();
        for (a, point) in found.points.iter().enumerate() {
            // u = s + phi x X: g = phi x (X_slave - X_projection) = gap phi x n, nothing where the gap is zero
            let expected = point.gap * turn.cross(&Vector3::from(point.normal));
            let g = Vector3::from(gap_operator.gap(a, rigid));
            prop_assert!((g - expected).norm() < 1e-14);
        }
    }
}

#[test]
fn weights_are_the_exact_quadrature_of_a_uniform_pressure() {
    // Patch test on a curved surface: sum w_a n_a of a half cylinder's closed-form resultant.
    let mut nodes = Vec::new();
    let half = patch(&mut nodes, [20, 3], |u, v| [(PI * u).cos(), (PI * u).sin(), v]);
    let shell = flipped(&patch(&mut nodes, [20, 3], |u, v| [(PI * u).cos(), (PI * u).sin(), v]));
    let found = find(&half, &shell, &nodes, &Options::default(), &Alone);
    let resultant: Vector3<f64> = found.points.iter().map(|p| -p.weight * Vector3::from(p.normal)).sum();
    assert!((resultant - Vector3::new(0.0, 2.0, 0.0)).norm() < 1e-3, "{resultant}");
}
