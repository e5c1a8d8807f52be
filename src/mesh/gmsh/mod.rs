//! Gmsh's mesh format 4.1, ASCII and binary (<https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format>).
//!
//! [`scan`] reads numbers in either encoding, [`sections`] reads the file's tables, [`convert`] relates them: tags to
//! indices, groups to parts, facets to elements. Gmsh has other orders of midsides than we do (`kinds`); this is put
//! right on reading, and nothing after this module depends on it.

mod convert;
mod groups;
mod kinds;
mod scan;
mod sections;
#[cfg(test)]
mod tests;
mod write;

pub use write::write;

use super::Mesh;
use crate::{Error, Result};
use std::path::Path;

/// Reads a mesh of tetrahedra, hexahedra and wedges of first or second order; `unit` is metres per unit of the file.
///
/// Physical volumes become parts (in the order of `$PhysicalNames`), physical surfaces become surfaces with facets that
/// look out of their part, physical curves and points become node sets. Elements are of the kind that
/// [`ElementKind::default_for`](crate::element::ElementKind::default_for) gives their shape. Nodes that no element uses
/// are left out.
///
/// ```
/// let mesh = squeal::mesh::read("tests/data/pads_on_disc.msh".as_ref(), 1e-3)?;
/// assert_eq!((mesh.parts.len(), mesh.parts[0].as_str()), (5, "disc"));
/// assert!(mesh.surfaces.contains_key("lining_inner_face"));
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] with the file and line (or byte, or the names of part and element) for a file that is missing,
/// truncated or of another version, for elements of other shapes, volumes outside all parts, names with two meanings,
/// facets and node sets off the elements, and inverted elements.
pub fn read(path: &Path, unit: f64) -> Result<Mesh> {
    let bytes = std::fs::read(path).map_err(|reason| {
        Error::input(format!("{}: cannot read the mesh: {reason}. Give its path in [mesh] file", path.display()))
    })?;
    parse(&bytes, path, unit)
}

/// Reads the bytes of a mesh file; `file` is what messages call it.
fn parse(bytes: &[u8], file: &Path, unit: f64) -> Result<Mesh> {
    let sections = sections::sections(&mut scan::Scan::new(file, bytes))?;
    let convert = || convert::mesh(&sections, unit);
    convert().map_err(|message: String| Error::Input(format!("{}: {message}", file.display())))
}
