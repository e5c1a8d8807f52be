//! `squeal convert`: a deck as a model file, a model as a deck.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::element::ElementKind;
use crate::model::{UnitSystem, is_deck};
use crate::output::files::write_whole;
use crate::output::overwrite::{FileKind, head_contains, may_write_file};
use crate::structure::ModelFiles;
use crate::{Error, Result, deck, mesh, model};

use super::{Shell, values};

/// What `convert` takes.
#[derive(Args)]
#[group(skip)]
pub struct Convert {
    /// A deck of Abaqus or CalculiX (.inp), or a model file
    input: PathBuf,
    /// The file to write: brake.toml, with the mesh beside it in brake.msh, or brake.inp
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Units of the deck, such as mm-t-s or m-kg-s (default: of a deck that is read, found from densities and moduli;
    /// of a deck that is written, mm-t-s)
    #[arg(long, value_name = "SYSTEM", value_parser = values::units)]
    units: Option<UnitSystem>,
    /// Replace earlier files that this command has written
    #[arg(long)]
    force: bool,
}

/// What the command prints as JSON.
#[derive(Serialize)]
struct Written {
    files: Vec<String>,
    notes: Vec<String>,
}

/// Stands near the start of all files that the command writes.
const MARK: &str = "written by squeal convert";

const KIND: FileKind =
    FileKind { name: "a file that squeal convert has written", is_one: |path| head_contains(path, MARK) };

pub fn run(shell: &Shell, arguments: &Convert) -> Result<()> {
    let comm = shell.comm;
    let written = comm.agree(if comm.is_root() { arguments.write().map(Some) } else { Ok(None) })?;
    let Some(written) = written else { return Ok(()) };
    let notes = written.notes.iter().map(|note| format!("note: {note}\n"));
    let text: String = notes.chain([format!("written: {}\n", written.files.join(", "))]).collect();
    shell.print(&text, &written)
}

impl Convert {
    fn write(&self) -> Result<Written> {
        let mut files = vec![self.output.clone()];
        match self.output.extension().and_then(|extension| extension.to_str()) {
            Some("toml") => files.push(self.output.with_extension("msh")),
            Some("inp") => {}
            _ => {
                let what = format!("{}: the name must end with .toml or .inp", self.output.display());
                return Err(Error::input(format!("{what}. Give -o brake.toml or -o brake.inp")));
            }
        }
        files.iter().try_for_each(|file| may_write_file(file, &KIND, self.force))?;
        let mut read = ModelFiles::read(&self.input, self.units.filter(|_| is_deck(&self.input)))?;
        read.model.check_against(&read.mesh)?;
        let mut notes = read.deck.as_ref().map_or_else(Vec::new, |deck| {
            let units = format!("the deck's units are {}", deck.units);
            std::iter::once(units).chain(deck.notes.iter().cloned()).collect()
        });
        notes.extend(read.model.proposed(&read.mesh).iter().map(ToString::to_string));
        match &files[..] {
            [model, mesh] => {
                notes.extend(name_kinds(&mut read));
                write_model(&read, model, mesh)?;
            }
            _ => notes.extend(self.write_deck(&read)?),
        }
        Ok(Written { files: files.iter().map(|file| file.display().to_string()).collect(), notes })
    }

    fn write_deck(&self, read: &ModelFiles) -> Result<Vec<String>> {
        let units = self.units.unwrap_or(UnitSystem::ALL[0]);
        let mut losses = Vec::new();
        write_whole(&self.output, |mut out| {
            losses = deck::write(&read.model, &read.mesh, units, MARK, &mut out)?;
            Ok(())
        })?;
        Ok(losses)
    }
}

/// Gmsh's meshes know shapes alone: the parts name the kinds that are not the usual ones of their shapes. Gives what is
/// lost where a part has two kinds of one shape.
fn name_kinds(read: &mut ModelFiles) -> Vec<String> {
    let mut lost = Vec::new();
    let mut of_parts = vec![BTreeSet::new(); read.mesh.parts.len()];
    for element in read.mesh.elements.iter() {
        of_parts[element.part as usize].insert(element.kind);
    }
    for (kinds, name) in of_parts.iter().zip(&read.mesh.parts) {
        let unusual = kinds.iter().filter(|kind| ElementKind::default_for(kind.shape()) != **kind);
        let Some(part) = read.model.parts.iter_mut().find(|part| part.name == *name) else { continue };
        part.elements.clear();
        for &kind in unusual {
            match kinds.iter().find(|other| **other != kind && other.shape() == kind.shape()) {
                None => part.elements.push(kind),
                Some(other) => lost.push(format!(
                    "elements {} and {} of {name} become {}: a part has one kind for each shape",
                    kind.name(),
                    other.name(),
                    ElementKind::default_for(kind.shape()).name()
                )),
            }
        }
    }
    lost
}

fn write_model(read: &ModelFiles, model: &Path, mesh: &Path) -> Result<()> {
    let name = mesh.file_name().unwrap_or_default().to_string_lossy();
    let text = format!("# {MARK} from {}\n{}", read.model.file.display(), model::write(&read.model, &name));
    write_whole(mesh, |mut out| mesh::write(&read.mesh, read.model.mesh_unit, MARK, &mut out))?;
    write_whole(model, |out| out.write_all(text.as_bytes()))
}
