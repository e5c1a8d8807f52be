//! The results file, HDF5.
//!
//! ```text
//! /                     attributes: format "squeal results", version 2
//! about                 text, TOML: the fields of [`About`]: model and mesh with their SHA-256, program, libraries,
//!                       command, band (Hz),
//!                       friction values asked for, [[parts]], [[pairs]]
//! costs                 text, for people
//! failure               text, TOML, only where the study did not come to its end: reason, [[steps]] of the equilibrium
//!                       not reached
//! surface/nodes         n_s x 3     the outer surface of all parts, m
//! surface/triangles     n_t x 3     normals point out
//! surface/part          n_t         index into the parts
//! surface/samples       n_p         some of the nodes, spread over all parts
//! contact/nodes         n_c x 3     the slave faces of the contact pairs, m
//! contact/triangles     n_f x 3     none where contacts are single points
//! contact/pair          n_f         index into the pairs
//! contact/pair_of_node  n_c
//! values/0000/          one group a value, in the order in which they were finished; attributes: friction, asked
//!                       (1, or 0 where
//!                       only tracking needed it)
//!   modes               n rows, by frequency: growth_rate (1/s) and omega (rad/s), which make the eigenvalue,
//!                       backward_error, unstable (0 or 1)
//!   sampled             n x n_p x 3 x 2   displacements at the samples, the last index real and imaginary part
//!   shaped              k           places of the modes that have a shape at all nodes: unstable ones at the values
//!                                   asked for
//!   shapes              k x n_s x 3 x 2   their displacements; the largest of a shape is 1
//!   pressure, status    n_c         at the nodes of contact/, Pa; 0 open, 1 slip, 2 stick, -1 no contact point
//!   record              text, TOML: friction, asked, seconds, checks, count of modes, [[pairs]] forces and counts,
//!                       [[steps]] Newton iterations
//!   sources             text, TOML: [[sources]] what explains a mode: its place, shares, sensitivities
//! diagram/              only where modes were followed
//!   values              solved friction values
//!   points              n rows: branch (from 0), mode (place among those of tracking), friction, growth_rate, omega
//!   hopf                text, TOML: [[hopf]]
//!   doubtful            n x 2       intervals over which not all modes could be recognised
//! ```
//!
//! Texts are arrays of bytes, UTF-8. All arrays are checksummed, and none is compressed: of displacements, in single
//! precision, deflate takes off 15 % at a quarter of the time of a sweep of a super-element.

use std::path::Path;

use hdf5::{File, Group, H5Type};
use num_complex::Complex64;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Source;
use super::{About, ContactFaces, ModeData, Results, Shape, Surface, Value};
use crate::Result;
use crate::hdf::{self, Format, array, list, read_text, table, text, triples, values};
use crate::tracking::{Branch, Diagram, Hopf, Point};

const FORMAT: Format =
    Format { name: "squeal results", version: 2, advice: "Make the results again with the same command" };

/// A mode's numbers.
#[derive(H5Type, Clone, Copy)]
#[repr(C)]
struct ModeRow {
    growth_rate: f64,
    omega: f64,
    backward_error: f64,
    unstable: u8,
}

/// A point of a branch.
#[derive(H5Type, Clone, Copy)]
#[repr(C)]
struct PointRow {
    branch: u32,
    mode: u32,
    friction: f64,
    growth_rate: f64,
    omega: f64,
}

/// What explains the modes of a value, as a text.
#[derive(Serialize, Deserialize)]
struct SourcesText {
    #[serde(default)]
    sources: Vec<Explained>,
}

/// What explains a mode.
#[derive(Serialize, Deserialize)]
struct Explained {
    mode: usize,
    sources: Vec<Source>,
}

/// Hopf points as a text.
#[derive(Serialize, Deserialize)]
struct HopfText {
    #[serde(default)]
    hopf: Vec<Hopf>,
}

