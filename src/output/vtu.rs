//! VTU files (VTK XML unstructured grids) that ParaView, VisIt and pyvista open.
//!
//! Arrays are inline base64 with a 64-bit byte count each, numbers in little endian, values in single precision.
//! Format: VTK file formats, <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::overwrite::{FileKind, SIGNATURE, head_contains};

/// Cells of one kind; VTK's node orders are those of [`crate::mesh::Mesh`].
pub enum Cells<'a> {
    /// 10-node tetrahedra.
    Tets(&'a [[u32; 10]]),
    /// 6-node triangles.
    Triangles(&'a [[u32; 6]]),
    /// 3-node triangles.
    Patches(&'a [[u32; 3]]),
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

/// A file that [`Grid::write`] has written.
pub const KIND: FileKind = FileKind { name: "a VTU file of squeal", is_one: |path| head_contains(path, SIGNATURE) };

/// VTK's numbers of the cell types.
const TRIANGLE: u8 = 5;
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_TETRA: u8 = 24;

impl Cells<'_> {
    fn shape(&self) -> (usize, usize, u8) {
        match self {
            Cells::Tets(cells) => (cells.len(), 10, QUADRATIC_TETRA),
            Cells::Triangles(cells) => (cells.len(), 6, QUADRATIC_TRIANGLE),
            Cells::Patches(cells) => (cells.len(), 3, TRIANGLE),
        }
    }

    fn connectivity(&self) -> &[u32] {
        match self {
            Cells::Tets(cells) => cells.as_flattened(),
            Cells::Triangles(cells) => cells.as_flattened(),
            Cells::Patches(cells) => cells.as_flattened(),
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
        writeln!(out, "<?xml version=\"1.0\"?>\n{SIGNATURE}")?;
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

impl Grid<'_> {
    /// Writes the file (`.pvtu`) that names the pieces of a grid that several ranks have written, each with arrays like
    /// this grid's.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_list(&self, pieces: &[String], out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "<?xml version=\"1.0\"?>\n{SIGNATURE}")?;
        let attributes = r#"type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64""#;
        writeln!(out, "<VTKFile {attributes}>\n<PUnstructuredGrid GhostLevel=\"0\">")?;
        let mut list = |group: &str, arrays: &[Array]| {
            writeln!(out, "<P{group}>")?;
            for (name, values) in arrays {
                let (kind, components) = values.shape();
                let name = escaped(name);
                writeln!(out, r#"<PDataArray type="{kind}" Name="{name}" NumberOfComponents="{components}"/>"#)?;
            }
            writeln!(out, "</P{group}>")
        };
        list("Points", &[("Points", Values::Vectors(&[]))])?;
        list("PointData", &self.point_data)?;
        list("CellData", &self.cell_data)?;
        pieces.iter().try_for_each(|piece| writeln!(out, r#"<Piece Source="{}"/>"#, escaped(piece)))?;
        writeln!(out, "</PUnstructuredGrid>\n</VTKFile>")
    }
}

impl Values<'_> {
    /// VTK's name of the type, and the number of components.
    fn shape(&self) -> (&'static str, usize) {
        match self {
            Values::Vectors(_) => ("Float32", 3),
            Values::Scalars(_) => ("Float32", 1),
            Values::Integers(_) => ("Int32", 1),
        }
    }
}

fn array(out: &mut impl Write, name: &str, values: &Values) -> io::Result<()> {
    let single = |values: &[f64]| values.iter().flat_map(|&v| (v as f32).to_le_bytes()).collect();
    let (kind, components) = values.shape();
    let bytes = match values {
        Values::Vectors(v) => single(v.as_flattened()),
        Values::Scalars(v) => single(v),
        Values::Integers(v) => v.iter().flat_map(|i| i.to_le_bytes()).collect(),
    };
    raw(out, name, kind, components, bytes)
}

/// A name inside an attribute.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;")
}

fn raw(out: &mut impl Write, name: &str, kind: &str, components: usize, bytes: Vec<u8>) -> io::Result<()> {
    let name = escaped(name);
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
    fn a_list_of_pieces_names_files_and_arrays() {
        let grid = Grid {
            points: &[],
            cells: Cells::Tets(&[]),
            point_data: vec![("u", Values::Vectors(&[]))],
            cell_data: vec![("part", Values::Integers(&[]))],
        };
        let mut out = Vec::new();
        grid.write_list(&["pieces/u.0.vtu".into(), "pieces/u.1.vtu".into()], &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let xml = roxmltree::Document::parse(&text).unwrap();
        let all = |tag: &str, attribute: &str| -> Vec<String> {
            let tags = xml.descendants().filter(|node| node.has_tag_name(tag));
            tags.map(|node| node.attribute(attribute).unwrap().to_owned()).collect()
        };
        assert_eq!(all("Piece", "Source"), ["pieces/u.0.vtu", "pieces/u.1.vtu"]);
        assert_eq!(all("PDataArray", "Name"), ["Points", "u", "part"]);
        assert_eq!(all("PDataArray", "type"), ["Float32", "Float32", "Int32"]);
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
