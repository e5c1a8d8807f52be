//! Interfaces of the test brake and of plates, and what is refused.

use super::*;
use crate::contact::search::Alone;
use crate::contact::testing::{contact, flipped, model, pads_on_disc, patch, skin};
use crate::model::{Contact, GapField, NormalLaw, StiffnessField};
use nalgebra::Vector3;

/// The two pads on their disc.
fn brake() -> (Interface, Mesh) {
    let mesh = pads_on_disc();
    let pads = vec![
        contact("inner", "lining_inner_face", "disc_inner_face"),
        contact("outer", "lining_outer_face", "disc_outer_face"),
    ];
    let interface = Interface::build(&model(pads, true), &mesh, &Alone).unwrap();
    (interface, mesh)
}

/// A plate "pad" on a plate "disc" at a distance, both unit squares.
fn plates(distance: f64) -> Mesh {
    let mut nodes = Vec::new();
    let pad = flipped(&patch(&mut nodes, [3, 3], |u, v| [u, v, distance]));
    let disc = patch(&mut nodes, [4, 4], |u, v| [u, v, 0.0]);
    skin(nodes, vec![("pad_face", "pad", pad), ("disc_face", "disc", disc)])
}

fn pad() -> Contact {
    contact("pad", "pad_face", "disc_face")
}

fn refused(contact: Contact, turning: bool, mesh: &Mesh) -> String {
    Interface::build(&model(vec![contact], turning), mesh, &Alone).unwrap_err().to_string()
}

#[test]
fn pads_on_a_disc_slide_along_the_circles_of_the_disc() {
    let (interface, _) = brake();
    assert_eq!(interface.points.len(), 236);
    assert_eq!(interface.gap_operator.len(), 236);
    assert_eq!(interface.pairs[1].points, 118..236);
    for pair in &interface.pairs {
        let found = &pair.statistics;
        assert_eq!((pair.kind, pair.swept), (TangentialKind::Sliding, true));
        assert_eq!((found.n_dropped, found.touching), (0, 118));
        assert!((found.weight / 4.495969950628393e-3 - 1.0).abs() < 1e-12);
    }
    for point in &interface.points {
        let law::Tangential::Sliding { direction, speed } = point.law.tangential else {
            panic!("{point:?} does not slide");
        };
        let [x, y, _] = point.position;
        let radius = x.hypot(y);
        let circle = Vector3::new(-y, x, 0.0) / radius;
        assert!((Vector3::from(direction) - circle).norm() < 1e-14);
        assert!((speed - 5.0 * radius).abs() < 1e-14);
    }
}

#[test]
fn a_gap_field_is_added_to_the_gaps_and_leaves_what_touches_touching() {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("worn.csv");
    let rows: String = (0..=24).map(|i| format!("{},{},{i}\n", 250 * (i % 5), 250 * (i / 5))).collect();
    std::fs::write(&file, "x_mm,y_mm,gap_um\n".to_owned() + &rows).unwrap();
    let field = GapField::read(&file, "pad").unwrap();
    let mesh = plates(1e-9);
    let build = |field: Option<&GapField>| {
        let contact = Contact { gap_field: field.cloned(), ..pad() };
        Interface::build(&model(vec![contact], true), &mesh, &Alone)
    };
    let (flat, worn) = (build(None).unwrap(), build(Some(&field)).unwrap());
    let positions: Vec<[f64; 3]> = flat.points.iter().map(|point| point.position).collect();
    let expected = field.at(&positions).unwrap();
    for ((flat, worn), gap) in flat.points.iter().zip(&worn.points).zip(&expected) {
        assert!((worn.law.gap - flat.law.gap - gap).abs() < 1e-18);
        assert!(flat.law.touching && worn.law.touching);
    }
    let [low, high] = worn.pairs[0].statistics.gap;
    assert!(low < 2e-6 && high > 22e-6 && high - low < 24e-6, "{low} {high}");
    std::fs::write(&file, "x_mm,y_mm,factor\n".to_owned() + &rows.replace(",0\n", ",0.5\n")).unwrap();
    let factors = StiffnessField::read(&file, "pad").unwrap();
    let contact = Contact { stiffness_field: Some(factors.clone()), ..pad() };
    let scaled = Interface::build(&model(vec![contact], true), &mesh, &Alone).unwrap();
    for (own, factor) in scaled.points.iter().zip(factors.at(&positions).unwrap()) {
        assert_eq!(own.law.normal_law, NormalLaw::Linear { stiffness: factor * 2e13 });
    }
    let elsewhere = Contact { gap_field: Some(field), ..pad() };
    let message = refused(elsewhere, true, &translated(plates(0.0), 1e3));
    assert!(message.starts_with("brake.toml:12: contact \"pad\": ") && message.contains("worn.csv: no row lies"));
}

