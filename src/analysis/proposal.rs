//! A model file proposed for a mesh: what can be seen in the mesh is filled in, what cannot stands as a comment.
//!
//! Seen are the parts, the surfaces that touch, and the part that turns: it is a solid of revolution, whose inertia
//! has two equal principal moments, smaller than the third; the axis belongs to the third.

use std::fmt::Write;
use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use crate::contact::search::{Alone, Options, find};
use crate::contact::surface_points::surface_points;
use crate::element::facet::{area, pressure_load};
use crate::element::solid::{MassProperties, mass_properties};
use crate::mesh::Mesh;

/// Surfaces touch where at least this fraction of the smaller one has the other one opposite.
const TOUCHING: f64 = 0.1;
/// Two principal moments of inertia are equal within this fraction of the third.
const REVOLUTION: f64 = 0.02;
/// Extents of brakes in their unit of length: (smallest, name of the unit).
const UNITS: [(f64, &str); 3] = [(20.0, "mm"), (2.0, "cm"), (0.0, "m")];
/// What a part's name says of its material: words, material.
const MATERIALS: [(&[&str], &str); 3] = [
    (&["lining", "friction"], "lining"),
    (&["plate", "piston", "shim", "steel", "pin"], "steel"),
    (&["pad"], "lining"),
];
/// Materials: name, Young's modulus (Pa), Poisson's ratio, density (kg/m3), what it is.
const PROPERTIES: [(&str, f64, f64, f64, &str); 3] = [
    ("iron", 110e9, 0.27, 7100.0, "grey cast iron"),
    ("lining", 8e9, 0.3, 2600.0, "friction material: measure it, linings differ by factors"),
    ("steel", 210e9, 0.3, 7850.0, "steel"),
];

/// Words in the names of surfaces that are bolted or clamped.
const HOLDING: [&str; 6] = ["hub", "bolt", "fix", "mount", "clamp", "ground"];

/// Damping of a part, as a comment.
const DAMPING: &str = "#rayleigh = { alpha = 5, beta = 1e-7 }   # 1/s and s; choose: without damping no mode decays\n";
/// Cosine of the angle between a face and the axis above which a load on it presses pads against the disc.
const ALONG_AXIS: f64 = 0.9;

/// Two surfaces that touch.
struct Touching {
    slave: String,
    master: String,
    /// Whether one of them turns.
    sliding: bool,
}

/// The text of a model file for a mesh as its file has it, in the file's unit; `mesh_file` is the path that the model
/// file gives.
pub fn propose_model(mesh: &Mesh, mesh_file: &Path) -> String {
    let unit = unit(mesh);
    let turning = turning(mesh);
    let pairs = touching(mesh, turning.as_ref().map(|turning| turning.part));
    let mut text = format!(
        "# Proposed by `squeal new`. Lines with \"choose\" hold what no mesh says. `squeal example` explains every key.\n\n\
         [mesh]\nfile = \"{}\"\nunit = \"{unit}\"   # from the size of the model; choose if it is another\n",
        mesh_file.display()
    );
    materials(&mut text, mesh);
    supports_and_loads(&mut text, mesh, &pairs, turning.as_ref());
    rotation(&mut text, mesh, turning.as_ref());
    contacts(&mut text, &pairs);
    text += "\n[stability]\nband = [0, 6000]   # Hz\n";
    text += match turning {
        Some(_) => "\n[sweep]\nfriction = { from = 0.1, to = 0.7, step = 0.1 }\n",
        None => "",
    };
    text
}

/// Name of the unit of length in which the mesh is as large as a brake.
fn unit(mesh: &Mesh) -> &'static str {
    let extent = |i: usize| {
        let ends = mesh.nodes.iter().fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x[i]), high.max(x[i])]);
        ends[1] - ends[0]
    };
    let largest = (0..3).map(extent).fold(0.0, f64::max);
    UNITS.into_iter().find(|(from, _)| largest >= *from).unwrap_or(UNITS[0]).1
}

/// A part that turns.
struct Turning {
    part: u32,
    axis: Vector3<f64>,
    through: Vector3<f64>,
}

