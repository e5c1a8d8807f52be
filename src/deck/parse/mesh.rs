//! Nodes and elements, and what they are made of.

use std::f64::consts::PI;

use super::{Parser, scope};
use crate::Result;
use crate::algebra::{cross, norm, scale, sub};
use crate::deck::card::Card;
use crate::deck::elements::by_name;
use crate::deck::row::Row;
use crate::deck::types::{ElementBlock, Entry, Orientation, Section, SetDefinition};

/// Nodes may lie this far out, so that no square overflows.
const LARGEST_COORDINATE: f64 = 1e100;

/// Numbers that CalculiX's decks have behind the nodes of a C3D8I, for its incompatible modes.
const N_INCOMPATIBLE_MODES: usize = 3;

/// Axes in which coordinates are given, `x = origin + sum_i c_i axes_i`.
#[derive(Clone, Copy)]
pub struct Frame {
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
}

/// How coordinates are given.
#[derive(Clone, Copy)]
enum Coordinates {
    Cartesian,
    /// Radius, angle in degrees, z.
    Cylindrical,
    /// Radius, angle about z and angle above the plane, degrees.
    Spherical,
}

impl Coordinates {
    fn cartesian(self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = (b * PI / 180.0).sin_cos();
        match self {
            Coordinates::Cartesian => [a, b, c],
            Coordinates::Cylindrical => [a * cos, a * sin, c],
            Coordinates::Spherical => {
                let (up, across) = (c * PI / 180.0).sin_cos();
                [a * across * cos, a * across * sin, a * up]
            }
        }
    }
}

impl Frame {
    fn global(&self, c: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.origin[k] + (0..3).map(|i| c[i] * self.axes[i][k]).sum::<f64>())
    }

    /// The axes with an origin, a point on x and a point in the xy plane; none where they lie on a line.
    fn new(origin: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Option<Frame> {
        let x = unit(sub(x, origin))?;
        let z = unit(cross(x, sub(y, origin)))?;
        Some(Frame { origin, axes: [x, cross(z, x), z] })
    }
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(v);
    (length > 0.0 && length.is_finite()).then(|| scale(1.0 / length, v))
}

impl Parser {
    pub(super) fn node(&mut self, card: &Card) -> Result<()> {
        let system = [Coordinates::Cartesian, Coordinates::Cylindrical, Coordinates::Spherical];
        let coordinates = system[card.choice("SYSTEM", &["R", "C", "S"])?];
        let set = card.value("NSET").map(str::to_owned).map(|name| self.named(&name));
        let frame = self.system;
        let nodes = &mut scope(&mut self.deck, self.at).nodes;
        let first = nodes.numbers.len();
        while let Some(row) = self.lines.row()? {
            let (number, given) = node_row(&row)?;
            let x = coordinates.cartesian(given);
            nodes.numbers.push(number);
            nodes.coordinates.push(frame.map_or(x, |frame| frame.global(x)));
            nodes.places.push(row.place);
        }
        if let Some(name) = set {
            let entries = nodes.numbers[first..].iter().zip(&nodes.places[first..]);
            let entries = entries.map(|(&number, &place)| (Entry::Number(number), place)).collect();
            self.scope().node_sets.push(SetDefinition { name, instance: None, entries, place: card.place });
        }
        Ok(())
    }

    /// Axes for the nodes that follow; without data the global ones.
    pub(super) fn system(&mut self, card: &Card) -> Result<()> {
        let Some(row) = self.lines.row()? else {
            self.system = None;
            return Ok(());
        };
        let origin: [f64; 3] = row.reals(0, "a coordinate")?;
        let x: [f64; 3] = if row.fields().count() > 3 { row.reals(3, "a coordinate")? } else { shifted(origin, 0) };
        let y = match self.lines.row()? {
            Some(row) => row.reals(0, "a coordinate")?,
            None => turned_about_z(origin, x),
        };
        let parallel = "the points of the axes lie on a line. Give three points of a plane";
        self.system = Some(Frame::new(origin, x, y).ok_or_else(|| card.error(parallel))?);
        Ok(())
    }

