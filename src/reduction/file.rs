//! The file of a super-element, HDF5.
//!
//! ```text
//! /                 attributes: format "squeal super-element", version 1
//! about             text, TOML: [origin] model, mesh with hash, friction, bands; [[pair]] the sliding pairs; parts
//! points            n_p x 3     positions of the retained points, m: slaves, masters, loads
//! frequencies       n_m         of the fixed-interface modes, Hz
//! mass, damping, stiffness      n x n, symmetric; n = 3 n_p + n_m + inertia modes; kg, N s/m, N/m at the retained points, unit modal mass
//! load, preload     n           generalised forces, N
//! contacts/         one row a contact: pair, position (m), normal, direction and speed of sliding (m/s; zero: frictionless), weight (m2),
//!                   gap (m), touching (0 or 1), displacement (m) and normal_force (N) at the equilibrium it was made about
//! surface/nodes     n_s x 3     corners of the outer surface, m
//! surface/triangles n_t x 3
//! surface/part      n_t         index into the parts
//! surface/basis     n x 3 n_s   displacements of the corners for a unit of each coordinate, single precision
//! ```
//!
//! The file appears when it is complete: it is written under another name beside its place.

use std::path::Path;

use hdf5::types::VarLenUnicode;
use hdf5::{File, Group, H5Type};
use ndarray::{ArrayView1, ArrayView2};
use serde::{Deserialize, Serialize};

use crate::contact::interface::{Kind, Pair, Statistics};
use crate::contact::{ContactPoint, Point, Tangential};
use crate::model::NormalLaw;
use crate::{Error, Result};

use super::recovery::OuterSurface;
use super::super_element::{NodeContact, Origin, SuperElement};

const FORMAT: &str = "squeal super-element";
/// Raised with every change of the layout.
const VERSION: i32 = 1;
/// First bytes of every HDF5 file.
const MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";

/// What is told in words.
#[derive(Serialize, Deserialize)]
struct About {
    origin: Origin,
    parts: Vec<String>,
    pair: Vec<PairText>,
}

/// A sliding pair.
#[derive(Serialize, Deserialize)]
struct PairText {
    name: String,
    slave: String,
    master: String,
    /// One number: linear, N/m3; two: cubic, N/m3 and N/m5.
    law: Vec<f64>,
    friction: f64,
    separation: bool,
    swept: bool,
    area: f64,
    n_contacts: usize,
}

/// Whether a file is HDF5, by its first bytes; false where it cannot be read.
pub fn is_hdf5(path: &Path) -> bool {
    use std::io::Read;
    let mut start = [0; MAGIC.len()];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC
}

/// Writes a super-element with its surface. Not collective.
///
/// # Errors
/// The system's and HDF5's, with the path.
pub fn write(path: &Path, element: &SuperElement, surface: &OuterSurface) -> Result<()> {
    let name = path.file_name().ok_or_else(|| Error::input(format!("{} has no file name", path.display())))?;
    let draft = path.with_file_name(format!(".{}.partial-{}", name.to_string_lossy(), std::process::id()));
    let written = write_draft(&draft, element, surface);
    if written.is_err() {
        // Best effort: half a file is of no use.
        let _ = std::fs::remove_file(&draft);
    }
    written.map_err(|reason| Error::Library(format!("{}: HDF5: {reason}", path.display())))?;
    std::fs::rename(&draft, path).map_err(Error::io(path))
}

fn write_draft(path: &Path, element: &SuperElement, surface: &OuterSurface) -> hdf5::Result<()> {
    let file = File::create(path)?;
    file.new_attr::<VarLenUnicode>().create("format")?.write_scalar(&text(FORMAT)?)?;
    file.new_attr::<i32>().create("version")?.write_scalar(&VERSION)?;
    let about = About { origin: element.origin.clone(), parts: surface.parts.clone(), pair: pair_texts(element) };
    let about = toml::to_string(&about).map_err(|reason| hdf5::Error::from(reason.to_string()))?;
    file.new_dataset::<VarLenUnicode>().create("about")?.write_scalar(&text(&about)?)?;
    let n = element.n_coordinates();
    table(&file, "points", 3, element.points.as_flattened())?;
    list(&file, "frequencies", &element.frequencies)?;
    table(&file, "mass", n, &element.mass)?;
    table(&file, "damping", n, &element.damping)?;
    table(&file, "stiffness", n, &element.stiffness)?;
    list(&file, "load", &element.load)?;
    list(&file, "preload", &element.preload)?;
    write_contacts(&file.create_group("contacts")?, &element.contacts)?;
    let group = file.create_group("surface")?;
    table(&group, "nodes", 3, surface.nodes.as_flattened())?;
    table(&group, "triangles", 3, surface.triangles.as_flattened())?;
    list(&group, "part", &surface.part)?;
    table(&group, "basis", 3 * surface.nodes.len(), &surface.basis)?;
    file.close()
}

