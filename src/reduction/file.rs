//! The file of a super-element, HDF5.
//!
//! ```text
//! /                 attributes: format "squeal super-element", version 6
//! about             text, TOML: [origin] model, mesh with hash, friction, bands, samples; [[pair]] the pairs kept;
//!                   parts; [[part_matrices]] name, damping and viscoelastic law of each part; rest, what is in no
//!                   part; viscoelastic, the laws of which there is a stiffness
//! model             text, TOML: the model file, by whose keys a study changes the super-element; only where it has its
//!                   contacts from no deck
//! points            n_p x 3     positions of the retained points, m: slaves, masters, loads
//! frequencies       n_m         of the fixed-interface modes, Hz
//! mass, damping, stiffness      n x n, symmetric but for gyroscopic damping; n = 3 n_p + n_m + residual modes; kg,
//!                               N s/m, N/m at the retained points, unit modal mass
//!                               stiffness with that of viscoelastic materials at rest
//! structural_damping            n x n, as stiffness; only where a stiffness has a loss factor
//! viscoelastic_stiffnesses      n_v x n^2: the stiffness at rest of each viscoelastic law, part of stiffness; only
//!                               where there is a law
//! geometric_stiffness           n x n, of the equilibrium at prestress_at_friction of [origin], which modes have; only
//!                               where the model has prestress
//! part_masses, part_stiffnesses n_p x n^2: what each part adds to mass and stiffness; to damping it adds alpha and
//!                   beta times these, to structural_damping its loss factor times its stiffness
//! load, preload     n           generalised forces, N: those that a load factor multiplies; all others
//! contacts/         one row a contact: pair, position (m), normal, direction and speed of sliding (m/s; zero:
//!                   frictionless), weight (m2), gap (m), field_gap (m, what of it is of a gap field), touching (0 or
//!                   1), displacement (m) and normal_force (N) at the equilibrium that it was made about
//! contacts/motion   3 n_c x n   of a Galerkin super-element alone: displacements of the contacts for a unit of each
//!                   coordinate; it has no points and no frequencies
//! surface/nodes     n_s x 3     corners of the outer surface, m
//! surface/triangles n_t x 3
//! surface/part      n_t         index into the parts
//! surface/basis     n x 3 n_s   displacements of the corners for a unit of each coordinate, single precision
//! basis             n x 3 n_n   displacements of all nodes of the mesh, single precision; only where asked for
//! ```
//!
//! Texts are arrays of bytes, UTF-8; all arrays are checksummed. The file appears when it is complete.

use std::path::Path;

use hdf5::{File, Group};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::contact::interface::ContactPair;
use crate::contact::surface_points::Place;
use crate::contact::{ContactPoint, PointLaw, Tangential};
use crate::hdf::{self, Format, list, read_text, table, text, triples, values};
use crate::model::Rayleigh;
use crate::model::viscoelastic::ViscoelasticLaw;

use super::pair_text::{PairText, pair_texts, pairs};
use super::parts::PartMatrices;
use super::recovery::OuterSurface;
use super::super_element::{ContactMotion, NodeContact, Origin, SuperElement, ViscoelasticTerm};

const FORMAT: Format =
    Format { name: "squeal super-element", version: 6, advice: "Make the super-element again with `squeal reduce`" };

/// The text of the model file, which only some have.
const MODEL: &str = "model";
/// The matrices that only some have.
const STRUCTURAL_DAMPING: &str = "structural_damping";
const GEOMETRIC_STIFFNESS: &str = "geometric_stiffness";
/// The matrices of the viscoelastic laws, one after the other, which only some have.
const VISCOELASTIC: &str = "viscoelastic_stiffnesses";
/// The basis by nodes of the mesh, which only some have.
const BASIS: &str = "basis";
/// What of the gaps is of a gap field; older files do not have it.
const FIELD_GAP: &str = "field_gap";
/// The matrices of the parts, one after the other.
const PART_MASSES: &str = "part_masses";
const PART_STIFFNESSES: &str = "part_stiffnesses";

/// What is told in words.
#[derive(Serialize, Deserialize)]
struct About {
    origin: Origin,
    parts: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rest: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    viscoelastic: Vec<ViscoelasticLaw>,
    pair: Vec<PairText>,
    part_matrices: Vec<PartText>,
}

/// A part of which the file has the matrices.
#[derive(Serialize, Deserialize)]
struct PartText {
    name: String,
    rayleigh: Rayleigh,
    loss_factor: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    viscoelastic: Option<ViscoelasticLaw>,
}

/// Whether a file is a super-element, of whatever version. Not collective.
pub fn is_super_element(path: &Path) -> bool {
    hdf::is_of(path, &FORMAT)
}