    pub(super) fn element(&mut self, card: &Card) -> Result<()> {
        let name = card.required("TYPE")?.to_uppercase();
        let kind = by_name(&name).ok_or_else(|| {
            let kinds = "C3D4, C3D6, C3D8, C3D8I, C3D8R, C3D10, C3D10M, C3D15, C3D20, C3D20R";
            card.error(format_args!("elements of the type {name} are not supported. Solids are: {kinds}"))
        })?;
        let set = card.value("ELSET").map(str::to_owned).map(|name| self.named(&name));
        let n_others = if name == "C3D8I" { N_INCOMPATIBLE_MODES } else { 0 };
        let mut block = ElementBlock { kind, numbers: Vec::new(), nodes: Vec::new(), places: Vec::new() };
        while let Some(row) = self.lines.row()? {
            let place = row.place;
            let number = row.number(row.fields().next().unwrap_or_default(), "the number of an element")?;
            let mut n = push_nodes(&row, 1, [0, kind.n_nodes], n_others, &mut block.nodes)?;
            let mut continued = row.is_continued();
            while n < kind.n_nodes && continued {
                let Some(row) = self.lines.row()? else { break };
                n += push_nodes(&row, 0, [n, kind.n_nodes], n_others, &mut block.nodes)?;
                continued = row.is_continued();
            }
            if n < kind.n_nodes {
                let what = format_args!("element {number} has {n} nodes, but {name} has {}", kind.n_nodes);
                return Err(self.lines.error(place, what));
            }
            block.numbers.push(number);
            block.places.push(place);
        }
        if let Some(name) = set {
            let entries = block.numbers.iter().zip(&block.places);
            let entries = entries.map(|(&number, &place)| (Entry::Number(number), place)).collect();
            self.scope().element_sets.push(SetDefinition { name, instance: None, entries, place: card.place });
        }
        self.scope().elements.push(block);
        Ok(())
    }

    pub(super) fn section(&mut self, card: &Card) -> Result<()> {
        let (set, material) = (self.name_of(card, "ELSET")?, self.name_of(card, "MATERIAL")?);
        let orientation = card.word("ORIENTATION");
        self.scope().sections.push(Section { set, material, orientation, place: card.place });
        Ok(())
    }

    pub(super) fn orientation(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        let is_cylindrical = card.choice("SYSTEM", &["RECTANGULAR", "CYLINDRICAL"])? == 1;
        card.choice("DEFINITION", &["COORDINATES"])?;
        let Some(row) = self.lines.row()? else {
            return Err(card.error("the points of the axes are missing. Give two points"));
        };
        let (a, b) = (row.reals(0, "a coordinate")?, row.reals(3, "a coordinate")?);
        if row.fields().skip(6).any(|field| !field.is_empty()) {
            return Err(row.error("a third point is not supported: the origin of the axes is that of the mesh"));
        }
        if let Some(row) = self.lines.row()?
            && row.real_or(1, 0.0, "the angle")? != 0.0
        {
            return Err(row.error("an additional rotation is not supported. Give the points of the turned axes"));
        }
        self.scope().orientations.push(Orientation { name, is_cylindrical, a, b, place: card.place });
        Ok(())
    }
}

fn node_row(row: &Row) -> Result<(u32, [f64; 3])> {
    let mut fields = row.fields();
    let number = row.number(fields.next().unwrap_or_default(), "the number of a node")?;
    let mut x = [0.0; 3];
    for (i, value) in x.iter_mut().enumerate() {
        match fields.next() {
            None | Some("") => {}
            Some(text) => match crate::deck::row::real(text).filter(|x: &f64| x.abs() <= LARGEST_COORDINATE) {
                Some(given) => *value = given,
                None => {
                    return Err(
                        row.error(format_args!("coordinate {} of node {number} is {text:?}, not a number", i + 1))
                    );
                }
            },
        }
    }
    Ok((number, x))
}

/// Adds the node numbers of a line, from a field on, to those known of an element; refuses more than it has. Some
/// elements have other numbers behind their nodes.
fn push_nodes(
    row: &Row,
    first: usize,
    [known, most]: [usize; 2],
    n_others: usize,
    nodes: &mut Vec<u32>,
) -> Result<usize> {
    let fields = row.fields().skip(first);
    if let Some(field) = fields.clone().nth(most + n_others - known) {
        return Err(row.error(format_args!("the element has more nodes than its type, such as {field:?}")));
    }
    let before = nodes.len();
    for field in fields.take(most - known) {
        nodes.push(row.number(field, "the number of a node")?);
    }
    Ok(nodes.len() - before)
}

/// A point one unit along an axis from another.
fn shifted(mut x: [f64; 3], axis: usize) -> [f64; 3] {
    x[axis] += 1.0;
    x
}

/// The point `x`, turned by a right angle about an axis along z through `origin`.
fn turned_about_z(origin: [f64; 3], x: [f64; 3]) -> [f64; 3] {
    let arm = sub(x, origin);
    [origin[0] - arm[1], origin[1] + arm[0], origin[2] + arm[2]]
}