/// Writes the results of a study; the file appears when it is complete. Not collective.
///
/// ```
/// use squeal::Results;
/// use squeal::results::file;
///
/// # let folder = tempfile::tempdir().expect("a folder");
/// let path = folder.path().join("results.h5");
/// let mut results = Results::default();
/// results.about.title = "my brake".into();
/// file::write(&path, &results)?;
/// assert_eq!(file::read(&path)?, results);
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// The system's and HDF5's, with the path.
pub fn write(path: &Path, results: &Results) -> Result<()> {
    hdf::create(path, &FORMAT, |file| {
        words(file, "about", &results.about)?;
        write_surface(file, &results.surface)?;
        list(&file.group("surface")?, "samples", &results.surface.samples)?;
        write_contact(&file.create_group("contact")?, &results.contact)?;
        let group = file.create_group("values")?;
        for (i, value) in results.values.iter().enumerate() {
            write_value(&group.create_group(&format!("{i:04}"))?, value)?;
        }
        if let Some(diagram) = &results.diagram {
            write_diagram(&file.create_group("diagram")?, diagram)?;
        }
        results.failure.as_ref().map_or(Ok(()), |failure| words(file, "failure", failure))?;
        text(file, "costs", &results.costs)
    })
}

/// Reads the results of a study. Not collective.
///
/// # Errors
/// [`crate::Error::Input`] where the file is none, is incomplete, damaged, or of another version.
pub fn read(path: &Path) -> Result<Results> {
    let file = hdf::open(path, &FORMAT)?;
    let results = read_body(&file).map_err(|reason| hdf::damaged(path, &FORMAT, reason))?;
    match inconsistency(&results) {
        None => Ok(results),
        Some(what) => Err(hdf::damaged(path, &FORMAT, what)),
    }
}

fn read_body(file: &File) -> hdf5::Result<Results> {
    let group = file.group("values")?;
    let values =
        (0..group.len()).map(|i| read_value(&group.group(&format!("{i:04}"))?)).collect::<hdf5::Result<_>>()?;
    let diagram = file.link_exists("diagram").then(|| read_diagram(&file.group("diagram")?)).transpose()?;
    let failure = file.link_exists("failure").then(|| from_words(file, "failure")).transpose()?;
    Ok(Results {
        about: from_words::<About>(file, "about")?,
        surface: read_surface(&file.group("surface")?)?,
        contact: read_contact(&file.group("contact")?)?,
        values,
        diagram,
        costs: read_text(file, "costs")?,
        failure,
    })
}

/// Keeps a record as TOML.
fn words(group: &Group, name: &str, record: &impl Serialize) -> hdf5::Result<()> {
    text(group, name, &toml::to_string(record).map_err(|reason| hdf5::Error::from(reason.to_string()))?)
}

fn from_words<T: DeserializeOwned>(group: &Group, name: &str) -> hdf5::Result<T> {
    toml::from_str(&read_text(group, name)?).map_err(|reason| hdf5::Error::from(format!("{name}: {reason}")))
}

/// Writes a surface without its samples.
pub(super) fn write_surface(file: &Group, surface: &Surface) -> hdf5::Result<()> {
    let group = file.create_group("surface")?;
    table(&group, "nodes", 3, surface.nodes.as_flattened())?;
    table(&group, "triangles", 3, surface.triangles.as_flattened())?;
    list(&group, "part", &surface.part)
}

fn read_surface(group: &Group) -> hdf5::Result<Surface> {
    Ok(Surface {
        nodes: triples(group, "nodes")?,
        triangles: triples(group, "triangles")?,
        part: values(group, "part")?,
        samples: values(group, "samples")?,
    })
}

fn write_contact(group: &Group, faces: &ContactFaces) -> hdf5::Result<()> {
    table(group, "nodes", 3, faces.nodes.as_flattened())?;
    table(group, "triangles", 3, faces.triangles.as_flattened())?;
    list(group, "pair", &faces.pair)?;
    list(group, "pair_of_node", &faces.pair_of_node)
}

fn read_contact(group: &Group) -> hdf5::Result<ContactFaces> {
    Ok(ContactFaces {
        nodes: triples(group, "nodes")?,
        triangles: triples(group, "triangles")?,
        pair: values(group, "pair")?,
        pair_of_node: values(group, "pair_of_node")?,
    })
}

