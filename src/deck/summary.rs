//! What was understood of a deck, for the user to compare with what was meant.

use serde::{Deserialize, Serialize};

use super::assembly::Assembly;
use super::sets::Kind;
use crate::model::UnitSystem;

/// What was understood of a deck.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeckSummary {
    /// The deck and the files that it includes.
    pub files: Vec<String>,
    /// Lines in all files.
    pub lines: usize,
    /// Name of the system of units.
    pub units: String,
    /// Kinds of element and their numbers.
    pub elements: Vec<ElementCount>,
    /// Instances of parts.
    pub instances: usize,
    /// Sets of nodes.
    pub node_sets: usize,
    /// Sets of elements.
    pub element_sets: usize,
    /// Surfaces.
    pub surfaces: usize,
    /// Steps.
    pub steps: usize,
    /// Keywords that change no result, how often they are there, and where first.
    pub ignored: Vec<IgnoredKeyword>,
    /// How something was understood, or what was chosen.
    pub notes: Vec<String>,
}

/// How many elements of a kind there are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ElementCount {
    /// The kind, as the deck calls it.
    pub kind: String,
    /// Their number.
    pub elements: usize,
}

/// A keyword that changes no result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IgnoredKeyword {
    /// The keyword.
    pub keyword: String,
    /// How often it is there.
    pub times: usize,
    /// Where it is first, `file:line`.
    pub first: String,
}

impl DeckSummary {
    /// The summary of an assembly.
    pub fn new(assembly: &Assembly, units: &UnitSystem, notes: Vec<String>) -> DeckSummary {
        let deck = assembly.deck;
        let mut elements: Vec<ElementCount> = Vec::new();
        for element in &assembly.elements {
            match elements.iter_mut().find(|count| count.kind == element.kind.name) {
                Some(count) => count.elements += 1,
                None => elements.push(ElementCount { kind: element.kind.name.to_owned(), elements: 1 }),
            }
        }
        let place = |file: u16, line: u32| format!("{}:{line}", deck.files[usize::from(file)].display());
        let ignored = deck.ignored.iter().map(|ignored| IgnoredKeyword {
            keyword: ignored.keyword.clone(),
            times: ignored.times,
            first: place(ignored.place.file, ignored.place.line),
        });
        DeckSummary {
            files: deck.files.iter().map(|file| file.display().to_string()).collect(),
            lines: deck.n_lines,
            units: units.name.to_owned(),
            elements,
            instances: deck.instances.len(),
            node_sets: assembly.set_names(Kind::Node, 0).len(),
            element_sets: assembly.set_names(Kind::Element, 0).len(),
            surfaces: assembly.surface_names().len(),
            steps: deck.steps.len(),
            ignored: ignored.collect(),
            notes,
        }
    }

    /// The summary as text.
    pub fn text(&self) -> String {
        let mut out = format!("deck: {} lines in {}\n", self.lines, self.files.join(", "));
        let elements: Vec<String> =
            self.elements.iter().map(|count| format!("{} {}", count.elements, count.kind)).collect();
        out += &format!("elements: {}\n", elements.join(", "));
        out += &format!(
            "{} instances, {} element sets, {} node sets, {} surfaces, {} steps\n",
            self.instances, self.element_sets, self.node_sets, self.surfaces, self.steps
        );
        out += &format!("units: {} (found from densities and moduli, or named)\n", self.units);
        if !self.ignored.is_empty() {
            out += "ignored, as they change no result:\n";
        }
        for IgnoredKeyword { keyword, times, first } in &self.ignored {
            let times = if *times == 1 { String::new() } else { format!(", {times} times") };
            out += &format!("  {keyword} ({first}{times})\n");
        }
        self.notes.iter().for_each(|note| out += &format!("note: {note}\n"));
        out
    }
}