/// The solid of revolution with the largest moment of inertia; none where no part is one.
fn turning(mesh: &Mesh) -> Option<Turning> {
    let mut bodies = vec![MassProperties::default(); mesh.parts.len()];
    for (e, element) in mesh.elements.iter().enumerate() {
        bodies[element.part as usize] += mass_properties(element.shape(), &mesh.element_nodes(e), 1.0);
    }
    let of_revolution = |(part, body): (u32, &MassProperties)| {
        let inertia = Matrix3::from_fn(|i, j| body.inertia_about(body.centre())[i][j]).symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| inertia.eigenvalues[i].total_cmp(&inertia.eigenvalues[j]));
        let [small, middle, large] = order.map(|i| inertia.eigenvalues[i]);
        let is_one = middle - small < REVOLUTION * large && large - middle > REVOLUTION * large;
        let axis = inertia.eigenvectors.column(order[2]).into_owned();
        is_one.then_some((large, Turning { part, axis: rounded(axis), through: body.centre().into() }))
    };
    (0..).zip(&bodies).filter_map(of_revolution).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, turning)| turning)
}

/// An axis, which may point either way, by its nearest coordinate axis where it is within 0.1 % of it.
fn rounded(axis: Vector3<f64>) -> Vector3<f64> {
    match axis.iter().position(|c| c.abs() > 0.999_999) {
        Some(i) => Vector3::ith(i, 1.0),
        None => axis,
    }
}

/// The pairs of named surfaces of different parts that touch. The slave is never the turning part, else the surface
/// with more facets for its area.
fn touching(mesh: &Mesh, turning: Option<u32>) -> Vec<Touching> {
    let surfaces: Vec<(&String, u32)> =
        mesh.surfaces.keys().filter_map(|name| Some((name, mesh.part_of_surface(name)?))).collect();
    let mut pairs = Vec::new();
    for (i, a) in surfaces.iter().enumerate() {
        for b in surfaces[i + 1..].iter().filter(|b| b.1 != a.1) {
            let [slave, master] = if turning == Some(a.1) { [b, a] } else { [a, b] };
            pairs.extend(touch(mesh, slave.0, master.0, turning == Some(a.1) || turning == Some(b.1)));
        }
    }
    pairs
}

/// Whether two surfaces touch.
fn touch(mesh: &Mesh, slave: &str, master: &str, sliding: bool) -> Option<Touching> {
    let (a, b) = (&mesh.surfaces[slave], &mesh.surfaces[master]);
    let found = find(a, b, &mesh.nodes, &Options::default(), &Alone);
    let met: f64 = found.points.iter().map(|point| point.weight).sum();
    let (_, other) = surface_points(b, &mesh.nodes);
    let touch = met > TOUCHING * found.area.min(other);
    touch.then(|| Touching { slave: slave.into(), master: master.into(), sliding })
}

fn material_of(part: &str) -> &'static str {
    let name = part.to_lowercase();
    let found = MATERIALS.iter().find(|(words, _)| words.iter().any(|word| name.contains(word)));
    found.map_or("iron", |(_, material)| material)
}

fn materials(text: &mut String, mesh: &Mesh) {
    let is_used = |name: &str| mesh.parts.iter().any(|part| material_of(part) == name);
    for (name, young, poisson, density, what) in PROPERTIES.iter().filter(|row| is_used(row.0)) {
        let _ = write!(
            text,
            "\n[material.{name}]   # {what}; choose\nyoung = {young:e}\npoisson = {poisson}\ndensity = {density}\n"
        );
    }
    for part in &mesh.parts {
        let is_bare = part.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c));
        let key = if is_bare { part.clone() } else { format!("{part:?}") };
        let _ = write!(text, "\n[part.{key}]\nmaterial = \"{}\"\n{DAMPING}", material_of(part));
    }
}