/// Writes one value into a group of its own.
///
/// # Errors
/// HDF5's.
pub fn write_value(group: &Group, value: &Value) -> hdf5::Result<()> {
    group.new_attr::<f64>().create("friction")?.write_scalar(&value.friction)?;
    group.new_attr::<u8>().create("asked")?.write_scalar(&u8::from(value.asked))?;
    let row = |mode: &ModeData| ModeRow {
        growth_rate: mode.lambda.re,
        omega: mode.lambda.im,
        backward_error: mode.backward_error,
        unstable: u8::from(mode.unstable),
    };
    list(group, "modes", &value.modes.iter().map(row).collect::<Vec<_>>())?;
    write_shapes(group, "sampled", value.modes.iter().map(|mode| &mode.sampled))?;
    let shaped: Vec<(u32, &Shape)> =
        (0..).zip(&value.modes).filter_map(|(i, mode)| Some((i, mode.shape.as_ref()?))).collect();
    list(group, "shaped", &shaped.iter().map(|(i, _)| *i).collect::<Vec<_>>())?;
    write_shapes(group, "shapes", shaped.iter().map(|(_, shape)| *shape))?;
    list(group, "pressure", &value.pressure)?;
    list(group, "status", &value.status)?;
    let explained = |(mode, data): (usize, &ModeData)| Explained { mode, sources: data.sources.clone() };
    let sources = value.modes.iter().enumerate().map(explained).filter(|e| !e.sources.is_empty()).collect();
    words(group, "sources", &SourcesText { sources })?;
    words(group, "record", value)
}

fn write_shapes<'s>(
    group: &Group,
    name: &str,
    shapes: impl ExactSizeIterator<Item = &'s Shape> + Clone,
) -> hdf5::Result<()> {
    let shape = [shapes.len(), shapes.clone().next().map_or(0, |first| first.re.len()), 3, 2];
    array(group, name, &shape, &shapes.flat_map(numbers).collect::<Vec<f32>>())
}

/// The numbers of a shape in the order of the file.
pub(super) fn numbers(shape: &Shape) -> impl Iterator<Item = f32> {
    let pairs = shape.re.as_flattened().iter().zip(shape.im.as_flattened());
    pairs.flat_map(|(&re, &im)| [re, im])
}

/// Reads one value from its group.
///
/// # Errors
/// HDF5's; where its arrays do not fit together.
pub fn read_value(group: &Group) -> hdf5::Result<Value> {
    let rows: Vec<ModeRow> = values(group, "modes")?;
    let sampled = read_shapes(group, "sampled", rows.len())?;
    let mode = |(row, sampled): (&ModeRow, Shape)| ModeData {
        lambda: Complex64::new(row.growth_rate, row.omega),
        backward_error: row.backward_error,
        unstable: row.unstable != 0,
        sampled,
        ..ModeData::default()
    };
    let mut value: Value = from_words(group, "record")?;
    value.pressure = values(group, "pressure")?;
    value.status = values(group, "status")?;
    value.modes = rows.iter().zip(sampled).map(mode).collect();
    let shaped: Vec<u32> = values(group, "shaped")?;
    let stray = || hdf5::Error::from("a shape or a source of no mode");
    for (&i, shape) in shaped.iter().zip(read_shapes(group, "shapes", shaped.len())?) {
        value.modes.get_mut(i as usize).ok_or_else(stray)?.shape = Some(shape);
    }
    for Explained { mode, sources } in from_words::<SourcesText>(group, "sources")?.sources {
        value.modes.get_mut(mode).ok_or_else(stray)?.sources = sources;
    }
    Ok(value)
}

