//! Free modes of a part as text and tables.

use std::io;

use serde::Serialize;

use crate::Result;
use crate::results::{FreeModes, MeasuredComparison};
use crate::stability::Count;

use super::folder::Folder;
use super::tables::csv_file;

/// The modes in words, with the files of their folder.
pub fn summary(found: &FreeModes, place: &str) -> String {
    let ([from, to], n, part) = (found.band, found.n_dofs, &found.part);
    let mut text = format!("{}: free modes of {part}, {from}-{to} Hz, {n} dofs, undamped\n\n", found.title);
    text += &format!("{} rigid motions, below {:.1e} Hz\n", found.n_rigid, found.rigid_noise);
    let Count { below, expected, found: n_found } = found.count;
    text += &match found.count.agrees() {
        true => format!("{n_found} modes below {below:.1} Hz with them, as many as the Sturm count: none is missing\n"),
        false => {
            format!("{n_found} modes below {below:.1} Hz with them, {expected} by the Sturm count: not confirmed\n")
        }
    };
    text += "\n  mode   frequency Hz  backward error\n";
    for (number, mode) in (1..).zip(&found.modes) {
        text += &format!("  {number:>4}  {:>13.4}  {:>14.1e}\n", mode.frequency, mode.backward_error);
    }
    if let Some(measured) = &found.measured {
        text += &measured_text(measured, &found.frequencies());
    }
    let plural = if found.n_ranks == 1 { "" } else { "s" };
    text + &format!("\n{:.1} s on {} rank{plural}\n", found.seconds, found.n_ranks) + &files_text(found, place)
}

fn measured_text(measured: &MeasuredComparison, computed: &[f64]) -> String {
    let MeasuredComparison { frequencies, groups, grouped, distance, .. } = measured;
    let mut text = format!("\nmeasured points are up to {distance:.3} (unit of the mesh) from their nodes\n");
    text += "  measured Hz   computed Hz  difference %   MAC\n";
    for (i, measured) in frequencies.iter().enumerate() {
        let best = (0..groups.len()).max_by(|&a, &b| grouped[(i, a)].total_cmp(&grouped[(i, b)]));
        let Some(best) = best else { continue };
        let hertz = computed[groups[best].start];
        let together = if groups[best].len() > 1 { "  modes of one frequency together" } else { "" };
        let (off, mac) = (100.0 * (hertz / measured - 1.0), grouped[(i, best)]);
        text += &format!("  {measured:>11.2}   {hertz:>11.2}  {off:>+12.2}  {mac:>5.3}{together}\n");
    }
    text
}

fn files_text(found: &FreeModes, place: &str) -> String {
    let shapes = if found.n_ranks == 1 { "mode_*.vtu" } else { "mode_*.pvtu" };
    let mut files = vec![("summary.txt", "this text"), ("modes.csv", "frequencies"), (shapes, "shapes, for ParaView")];
    files.extend(found.measured.is_some().then_some(("mac.csv", "every measured mode against every computed one")));
    let lines: String = files.iter().map(|(name, what)| format!("  {name:36}{what}\n")).collect();
    format!("\nresults in {place}:\n{lines}")
}

/// Writes the folder's files beside the shapes. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(found: &FreeModes, folder: Folder, summary: &str) -> Result<()> {
    folder.write("summary.txt", |out| out.write_all(summary.as_bytes()))?;
    csv_file(&folder, "modes.csv", |out| modes_table(out, found))?;
    if let Some(measured) = &found.measured {
        csv_file(&folder, "mac.csv", |out| mac_table(out, measured, &found.frequencies()))?;
    }
    folder.finish()
}

fn modes_table(out: &mut dyn io::Write, found: &FreeModes) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["mode", "frequency_hz", "backward_error"])?;
    for (number, mode) in (1..).zip(&found.modes) {
        let error = format!("{:.2e}", mode.backward_error);
        table.write_record([format!("{number}"), format!("{:.15e}", mode.frequency), error])?;
    }
    Ok(table.flush()?)
}

/// Every measured mode against every computed one, alone and with those of its frequency.
fn mac_table(out: &mut dyn io::Write, measured: &MeasuredComparison, computed: &[f64]) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["measured_hz", "mode", "computed_hz", "mac", "mac_with_modes_of_its_frequency"])?;
    for (i, frequency) in measured.frequencies.iter().enumerate() {
        for (g, j) in measured.groups.iter().enumerate().flat_map(|(g, group)| group.clone().map(move |j| (g, j))) {
            table.write_record([
                frequency.to_string(),
                (j + 1).to_string(),
                format!("{:.9e}", computed[j]),
                format!("{:.6}", measured.single[(i, j)]),
                format!("{:.6}", measured.grouped[(i, g)]),
            ])?;
        }
    }
    Ok(table.flush()?)
}

/// The modes as one JSON document.
#[derive(Serialize)]
pub struct FreeModesDocument {
    part: String,
    rigid_motions: usize,
    frequencies_hz: Vec<f64>,
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
