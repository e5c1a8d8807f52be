//! A model and its mesh from their files: a model file with a Gmsh mesh, with a deck, or a deck alone.

use std::fs::File;
use std::path::Path;

use crate::deck::{self, Converted, DeckSummary, KnownUnits};
use crate::mesh::{self, Mesh};
use crate::model::{self, Model, UnitSystem, is_deck};
use crate::native::Comm;
use crate::{Error, Result};

/// A model with its whole mesh.
pub struct ModelFiles {
    /// The model.
    pub model: Model,
    /// Its mesh, m.
    pub mesh: Mesh,
    /// What was understood of the deck, where there is one.
    pub deck: Option<DeckSummary>,
    /// The text of the model file; none where a deck is read.
    pub text: Option<String>,
}

/// A model that all ranks have, and its mesh on the root.
pub(super) struct SharedFiles {
    pub model: Model,
    pub mesh: Option<Mesh>,
    pub deck: Option<DeckSummary>,
    pub text: Option<String>,
}

impl ModelFiles {
    /// Reads a model file or a deck, and the mesh. `units` is the system of units of a deck that is read alone, where
    /// it is not to be found from densities and moduli. Not collective.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line, whatever is wrong.
    pub fn read(path: &Path, units: Option<UnitSystem>) -> Result<ModelFiles> {
        let mut files = ModelFiles::as_written(path, units)?;
        change_kinds(&files.model, &mut files.mesh)?;
        Ok(files)
    }

    /// Model and mesh, whose elements are of the kinds of the mesh.
    fn as_written(path: &Path, units: Option<UnitSystem>) -> Result<ModelFiles> {
        if is_deck(path) {
            let known = KnownUnits { system: units, length: None };
            return Ok(ModelFiles::of_deck(deck::read(path, known)?, |_| true));
        }
        let text = model::read_text(path)?;
        let model = model::parse(&text, path)?;
        if let Err(reason) = File::open(&model.mesh_file) {
            let what = format!("cannot open the mesh {}: {reason}", model.mesh_file.display());
            let advice = "Give its path in [mesh] file, relative to the model file";
            return Err(model.error(model.mesh_place, format_args!("{what}. {advice}")));
        }
        if !is_deck(&model.mesh_file) {
            let mesh = mesh::read(&model.mesh_file, model.mesh_unit)?;
            return Ok(ModelFiles { model, mesh, deck: None, text: Some(text) });
        }
        let system = model.unit_system.as_deref().and_then(|name| UnitSystem::named(name).ok());
        let mut converted = deck::read(&model.mesh_file, KnownUnits { system, length: Some(model.mesh_unit) })?;
        converted.model = model.over(converted.model)?;
        Ok(ModelFiles::of_deck(converted, |contact| contact.place.file > 0))
    }

    fn of_deck(converted: Converted, is_of_deck: impl Fn(&model::Contact) -> bool) -> ModelFiles {
        let Converted { mut model, mesh, mut summary } = converted;
        summary.notes.extend(deck::settle(&mut model, &mesh, is_of_deck));
        ModelFiles { model, mesh, deck: Some(summary), text: None }
    }

    /// The root reads, and gives all ranks the model; it keeps the mesh. Collective.
    ///
    /// # Errors
    /// As [`ModelFiles::read`], on all ranks.
    pub(super) fn shared(comm: &Comm, path: &Path) -> Result<SharedFiles> {
        let root = || {
            let ModelFiles { model, mesh, deck, text } = ModelFiles::read(path, None)?;
            Ok((Some((model, deck, text)), Some(mesh)))
        };
        let (known, mesh) = comm.agree(if comm.is_root() { root() } else { Ok((None, None)) })?;
        let known = if comm.size() > 1 { comm.broadcast_value(0, known) } else { known };
        let (model, deck, text) = known.ok_or_else(|| Error::input(format!("{}: no model", path.display())))?;
        Ok(SharedFiles { model, mesh, deck, text })
    }
}

/// Gives the elements the kinds that the model's parts ask for.
fn change_kinds(model: &Model, mesh: &mut Mesh) -> Result<()> {
    for part in &model.parts {
        let Some(index) = mesh.parts.iter().position(|name| *name == part.name) else { continue };
        for kind in &part.elements {
            if mesh.elements.change_kind(index as u32, *kind) == 0 {
                let what =
                    format_args!("part {:?}: the mesh has no elements of the shape of {}", part.name, kind.name());
                return Err(model.error(part.place, format_args!("{what}. Leave it out of elements")));
            }
        }
    }
    Ok(())
}