/// What holds the disc: a surface that is called so, or another one of the part that turns. What presses the pads:
/// faces across the axis on other parts, as comments.
fn supports_and_loads(text: &mut String, mesh: &Mesh, pairs: &[Touching], turning: Option<&Turning>) {
    let touches = |name: &String| pairs.iter().any(|pair| [&pair.slave, &pair.master].contains(&name));
    let free: Vec<&String> = mesh.surfaces.keys().chain(mesh.node_sets.keys()).filter(|name| !touches(name)).collect();
    let _ = write!(text, "\n# Surfaces and sets that touch nothing: {free:?}\n\n");
    let holds = |name: &&&String| HOLDING.iter().any(|word| name.to_lowercase().contains(word));
    let turns = |name: &String| turning.is_some_and(|own| mesh.part_of_surface(name) == Some(own.part));
    let held = free.iter().find(holds).or_else(|| free.iter().find(|name| turns(name)));
    let (mark, name) = held.map_or(("#", "..."), |name| ("", name.as_str()));
    let _ = write!(
        text,
        "{mark}[[fix]]                      # choose: what holds the disc, the bracket, the pads\n{mark}nodes = {name:?}\n\
         {mark}axes = \"xyz\"\n\n"
    );
    let pressed: Vec<String> = free
        .iter()
        .filter(|name| held != Some(name) && !turns(name))
        .filter_map(|name| pressed(name, into_part(mesh, name)?, turning?.axis))
        .collect();
    *text += &match pressed[..] {
        [] => "#[[load]]                    # choose: what presses the pads against the disc\n#on = \"...\"\n\
               #force = [0, 0, 4000]        # N in total; or pressure = 2e6, Pa\n"
            .to_owned(),
        _ => pressed.concat(),
    };
}

/// The mean direction into the part behind a surface; none of node sets.
fn into_part(mesh: &Mesh, surface: &str) -> Option<Vector3<f64>> {
    let facets = &mesh.surfaces.get(surface)?.facets;
    let of_unit_pressure = facets.iter().flat_map(|facet| pressure_load(&facet.positions(&mesh.nodes), 1.0));
    let sum: Vector3<f64> = of_unit_pressure.map(Vector3::from).sum();
    let area: f64 = facets.iter().map(|facet| area(&facet.positions(&mesh.nodes))).sum();
    Some(sum / area)
}

/// A support across the axis and a load along it, as comments; none where the surface is not across the axis.
fn pressed(surface: &str, into: Vector3<f64>, axis: Vector3<f64>) -> Option<String> {
    let along = into.dot(&axis);
    (along.abs() > ALONG_AXIS).then(|| {
        let across: String = "xyz".chars().zip(axis.iter()).filter(|(_, a)| a.abs() < 0.5).map(|(c, _)| c).collect();
        let force = (axis * along.signum() * 4000.0).map(|f| f.round() + 0.0);
        format!(
            "#[[fix]]                     # choose: {surface:?} guided across the axis\n#nodes = {surface:?}\n#axes = {across:?}\n\
             #[[load]]                    # choose: {surface:?} pressed\n#on = {surface:?}\n\
             #force = [{}, {}, {}]        # N in total; or pressure = 2e6, Pa\n#spread = \"area\"\n\n",
            force.x, force.y, force.z
        )
    })
}

fn rotation(text: &mut String, mesh: &Mesh, turning: Option<&Turning>) {
    let Some(Turning { part, axis, through }) = turning else {
        *text += "\n# No part is a solid of revolution. A disc that turns needs a [[rotation]].\n";
        return;
    };
    let list = |v: &Vector3<f64>| {
        let numbers = v.iter().map(|c| format!("{}", (c * 1e4).round() / 1e4 + 0.0)).collect::<Vec<_>>();
        format!("[{}]", numbers.join(", "))
    };
    let _ = write!(
        text,
        "\n[[rotation]]                 # the part that is a solid of revolution\npart = {:?}\naxis = {}\nthrough = {}\n\
         speed = 5.0                  # rad/s; choose the sense: it turns right-handed about the axis\n",
        mesh.parts[*part as usize],
        list(axis),
        list(through)
    );
}

