//! Meshes of tests/data read right, and every message about a bad one.

use super::parse;
use crate::element::{ElementKind, facet, solid};
use crate::mesh::{Facet, Mesh, quality::scaled_jacobian};
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read(name: &str) -> Mesh {
    super::read(&data(name), 1e-3).unwrap()
}

const ASCII: &str = include_str!("../../../tests/data/two_blocks_ascii.msh");
const BINARY: &[u8] = include_bytes!("../../../tests/data/two_blocks_binary.msh");

/// What is said about a mesh file.
fn said(bytes: &[u8]) -> String {
    let error = parse(bytes, Path::new("bad.msh"), 1.0).expect_err("accepted");
    assert_eq!(error.exit_code(), 2);
    error.to_string()
}

#[track_caller]
fn complains(from: &str, to: &str, expected: &str) {
    assert!(ASCII.contains(from), "{from:?} is not in the file");
    let said = said(ASCII.replacen(from, to, 1).as_bytes());
    assert!(said.contains(expected), "{said}");
}

/// Signed volume below a facet (as a flat triangle) seen from the origin, and its area.
fn below(mesh: &Mesh, facet: &Facet) -> (f64, [f64; 3]) {
    let [a, b, c] = [0, 1, 2].map(|i| nalgebra::Vector3::from(mesh.nodes[facet.nodes()[i] as usize]));
    let normal = (b - a).cross(&(c - a)) / 2.0;
    (a.dot(&normal) / 3.0, normal.into())
}

fn normal_sum(mesh: &Mesh, surface: &str) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for facet in &mesh.surfaces[surface].facets {
        for force in facet::pressure_load(&facet.positions(&mesh.nodes), -1.0) {
            (0..3).for_each(|i| sum[i] += force[i]);
        }
    }
    sum
}

#[test]
fn text_bytes_and_parameters_are_read_alike() {
    let ascii = read("two_blocks_ascii.msh");
    assert_eq!(ascii.parts, ["lower", "upper block"]);
    assert_eq!(ascii.surfaces.keys().collect::<Vec<_>>(), ["bottom", "interface", "top"]);
    assert_eq!(ascii.node_sets.keys().collect::<Vec<_>>(), ["corner", "edge"]);
    for other in ["two_blocks_binary.msh", "two_blocks_parametric.msh"] {
        let other = read(other);
        assert_eq!(other.elements, ascii.elements);
        assert_eq!(other.parts, ascii.parts);
        assert_eq!(other.node_sets, ascii.node_sets);
        for (name, surface) in &ascii.surfaces {
            assert_eq!(other.surfaces[name].facets, surface.facets);
            assert_eq!(other.surfaces[name].parts, surface.parts);
        }
        for (a, b) in ascii.nodes.iter().zip(&other.nodes) {
            assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-17), "{a:?} {b:?}");
        }
    }
}

