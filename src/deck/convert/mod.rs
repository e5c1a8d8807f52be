//! From a deck to a [`Model`] and its [`Mesh`], in SI units; what the model cannot express is refused with its place.
//!
//! ```text
//! Deck --Assembly--> one numbering --bodies--> parts, materials, tetrahedra
//!                                  --regions--> surfaces, node sets   (each name once)
//!                                  --history--> what acts at the end of the last step: supports, loads, rotations
//!                                  --adjust--> nodes of slaves moved onto masters
//!                                  --pairs, ties--> contacts, ties
//!                                  --references--> joints, discrete: rigid sets, connectors, masses, point forces
//! ```

use std::collections::{BTreeMap, HashMap};

mod adjust;
mod analysis;
mod bodies;
mod bodies_apart;
mod discrete;
mod equations;
mod gravity;
mod history;
mod joints;
mod masses;
mod materials;
mod orientations;
mod pairs;
mod references;
mod regions;
mod rotations;
mod supports;
#[cfg(test)]
mod tests;
mod ties;

use super::assembly::Assembly;
use super::summary::DeckSummary;
use super::types::Deck;
use crate::Result;
use crate::mesh::Mesh;
use crate::model::{InstabilityCriterion, Model, Place, UnitSystem};
use bodies::Bodies;
use equations::Axes;
use regions::Regions;

pub use pairs::settle;

/// What is known of a deck's units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KnownUnits {
    /// The system, where it is named.
    pub system: Option<UnitSystem>,
    /// Metres per unit of length, where that is known.
    pub length: Option<f64>,
}

/// A deck as the program analyses it.
#[derive(Debug)]
pub struct Converted {
    /// Parts, contacts, loads and the rest.
    pub model: Model,
    /// Its mesh, m.
    pub mesh: Mesh,
    /// What was understood.
    pub summary: DeckSummary,
}

/// What a conversion works with, and what it has so far.
struct Conversion<'d> {
    deck: &'d Deck,
    assembly: Assembly<'d>,
    units: UnitSystem,
    bodies: Bodies,
    regions: Regions,
    /// Numbers of the mesh's nodes in the deck.
    numbers: Vec<u32>,
    /// Local axes of the mesh's nodes that have them.
    axes: HashMap<u32, Axes>,
    /// Elements of each point mass, by its name.
    mass_elements: BTreeMap<String, Vec<u32>>,
    notes: Vec<String>,
}

/// Converts a deck.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input), `file:line: what. what to do`: names and numbers that mean nothing, elements
/// and materials that cannot be analysed, units that cannot be found, constraints that the model cannot express.
pub fn convert(deck: &Deck, known: KnownUnits) -> Result<Converted> {
    let assembly = Assembly::new(deck)?;
    let sections = bodies::sections(&assembly)?;
    let units = materials::units(deck, &sections, known)?;
    let mut notes = deck.notes.clone();
    notes.extend(materials::without_density(deck));
    let (bodies, mesh) = Bodies::new(&assembly, &sections, &units, &mut notes)?;
    let regions = Regions::new(mesh);
    let used = (0..assembly.numbers.len()).filter(|&node| bodies.node_of[node] != bodies::UNUSED);
    let numbers = used.map(|node| assembly.numbers[node]).collect();
    let (axes, mass_elements) = Default::default();
    let mut conversion = Conversion { deck, assembly, units, bodies, regions, numbers, axes, mass_elements, notes };
    let model = conversion.model()?;
    let Conversion { assembly, regions, notes, .. } = conversion;
    let summary = DeckSummary::new(&assembly, &units, notes);
    Ok(Converted { model, mesh: regions.mesh, summary })
}

impl Conversion<'_> {
    fn model(&mut self) -> Result<Model> {
        self.named_surfaces()?;
        self.adjust_nodes()?;
        self.axes = self.transforms()?;
        let contacts = self.contacts()?;
        let state = history::State::of(self.deck);
        let mut equations = self.equations()?;
        let fixes = self.supports(&state, &mut equations)?;
        let loads = self.loads(&state)?;
        let references = self.references(&state)?;
        let rotations = self.rotations(&state)?;
        let (settings, file) = (self.settings(), self.deck.files[0].clone());
        let mut model = Model {
            title: self.deck.title.clone().unwrap_or_else(|| stem(&file)),
            mesh_file: file.clone(),
            files: self.deck.files.clone(),
            file,
            mesh_unit: self.units.length,
            unit_system: None,
            mesh_place: Place { file: 0, line: 1 },
            parts: self.bodies.parts.clone(),
            rotations,
            fixes,
            contacts: self.with_friction_of(&state, contacts)?,
            connectors: Vec::new(),
            ties: self.ties()?,
            rigid_sets: Vec::new(),
            masses: Vec::new(),
            equations,
            loads,
            band: settings.band,
            friction_damping: settings.friction_damping,
            prestress: settings.prestress,
            criterion: InstabilityCriterion::default(),
            swept: Vec::new(),
            frictions: Vec::new(),
            sweep_place: Place::default(),
            reduction: None,
        };
        self.joints(&references, &mut model)?;
        self.discrete(&references, &mut model)?;
        model.loads.extend(self.gravity(&state, &model)?);
        self.node_sets()?;
        Ok(model)
    }
}

fn stem(file: &std::path::Path) -> String {
    file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