/// Writes a super-element with its surface, and with its basis by nodes of the mesh where there is one. Not collective.
///
/// # Errors
/// The system's and HDF5's, with the path.
pub fn write(path: &Path, element: &SuperElement, surface: &OuterSurface, basis: Option<&[f32]>) -> Result<()> {
    hdf::create(path, &FORMAT, |file| {
        write_body(file, element, surface)?;
        let width = basis.map_or(0, <[f32]>::len) / element.n_coordinates().max(1);
        basis.map_or(Ok(()), |basis| table(file, BASIS, width, basis))
    })
}

/// Whether a file has the basis of its super-element. Not collective.
pub fn has_basis(path: &Path) -> bool {
    hdf::open(path, &FORMAT).is_ok_and(|file| file.link_exists(BASIS))
}

/// Reads the basis of a super-element by nodes of the mesh, one column after the other. Not collective.
///
/// # Errors
/// [`crate::Error::Input`] where the file is none, is of another version, or has no basis.
pub fn read_basis(path: &Path) -> Result<Vec<f32>> {
    let file = hdf::open(path, &FORMAT)?;
    values(&file, BASIS).map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

fn write_body(file: &File, element: &SuperElement, surface: &OuterSurface) -> hdf5::Result<()> {
    let about = About {
        origin: element.origin.clone(),
        parts: surface.parts.clone(),
        rest: element.rest.clone(),
        viscoelastic: element.viscoelastic.iter().map(|term| term.law.clone()).collect(),
        pair: pair_texts(element),
        part_matrices: element.parts.iter().map(part_text).collect(),
    };
    let about = toml::to_string(&about).map_err(|reason| hdf5::Error::from(reason.to_string()))?;
    text(file, "about", &about)?;
    let n = element.n_coordinates();
    table(file, "points", 3, element.points.as_flattened())?;
    list(file, "frequencies", &element.frequencies)?;
    table(file, "mass", n, &element.mass)?;
    table(file, "damping", n, &element.damping)?;
    table(file, "stiffness", n, &element.stiffness)?;
    write_optional(file, element)?;
    table(file, PART_MASSES, n * n, &element.parts.iter().flat_map(|part| part.mass.clone()).collect::<Vec<_>>())?;
    let stiffnesses: Vec<f64> = element.parts.iter().flat_map(|part| part.stiffness.clone()).collect();
    table(file, PART_STIFFNESSES, n * n, &stiffnesses)?;
    list(file, "load", &element.load)?;
    list(file, "preload", &element.preload)?;
    let group = file.create_group("contacts")?;
    write_contacts(&group, &element.contacts)?;
    if let ContactMotion::Rows(rows) = &element.motion {
        table(&group, "motion", n, rows)?;
    }
    let group = file.create_group("surface")?;
    table(&group, "nodes", 3, surface.nodes.as_flattened())?;
    table(&group, "triangles", 3, surface.triangles.as_flattened())?;
    list(&group, "part", &surface.part)?;
    table(&group, "basis", 3 * surface.nodes.len(), &surface.basis)
}

/// What only some have.
fn write_optional(file: &File, element: &SuperElement) -> hdf5::Result<()> {
    let n = element.n_coordinates();
    element.model_text.iter().try_for_each(|model| text(file, MODEL, model))?;
    element.structural_damping.iter().try_for_each(|g| table(file, STRUCTURAL_DAMPING, n, g))?;
    element.geometric_stiffness.iter().try_for_each(|k| table(file, GEOMETRIC_STIFFNESS, n, k))?;
    let laws: Vec<f64> = element.viscoelastic.iter().flat_map(|term| term.stiffness.clone()).collect();
    if laws.is_empty() { Ok(()) } else { table(file, VISCOELASTIC, n * n, &laws) }
}

fn part_text(part: &PartMatrices) -> PartText {
    PartText {
        name: part.name.clone(),
        rayleigh: part.rayleigh,
        loss_factor: part.loss_factor,
        viscoelastic: part.law.clone(),
    }
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
    list(group, FIELD_GAP, &scalars(&|c| c.point.field_gap))?;
    list(group, "touching", &contacts.iter().map(|c| u8::from(c.point.law.touching)).collect::<Vec<_>>())?;
    table(group, "displacement", 3, &vectors(&|c| c.displacement))?;
    list(group, "normal_force", &scalars(&|c| c.normal_force))
}

/// Reads a super-element and its surface. Not collective.
///
/// # Errors
/// [`crate::Error::Input`] where the file is none, is incomplete, or of another version.
pub fn read(path: &Path) -> Result<(SuperElement, OuterSurface)> {
    let element = read_element(path)?;
    let damaged = |reason: hdf5::Error| hdf::damaged(path, &FORMAT, reason);
    let surface = read_surface(&hdf::open(path, &FORMAT)?).map_err(damaged)?;
    if surface.basis.len() != 3 * surface.nodes.len() * element.n_coordinates() {
        return Err(hdf::damaged(path, &FORMAT, "the basis of the surface has another size"));
    }
    let is_outside = |i: &u32| *i as usize >= surface.nodes.len();
    if surface.triangles.as_flattened().iter().any(is_outside) || surface.part.len() != surface.triangles.len() {
        return Err(hdf::damaged(path, &FORMAT, "the triangles of the surface do not fit its nodes and parts"));
    }
    Ok((element, surface))
}

/// Reads a super-element without its surface, whose basis is most of the file. Not collective.
///
/// # Errors
/// See [`read`].
pub fn read_element(path: &Path) -> Result<SuperElement> {
    let file = hdf::open(path, &FORMAT)?;
    let element = read_body(&file).map_err(|reason| hdf::damaged(path, &FORMAT, reason))?;
    inconsistency(&element).map_or(Ok(element), |what| Err(hdf::damaged(path, &FORMAT, what)))
}

fn read_about(file: &File) -> hdf5::Result<About> {
    toml::from_str(&read_text(file, "about")?).map_err(|reason| hdf5::Error::from(reason.to_string()))
}

fn read_body(file: &File) -> hdf5::Result<SuperElement> {
    let about = read_about(file)?;
    let pairs = pairs(&about.pair);
    let group = file.group("contacts")?;
    let motion = match group.link_exists("motion") {
        true => ContactMotion::Rows(values(&group, "motion")?),
        false => ContactMotion::Nodes,
    };
    let parts = read_parts(file, about.part_matrices)?;
    Ok(SuperElement {
        origin: about.origin,
        model_text: file.link_exists(MODEL).then(|| read_text(file, MODEL)).transpose()?,
        parts,
        rest: about.rest,
        points: triples(file, "points")?,
        frequencies: values(file, "frequencies")?,
        mass: values(file, "mass")?,
        damping: values(file, "damping")?,
        stiffness: values(file, "stiffness")?,
        viscoelastic: read_viscoelastic(file, about.viscoelastic)?,
        geometric_stiffness: optional(file, GEOMETRIC_STIFFNESS)?,
        structural_damping: optional(file, STRUCTURAL_DAMPING)?,
        load: values(file, "load")?,
        preload: values(file, "preload")?,
        contacts: read_contacts(&group, &pairs, &about.pair)?,
        pairs,
        motion,
    })
}

/// Values that only some files have.
fn optional(file: &File, name: &str) -> hdf5::Result<Option<Vec<f64>>> {
    file.link_exists(name).then(|| values(file, name)).transpose()
}

/// As many matrices of one size, which stand one after the other.
fn matrices(file: &File, name: &str, n: usize) -> hdf5::Result<Vec<Vec<f64>>> {
    let all: Vec<f64> = values(file, name)?;
    match n {
        _ if !all.len().is_multiple_of(n.max(1)) => Err(format!("{name} is not for {n} matrices").into()),
        0 => Ok(Vec::new()),
        _ => Ok((0..n).map(|i| all[i * all.len() / n..(i + 1) * all.len() / n].to_vec()).collect()),
    }
}

fn read_viscoelastic(file: &File, laws: Vec<ViscoelasticLaw>) -> hdf5::Result<Vec<ViscoelasticTerm>> {
    let stiffnesses = if laws.is_empty() { Vec::new() } else { matrices(file, VISCOELASTIC, laws.len())? };
    let term = |(law, stiffness): (ViscoelasticLaw, _)| match law.is_sound() {
        true => Ok(ViscoelasticTerm { law, stiffness }),
        false => Err("a viscoelastic law that no material has".into()),
    };
    laws.into_iter().zip(stiffnesses).map(term).collect()
}

fn read_parts(file: &File, texts: Vec<PartText>) -> hdf5::Result<Vec<PartMatrices>> {
    let [masses, stiffnesses] = [PART_MASSES, PART_STIFFNESSES].map(|name| matrices(file, name, texts.len()));
    let part = |(text, (mass, stiffness)): (PartText, (Vec<f64>, Vec<f64>))| {
        let PartText { name, rayleigh, loss_factor, viscoelastic } = text;
        match viscoelastic.as_ref().is_none_or(ViscoelasticLaw::is_sound) {
            true => Ok(PartMatrices { name, mass, stiffness, rayleigh, loss_factor, law: viscoelastic }),
            false => Err("a viscoelastic law that no material has".into()),
        }
    };
    texts.into_iter().zip(masses?.into_iter().zip(stiffnesses?)).map(part).collect()
}

fn read_surface(file: &File) -> hdf5::Result<OuterSurface> {
    let surface = file.group("surface")?;
    Ok(OuterSurface {
        nodes: triples(&surface, "nodes")?,
        triangles: triples(&surface, "triangles")?,
        part: values(&surface, "part")?,
        parts: read_about(file)?.parts,
        basis: values(&surface, "basis")?,
    })
}

fn read_contacts(group: &Group, pairs: &[ContactPair], texts: &[PairText]) -> hdf5::Result<Vec<NodeContact>> {
    let pair: Vec<u32> = values(group, "pair")?;
    let [position, normal, direction, displacement] =
        ["position", "normal", "direction", "displacement"].map(|name| triples::<f64>(group, name));
    let (position, normal, direction, displacement) = (position?, normal?, direction?, displacement?);
    let [speed, weight, gap, force] = ["speed", "weight", "gap", "normal_force"].map(|name| values::<f64>(group, name));
    let (speed, weight, gap, force, touching) = (speed?, weight?, gap?, force?, values::<u8>(group, "touching")?);
    let field_gap = match group.link_exists(FIELD_GAP) {
        true => values::<f64>(group, FIELD_GAP)?,
        false => vec![0.0; pair.len()],
    };
    let lengths = [position.len(), normal.len(), direction.len(), displacement.len(), speed.len(), weight.len()];
    if lengths.iter().chain(&[gap.len(), field_gap.len(), force.len(), touching.len()]).any(|&n| n != pair.len()) {
        return Err("the lists of the contacts differ in length".into());
    }
    let of = |i: usize| {
        let own = pairs.get(pair[i] as usize).ok_or_else(|| hdf5::Error::from("a contact of no pair"))?;
        let law = PointLaw {
            weight: weight[i],
            normal: normal[i],
            gap: gap[i],
            correction: 0.0,
            wear: 0.0,
            touching: touching[i] != 0,
            separation: own.separation,
            normal_law: own.law.clone(),
            tangential: texts[pair[i] as usize].kind.tangential(direction[i], speed[i]),
        };
        let point = ContactPoint {
            pair: pair[i] as usize,
            places: vec![Place::Node(i as u32)],
            nodes: vec![i as u32],
            position: position[i],
            field_gap: field_gap[i],
            law,
        };
        Ok(NodeContact { point, displacement: displacement[i], normal_force: force[i] })
    };
    (0..pair.len()).map(of).collect()
}

/// What does not fit together.
fn inconsistency(element: &SuperElement) -> Option<String> {
    let (n, least) = (element.n_coordinates(), 3 * element.points.len() + element.frequencies.len());
    if n < least {
        return Some(format!("{n} coordinates for {least} retained displacements and modes"));
    }
    let matrices = [("mass", &element.mass), ("damping", &element.damping), ("stiffness", &element.stiffness)];
    let optional =
        [(STRUCTURAL_DAMPING, &element.structural_damping), (GEOMETRIC_STIFFNESS, &element.geometric_stiffness)];
    let optional = optional.into_iter().filter_map(|(name, own)| Some((name, own.as_ref()?)));
    let matrices = matrices.into_iter().chain(optional);
    let matrices = matrices.chain(element.viscoelastic.iter().map(|term| (VISCOELASTIC, &term.stiffness)));
    let parts = element.parts.iter().flat_map(|part| [(PART_MASSES, &part.mass), (PART_STIFFNESSES, &part.stiffness)]);
    let matrices = matrices.chain(parts);
    let vectors = [("load", &element.load), ("preload", &element.preload)];
    let sized = matrices.map(|(name, m)| (name, m, n * n)).chain(vectors.map(|(name, v)| (name, v, n)));
    for (name, values, length) in sized {
        if values.len() != length {
            return Some(format!("{name} has {} values instead of {length}", values.len()));
        }
        if !values.iter().all(|x| x.is_finite()) {
            return Some(format!("{name} holds values that are not finite"));
        }
    }
    let numbers = element.contacts.iter().flat_map(|contact| {
        let law = &contact.point.law;
        let scalars = [law.weight, law.gap, contact.point.field_gap, contact.normal_force];
        [&law.normal[..], &contact.point.position, &contact.displacement, &scalars].concat()
    });
    if !element.points.as_flattened().iter().copied().chain(numbers).all(f64::is_finite) {
        return Some("points or contacts hold values that are not finite".into());
    }
    let n_contacts: usize = element.pairs.iter().map(|pair| pair.points.len()).sum();
    let has_places = match &element.motion {
        ContactMotion::Nodes => 2 * n_contacts <= element.points.len(),
        ContactMotion::Rows(rows) => rows.len() == 3 * n_contacts * n && rows.iter().all(|x| x.is_finite()),
    };
    let differ = n_contacts != element.contacts.len() || !has_places;
    differ.then(|| format!("{} contacts, {n_contacts} in its pairs", element.contacts.len()))
}