fn contacts(text: &mut String, pairs: &[Touching]) {
    for Touching { slave, master, sliding } in pairs {
        let friction = if *sliding { 0.4 } else { 0.15 };
        let _ = write!(
            text,
            "\n[[contact]]\nslave = {slave:?}\nmaster = {master:?}\n\
             law = \"auto\"                 # by the elements beside it; or {{ linear = 2e13 }}, N/m3\nfriction = {friction}\n"
        );
    }
    if pairs.is_empty() {
        *text += "\n# No two named surfaces of different parts touch. Name the faces of pads and disc as physical surfaces in Gmsh,\n\
                  # and do not glue pads and disc: parts in contact share no nodes.\n";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pads_on_disc() -> Mesh {
        crate::mesh::read("tests/data/pads_on_disc.msh".as_ref(), 1.0).unwrap()
    }

    #[test]
    fn the_disc_turns_about_its_axis() {
        let mesh = pads_on_disc();
        let found = turning(&mesh).unwrap();
        assert_eq!(mesh.parts[found.part as usize], "disc");
        assert_eq!(found.axis, Vector3::z());
        assert!(found.through.norm() < 1e-3, "{}", found.through);
    }

    #[test]
    fn pads_alone_have_no_axis() {
        assert!(turning(&pads_on_disc().only("lining_inner").unwrap()).is_none());
    }

    #[test]
    fn faces_that_touch_are_pairs_with_the_pad_as_slave() {
        let mesh = pads_on_disc();
        let disc = turning(&mesh).map(|found| found.part);
        let pairs: Vec<_> =
            touching(&mesh, disc).into_iter().map(|pair| (pair.slave, pair.master, pair.sliding)).collect();
        let pair = |side: &str| (format!("lining_{side}_face"), format!("disc_{side}_face"), true);
        assert_eq!(pairs, [pair("inner"), pair("outer")]);
    }

    #[test]
    fn what_turns_is_held_and_what_lies_across_the_axis_is_pressed() {
        let mut mesh = pads_on_disc();
        let proposed = propose_model(&mesh, "brake.msh".as_ref());
        assert!(proposed.contains(
            "[[fix]]                      # choose: what holds the disc, the bracket, the pads\nnodes = \"hub\""
        ));
        let load = |side: &str, force: &str| format!("#on = \"backplate_{side}_back\"\n#force = [0, 0, {force}] ");
        assert!(proposed.contains(&load("inner", "4000")) && proposed.contains(&load("outer", "-4000")), "{proposed}");
        assert!(proposed.contains("#nodes = \"backplate_inner_back\"\n#axes = \"xy\"\n"));
        // A surface of the disc without a telling name is held, too; without one, nothing is.
        let hub = mesh.surfaces.remove("hub").expect("the mesh has it");
        mesh.surfaces.insert("zone".into(), hub);
        assert!(propose_model(&mesh, "brake.msh".as_ref()).contains("\nnodes = \"zone\"\naxes = \"xyz\""));
        mesh.surfaces.remove("zone");
        assert!(propose_model(&mesh, "brake.msh".as_ref()).contains("\n#nodes = \"...\"\n"));
    }

    #[test]
    fn a_brake_is_as_large_in_its_unit_as_brakes_are() {
        let mut mesh = pads_on_disc();
        assert_eq!(unit(&mesh), "mm");
        mesh.nodes.iter_mut().flatten().for_each(|x| *x *= 1e-3);
        assert_eq!(unit(&mesh), "m");
    }

    #[test]
    fn the_text_is_a_model_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("brake.toml");
        std::fs::write(&file, propose_model(&pads_on_disc(), "brake.msh".as_ref())).unwrap();
        let model = crate::model::read(&file).unwrap();
        let names: Vec<_> = model.contacts.iter().map(|contact| contact.name.as_str()).collect();
        assert_eq!(names, ["lining_inner_face / disc_inner_face", "lining_outer_face / disc_outer_face"]);
        let materials: Vec<_> =
            model.parts.iter().map(|part| (part.name.as_str(), part.material.name.as_str())).collect();
        assert!(materials.contains(&("disc", "iron")) && materials.contains(&("backplate_inner", "steel")));
        assert_eq!(model.fixes[0].nodes, "hub");
        assert!(model.contacts.iter().all(|contact| contact.law.is_none()));
    }
}
