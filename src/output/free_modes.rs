//! Free modes of a part as text and tables.

use serde::Serialize;

use crate::Result;
use crate::results::{FreeMode, FreeModes, MeasuredComparison};
use crate::stability::Count;

use super::columns::write_csv;
use super::folder::Folder;
use super::text::{self, aligned, cost};

/// The modes in words, with the files of their folder.
pub fn summary(found: &FreeModes, place: &str) -> String {
    let ([from, to], n, part) = (found.band, found.n_dofs, &found.part);
    let mut text = format!("{}: free modes of {part}, {from}-{to} Hz, {n} dofs, undamped\n\n", found.title);
    text += &format!("{} rigid motions, below {:.1e} Hz\n", found.n_rigid, found.rigid_noise);
    let Count { below, expected, found: n_found, .. } = found.count;
    text += &match found.count.agrees() {
        true => format!("{n_found} modes below {below:.1} Hz with them, as many as the Sturm count: none is missing\n"),
        false => {
            format!("{n_found} modes below {below:.1} Hz with them, {expected} by the Sturm count: not confirmed\n")
        }
    };
    let row =
        |(number, mode): (usize, &FreeMode)| format!("  {number}\t{:.4}\t{:.1e}", mode.frequency, mode.backward_error);
    text += &format!("\n{}", aligned("  mode\tfrequency Hz\tbackward error", (1..).zip(&found.modes).map(row)));
    if let Some(measured) = &found.measured {
        text += &measured_text(measured, &found.frequencies());
    }
    text + &cost(found.seconds, found.n_ranks) + &files_text(found, place)
}

fn measured_text(measured: &MeasuredComparison, computed: &[f64]) -> String {
    let MeasuredComparison { frequencies, groups, grouped, distance, .. } = measured;
    let row = |(i, measured): (usize, &f64)| {
        let best = (0..groups.len()).max_by(|&a, &b| grouped[(i, a)].total_cmp(&grouped[(i, b)]))?;
        let hertz = computed[groups[best][0]];
        let together = if groups[best].len() > 1 { "modes of one frequency together" } else { "" };
        let (off, mac) = (100.0 * (hertz / measured - 1.0), grouped[(i, best)]);
        Some(format!("  {measured:.2}\t{hertz:.2}\t{off:+.2}\t{mac:.3}\t{together}"))
    };
    let rows = frequencies.iter().enumerate().filter_map(row);
    let table = aligned("  measured Hz\tcomputed Hz\tdifference %\tMAC\t", rows);
    format!("\nmeasured points are up to {distance:.3} (unit of the mesh) from their nodes\n{table}")
}

fn files_text(found: &FreeModes, place: &str) -> String {
    let shapes = if found.n_ranks == 1 { "mode_*.vtu" } else { "mode_*.pvtu" };
    let mut files = vec![("summary.txt", "this text"), ("modes.csv", "frequencies"), (shapes, "shapes, for ParaView")];
    files.extend(found.measured.is_some().then_some(("mac.csv", "every measured mode against every computed one")));
    text::files(place, &files)
}

/// Writes the folder's files beside the shapes. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(found: &FreeModes, folder: Folder, summary: &str) -> Result<()> {
    folder.write("summary.txt", |out| out.write_all(summary.as_bytes()))?;
    folder.write("modes.csv", |out| write_csv(out, mode_rows(found)))?;
    if let Some(measured) = &found.measured {
        folder.write("mac.csv", |out| write_csv(out, mac_rows(measured, &found.frequencies())))?;
    }
    folder.finish()
}

/// A mode.
#[derive(Default, Serialize)]
struct FreeModeRow {
    mode: usize,
    #[serde(flatten)]
    data: FreeMode,
}

/// A measured mode and a computed one, the latter alone and with all modes of its frequency.
#[derive(Default, Serialize)]
struct MacRow {
    measured_hz: f64,
    mode: usize,
    computed_hz: f64,
    mac: f64,
    mac_with_modes_of_its_frequency: f64,
}

fn mode_rows(found: &FreeModes) -> impl Iterator<Item = FreeModeRow> {
    (1..).zip(&found.modes).map(|(mode, &data)| FreeModeRow { mode, data })
}

/// Every measured mode with every computed one.
fn mac_rows(measured: &MeasuredComparison, computed: &[f64]) -> Vec<MacRow> {
    let mut rows = Vec::new();
    for (i, &measured_hz) in measured.frequencies.iter().enumerate() {
        for (g, j) in measured.groups.iter().enumerate().flat_map(|(g, group)| group.iter().map(move |&j| (g, j))) {
            rows.push(MacRow {
                measured_hz,
                mode: j + 1,
                computed_hz: computed[j],
                mac: measured.single[(i, j)],
                mac_with_modes_of_its_frequency: measured.grouped[(i, g)],
            });
        }
    }
    rows
}

/// The modes as one JSON document.
#[derive(Serialize)]
pub struct FreeModesDocument {
    pub(super) part: String,
    pub(super) rigid_motions: usize,
    pub(super) frequencies_hz: Vec<f64>,
}

impl From<&FreeModes> for FreeModesDocument {
    fn from(found: &FreeModes) -> Self {
        FreeModesDocument {
            part: found.part.clone(),
            rigid_motions: found.n_rigid,
            frequencies_hz: found.frequencies(),
        }
    }
}
