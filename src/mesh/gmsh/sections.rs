//! The sections of a Gmsh 4.1 file, as they stand: tags are Gmsh's, nothing is related to anything yet.

use super::kinds::{self, GmshType};
use super::scan::Scan;
use crate::Result;
use std::collections::HashMap;

/// A named physical group.
pub struct Group {
    /// Its dimension.
    pub dimension: i32,
    /// Its tag, unique within the dimension.
    pub tag: i32,
    /// Its name.
    pub name: String,
}

/// Elements of one kind on one geometric entity.
pub struct ElementBlock {
    /// Dimension of the entity.
    pub dimension: i32,
    /// Tag of the entity.
    pub entity: i32,
    /// Kind of the elements.
    pub kind: &'static GmshType,
    /// Tags of the elements.
    pub elements: Vec<u64>,
    /// Tags of their nodes, in Gmsh's order, one element after another.
    pub nodes: Vec<u64>,
}

/// The content of a file.
#[derive(Default)]
pub struct Sections {
    /// The physical groups that have names.
    pub groups: Vec<Group>,
    /// Tags of the physical groups that an entity (dimension, tag) is in.
    pub entities: HashMap<(i32, i32), Vec<i32>>,
    /// Tags of the nodes.
    pub node_tags: Vec<u64>,
    /// Their coordinates, in the file's unit.
    pub coordinates: Vec<[f64; 3]>,
    /// The elements.
    pub blocks: Vec<ElementBlock>,
}

/// Reads all sections that matter.
///
/// # Errors
/// Input errors for another format, a truncated or partitioned file, and kinds of element that nobody knows.
pub fn sections(scan: &mut Scan) -> Result<Sections> {
    if scan.open_section()? != Some("MeshFormat") {
        return Err(scan.error("the file does not begin with $MeshFormat. Is this a Gmsh mesh?"));
    }
    let binary = format(scan)?;
    let mut sections = Sections::default();
    let mut seen = Vec::new();
    while let Some(name) = scan.open_section()? {
        scan.binary = binary;
        seen.push(name);
        match name {
            "PhysicalNames" => physical_names(scan, &mut sections.groups)?,
            "Entities" => entities(scan, &mut sections.entities)?,
            "Nodes" => nodes(scan, &mut sections)?,
            "Elements" => elements(scan, &mut sections.blocks)?,
            "PartitionedEntities" => {
                let advice = "Save the mesh unpartitioned: the program partitions it itself";
                return Err(scan.error(format_args!("the mesh is partitioned. {advice}")));
            }
            _ => scan.skip_section()?,
        }
        scan.binary = false;
    }
    match ["Nodes", "Elements"].into_iter().find(|needed| !seen.contains(needed)) {
        None => Ok(sections),
        Some(name) => {
            Err(scan.error(format_args!("the file has no ${name}. It is truncated, or was saved before meshing")))
        }
    }
}

/// Checks the version; whether the file is binary.
fn format(scan: &mut Scan) -> Result<bool> {
    let line = scan.line()?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let [version, binary, size] = words[..] else {
        return Err(scan.error(format_args!("$MeshFormat is {line:?}. Save the mesh as version 4.1")));
    };
    if version != "4.1" {
        let advice = "Save it as 4.1 (Mesh.MshFileVersion = 4.1, or gmsh -format msh41)";
        return Err(scan.error(format_args!("the mesh has Gmsh's format {version}, not 4.1. {advice}")));
    }
    let binary = binary == "1";
    if binary && size != "8" {
        let what = format_args!("size_t has {size} bytes, not 8. Save the mesh on a 64-bit machine, or as text");
        return Err(scan.error(what));
    }
    scan.binary = binary;
    if binary && scan.int()? != 1 {
        return Err(scan.error("the file is big-endian. Save it as text, or on a little-endian machine"));
    }
    scan.close_section()?;
    scan.binary = false;
    Ok(binary)
}

/// `dimension tag "name"`, as text in binary files too.
fn physical_names(scan: &mut Scan, groups: &mut Vec<Group>) -> Result<()> {
    scan.binary = false;
    for _ in 0..scan.count()? {
        let (dimension, tag) = (scan.int()?, scan.int()?);
        let line = scan.line()?.trim();
        let name = line.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        let Some(name) = name else {
            return Err(scan.error(format_args!("expected a name in quotes, found {line:?}. Write the mesh again")));
        };
        groups.push(Group { dimension, tag, name: name.to_owned() });
    }
    scan.close_section()
}

/// Keeps of each entity the groups it is in; the sign of a tag is an orientation.
fn entities(scan: &mut Scan, entities: &mut HashMap<(i32, i32), Vec<i32>>) -> Result<()> {
    let counts = [scan.count()?, scan.count()?, scan.count()?, scan.count()?];
    for (dimension, &count) in counts.iter().enumerate() {
        for _ in 0..count {
            let tag = scan.int()?;
            // A point has coordinates, all others a bounding box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                scan.double()?;
            }
            let groups = ints(scan)?.into_iter().map(i32::saturating_abs).collect();
            if dimension > 0 {
                ints(scan)?;
            }
            entities.insert((dimension as i32, tag), groups);
        }
    }
    scan.close_section()
}

/// A count and as many tags.
fn ints(scan: &mut Scan) -> Result<Vec<i32>> {
    let count = scan.count()?;
    (0..count).map(|_| scan.int()).collect()
}

/// Blocks of tags and then coordinates, with parameters of the entity where it says so.
fn nodes(scan: &mut Scan, sections: &mut Sections) -> Result<()> {
    let (n_blocks, n_nodes) = block_header(scan)?;
    for _ in 0..n_blocks {
        let dimension = scan.int()?;
        scan.int()?;
        let n_parameters = if scan.int()? == 0 { 0 } else { dimension };
        let count = scan.count()?;
        for _ in 0..count {
            sections.node_tags.push(scan.size()?);
        }
        for _ in 0..count {
            let x = [scan.double()?, scan.double()?, scan.double()?];
            for _ in 0..n_parameters {
                scan.double()?;
            }
            if !x.iter().all(|x| x.is_finite()) {
                return Err(scan.error(format_args!("a node lies at {x:?}. Mesh again")));
            }
            sections.coordinates.push(x);
        }
    }
    if sections.node_tags.len() != n_nodes {
        let found = sections.node_tags.len();
        return Err(scan.error(format_args!("$Nodes announces {n_nodes} nodes and has {found}. Write the mesh again")));
    }
    scan.close_section()
}

fn elements(scan: &mut Scan, blocks: &mut Vec<ElementBlock>) -> Result<()> {
    let (n_blocks, _) = block_header(scan)?;
    for _ in 0..n_blocks {
        let (dimension, entity, number) = (scan.int()?, scan.int()?, scan.int()?);
        let Some(kind) = kinds::by_number(number) else {
            let advice = "Mesh with tetrahedra, hexahedra or wedges of first or second order";
            return Err(scan.error(format_args!("unknown Gmsh element type {number}. {advice}")));
        };
        let count = scan.count()?;
        let mut block = ElementBlock { dimension, entity, kind, elements: Vec::new(), nodes: Vec::new() };
        for _ in 0..count {
            block.elements.push(scan.size()?);
            for _ in 0..kind.n_nodes {
                block.nodes.push(scan.size()?);
            }
        }
        blocks.push(block);
    }
    scan.close_section()
}

/// Number of blocks, of things in them, and their least and greatest tag, which are not used.
fn block_header(scan: &mut Scan) -> Result<(usize, usize)> {
    let counts = (scan.count()?, scan.count()?);
    scan.size()?;
    scan.size()?;
    Ok(counts)
}