#[test]
fn blocks_have_their_volume_sets_and_interface() {
    let mesh = read("two_blocks_ascii.msh");
    let corner = &mesh.nodes[mesh.node_sets["corner"][0] as usize];
    assert_eq!(*corner, [0.0; 3]);
    assert_eq!(mesh.node_set("edge").unwrap().len(), 5);
    let interface = &mesh.surfaces["interface"];
    assert_eq!(interface.inner.len(), interface.facets.len());
    assert_eq!(mesh.part_of_surface("interface"), Some(0));
    assert_eq!(mesh.part_of_surface("top"), Some(1));
    assert_eq!(mesh.part_of_surface("edge"), None);
    assert!(mesh.surfaces["top"].inner.is_empty());
    for (name, z) in [("bottom", -1e-6), ("interface", 1e-6), ("top", 1e-6)] {
        let sum = normal_sum(&mesh, name);
        assert!(sum[0].abs() < 1e-18 && sum[1].abs() < 1e-18 && (sum[2] - z).abs() < 1e-18, "{name} {sum:?}");
    }
    let nodes = mesh.node_set("top").unwrap();
    assert!(nodes.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(nodes.iter().all(|&node| (mesh.nodes[node as usize][2] - 1.5e-3).abs() < 1e-15));
    assert_eq!(mesh.node_set("nothing"), None);
}

#[test]
fn midsides_lie_on_their_edges() {
    let mesh = read("two_blocks_ascii.msh");
    let edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
    for e in 0..mesh.elements.len() {
        let x = mesh.element_nodes(e);
        for (midside, (a, b)) in edges.into_iter().enumerate() {
            assert!((0..3).all(|i| (x[4 + midside][i] - 0.5 * (x[a][i] + x[b][i])).abs() < 1e-16));
        }
    }
}

/// Four hexahedra of 0.5 x 1 x 0.35 and a wedge, as Gmsh writes them.
#[test]
fn hexahedra_and_wedges_come_with_midsides_on_their_edges_and_facets_outward() {
    let files = [
        ("hexahedra_wedges.msh", [ElementKind::C3D20, ElementKind::C3D15], 66),
        ("hexahedra_wedges_linear.msh", [ElementKind::C3D8I, ElementKind::C3D6], 24),
    ];
    for (file, kinds, n_nodes) in files {
        let mesh = read(file);
        assert_eq!((mesh.nodes.len(), mesh.elements.len()), (n_nodes, 5));
        let mut volumes = [0.0; 2];
        for (e, element) in mesh.elements.iter().enumerate() {
            assert_eq!(element.kind, kinds[element.part as usize]);
            let (shape, x) = (element.shape(), mesh.element_nodes(e));
            volumes[element.part as usize] += 1e9 * solid::volume(shape, &x);
            for (x, straight) in x.iter().zip(shape.straight(&x[..shape.n_corners()])) {
                assert!((0..3).all(|i| (x[i] - straight[i]).abs() < 1e-12), "{file}");
            }
        }
        // Areas 1.05 and 0.5 of the bases, by the height.
        assert!((volumes[0] - 0.7 * 1.05).abs() < 1e-9 && (volumes[1] - 0.35).abs() < 1e-9, "{volumes:?}");
        for (name, n_facets, area) in [("hexahedra_top", 2, 1.05), ("wedges_top", 1, 0.5)] {
            assert_eq!(mesh.surfaces[name].facets.len(), n_facets);
            assert!((1e6 * normal_sum(&mesh, name)[2] - area).abs() < 1e-9, "{file} {name}");
        }
        assert_eq!(mesh.surfaces["wedges_side"].facets[0].corners().len(), 4);
    }
}

#[test]
fn the_reference_brake_reads_with_its_names_and_facets_outward() {
    let mesh = read("pads_on_disc.msh");
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (6750, 3292));
    let parts = ["disc", "lining_inner", "backplate_inner", "lining_outer", "backplate_outer"];
    assert_eq!(mesh.parts, parts);
    let surfaces: Vec<&str> = mesh.surfaces.keys().map(String::as_str).collect();
    let expected = [
        "backplate_inner_back",
        "backplate_outer_back",
        "disc_inner_face",
        "disc_outer_face",
        "hub",
        "lining_inner_face",
        "lining_outer_face",
    ];
    assert_eq!(surfaces, expected);
    assert!(mesh.surfaces.values().all(|surface| surface.inner.is_empty()));
    // The inner pad lies below the disc (z < 0), the outer one above.
    for (name, sign) in [
        ("disc_inner_face", -1.0),
        ("lining_inner_face", 1.0),
        ("backplate_inner_back", -1.0),
        ("disc_outer_face", 1.0),
        ("lining_outer_face", -1.0),
        ("backplate_outer_back", 1.0),
    ] {
        for facet in &mesh.surfaces[name].facets {
            assert!(below(&mesh, facet).1[2] * sign > 0.0, "{name}");
        }
    }
    // Out of the disc, the normals of its bore point to the axis.
    let volume: f64 = mesh.surfaces["hub"].facets.iter().map(|facet| below(&mesh, facet).0).sum();
    assert!(volume < 0.0);
    let area = normal_sum(&mesh, "lining_inner_face")[2];
    assert!((area / 0.004495969950628393 - 1.0).abs() < 1e-3, "{area}");
    assert_eq!(mesh.part_of_surface("lining_outer_face"), Some(3));
    for (e, element) in mesh.elements.iter().enumerate() {
        assert!(scaled_jacobian(element.shape(), &mesh.element_nodes(e)) > 0.05, "{e}");
    }
}

