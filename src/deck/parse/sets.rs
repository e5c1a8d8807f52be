//! Sets of nodes and elements, and surfaces.

use super::Parser;
use crate::Result;
use crate::deck::card::{Card, label};
use crate::deck::row::{Row, number};
use crate::deck::types::{Entry, SetDefinition, SurfaceDefinition, SurfaceItem};

impl Parser {
    /// `*NSET`, `*ELSET`: numbers and names of sets, or ranges.
    pub(super) fn set(&mut self, card: &Card) -> Result<()> {
        let is_of_nodes = card.name == "NSET";
        let name = self.name_of(card, if is_of_nodes { "NSET" } else { "ELSET" })?;
        if is_of_nodes && card.has("ELSET") {
            let what = "a node set of the nodes of an element set is not supported (ELSET=). List the nodes";
            return Err(card.error(what));
        }
        let instance = card.word("INSTANCE");
        let generate = card.has("GENERATE");
        let mut entries = Vec::new();
        while let Some(row) = self.lines.row()? {
            if generate {
                entries.push((range(&row)?, row.place));
            } else {
                entries.extend(row.fields().filter(|field| !field.is_empty()).map(|field| (entry(field), row.place)));
            }
        }
        let set = SetDefinition { name, instance, entries, place: card.place };
        let scope = self.scope();
        if is_of_nodes {
            scope.node_sets.push(set)
        } else {
            scope.element_sets.push(set)
        }
        Ok(())
    }

    /// `*SURFACE`: a set or number and a face a line, or nodes.
    pub(super) fn surface(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        let of_nodes = card.choice("TYPE", &["ELEMENT", "NODE"])? == 1;
        let instance = card.word("INSTANCE");
        let mut items = Vec::new();
        while let Some(row) = self.lines.row()? {
            let of = entry(&row.name(0, "the set or number")?);
            let face = match row.field(1) {
                "" => None,
                // The second field of a node is its area.
                _ if of_nodes => None,
                text => Some(face(&row, text, 'S')?),
            };
            items.push(SurfaceItem { of, face, place: row.place });
        }
        if let Some(other) = self.scope().surfaces.iter().find(|other| other.name == name) {
            let line = other.place.line;
            return Err(
                card.error(format_args!("the surface {name} is there already, in line {line}. Rename one of them"))
            );
        }
        self.scope().surfaces.push(SurfaceDefinition { name, of_nodes, instance, items, place: card.place });
        Ok(())
    }
}

/// A number, or a name in capital letters.
pub fn entry(text: &str) -> Entry {
    match number(text) {
        Some(number) => Entry::Number(number),
        None => Entry::Name(label(text).to_uppercase().into()),
    }
}

/// First, last and step of a range.
fn range(row: &Row) -> Result<Entry> {
    let mut fields = row.fields();
    let mut next = |what: &str| row.number(fields.next().unwrap_or_default(), what);
    let (first, last) = (next("the first number of the range")?, next("the last number of the range")?);
    let step = if row.field(2).is_empty() { 1 } else { row.number(row.field(2), "the step of the range")? };
    if first > last {
        return Err(row.error(format_args!("the range from {first} to {last} is empty")));
    }
    Ok(Entry::Range(first, last, step))
}

/// The number of a face, `S3` or `P3`, from 1.
pub fn face(row: &Row, text: &str, letter: char) -> Result<u8> {
    let number = text.to_uppercase().strip_prefix(letter).and_then(|rest| rest.parse().ok());
    number.filter(|number| (1..=6).contains(number)).ok_or_else(|| {
        row.error(format_args!("the face {text:?} is not supported. Faces of solids are {letter}1 to {letter}6"))
    })
}
