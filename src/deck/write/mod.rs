//! A model and its mesh as a deck.
//!
//! What [`read`](super::read) understands is written so that reading it back gives the same matrices to round-off.
//! CalculiX reads all of it but `*COUPLING` of connectors and masses, `*ROTARY INERTIA` and `*MOTION`. Numbers have at
//! most 20 characters, which is what CalculiX reads.

mod history;
mod joints;
mod names;
mod properties;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::{self, Write};

use super::elements::{Class, by_name};
use crate::mesh::{Facet, Mesh};
use crate::model::{Inertia, Load, LoadKind, Model, UnitSystem};
use names::Names;

/// Nodes of an element on its first line.
const NODES_ON_FIRST_LINE: usize = 15;
/// Entries of a set on a line.
const PER_LINE: usize = 12;

/// Writes a model with its whole mesh; `mark` is a comment. Returns what of the model a deck cannot say, a sentence
/// each.
///
/// # Errors
/// The system's.
pub fn write(
    model: &Model,
    mesh: &Mesh,
    units: UnitSystem,
    mark: &str,
    out: &mut impl Write,
) -> io::Result<Vec<String>> {
    let mut writer = DeckWriter {
        model,
        mesh,
        units,
        names: Names::new(model, mesh),
        n_extra_nodes: 0,
        n_discrete: 0,
        n_orientations: 0,
        mass_sets: Vec::new(),
    };
    writeln!(out, "*HEADING\n{}\n** {mark}; units: {}", model.title.replace(['\n', '*'], " "), units.name)?;
    writer.nodes(out)?;
    writer.elements(out)?;
    out.write_all(writer.sets().as_bytes())?;
    out.write_all(writer.surfaces().as_bytes())?;
    out.write_all(writer.properties().as_bytes())?;
    out.write_all(writer.contacts().as_bytes())?;
    let joints = writer.joints();
    out.write_all(joints.text.as_bytes())?;
    out.write_all(writer.history(&joints.forces).as_bytes())?;
    Ok(writer.losses())
}

struct DeckWriter<'a> {
    model: &'a Model,
    mesh: &'a Mesh,
    units: UnitSystem,
    names: Names,
    /// Reference nodes so far, numbered after those of the mesh.
    n_extra_nodes: usize,
    /// Springs, dashpots and masses so far, numbered after the elements of the mesh.
    n_discrete: usize,
    /// Axes of connectors so far.
    n_orientations: usize,
    /// Point masses with their element sets, so far.
    mass_sets: Vec<(String, String)>,
}

/// A number with a decimal point and at most 20 characters: the shortest text that is read as the same number, or 13
/// digits. CalculiX 2.20 does not take `1e5` for the constant of a spring.
pub(super) fn number(x: f64) -> String {
    const LONGEST: usize = 20;
    let plain = if x.fract() == 0.0 && x.abs() < 1e15 { format!("{x:.1}") } else { format!("{x}") };
    let short = format!("{x:e}");
    let exponential = if short.contains('.') { short } else { short.replace('e', ".0e") };
    let candidates = [plain, exponential, format!("{x:.12e}")];
    let shortest = candidates[..2].iter().min_by_key(|text| text.len()).expect("there are two");
    if shortest.len() <= LONGEST { shortest.clone() } else { candidates[2].clone() }
}

/// A list of numbers of nodes or elements, some a line.
pub(super) fn rows(numbers: impl IntoIterator<Item = usize>) -> String {
    let all: Vec<String> = numbers.into_iter().map(|number| number.to_string()).collect();
    all.chunks(PER_LINE).map(|line| format!("{}\n", line.join(","))).collect()
}

