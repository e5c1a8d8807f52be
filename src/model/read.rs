//! From the file to the model: one step a table, in an order in which names are known before they are used.

use super::item::Item;
use super::source::{ModelText, utf8};
use super::{Model, Place, UnitSystem, analysis, bodies, contacts, joints, keys, loads, materials};
use crate::hdf::is_hdf5;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// Units of length and their metres.
pub(super) const UNITS: [(&str, f64); 6] =
    [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254), ("ft", 0.3048)];

/// Reads and checks a model file.
///
/// The mesh it names is not opened; see [`Model::check_against`] for what only the mesh can tell.
///
/// ```
/// let model = squeal::model::read("tests/data/pads_on_disc.toml".as_ref())?;
/// assert_eq!((model.contacts.len(), model.contacts[0].friction), (2, 0.4));
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`], `file:line: what (item). what to do`, for the first thing that is wrong.
pub fn read(path: &Path) -> Result<Model> {
    parse(&read_text(path)?, path)
}

/// Reads the text of a model file.
///
/// # Errors
/// [`Error::Input`] where the file cannot be read or is of another kind.
pub fn read_text(path: &Path) -> Result<String> {
    let place = path.display();
    let bytes = std::fs::read(path).map_err(|reason| {
        let advice =
            if path.is_dir() { "Name the model file in it" } else { "Name the model file, such as brake.toml" };
        Error::input(format!("{place}: cannot read the model file: {reason}. {advice}"))
    })?;
    if bytes.starts_with(b"$MeshFormat") {
        return Err(Error::input(format!("{place} is a mesh. Name the model file that has it as [mesh] file")));
    }
    if is_hdf5(path) {
        let what = "is a super-element or a results file, not a model file";
        let advice = "Super-elements are for squeal static, stability and export, results for report and compare";
        return Err(Error::input(format!("{place} {what}. {advice}")));
    }
    utf8(path, &bytes).map(str::to_owned)
}

/// Checks the text of a model file; `file` is what messages call it, and its folder is where the mesh is looked for.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, file: &Path) -> Result<Model> {
    let source = ModelText { file, text };
    let raw: keys::File = source.deserialize()?;
    let names_deck = is_deck(Path::new(raw.mesh.get_ref().file.get_ref()));
    let (mesh_unit, unit_system) = unit(source, raw.mesh.get_ref(), names_deck)?;
    let materials = materials::materials(source, &raw.material)?;
    let parts = bodies::parts(source, &raw.part, &materials)?;
    let contacts = contacts::contacts(source, &raw.contact, mesh_unit)?;
    let sweep = analysis::sweep(source, raw.sweep.as_ref(), (!names_deck).then_some(&contacts[..]))?;
    let stability = Item::new(source, "stability".to_owned(), raw.stability.span());
    Ok(Model {
        file: file.to_owned(),
        files: vec![file.to_owned()],
        title: raw.title.unwrap_or_else(|| stem(file)),
        mesh_file: beside(file, raw.mesh.get_ref().file.get_ref()),
        mesh_unit,
        unit_system,
        mesh_place: Place { file: 0, line: source.line(raw.mesh.get_ref().file.span().start) as u32 },
        fixes: bodies::fixes(source, &raw.fix, mesh_unit)?,
        rotations: bodies::rotations(source, &raw.rotation, (!names_deck).then_some(&parts[..]), mesh_unit)?,
        connectors: joints::connectors(source, &raw.connector, mesh_unit)?,
        ties: joints::ties(source, &raw.tie, mesh_unit)?,
        rigid_sets: joints::rigid_sets(source, &raw.rigid)?,
        masses: joints::masses(source, &raw.mass, mesh_unit)?,
        equations: joints::equations(source, &raw.equation)?,
        loads: loads::loads(source, &raw.load, mesh_unit)?,
        band: stability.band(&raw.stability.get_ref().band)?,
        friction_damping: raw.stability.get_ref().friction_damping,
        prestress: raw.stability.get_ref().prestress,
        criterion: analysis::criterion(&stability, raw.stability.get_ref().unstable.as_ref())?,
        swept: sweep.contacts,
        frictions: sweep.frictions,
        sweep_place: sweep.place,
        reduction: raw.reduction.map(|raw| analysis::reduction(source, &raw)).transpose()?,
        parts,
        contacts,
    })
}

/// Whether a path names an input file of Abaqus or CalculiX: it ends with `.inp`, in any case.
pub fn is_deck(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("inp"))
}

/// Metres per unit of the mesh; of a deck also the name of a system of units, where one is given.
fn unit(source: ModelText, mesh: &keys::MeshTable, names_deck: bool) -> Result<(f64, Option<String>)> {
    let wanted = mesh.unit.get_ref();
    if let Some(system) = UnitSystem::named(wanted).ok().filter(|_| names_deck) {
        return Ok((system.length, Some(wanted.clone())));
    }
    let item = Item::new(source, "mesh".to_owned(), mesh.unit.span());
    item.find("unit of length", &mesh.unit, &UNITS, |(name, _)| name).map(|(_, metres)| (*metres, None))
}

/// A path of the file, seen from the current directory.
fn beside(file: &Path, path: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(path)
}

fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