fn write_contacts(group: &Group, contacts: &[NodeContact]) -> hdf5::Result<()> {
    let scalars = |of: &dyn Fn(&NodeContact) -> f64| contacts.iter().map(of).collect::<Vec<f64>>();
    let vectors = |of: &dyn Fn(&NodeContact) -> [f64; 3]| contacts.iter().flat_map(of).collect::<Vec<f64>>();
    let slide = |contact: &NodeContact| match contact.point.law.tangential {
        Tangential::Sliding { direction, speed } => (direction, speed),
        _ => ([0.0; 3], 0.0),
    };
    list(group, "pair", &contacts.iter().map(|c| c.point.pair as u32).collect::<Vec<_>>())?;
    table(group, "position", 3, &vectors(&|c| c.point.position))?;
    table(group, "normal", 3, &vectors(&|c| c.point.law.normal))?;
    table(group, "direction", 3, &vectors(&|c| slide(c).0))?;
    list(group, "speed", &scalars(&|c| slide(c).1))?;
    list(group, "weight", &scalars(&|c| c.point.law.weight))?;
    list(group, "gap", &scalars(&|c| c.point.law.gap))?;
    list(group, "touching", &contacts.iter().map(|c| u8::from(c.point.law.touching)).collect::<Vec<_>>())?;
    table(group, "displacement", 3, &vectors(&|c| c.displacement))?;
    list(group, "normal_force", &scalars(&|c| c.normal_force))
}

fn pair_texts(element: &SuperElement) -> Vec<PairText> {
    let of = |pair: &Pair| PairText {
        name: pair.name.clone(),
        slave: pair.slave.clone(),
        master: pair.master.clone(),
        law: match pair.law {
            NormalLaw::Linear { stiffness } => vec![stiffness],
            NormalLaw::Cubic { k1, k3 } => vec![k1, k3],
        },
        friction: pair.friction,
        separation: pair.separation,
        swept: pair.swept,
        area: pair.statistics.area,
        n_contacts: pair.points.len(),
    };
    element.pairs.iter().map(of).collect()
}

fn text(text: &str) -> hdf5::Result<VarLenUnicode> {
    text.parse().map_err(|reason| hdf5::Error::from(format!("{reason:?}")))
}

fn list<T: H5Type>(group: &Group, name: &str, values: &[T]) -> hdf5::Result<()> {
    group.new_dataset_builder().with_data(ArrayView1::from(values)).create(name).map(|_| ())
}

fn table<T: H5Type>(group: &Group, name: &str, width: usize, values: &[T]) -> hdf5::Result<()> {
    let rows = values.len() / width.max(1);
    let view = ArrayView2::from_shape((rows, width), values).map_err(|reason| hdf5::Error::from(reason.to_string()))?;
    group.new_dataset_builder().with_data(view).create(name).map(|_| ())
}

/// Reads a super-element and its surface. Not collective.
///
/// # Errors
/// [`Error::Input`] where the file is none, is incomplete, or of another version.
pub fn read(path: &Path) -> Result<(SuperElement, OuterSurface)> {
    let place = path.display();
    let refuse = |what: String| Error::input(format!("{place}: {what}. Make it anew with `squeal reduce`"));
    let broken = |reason: hdf5::Error| refuse(format!("the super-element is incomplete or damaged: {reason}"));
    let file = File::open(path).map_err(broken)?;
    let format = file.attr("format").and_then(|a| a.read_scalar::<VarLenUnicode>());
    if format.map_or(true, |format| format.as_str() != FORMAT) {
        return Err(Error::input(format!("{place} is an HDF5 file, but not a super-element of squeal")));
    }
    let version: i32 = file.attr("version").and_then(|a| a.read_scalar()).map_err(broken)?;
    if version != VERSION {
        return Err(refuse(format!("the super-element is of version {version}, this program reads version {VERSION}")));
    }
    let (element, surface) = read_body(&file).map_err(broken)?;
    match inconsistency(&element, &surface) {
        None => Ok((element, surface)),
        Some(what) => Err(refuse(format!("the super-element is damaged: {what}"))),
    }
}

