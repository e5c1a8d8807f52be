//! VTU files (VTK XML unstructured grids) that ParaView, VisIt and pyvista open.
//!
//! Arrays are inline base64 with a 64-bit byte count each, numbers in little endian, values in single precision.
//! Format: VTK file formats, <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::element::{FacetShape, Shape};
use crate::mesh::{ElementList, Facet};

use super::overwrite::{FileKind, SIGNATURE, head_contains};
use super::text::escaped;

/// Cells; VTK's node orders are those of [`Shape`] and [`FacetShape`].
pub enum Cells<'a> {
    /// Solid elements.
    Elements(&'a ElementList),
    /// Facets.
    Facets(&'a [Facet]),
    /// 3-node triangles.
    Patches(&'a [[u32; 3]]),
    /// Points, lines and facets, by their number of nodes: 1, 2, or that of a [`FacetShape`].
    Lists(&'a [Vec<u32>]),
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

/// VTK's number of a cell type.
const fn solid_type(shape: Shape) -> u8 {
    match shape {
        Shape::Tetrahedron4 => 10,
        Shape::Hexahedron8 => 12,
        Shape::Wedge6 => 13,
        Shape::Tetrahedron10 => 24,
        Shape::Hexahedron20 => 25,
        Shape::Wedge15 => 26,
    }
}

/// VTK's number of a cell type.
const fn facet_type(shape: FacetShape) -> u8 {
    match shape {
        FacetShape::Triangle3 => 5,
        FacetShape::Quadrilateral4 => 9,
        FacetShape::Triangle6 => 22,
        FacetShape::Quadrilateral8 => 23,
    }
}

/// VTK's number of the type of a point, a line or a facet with so many nodes.
fn type_of(n_nodes: usize) -> u8 {
    match n_nodes {
        1 => 1,
        2 => 3,
        n => facet_type(FacetShape::of(n)),
    }
}

/// Cells as VTK has them: the type of each, all their nodes, and where each one's end.
#[derive(Default)]
struct CellArrays {
    types: Vec<u8>,
    nodes: Vec<u32>,
    ends: Vec<u32>,
}

impl CellArrays {
    fn new(cells: &Cells) -> CellArrays {
        let mut arrays = CellArrays::default();
        match cells {
            Cells::Elements(list) => {
                list.iter().for_each(|element| arrays.push(solid_type(element.shape()), element.nodes));
            }
            Cells::Facets(list) => {
                list.iter().for_each(|facet| arrays.push(facet_type(facet.shape()), facet.nodes()));
            }
            Cells::Patches(list) => {
                list.iter().for_each(|nodes| arrays.push(facet_type(FacetShape::Triangle3), nodes));
            }
            Cells::Lists(list) => list.iter().for_each(|nodes| arrays.push(type_of(nodes.len()), nodes)),
        }
        arrays
    }

    fn push(&mut self, cell_type: u8, nodes: &[u32]) {
        self.types.push(cell_type);
        self.nodes.extend_from_slice(nodes);
        self.ends.push(self.nodes.len() as u32);
    }
}

impl Grid<'_> {
    /// Writes the file.
    ///
    /// # Errors
    /// The writer's.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let cells = CellArrays::new(&self.cells);
        let n_cells = cells.types.len();
        writeln!(out, "<?xml version=\"1.0\"?>\n{SIGNATURE}")?;
        let attributes = r#"type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64""#;
        writeln!(out, "<VTKFile {attributes}>\n<UnstructuredGrid>")?;
        writeln!(out, r#"<Piece NumberOfPoints="{}" NumberOfCells="{n_cells}">"#, self.points.len())?;
        writeln!(out, "<Points>")?;
        array(out, "Points", &Values::Vectors(self.points))?;
        writeln!(out, "</Points>\n<Cells>")?;
        let bytes = |numbers: &[u32]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        raw(out, "connectivity", "UInt32", 1, bytes(&cells.nodes))?;
        raw(out, "offsets", "UInt32", 1, bytes(&cells.ends))?;
        raw(out, "types", "UInt8", 1, cells.types)?;
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
    use crate::element::ElementKind;

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
            cells: Cells::Facets(&[]),
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
        let mut elements = ElementList::default();
        elements.push(ElementKind::C3D10, 0, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
        elements.push(ElementKind::C3D8I, 0, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let arrays = CellArrays::new(&Cells::Elements(&elements));
        assert_eq!((arrays.types, arrays.ends), (vec![24, 12], vec![10, 18]));
        let lists = CellArrays::new(&Cells::Lists(&[vec![0], vec![0, 1], vec![0, 1, 2]]));
        assert_eq!((lists.types, lists.ends), (vec![1, 3, 5], vec![1, 3, 6]));
        let cells = Cells::Elements(&elements);
        let grid = Grid { points: &points, cells, point_data: vec![], cell_data: vec![] };
        let mut out = Vec::new();
        grid.write(&mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains(r#"<Piece NumberOfPoints="10" NumberOfCells="2">"#));
        assert!(text.ends_with("</VTKFile>\n"));
    }
}