/// A mesh moved along x.
fn translated(mut mesh: Mesh, by: f64) -> Mesh {
    mesh.nodes.iter_mut().for_each(|x| x[0] += by);
    mesh
}

#[test]
fn a_clearance_is_the_gap_of_all_points_in_place_of_the_meshs() {
    let mesh = plates(0.01);
    let gaps = |clearance| {
        let contact = Contact { clearance, search_distance: Some(1.0), ..pad() };
        let interface = Interface::build(&model(vec![contact], true), &mesh, &Alone).unwrap();
        let touching = interface.pairs[0].statistics.touching;
        (interface.points.iter().map(|point| point.law.gap).collect::<Vec<_>>(), touching == interface.points.len())
    };
    assert!(gaps(None).0.iter().all(|gap| (gap - 0.01).abs() < 1e-15) && !gaps(None).1);
    assert!(gaps(Some(0.2)).0.iter().all(|gap| *gap == 0.2) && !gaps(Some(0.2)).1);
    assert!(gaps(Some(-1e-3)).0.iter().all(|gap| *gap == -1e-3) && gaps(Some(-1e-3)).1);
}

/// Sum of forces and of moments about the origin that all points put on the slaves, and on all nodes together.
fn resultants(
    interface: &Interface,
    mesh: &Mesh,
    stage: &Stage,
    g: impl Fn(&ContactPoint) -> [f64; 3],
) -> ([Vector3<f64>; 2], [Vector3<f64>; 2]) {
    let mut slaves = [Vector3::zeros(); 2];
    let mut all = [Vector3::zeros(); 2];
    for (a, point) in interface.points.iter().enumerate() {
        let force = interface.respond(a, g(point), stage).force;
        slaves[0] += Vector3::from(force);
        slaves[1] += Vector3::from(point.position).cross(&Vector3::from(force));
        interface.gap_operator.spread(a, force, |node, f| {
            all[0] += Vector3::from(f);
            all[1] += Vector3::from(mesh.nodes[node as usize]).cross(&Vector3::from(f));
        });
    }
    (slaves, all)
}

#[test]
fn friction_turns_the_pads_with_the_disc_and_every_force_has_its_opposite() {
    let (interface, mesh) = brake();
    let stage = Stage::Solve { friction: vec![0.4, 0.2] };
    let depth = 1e-8;
    let press = |p: &ContactPoint| p.law.normal.map(|n| -depth * n);
    let ([force, moment], [all, all_moments]) = resultants(&interface, &mesh, &stage, press);
    // sum p = k d A on each pad; the torque on them is mu sum p r about +z
    let pressed = 2e13 * depth * 4.495969950628393e-3;
    let arms: Vec<f64> = interface
        .pairs
        .iter()
        .map(|pair| {
            let points = interface.points[pair.points.clone()].iter();
            points.map(|p| p.law.weight * p.position[0].hypot(p.position[1])).sum()
        })
        .collect();
    let torque = 2e13 * depth * (0.4 * arms[0] + 0.2 * arms[1]);
    assert!(force.z.abs() < 1e-9 * pressed);
    // The gaps are rounding of positions, 1e-10 of the depth.
    assert!((moment.z / torque - 1.0).abs() < 1e-9);
    assert!(all.norm() < 1e-12 * pressed && all_moments.norm() < 1e-12 * pressed);
}

#[test]
fn a_brake_that_settles_has_no_friction() {
    let (interface, mesh) = brake();
    let press = |p: &ContactPoint| p.law.normal.map(|n| -1e-8 * n);
    let ([_, moment], _) = resultants(&interface, &mesh, &Stage::Settle, press);
    assert!(moment.z.abs() < 1e-12);
    // All pads touch, so pulling them off is resisted, too.
    let lift = |p: &ContactPoint| p.law.normal.map(|n| 1e-8 * n);
    for (a, point) in interface.points.iter().enumerate() {
        let answer = interface.respond(a, lift(point), &Stage::Settle);
        assert!(answer.normal_force < 0.0 && answer.status == Status::Slip);
        let solved = Stage::Solve { friction: interface.frictions() };
        assert_eq!(interface.respond(a, lift(point), &solved).status, Status::Open);
    }
}

