//! What the page draws by itself, as packed numbers: the outer surface, shapes on it, and contact faces laid flat.
//!
//! Numbers are little-endian integers in base64: places on a grid of 65 536 steps across the surface, displacements in
//! steps of 1/32 767 of the largest. That is finer than a screen shows, and a quarter of the numbers written out.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::findings::{Findings, Place};
use crate::algebra::{cross, dot, norm, sub};
use crate::results::{Part, Shape, Surface, n_on_page};

/// The outer surface, its triangles part by part.
#[derive(Serialize)]
pub struct Outer {
    /// The corner of the least coordinates, m.
    origin: [f64; 3],
    /// The longest side of the box, m.
    size: f64,
    /// Three u16 a node, fractions of `size` from `origin`.
    nodes: String,
    /// Three u32 a triangle.
    triangles: String,
    /// The parts: name, first triangle, number of triangles.
    parts: Vec<(String, usize, usize)>,
}

/// The outer surface of some parts, if there is one.
pub fn outer(surface: &Surface, names: &[Part]) -> Option<Outer> {
    let [low, high] = bounds(&surface.nodes)?;
    let size = (0..3).map(|i| high[i] - low[i]).fold(f64::MIN_POSITIVE, f64::max);
    let step = |x: f64| ((x / size).clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16;
    let nodes = surface.nodes.iter().flat_map(|x| sub(*x, low)).flat_map(|x| step(x).to_le_bytes());
    let mut order: Vec<usize> = (0..surface.triangles.len()).collect();
    order.sort_by_key(|&t| surface.part[t]);
    let mut parts: Vec<(String, usize, usize)> = Vec::new();
    for (place, chunk) in order.chunk_by(|&s, &t| surface.part[s] == surface.part[t]).map(|c| (c[0], c)) {
        let first = parts.last().map_or(0, |(_, first, n)| first + n);
        parts.push((part_name(names, surface.part[place]), first, chunk.len()));
    }
    let triangles = order.iter().flat_map(|&t| surface.triangles[t]).flat_map(u32::to_le_bytes);
    Some(Outer { origin: low, size, nodes: packed(nodes), triangles: packed(triangles), parts })
}

fn part_name(names: &[Part], part: i32) -> String {
    let known = usize::try_from(part).ok().and_then(|part| names.get(part));
    known.map_or_else(|| format!("part {part}"), |part| part.name.clone())
}

fn bounds(nodes: &[[f64; 3]]) -> Option<[[f64; 3]; 2]> {
    let first = *nodes.first()?;
    let least = |a: [f64; 3], b: &[f64; 3]| [0, 1, 2].map(|i| a[i].min(b[i]));
    let most = |a: [f64; 3], b: &[f64; 3]| [0, 1, 2].map(|i| a[i].max(b[i]));
    Some([nodes.iter().fold(first, least), nodes.iter().fold(first, most)])
}

/// Shapes by the name of their mode, and how many did not fit.
#[derive(Serialize)]
pub struct Shapes {
    /// Six i16 a node: real part, imaginary part.
    pub shapes: BTreeMap<String, String>,
    /// Shapes that the results have and the page does not.
    pub omitted: usize,
}

/// Shapes of the unstable modes: of each instability the strongest in any case, then the others, strong ones first, as
/// far as they fit.
pub fn shapes(findings: &Findings) -> Shapes {
    let has_shape = |place: &&Place| findings.mode(**place).shape.is_some();
    let mut others: Vec<Place> =
        findings.instabilities.iter().flat_map(|one| &one.modes).filter(has_shape).copied().collect();
    others.sort_by(|&a, &b| findings.mode(b).growth_rate().total_cmp(&findings.mode(a).growth_rate()));
    let worst: Vec<Place> = findings.instabilities.iter().map(|one| one.worst).collect();
    others.sort_by_key(|place| !worst.contains(place));
    let n_worst = others.iter().filter(|place| worst.contains(place)).count();
    let n = n_on_page(findings.results.surface.nodes.len()).max(n_worst).min(others.len());
    let packed = |place: &Place| Some((place.name(), packed_shape(findings.mode(*place).shape.as_ref()?)));
    Shapes { shapes: others[..n].iter().filter_map(packed).collect(), omitted: others.len() - n }
}

/// Six i16 a node: real part, imaginary part.
pub(super) fn packed_shape(shape: &Shape) -> String {
    let step = |x: f32| ((x.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round() as i16).to_le_bytes();
    packed(shape.re.iter().zip(&shape.im).flat_map(|(re, im)| [*re, *im]).flatten().flat_map(step))
}

/// The slave face of a contact pair, laid flat, with its pressure.
#[derive(Serialize)]
pub struct Face {
    /// Its pair.
    pair: usize,
    /// Two f32 a node: m, to the right and up.
    nodes: String,
    /// Three u32 a triangle; empty where contacts are single points.
    triangles: String,
    /// What lies to the right and up, e.g. `x`, `y`.
    axes: [String; 2],
    /// The largest pressure, Pa.
    peak: f64,
    /// For each value asked for: a u16 a node, fractions of `peak`.
    pressure: Vec<String>,
    /// For each value asked for: an i8 a node, 0 open, 1 slip, 2 stick, -1 no contact point.
    status: Vec<String>,
}

/// The contact faces of all pairs.
pub fn faces(findings: &Findings) -> Vec<Face> {
    (0..findings.results.about.pairs.len()).filter_map(|pair| face(findings, pair)).collect()
}

fn face(findings: &Findings, pair: usize) -> Option<Face> {
    let contact = &findings.results.contact;
    let own: Vec<usize> = (0..contact.nodes.len()).filter(|&n| contact.pair_of_node[n] as usize == pair).collect();
    let first = *own.first()?;
    let mut place = vec![0_u32; contact.nodes.len()];
    own.iter().enumerate().for_each(|(local, &n)| place[n] = local as u32);
    let triangles: Vec<[u32; 3]> = (0..contact.triangles.len())
        .filter(|&t| contact.pair[t] as usize == pair)
        .map(|t| contact.triangles[t])
        .collect();
    let (right, up) = mean_plane(&contact.nodes, &triangles);
    let flat = |n: usize| {
        let x = sub(contact.nodes[n], contact.nodes[first]);
        [dot(x, right), dot(x, up)]
    };
    let values: Vec<_> = findings.asked.iter().map(|&v| &findings.results.values[v]).collect();
    let of = |all: &[f64], n: usize| all.get(n).copied().unwrap_or(0.0);
    let peak = values.iter().flat_map(|v| own.iter().map(|&n| of(&v.pressure, n))).fold(0.0, f64::max);
    let step = |p: f64| if peak > 0.0 { ((p / peak).clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16 } else { 0 };
    let status = |all: &[i32], n: usize| all.get(n).copied().unwrap_or(-1) as i8;
    Some(Face {
        pair,
        nodes: packed(own.iter().flat_map(|&n| flat(n)).flat_map(|x| (x as f32).to_le_bytes())),
        triangles: packed(triangles.iter().flatten().flat_map(|&n| place[n as usize].to_le_bytes())),
        axes: [right, up].map(axis_name),
        peak,
        pressure: values
            .iter()
            .map(|v| packed(own.iter().flat_map(|&n| step(of(&v.pressure, n)).to_le_bytes())))
            .collect(),
        status: values.iter().map(|v| packed(own.iter().flat_map(|&n| status(&v.status, n).to_le_bytes()))).collect(),
    })
}

/// Two axes of the plane that a face lies in on the whole, as one sees it who looks at the face: sideways that global
/// axis which lies in it most. A face of single points is seen along z.
pub(super) fn mean_plane(nodes: &[[f64; 3]], triangles: &[[u32; 3]]) -> ([f64; 3], [f64; 3]) {
    let mut normal = [0.0; 3];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|n| nodes[n as usize]);
        let twice_area = cross(sub(b, a), sub(c, a));
        (0..3).for_each(|i| normal[i] += twice_area[i]);
    }
    if norm(normal) == 0.0 {
        normal = [0.0, 0.0, 1.0];
    }
    let n = normal.map(|x| x / norm(normal));
    let axis = (1..3).fold(0, |best, i| if n[i].abs() < n[best].abs() - 1e-6 { i } else { best });
    let mut right: [f64; 3] = std::array::from_fn(|i| f64::from(u8::from(i == axis)) - n[axis] * n[i]);
    right = right.map(|x| x / norm(right));
    let up = cross(n, right);
    // Up is never down: a face seen from the other side is turned about the vertical.
    let is_down = up.iter().sum::<f64>() < 0.0;
    if is_down { (right.map(|x| -x), up.map(|x| -x)) } else { (right, up) }
}

/// The global axis that a direction is close to, else its components.
fn axis_name(direction: [f64; 3]) -> String {
    for (i, name) in ["x", "y", "z"].iter().enumerate() {
        if direction[i].abs() > 0.999 {
            return if direction[i] > 0.0 { (*name).into() } else { format!("\u{2212}{name}") };
        }
    }
    let [x, y, z] = direction;
    format!("({x:.2}, {y:.2}, {z:.2})")
}

fn packed(bytes: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::testing;

    fn bytes(text: &str) -> Vec<u8> {
        STANDARD.decode(text).unwrap()
    }

    fn words<const N: usize>(text: &str) -> Vec<[u8; N]> {
        bytes(text).as_chunks().0.to_vec()
    }

    #[test]
    fn a_surface_is_unpacked_to_a_few_micrometres_and_its_parts_are_runs() {
        let results = testing::results();
        let outer = outer(&results.surface, &results.about.parts).unwrap();
        let steps: Vec<u16> = words(&outer.nodes).into_iter().map(u16::from_le_bytes).collect();
        for (x, packed) in results.surface.nodes.iter().zip(steps.as_chunks::<3>().0) {
            for i in 0..3 {
                let back = outer.origin[i] + outer.size * f64::from(packed[i]) / 65535.0;
                assert!((back - x[i]).abs() < 0.6 * outer.size / 65535.0);
            }
        }
        let n = results.surface.triangles.len();
        let n_pad = results.surface.part.iter().filter(|&&part| part == 1).count();
        assert_eq!(outer.parts, [("disc".into(), 0, n - n_pad), ("pad".into(), n - n_pad, n_pad)]);
        assert_eq!(words::<12>(&outer.triangles).len(), n);
        assert!(super::outer(&Surface::default(), &[]).is_none());
    }

    #[test]
    fn a_shape_is_unpacked_to_its_last_step() {
        let results = testing::results();
        let findings = Findings::new(&results);
        let packed = shapes(&findings);
        let n = findings.instabilities.iter().flat_map(|one| &one.modes).filter(|p| findings.mode(**p).shape.is_some());
        assert_eq!((packed.shapes.len(), packed.omitted), (n.count(), 0));
        let worst = findings.instabilities[0].worst;
        let shape = findings.mode(worst).shape.as_ref().unwrap();
        let steps: Vec<i16> = words(&packed.shapes[&worst.name()]).into_iter().map(i16::from_le_bytes).collect();
        for (i, six) in steps.as_chunks::<6>().0.iter().enumerate() {
            let exact = [shape.re[i], shape.im[i]];
            for (step, x) in six.iter().zip(exact.as_flattened()) {
                assert!((f32::from(*step) / 32767.0 - x).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn a_face_is_seen_from_outside_and_upright() {
        let nodes = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(mean_plane(&nodes, &[[0, 1, 2]]), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
        let (right, up) = mean_plane(&nodes, &[[0, 2, 1]]);
        assert_eq!([right, up].map(axis_name), ["\u{2212}x", "y"]);
        let (right, up) = mean_plane(&[[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &[[0, 1, 2]]);
        assert_eq!([right, up].map(axis_name), ["y", "z"]);
    }

    #[test]
    fn pressures_are_fractions_of_the_peak() {
        let results = testing::results();
        let findings = Findings::new(&results);
        let faces = faces(&findings);
        assert_eq!(faces.iter().map(|face| face.pair).collect::<Vec<_>>(), [0, 1]);
        for face in &faces {
            for (&v, packed) in findings.asked.iter().zip(&face.pressure) {
                let own =
                    (0..results.contact.nodes.len()).filter(|&n| results.contact.pair_of_node[n] as usize == face.pair);
                for (n, step) in own.zip(words(packed)) {
                    let back = face.peak * f64::from(u16::from_le_bytes(step)) / 65535.0;
                    assert!((back - results.values[v].pressure[n]).abs() < 1e-5 * face.peak);
                }
            }
        }
    }
}