impl DeckWriter<'_> {
    fn nodes(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "*NODE")?;
        for (x, i) in self.mesh.nodes.iter().zip(1..) {
            let [x, y, z] = x.map(|x| number(x / self.units.length));
            writeln!(out, "{i},{x},{y},{z}")?;
        }
        Ok(())
    }

    fn elements(&self, out: &mut impl Write) -> io::Result<()> {
        for (part, name) in self.mesh.parts.iter().enumerate() {
            let mut kind = None;
            for (e, element) in self.mesh.elements.iter().enumerate().filter(|(_, own)| own.part as usize == part) {
                if kind != Some(element.kind) {
                    writeln!(out, "*ELEMENT,TYPE={},ELSET={}", element.kind.name(), self.names.part(name))?;
                    kind = Some(element.kind);
                }
                write!(out, "{}", e + 1)?;
                for (i, node) in element.nodes.iter().enumerate() {
                    // CalculiX reads sixteen fields of a line.
                    let end = if i == NODES_ON_FIRST_LINE { "\n" } else { "" };
                    write!(out, ",{end}{}", node + 1)?;
                }
                writeln!(out)?;
            }
        }
        Ok(())
    }

    /// Node sets of the mesh, of the surfaces that supports and loads act on, and of turning parts.
    fn sets(&self) -> String {
        let (model, mut out) = (self.model, String::new());
        let mut wanted: Vec<&str> = self.mesh.node_sets.keys().map(String::as_str).collect();
        wanted.extend(model.fixes.iter().map(|fix| fix.nodes.as_str()));
        wanted.extend(model.rigid_sets.iter().map(|set| set.nodes.as_str()));
        let by_node = |load: &&Load| matches!(load.kind, LoadKind::ForceByNode(_));
        wanted.extend(model.loads.iter().filter(by_node).map(|load| load.on.as_str()));
        wanted.sort_unstable();
        wanted.dedup();
        for name in wanted {
            let nodes = self.mesh.node_set(name).unwrap_or_default();
            write!(out, "*NSET,NSET={}\n{}", self.names.region(name), rows(nodes.iter().map(|&n| n as usize + 1)))
                .expect("a string takes all");
        }
        for rotation in &model.rotations {
            let part = self.mesh.parts.iter().position(|name| *name == rotation.part);
            let own = self.mesh.elements.iter().filter(|element| Some(element.part as usize) == part);
            let mut nodes: Vec<usize> = own.flat_map(|element| element.nodes).map(|&n| n as usize + 1).collect();
            nodes.sort_unstable();
            nodes.dedup();
            write!(out, "*NSET,NSET={}\n{}", self.names.turning(&rotation.part), rows(nodes))
                .expect("a string takes all");
        }
        out
    }

    /// Surfaces by faces of elements.
    fn surfaces(&self) -> String {
        let facets = self.mesh.surfaces.values().flat_map(|surface| &surface.facets);
        let mut wanted: HashMap<[u32; 4], Option<(usize, usize)>> = facets.map(|facet| (facet.key(), None)).collect();
        for (e, element) in self.mesh.elements.iter().enumerate() {
            let Some(Class::Solid(faces)) = by_name(element.kind.name()).map(|kind| kind.class) else { continue };
            for (f, face) in faces.iter().enumerate() {
                let facet: Facet = face.iter().map(|&i| element.nodes[i]).collect();
                if let Some(place) = wanted.get_mut(&facet.key()) {
                    place.get_or_insert((e + 1, f + 1));
                }
            }
        }
        let mut out = String::new();
        for (name, surface) in &self.mesh.surfaces {
            writeln!(out, "*SURFACE,NAME={},TYPE=ELEMENT", self.names.region(name)).expect("a string takes all");
            for (element, face) in surface.facets.iter().filter_map(|facet| wanted[&facet.key()]) {
                writeln!(out, "{element},S{face}").expect("a string takes all");
            }
        }
        out
    }

    /// What of the model a deck cannot say.
    fn losses(&self) -> Vec<String> {
        let model = self.model;
        let mut losses = Vec::new();
        if !model.frictions.is_empty() {
            losses.push("the sweep of the friction coefficient is not written: a deck has one coefficient".to_owned());
        }
        if model.reduction.is_some() {
            losses.push("the reduction is not written".to_owned());
        }
        for part in model.parts.iter().filter(|part| part.material.viscoelastic.is_some()) {
            let what = "is not written: the deck has its modulus at rest";
            losses.push(format!("the viscoelastic law of {:?} {what}", part.material.name));
        }
        if model.prestress == Some(false) && model.rotations.iter().any(|rotation| rotation.inertia != Inertia::None) {
            losses.push("prestress = false is not written: parts with inertia have prestress".to_owned());
        }
        for contact in model.contacts.iter().filter(|contact| contact.friction_curve.is_some()) {
            losses.push(format!("how the friction of {:?} depends on speed and pressure is not written", contact.name));
        }
        for contact in model.contacts.iter().filter(|contact| contact.search_distance.is_some()) {
            losses.push(format!("the search distance of the contact {:?} is not written", contact.name));
        }
        for tie in model.ties.iter().filter(|tie| tie.stiffness.is_some() && tie.search_distance.is_some()) {
            losses.push(format!("the search distance of the tie {:?} is not written", tie.name));
        }
        losses
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_twenty_characters_at_most_and_a_point() {
        let all = [0.0, 1.0, -12.5, 0.1, 7.85e-9, 210e3, -1.0 / 3.0e-7, 1.0 / 3.0, -1.234_567_890_123_456e-105, 2e13];
        for x in all {
            let text = number(x);
            assert!(text.len() <= 20 && text.contains('.'), "{text}");
            let back: f64 = text.parse().unwrap();
            assert!((back - x).abs() <= 1e-12 * x.abs(), "{text}");
        }
        assert_eq!([1.0, 0.1, 7.85e-9].map(number), ["1.0", "0.1", "7.85e-9"]);
    }
}