/// So many shapes.
fn read_shapes(group: &Group, name: &str, n: usize) -> hdf5::Result<Vec<Shape>> {
    let numbers: Vec<f32> = values(group, name)?;
    let length = numbers.len() / n.max(1);
    if numbers.len() != n * length || !length.is_multiple_of(6) {
        return Err(format!("{name} has {} numbers for {n} modes", numbers.len()).into());
    }
    let part = |shape: &[f32], k: usize| shape.chunks_exact(6).map(|v| [v[k], v[2 + k], v[4 + k]]).collect();
    let shape = |i: usize| {
        let own = &numbers[i * length..(i + 1) * length];
        Shape { re: part(own, 0), im: part(own, 1) }
    };
    Ok((0..n).map(shape).collect())
}

fn write_diagram(group: &Group, diagram: &Diagram) -> hdf5::Result<()> {
    list(group, "values", &diagram.values)?;
    let row = |branch: u32, point: &Point| PointRow {
        branch,
        mode: point.mode as u32,
        friction: point.value,
        growth_rate: point.lambda.re,
        omega: point.lambda.im,
    };
    let branches = (0..).zip(&diagram.branches);
    let rows = branches.flat_map(|(i, branch)| branch.points.iter().map(move |point| row(i, point)));
    list(group, "points", &rows.collect::<Vec<_>>())?;
    words(group, "hopf", &HopfText { hopf: diagram.hopf.clone() })?;
    table(group, "doubtful", 2, diagram.doubtful.as_flattened())
}

fn read_diagram(group: &Group) -> hdf5::Result<Diagram> {
    let rows: Vec<PointRow> = values(group, "points")?;
    let point = |row: &PointRow| Point {
        value: row.friction,
        lambda: Complex64::new(row.growth_rate, row.omega),
        mode: row.mode as usize,
    };
    let branches = rows.chunk_by(|a, b| a.branch == b.branch);
    Ok(Diagram {
        values: values(group, "values")?,
        branches: branches.map(|rows| Branch { points: rows.iter().map(point).collect() }).collect(),
        hopf: from_words::<HopfText>(group, "hopf")?.hopf,
        doubtful: values::<f64>(group, "doubtful")?.chunks_exact(2).map(|v| [v[0], v[1]]).collect(),
    })
}

/// What does not fit together.
fn inconsistency(results: &Results) -> Option<String> {
    let Results { about, surface, contact, values, diagram, .. } = results;
    let exceeds = |list: &[u32], n: usize| list.iter().any(|&i| i as usize >= n);
    let outside = |list: &[i32], n: usize| list.iter().any(|&i| i < 0 || i as usize >= n);
    let n_surface = surface.nodes.len();
    if exceeds(surface.triangles.as_flattened(), n_surface) || exceeds(&surface.samples, n_surface) {
        return Some("the surface names nodes that it does not have".into());
    }
    if surface.part.len() != surface.triangles.len() || outside(&surface.part, about.parts.len()) {
        return Some("the surface's triangles and parts do not fit together".into());
    }
    let n_contact = contact.nodes.len();
    if exceeds(contact.triangles.as_flattened(), n_contact)
        || contact.pair.len() != contact.triangles.len()
        || contact.pair_of_node.len() != n_contact
        || outside(&contact.pair, about.pairs.len())
        || outside(&contact.pair_of_node, about.pairs.len())
    {
        return Some("the contact faces do not fit together".into());
    }
    let n_branches = diagram.as_ref().map_or(0, |diagram| diagram.branches.len());
    let hopf = diagram.iter().flat_map(|diagram| &diagram.hopf);
    if hopf.flat_map(|hopf| [Some(hopf.branch), hopf.partner.map(|p| p.branch)]).flatten().any(|b| b >= n_branches) {
        return Some("a Hopf point of no branch".into());
    }
    values.iter().find_map(|value| {
        let shapes = value.modes.iter().filter_map(|mode| mode.shape.as_ref());
        let wrong = value.pairs.len() != about.pairs.len()
            || value.pressure.len() != n_contact
            || value.status.len() != n_contact
            || value.modes.iter().any(|mode| mode.sampled.re.len() != surface.samples.len())
            || shapes.into_iter().any(|shape| shape.re.len() != n_surface);
        wrong.then(|| format!("the lists at friction {} differ in length from what they are of", value.friction))
    })
}

#[cfg(test)]
mod tests;