#[test]
fn nodes_off_the_elements_are_left_out() {
    let one_more = ASCII.replacen("45 357 1 357\n", "46 358 1 400\n0 99 0 1\n400\n5 5 5\n", 1);
    let mesh = parse(one_more.as_bytes(), Path::new("x.msh"), 1e-3).unwrap();
    assert_eq!(mesh.nodes, read("two_blocks_ascii.msh").nodes);
}

#[test]
fn other_files_and_versions_are_named() {
    let error = super::read(Path::new("no/such.msh"), 1.0).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().starts_with("no/such.msh: cannot read the mesh: No such file"));
    assert!(said(b"*HEADING\n").contains("bad.msh:1: expected a section such as $Nodes, found \"*HEADING\""));
    assert!(said(b"").contains("does not begin with $MeshFormat"));
    complains("4.1 0 8", "2.2 0 8", "Gmsh's format 2.2, not 4.1. Save it as 4.1");
    complains("$Nodes", "$PartitionedEntities", "the mesh is partitioned. Save the mesh unpartitioned");
    let mut big_endian = BINARY.to_vec();
    let one = BINARY.windows(4).position(|bytes| bytes == [1, 0, 0, 0]).unwrap();
    big_endian[one..one + 4].reverse();
    assert!(said(&big_endian).contains("the file is big-endian"));
}

#[test]
fn truncated_files_say_where_they_end() {
    let cut = |at: usize| said(&ASCII.as_bytes()[..at]);
    let nodes = ASCII.find("$Nodes").unwrap();
    assert!(cut(nodes + 500).contains("inside $Nodes. It is truncated"));
    let line = ASCII[..nodes].matches('\n').count();
    assert!(cut(nodes).contains(&format!("bad.msh:{}: the file has no $Nodes", line + 1)));
    let elements = ASCII.find("$Elements").unwrap();
    assert!(cut(elements + 1000).contains("$Elements"));
    assert!(cut(elements).contains("the file has no $Elements"));
    let cut = |at: usize| said(&BINARY[..at]);
    assert!(cut(BINARY.len() - 5000).contains("the file ends inside $Elements"));
    assert!(cut(4000).contains("bad.msh: byte "));
}

#[test]
fn no_cut_panics() {
    for (bytes, step) in [(ASCII.as_bytes(), 97), (BINARY, 131)] {
        for at in (0..bytes.len() - 14).step_by(step) {
            said(&bytes[..at]);
        }
    }
}

#[test]
fn wrong_numbers_are_located() {
    complains("45 357 1 357", "45 x 1 357", "expected a whole number, 0 or above in $Nodes, found \"x\"");
    complains("45 357 1 357", "45 356 1 357", "$Nodes announces 356 nodes and has 357");
    complains("45 357 1 357", "45 999999999999 1 357", "the file ends inside $Nodes");
    complains("\n2\n0 0 1\n", "\n1\n0 0 1\n", "node 1 is there twice");
    complains("\n2\n0 0 1\n", "\n2\n0 nan 1\n", "a node lies at [0.0, NaN, 1.0]");
    complains("\n2\n0 0 1\n", "\n1000\n0 0 1\n", "uses node 2, which $Nodes does not have");
}

/// The lines of a tetrahedron alone, of any kind.
fn one_element(kind: i32, n_nodes: usize) -> String {
    let tags: Vec<String> = (1..=n_nodes).map(|tag| tag.to_string()).collect();
    let nodes: String = (1..=n_nodes).map(|i| format!("{i} {} {}\n", i * i, i * i * i)).collect();
    format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"block\"\n$EndPhysicalNames\n\
         $Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 1 0\n$EndEntities\n\
         $Nodes\n1 {n_nodes} 1 {n_nodes}\n3 1 0 {n_nodes}\n{}\n{nodes}$EndNodes\n\
         $Elements\n1 1 1 1\n3 1 {kind} 1\n1 {}\n$EndElements\n",
        tags.join("\n"),
        tags.join(" ")
    )
}

