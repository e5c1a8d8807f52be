//! VTU files (VTK XML unstructured grids) that ParaView, VisIt and pyvista open.
//!
//! Arrays are inline base64 with a 64-bit byte count each, numbers in little endian, values in single precision.
//! Format: VTK file formats, <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Quadratic cells of one kind; VTK's node orders are those of [`crate::mesh::Mesh`].
pub enum Cells<'a> {
    /// 10-node tetrahedra.
    Tets(&'a [[u32; 10]]),
    /// 6-node triangles.
    Triangles(&'a [[u32; 6]]),
}

/// Values of a named array.
pub enum Values<'a> {
    /// Three components each.
    Vectors(&'a [[f64; 3]]),
    /// One each.
    Scalars(&'a [f64]),
    /// One small integer each.
    Integers(&'a [i32]),
}

/// A named array.
pub type Array<'a> = (&'a str, Values<'a>);

/// A grid with data at points and cells.
pub struct Grid<'a> {
    /// Coordinates.
    pub points: &'a [[f64; 3]],
    /// Cells on them.
    pub cells: Cells<'a>,
    /// Arrays with one value a point.
    pub point_data: Vec<Array<'a>>,
    /// Arrays with one value a cell.
    pub cell_data: Vec<Array<'a>>,
}

/// VTK's numbers of the cell types.
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_TETRA: u8 = 24;

impl Cells<'_> {
    fn shape(&self) -> (usize, usize, u8) {
        match self {
            Cells::Tets(cells) => (cells.len(), 10, QUADRATIC_TETRA),
            Cells::Triangles(cells) => (cells.len(), 6, QUADRATIC_TRIANGLE),
        }
    }

    fn connectivity(&self) -> &[u32] {
        match self {
            Cells::Tets(cells) => cells.as_flattened(),
            Cells::Triangles(cells) => cells.as_flattened(),
        }
    }
}

impl Grid<'_> {
    /// Writes the file.
    ///
    /// # Errors
    /// The writer's.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let (n_cells, width, kind) = self.cells.shape();
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        let attributes = r#"type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64""#;
        writeln!(out, "<VTKFile {attributes}>\n<UnstructuredGrid>")?;
        writeln!(out, r#"<Piece NumberOfPoints="{}" NumberOfCells="{n_cells}">"#, self.points.len())?;
        writeln!(out, "<Points>")?;
        array(out, "Points", &Values::Vectors(self.points))?;
        writeln!(out, "</Points>\n<Cells>")?;
        let connectivity = self.cells.connectivity().iter().flat_map(|n| n.to_le_bytes());
        raw(out, "connectivity", "UInt32", 1, connectivity.collect())?;
        let offsets = (1..=n_cells).flat_map(|e| ((e * width) as u32).to_le_bytes());
        raw(out, "offsets", "UInt32", 1, offsets.collect())?;
        raw(out, "types", "UInt8", 1, vec![kind; n_cells])?;
        writeln!(out, "</Cells>\n<PointData>")?;
        self.point_data.iter().try_for_each(|(name, values)| array(out, name, values))?;
        writeln!(out, "</PointData>\n<CellData>")?;
        self.cell_data.iter().try_for_each(|(name, values)| array(out, name, values))?;
        writeln!(out, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }
}

fn array(out: &mut impl Write, name: &str, values: &Values) -> io::Result<()> {
    let single = |values: &[f64]| values.iter().flat_map(|&v| (v as f32).to_le_bytes()).collect();
    match values {
        Values::Vectors(v) => raw(out, name, "Float32", 3, single(v.as_flattened())),
        Values::Scalars(v) => raw(out, name, "Float32", 1, single(v)),
        Values::Integers(v) => raw(out, name, "Int32", 1, v.iter().flat_map(|i| i.to_le_bytes()).collect()),
    }
}

fn raw(out: &mut impl Write, name: &str, kind: &str, components: usize, bytes: Vec<u8>) -> io::Result<()> {
    let name = name.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;");
    let mut data = (bytes.len() as u64).to_le_bytes().to_vec();
    data.extend(bytes);
    write!(out, r#"<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="binary">"#)?;
    out.write_all(STANDARD.encode(data).as_bytes())?;
    writeln!(out, "</DataArray>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_carry_their_byte_count_and_little_endian_values() {
        let mut out = Vec::new();
        array(&mut out, "a & b", &Values::Scalars(&[1.0, -2.5])).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains(r#"Name="a &amp; b""#), "{text}");
        let data = text.split_once('>').unwrap().1.split_once('<').unwrap().0;
        let bytes = STANDARD.decode(data).unwrap();
        assert_eq!(bytes[..8], 8_u64.to_le_bytes());
        assert_eq!(bytes[8..12], 1.0_f32.to_le_bytes());
        assert_eq!(bytes[12..], (-2.5_f32).to_le_bytes());
    }

    #[test]
    fn a_grid_names_its_counts_and_types() {
        let points = [[0.0; 3]; 10];
        let tets = [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]];
        let grid = Grid { points: &points, cells: Cells::Tets(&tets), point_data: vec![], cell_data: vec![] };
        let mut out = Vec::new();
        grid.write(&mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains(r#"<Piece NumberOfPoints="10" NumberOfCells="1">"#));
        assert!(text.ends_with("</VTKFile>\n"));
    }
}
