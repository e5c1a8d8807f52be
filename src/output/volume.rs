//! Fields on the elements as files: one alone, or a piece from each rank and a file that names them.

use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt;
use std::path::PathBuf;

use super::files::write_file;
use super::folder::Folder;
use super::vtu::{Array, Cells, Grid};
use crate::Result;
use crate::mesh::ElementList;
use crate::native::Comm;
use crate::structure::FullModel;

/// What this rank draws: the elements that it counts, and their nodes.
pub struct Volume {
    elements: Vec<usize>,
    nodes: Vec<u32>,
    points: Vec<[f64; 3]>,
    cells: ElementList,
}

impl Volume {
    /// The rank's share of a model. Not collective.
    pub fn new(full: &FullModel) -> Volume {
        let mesh = &full.mesh;
        let elements: Vec<usize> = full.own_elements().collect();
        let mut cells: ElementList = elements.iter().map(|&e| mesh.elements.get(e)).collect();
        let mut nodes: Vec<u32> = cells.all_nodes().0.to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        let mut place = vec![0; mesh.nodes.len()];
        nodes.iter().enumerate().for_each(|(i, &n)| place[n as usize] = i as u32);
        cells.renumber(|n| place[n as usize]);
        let points = nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
        Volume { elements, nodes, points, cells }
    }

    /// The nodes of this rank's mesh that are drawn.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Of values at all nodes of this rank's mesh those that are drawn.
    pub fn at_nodes<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.nodes.iter().map(|&n| values[n as usize]).collect()
    }

    /// A value for each element that is drawn.
    pub fn at_elements<T>(&self, value: impl FnMut(usize) -> T) -> Vec<T> {
        self.elements.iter().copied().map(value).collect()
    }

    /// Writes `name.vtu` on one rank, else `name.pvtu` with a piece from each. Collective; the root has the folder.
    ///
    /// # Errors
    /// The system's, with the file's path.
    pub fn write(
        &self,
        comm: &Comm,
        folder: Option<&Folder>,
        name: &str,
        point_data: Vec<Array>,
        cell_data: Vec<Array>,
    ) -> Result<()> {
        let grid = Grid { points: &self.points, cells: Cells::Elements(&self.cells), point_data, cell_data };
        if comm.size() == 1 {
            let file = format!("{name}.vtu");
            return folder.map_or(Ok(()), |folder| folder.write(&file, |mut out| grid.write(&mut out)));
        }
        let draft = folder.map_or_else(Vec::new, |folder| folder.draft().as_os_str().as_encoded_bytes().to_vec());
        let draft = PathBuf::from(OsString::from_vec(comm.broadcast(0, draft)));
        if draft.as_os_str().is_empty() {
            // The root has no folder: nothing is to be drawn.
            return Ok(());
        }
        let piece = |rank: usize| format!("pieces/{name}.{rank}.vtu");
        comm.agree(write_file(&draft.join(piece(comm.rank())), |mut out| grid.write(&mut out)))?;
        let pieces: Vec<String> = (0..comm.size()).map(piece).collect();
        let list = folder.map_or(Ok(()), |folder| {
            folder.write(&format!("{name}.pvtu"), |mut out| grid.write_list(&pieces, &mut out))
        });
        comm.agree(list)
    }
}