fn read_body(file: &File) -> hdf5::Result<(SuperElement, OuterSurface)> {
    let about = file.dataset("about")?.read_scalar::<VarLenUnicode>()?;
    let about: About = toml::from_str(about.as_str()).map_err(|reason| hdf5::Error::from(reason.to_string()))?;
    let pairs = pairs(&about.pair);
    let surface = file.group("surface")?;
    let element = SuperElement {
        origin: about.origin,
        points: triples(file, "points")?,
        frequencies: values(file, "frequencies")?,
        mass: values(file, "mass")?,
        damping: values(file, "damping")?,
        stiffness: values(file, "stiffness")?,
        load: values(file, "load")?,
        preload: values(file, "preload")?,
        contacts: read_contacts(&file.group("contacts")?, &pairs)?,
        pairs,
    };
    let surface = OuterSurface {
        nodes: triples(&surface, "nodes")?,
        triangles: triples(&surface, "triangles")?,
        part: values(&surface, "part")?,
        parts: about.parts,
        basis: values(&surface, "basis")?,
    };
    Ok((element, surface))
}

fn pairs(texts: &[PairText]) -> Vec<Pair> {
    let mut first = 0;
    let of = |text: &PairText| {
        let points = first..first + text.n_contacts;
        first = points.end;
        Pair {
            name: text.name.clone(),
            slave: text.slave.clone(),
            master: text.master.clone(),
            law: match text.law[..] {
                [k1, k3] => NormalLaw::Cubic { k1, k3 },
                _ => NormalLaw::Linear { stiffness: text.law.first().copied().unwrap_or(f64::NAN) },
            },
            friction: text.friction,
            kind: Kind::Sliding,
            separation: text.separation,
            swept: text.swept,
            points,
            statistics: Statistics { area: text.area, ..Statistics::default() },
        }
    };
    texts.iter().map(of).collect()
}

fn read_contacts(group: &Group, pairs: &[Pair]) -> hdf5::Result<Vec<NodeContact>> {
    let pair: Vec<u32> = values(group, "pair")?;
    let [position, normal, direction, displacement] =
        ["position", "normal", "direction", "displacement"].map(|name| triples::<f64>(group, name));
    let (position, normal, direction, displacement) = (position?, normal?, direction?, displacement?);
    let [speed, weight, gap, force] = ["speed", "weight", "gap", "normal_force"].map(|name| values::<f64>(group, name));
    let (speed, weight, gap, force, touching) = (speed?, weight?, gap?, force?, values::<u8>(group, "touching")?);
    let lengths = [position.len(), normal.len(), direction.len(), displacement.len(), speed.len(), weight.len()];
    if lengths.iter().chain(&[gap.len(), force.len(), touching.len()]).any(|&n| n != pair.len()) {
        return Err("the lists of the contacts differ in length".into());
    }
    let of = |i: usize| {
        let own = pairs.get(pair[i] as usize).ok_or_else(|| hdf5::Error::from("a contact of no pair"))?;
        let law = Point {
            weight: weight[i],
            normal: normal[i],
            gap: gap[i],
            correction: 0.0,
            touching: touching[i] != 0,
            separation: own.separation,
            normal_law: own.law,
            tangential: match speed[i] {
                0.0 => Tangential::Frictionless,
                speed => Tangential::Sliding { direction: direction[i], speed },
            },
        };
        let point = ContactPoint { pair: pair[i] as usize, nodes: vec![i as u32], position: position[i], law };
        Ok(NodeContact { point, displacement: displacement[i], normal_force: force[i] })
    };
    (0..pair.len()).map(of).collect()
}

fn values<T: H5Type>(group: &Group, name: &str) -> hdf5::Result<Vec<T>> {
    group.dataset(name)?.read_raw()
}

fn triples<T: H5Type + Copy>(group: &Group, name: &str) -> hdf5::Result<Vec<[T; 3]>> {
    let flat: Vec<T> = values(group, name)?;
    Ok(flat.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect())
}

/// What does not fit together.
fn inconsistency(element: &SuperElement, surface: &OuterSurface) -> Option<String> {
    let (n, least) = (element.n_coordinates(), 3 * element.points.len() + element.frequencies.len());
    if n < least {
        return Some(format!("{n} coordinates for {least} retained displacements and modes"));
    }
    let matrices = [("mass", &element.mass), ("damping", &element.damping), ("stiffness", &element.stiffness)];
    let vectors = [("load", &element.load), ("preload", &element.preload)];
    let sized = matrices.map(|(name, m)| (name, m, n * n)).into_iter().chain(vectors.map(|(name, v)| (name, v, n)));
    for (name, values, length) in sized {
        if values.len() != length {
            return Some(format!("{name} has {} values instead of {length}", values.len()));
        }
        if !values.iter().all(|x| x.is_finite()) {
            return Some(format!("{name} holds values that are not finite"));
        }
    }
    let n_contacts: usize = element.pairs.iter().map(|pair| pair.points.len()).sum();
    if n_contacts != element.contacts.len() || 2 * n_contacts > element.points.len() {
        return Some(format!("{} contacts, {n_contacts} in its pairs", element.contacts.len()));
    }
    (surface.basis.len() != 3 * surface.nodes.len() * n).then(|| "the basis of the surface has another size".into())
}
