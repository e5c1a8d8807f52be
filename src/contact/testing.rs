//! Surfaces for the tests of this module.

use super::facet::FacetGeometry;
use crate::element::FacetShape;
use crate::mesh::{self, Facet, Mesh, Surface};
use crate::model::{Contact, Inertia, InstabilityCriterion, Model, NormalLaw, Place, Rotation};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// A facet of any shape and of about unit size whose nodes all lie a little off their places.
pub(in crate::contact) fn bent_facet() -> impl Strategy<Value = FacetGeometry> {
    let offsets = prop::array::uniform8(prop::array::uniform3(-0.08..0.08));
    (prop::sample::select(FacetShape::ALL.to_vec()), offsets).prop_map(|(shape, offsets)| {
        let nodes = shape.interpolation().nodes().iter().zip(offsets);
        let positions = nodes.map(|(&[r, s], offset)| Vector3::new(r, s, 0.0) + Vector3::from(offset));
        FacetGeometry::new(&positions.collect::<Vec<_>>())
    })
}

/// A point of a facet's reference element, of whatever shape it is.
pub(in crate::contact) fn on_reference() -> impl Strategy<Value = OnReference> {
    (0.0..1.0, 0.0..1.0).prop_map(|(a, b): (f64, f64)| OnReference([a, b]))
}

/// A point of the unit square that stands for one of any facet.
#[derive(Debug, Clone, Copy)]
pub(in crate::contact) struct OnReference([f64; 2]);

impl OnReference {
    pub fn on(&self, facet: &FacetGeometry) -> [f64; 2] {
        let [a, b] = self.0;
        if facet.shape.is_triangle() { [a * (1.0 - b), b] } else { [2.0 * a - 1.0, 2.0 * b - 1.0] }
    }
}

/// A structured patch of `2 nu nv` quadratic facets: every node is `map(u, v)` with u, v in [0, 1], appended to
/// `nodes`. Outward is the side of `map_u x map_v`.
pub fn patch(nodes: &mut Vec<[f64; 3]>, [nu, nv]: [usize; 2], map: impl Fn(f64, f64) -> [f64; 3]) -> Surface {
    let first = nodes.len();
    let (width, height) = (2 * nu + 1, 2 * nv + 1);
    for j in 0..height {
        for i in 0..width {
            nodes.push(map(i as f64 / (2 * nu) as f64, j as f64 / (2 * nv) as f64));
        }
    }
    let node = |i: usize, j: usize| (first + j * width + i) as u32;
    let mut surface = Surface::default();
    for (i, j) in (0..nv).flat_map(|j| (0..nu).map(move |i| (2 * i, 2 * j))) {
        let [a, b, c, d] = [node(i, j), node(i + 2, j), node(i + 2, j + 2), node(i, j + 2)];
        let middle = node(i + 1, j + 1);
        let (south, east) = (node(i + 1, j), node(i + 2, j + 1));
        let (north, west) = (node(i + 1, j + 2), node(i, j + 1));
        surface.facets.push([a, b, c, south, east, middle].into());
        surface.facets.push([a, c, d, middle, north, west].into());
    }
    surface.parts = vec![0; surface.facets.len()];
    surface
}

/// As [`patch`] with facets of any shape: `nu nv` quadrilaterals, or twice as many triangles.
pub fn patch_of(
    shape: FacetShape,
    nodes: &mut Vec<[f64; 3]>,
    n: [usize; 2],
    map: impl Fn(f64, f64) -> [f64; 3],
) -> Surface {
    let mut quadratic = Vec::new();
    let mut surface = patch(&mut quadratic, n, map);
    if !shape.is_triangle() {
        let halves: Vec<[u32; 6]> =
            surface.facets.iter().map(|facet| facet.nodes().try_into().expect("six nodes")).collect();
        let whole = |pair: &[[u32; 6]]| {
            let ([a, b, c, south, east, _], [_, _, d, _, north, west]) = (pair[0], pair[1]);
            Facet::from([a, b, c, d, south, east, north, west])
        };
        surface.facets = halves.chunks_exact(2).map(whole).collect();
        surface.parts.truncate(surface.facets.len());
    }
    let n_kept = shape.n_nodes();
    surface.facets.iter_mut().for_each(|facet| *facet = facet.nodes()[..n_kept].iter().copied().collect());
    let mut place = BTreeMap::new();
    for facet in &mut surface.facets {
        *facet = facet.renumbered(|n| {
            *place.entry(n).or_insert_with(|| {
                nodes.push(quadratic[n as usize]);
                nodes.len() as u32 - 1
            })
        });
    }
    surface
}

/// A facet seen from the other side: first corner, the others backwards, and the midsides from the last.
fn turned(facet: &Facet) -> Facet {
    let (first, others) = facet.corners().split_first().expect("a facet has corners");
    [*first].into_iter().chain(others.iter().rev().copied()).chain(facet.midsides().iter().rev().copied()).collect()
}

/// The same facets seen from the other side.
pub fn flipped(surface: &Surface) -> Surface {
    Surface { facets: surface.facets.iter().map(turned).collect(), ..surface.clone() }
}

/// A model of nothing but contacts, the part "disc" turning about +z at 5 rad/s where `turning`.
pub fn model(contacts: Vec<Contact>, turning: bool) -> Model {
    let rotation = Rotation {
        part: "disc".into(),
        axis: [0.0, 0.0, 1.0],
        through: [0.0; 3],
        speed: 5.0,
        inertia: Inertia::None,
        place: Place::default(),
    };
    Model {
        file: "brake.toml".into(),
        title: String::new(),
        mesh_file: "brake.msh".into(),
        mesh_unit: 1.0,
        unit_system: None,
        parts: Vec::new(),
        fixes: Vec::new(),
        rotations: if turning { vec![rotation] } else { Vec::new() },
        contacts,
        connectors: Vec::new(),
        ties: Vec::new(),
        rigid_sets: Vec::new(),
        masses: Vec::new(),
        equations: Vec::new(),
        loads: Vec::new(),
        band: [0.0, 1.0],
        friction_damping: false,
        prestress: None,
        criterion: InstabilityCriterion::default(),
        swept: Vec::new(),
        frictions: Vec::new(),
        files: vec!["brake.toml".into()],
        mesh_place: Place::default(),
        sweep_place: Place::default(),
        reduction: None,
    }
}

/// A linear contact of 2e13 N/m3 that may open, with friction 0.5.
pub fn contact(name: &str, slave: &str, master: &str) -> Contact {
    Contact {
        name: name.into(),
        slave: slave.into(),
        master: master.into(),
        law: Some(NormalLaw::Linear { stiffness: 2e13 }),
        friction: 0.5,
        friction_curve: None,
        stick: None,
        separation: true,
        search_distance: None,
        adjust: 0.0,
        clearance: None,
        gap_field: None,
        stiffness_field: None,
        wear: None,
        place: Place { file: 0, line: 12 },
    }
}

/// A mesh of surfaces only: each comes with the name of the part it lies on.
pub fn skin(nodes: Vec<[f64; 3]>, surfaces: Vec<(&str, &str, Surface)>) -> Mesh {
    let mut mesh = Mesh { nodes, ..Mesh::default() };
    for (name, part, mut surface) in surfaces {
        surface.parts = vec![mesh.parts.len() as u32; surface.facets.len()];
        mesh.parts.push(part.into());
        mesh.surfaces.insert(name.into(), surface);
    }
    mesh
}

/// Two pads on a disc, the mesh of `tests/data`.
pub fn pads_on_disc() -> Mesh {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pads_on_disc.msh");
    mesh::read(Path::new(file), 1e-3).unwrap()
}