#[test]
fn other_elements_are_named() {
    let pyramid = said(one_element(7, 5).as_bytes());
    assert!(pyramid.contains("the part \"block\" has 5-node pyramids, which are not analysed. Pyramids"), "{pyramid}");
    let full = said(one_element(12, 27).as_bytes());
    assert!(
        full.ends_with(
            "has 27-node hexahedra, which are not analysed. Set Mesh.SecondOrderIncomplete = 1 and mesh again"
        )
    );
    assert!(said(one_element(77, 4).as_bytes()).contains("unknown Gmsh element type 77"));
}

/// Linear facets on quadratic elements are no faces of them.
#[test]
fn linear_facets_are_named() {
    let begin = ASCII.find("\n2 5 9 ").unwrap() + 1;
    let block: Vec<&str> = ASCII[begin..].lines().take(15).collect();
    let mut linear = String::from("2 5 2 14\n");
    for line in &block[1..] {
        let corners: Vec<&str> = line.split(' ').take(4).collect();
        linear += &format!("{}\n", corners.join(" "));
    }
    let bytes = ASCII.replacen(&format!("{}\n", block.join("\n")), &linear, 1);
    let said = said(bytes.as_bytes());
    assert!(said.contains("of the surface \"bottom\" is no face of an element"), "{said}");
}

#[test]
fn volumes_must_be_in_one_named_part() {
    complains(" 1 1 6 1 2 3 4 5 6 ", " 0 6 1 2 3 4 5 6 ", "has no elements");
    let bare = one_element(11, 10).replace("3 1 \"block\"", "3 2 \"block\"");
    assert!(said(bare.as_bytes()).contains("the physical volume \"block\" has no elements"));
    let unnamed = one_element(11, 10).replace("1\n3 1 \"block\"", "0");
    assert!(said(unnamed.as_bytes()).contains("physical volume 1 has no name"));
    let outside = one_element(11, 10).replace("1\n3 1 \"block\"", "0").replace("1 1 1 1 1 0\n", "1 1 1 0 0\n");
    assert!(said(outside.as_bytes()).contains("volume 1 is in no physical volume. Add Physical Volume"));
    complains(
        " 1 1 6 1 2 3 4 5 6 ",
        " 2 1 2 6 1 2 3 4 5 6 ",
        "volume 1 is in several physical volumes: lower, upper block",
    );
}

#[test]
fn a_name_means_one_thing() {
    complains(
        "2 3 \"bottom\"",
        "2 3 \"top\"",
        "the name \"top\" is used twice, for a physical surface and a physical surface",
    );
    complains(
        "3 1 \"lower\"",
        "3 1 \"top\"",
        "the name \"top\" is used twice, for a physical surface and a physical volume",
    );
}

#[test]
fn facets_and_sets_lie_on_elements() {
    // Without the upper block its top belongs to nothing.
    let elements = ASCII.find("$Elements").unwrap();
    let upper = elements + ASCII[elements..].find("\n3 2 11 ").unwrap();
    let counts: Vec<&str> = ASCII[elements..].lines().nth(1).unwrap().split(' ').collect();
    let blocks: usize = counts[0].parse().unwrap();
    let bare = ASCII[..upper].replacen(&format!("$Elements\n{blocks} "), &format!("$Elements\n{} ", blocks - 1), 1)
        + "\n$EndElements\n";
    let bare = bare.replacen("7\n0 7", "6\n0 7", 1).replacen("3 2 \"upper block\"\n", "", 1);
    let said_of = said(bare.as_bytes());
    assert!(said_of.contains("of the surface \"top\" is no face of an element"), "{said_of}");
}

#[test]
fn inverted_elements_are_counted_and_named() {
    // The corner of the blocks pulled far beyond its neighbours turns its elements inside out.
    complains("\n1\n0 0 0\n", "\n1\n2 2 2\n", " elements are inverted (Jacobian 0 or below), first element ");
    complains("\n1\n0 0 0\n", "\n1\n2 2 2\n", "of the part \"lower\". Set Mesh.HighOrderOptimize = 2");
}
