//! Modes in motion for ParaView: a collection (`.pvd`) of the moments of a cycle for each instability.
//!
//! Each moment is the outer surface, moved; its field `displacement` is the shape at that moment, the largest of the
//! surface 1. The time of a moment is its part of the cycle.

use std::f64::consts::TAU;
use std::io::Write;

use super::findings::{Findings, Place};
use crate::algebra::{norm, sub};
use crate::output::overwrite::{FileKind, SIGNATURE, head_contains};
use crate::output::vtu::{Cells, Grid, Values};
use crate::results::{Results, Shape};

/// Moments of a cycle.
pub const MOMENTS: usize = 24;
/// The largest displacement drawn, of the model's size.
const AMPLITUDE: f64 = 0.04;

/// A file that [`Cycle::write_collection`] has written.
pub const KIND: FileKind =
    FileKind { name: "a ParaView collection of squeal", is_one: |path| head_contains(path, SIGNATURE) };

/// A mode to be written.
pub struct Cycle<'a> {
    results: &'a Results,
    shape: &'a Shape,
    /// Name of its files, without an extension.
    pub name: String,
    /// m of drawing for a displacement of 1.
    scale: f64,
}

/// The strongest mode of each instability, as far as its shape is known.
pub fn cycles<'a>(findings: &Findings<'a>) -> Vec<Cycle<'a>> {
    let results = findings.results;
    let nodes = &results.surface.nodes;
    let far = |to: [f64; 3]| nodes.iter().map(|x| norm(sub(*x, to))).fold(0.0, f64::max);
    let scale = AMPLITUDE * nodes.first().map_or(0.0, |&first| far(first));
    let cycle = |place: Place| {
        let mode = findings.mode(place);
        let name = format!("mode_mu{:.3}_{:.0}Hz", findings.friction(place), mode.frequency());
        mode.shape.as_ref().map(|shape| Cycle { results, shape, name, scale })
    };
    findings.instabilities.iter().filter_map(|one| cycle(one.worst)).collect()
}

impl Cycle<'_> {
    /// Name of the file of a moment.
    pub fn file(&self, moment: usize) -> String {
        format!("{}/{moment:02}.vtu", self.name)
    }

    /// Writes the collection's file.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_collection(&self, out: &mut dyn Write) -> std::io::Result<()> {
        writeln!(
            out,
            "<?xml version=\"1.0\"?>\n{SIGNATURE}\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>"
        )?;
        for moment in 0..MOMENTS {
            let (time, file) = (moment as f64 / MOMENTS as f64, self.file(moment));
            writeln!(out, "<DataSet timestep=\"{time:.6}\" file=\"{file}\"/>")?;
        }
        writeln!(out, "</Collection>\n</VTKFile>")
    }

    /// Writes a moment: `Re (shape exp(i phase))`.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_moment(&self, moment: usize, mut out: &mut dyn Write) -> std::io::Result<()> {
        let (sine, cosine) = (TAU * moment as f64 / MOMENTS as f64).sin_cos();
        let at = |re: &[f32; 3], im: &[f32; 3]| [0, 1, 2].map(|i| f64::from(re[i]) * cosine - f64::from(im[i]) * sine);
        let u: Vec<[f64; 3]> = self.shape.re.iter().zip(&self.shape.im).map(|(re, im)| at(re, im)).collect();
        let surface = &self.results.surface;
        let moved = |(x, u): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|i| x[i] + self.scale * u[i]);
        let points: Vec<[f64; 3]> = surface.nodes.iter().zip(&u).map(moved).collect();
        let grid = Grid {
            points: &points,
            cells: Cells::Patches(&surface.triangles),
            point_data: vec![("displacement", Values::Vectors(&u))],
            cell_data: vec![("part", Values::Integers(&surface.part))],
        };
        grid.write(&mut out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::testing;

    #[test]
    fn a_collection_names_the_moments_of_one_cycle() {
        let results = testing::results();
        let cycles = cycles(&Findings::new(&results));
        let names: Vec<&str> = cycles.iter().map(|cycle| cycle.name.as_str()).collect();
        assert_eq!(names, ["mode_mu0.800_2400Hz", "mode_mu0.400_3700Hz"]);
        let mut out = Vec::new();
        cycles[0].write_collection(&mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let xml = roxmltree::Document::parse(&text).unwrap();
        let sets: Vec<_> = xml.descendants().filter(|node| node.has_tag_name("DataSet")).collect();
        assert_eq!(sets.len(), MOMENTS);
        assert_eq!(sets[6].attribute("timestep"), Some("0.250000"));
        assert_eq!(sets[6].attribute("file"), Some("mode_mu0.800_2400Hz/06.vtu"));
    }

    #[test]
    fn half_a_cycle_later_all_is_reversed() {
        let results = testing::results();
        let cycles = cycles(&Findings::new(&results));
        let displacement = |moment: usize| {
            let mut out = Vec::new();
            cycles[0].write_moment(moment, &mut out).unwrap();
            let text = String::from_utf8(out).unwrap();
            let after = text.split_once(r#"Name="displacement""#).unwrap().1.split_once('>').unwrap().1.to_owned();
            use base64::Engine;
            let data = after.split_once('<').unwrap().0;
            let bytes = base64::engine::general_purpose::STANDARD.decode(data).unwrap();
            bytes[8..].as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect::<Vec<f32>>()
        };
        let (start, half) = (displacement(0), displacement(MOMENTS / 2));
        assert!(start.iter().zip(&half).all(|(a, b)| (a + b).abs() < 1e-6));
        let shape = results.values[8].modes.iter().find_map(|mode| mode.shape.as_ref()).unwrap();
        assert!(start.iter().zip(shape.re.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}