#[test]
fn pairs_at_rest_stick_and_each_pair_has_its_own_friction() {
    let stuck = Contact { stick: Some(1e13), ..pad() };
    let mut other = stuck.clone();
    other.name = "other".into();
    let interface = Interface::build(&model(vec![stuck, other], false), &plates(0.0), &Alone).unwrap();
    assert!(interface.pairs.iter().all(|p| p.kind == TangentialKind::StickSlip && !p.swept));
    assert_eq!(interface.frictions(), [0.5, 0.5]);
    let stage = Stage::Solve { friction: vec![0.5, 0.1] };
    // trial w k_t 1e-8 against mu w k_n 2e-8: sticks at 0.5, slips at 0.1
    let g = [1e-8, 0.0, -2e-8];
    let second = interface.pairs[1].points.start;
    assert_eq!(interface.respond(0, g, &stage).status, Status::Stick);
    let slip = interface.respond(second, g, &stage);
    assert_eq!(slip.status, Status::Slip);
    assert!((slip.force[0] + 0.1 * slip.normal_force).abs() < 1e-12 * slip.normal_force);
    // For stability both stick.
    let frozen = interface.linearise(second, g, slip.status, &[0.5, 0.1]);
    assert!((frozen[0][0] / (1e13 * interface.points[second].law.weight) - 1.0).abs() < 1e-14);
}

#[test]
fn forces_are_proportional_to_displacements_without_gaps_under_linear_laws() {
    let built =
        |contact: Contact, turning| Interface::build(&model(vec![contact], turning), &plates(0.0), &Alone).unwrap();
    let stuck = Contact { stick: Some(1e13), ..pad() };
    for interface in [built(pad(), true), built(stuck, false)] {
        assert!(interface.is_homogeneous());
        let at = |s: f64| interface.respond(0, [1e-8, 2e-9, -2e-8].map(|g| s * g), &interface.stage(0.3));
        let (one, many) = (at(1.0), at(7.0));
        assert_eq!(one.status, many.status);
        assert!((0..3).all(|i| (many.force[i] - 7.0 * one.force[i]).abs() < 1e-12 * many.normal_force));
    }
    let wide = Contact { clearance: Some(1e-9), ..pad() };
    assert!(!built(wide.clone(), true).is_homogeneous());
    assert!(built(Contact { separation: false, ..wide }, true).is_homogeneous(), "its gap counts as zero");
    let cubic = Contact { law: Some(NormalLaw::Cubic { k1: 1e13, k3: 1e25 }), ..pad() };
    assert!(!built(cubic, true).is_homogeneous());
    let mut falling = built(pad(), true);
    falling.pairs[0].friction_law = FrictionLaw::Missing;
    assert!(!falling.is_homogeneous(), "friction may depend on the pressure");
}

#[test]
fn points_at_a_distance_do_not_touch() {
    let wide = Contact { search_distance: Some(1.0), ..pad() };
    let interface = Interface::build(&model(vec![wide], true), &plates(0.01), &Alone).unwrap();
    let found = &interface.pairs[0].statistics;
    assert_eq!(found.touching, 0);
    assert!((found.gap[0] - 0.01).abs() < 1e-15 && (found.gap[1] - 0.01).abs() < 1e-15);
    let rest = [0.0; 3];
    assert_eq!(interface.respond(0, rest, &Stage::Settle).status, Status::Open);
}

#[test]
fn a_named_sweep_takes_only_the_pairs_it_names() {
    let mut second = pad();
    second.name = "second".into();
    let mut brake = model(vec![pad(), second], true);
    brake.swept = vec!["second".into()];
    let interface = Interface::build(&brake, &plates(0.0), &Alone).unwrap();
    let swept: Vec<_> = interface.pairs.iter().map(|p| p.swept).collect();
    assert_eq!(swept, [false, true]);
}

#[test]
fn a_pair_without_points_is_refused_with_the_closest_distance() {
    let message = refused(pad(), true, &plates(0.7));
    assert!(message.starts_with("brake.toml:12: contact \"pad\": none of the 33 points"));
    assert!(message.contains("closest is 0.7 away, in the mesh's unit"), "{message}");
    let near = Contact { search_distance: Some(0.5), ..pad() };
    assert!(refused(near, true, &plates(0.7)).contains("search distance 0.5 of"));
}

#[test]
fn surfaces_that_look_the_same_way_are_refused() {
    let mut mesh = plates(0.0);
    let face = mesh.surfaces.get_mut("pad_face").unwrap();
    *face = flipped(face);
    assert!(refused(pad(), true, &mesh).contains("no facet of \"disc_face\" faces"));
}

#[test]
fn merged_surfaces_are_refused() {
    let mut mesh = plates(0.0);
    let merged = flipped(&mesh.surfaces["disc_face"]);
    mesh.surfaces.get_mut("pad_face").unwrap().facets = merged.facets;
    mesh.surfaces.get_mut("pad_face").unwrap().parts = vec![0; 32];
    assert!(refused(pad(), true, &mesh).contains("56 nodes belong to both surfaces"));
}

#[test]
fn a_pair_at_rest_without_stick_has_no_friction() {
    let free = Contact { friction: 0.0, ..pad() };
    let interface = Interface::build(&model(vec![free], false), &plates(0.0), &Alone).unwrap();
    assert_eq!(interface.pairs[0].kind, TangentialKind::Frictionless);
}
