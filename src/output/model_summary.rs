//! What a model is, before anything is computed: `squeal check` as text and JSON.

use std::fmt::Write;

use serde::Serialize;

/// A model, read and checked.
#[derive(Serialize)]
pub struct ModelSummary {
    /// Title of the model.
    pub title: String,
    /// The mesh as a whole.
    pub mesh: MeshSummary,
    /// One row a part.
    pub parts: Vec<PartRow>,
    /// One row a contact pair.
    pub pairs: Vec<PairRow>,
    /// The reference nodes of the sliding pairs, where contacts are reduced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layouts: Option<Vec<LayoutRow>>,
    /// Constrained dofs.
    pub held_displacements: usize,
    /// Connectors.
    pub connectors: usize,
    /// One row a load.
    pub loads: Vec<LoadRow>,
    /// Sum of all loads.
    pub sum_of_loads_n: [f64; 3],
    /// What in the model can hardly be meant.
    pub warnings: Vec<String>,
    /// The matrices, which take time to assemble.
    #[serde(flatten)]
    pub matrix: Option<MatrixSummary>,
}

/// Size of a mesh.
#[derive(Serialize)]
pub struct MeshSummary {
    /// Nodes.
    pub nodes: usize,
    /// Number of its elements.
    pub elements: usize,
    /// Edges of the box around it.
    pub size_m: [f64; 3],
}

/// A part.
#[derive(Serialize)]
pub struct PartRow {
    /// Its name.
    pub part: String,
    /// Number of its elements.
    pub elements: usize,
    /// Mass.
    pub mass_kg: f64,
    /// Centre of mass.
    pub centre_m: [f64; 3],
    /// Moments of inertia xx, yy, zz about the centre.
    pub inertia_kg_m2: [f64; 3],
    /// Least scaled Jacobian of its elements.
    pub quality_min: f64,
    /// Median of them.
    pub quality_median: f64,
}

/// A contact pair.
#[derive(Serialize)]
pub struct PairRow {
    /// Its name.
    pub pair: String,
    /// What acts in the tangent plane.
    pub kind: String,
    /// Contact points.
    pub points: usize,
    /// Slave nodes without a master facet opposite.
    pub dropped: usize,
    /// Points without a gap at the start.
    pub touching: usize,
    /// Area of the points.
    pub area_m2: f64,
    /// Smallest initial gap.
    pub gap_min_m: f64,
    /// Largest initial gap.
    pub gap_max_m: f64,
    /// Friction coefficient.
    pub friction: f64,
}

/// The reference nodes of a sliding pair, and how even their cells are.
#[derive(Serialize)]
pub struct LayoutRow {
    /// The pair's name.
    pub pair: String,
    /// Reference nodes.
    pub reference_nodes: usize,
    /// Smallest area of a cell.
    pub cell_area_min_m2: f64,
    /// Mean area of the cells.
    pub cell_area_mean_m2: f64,
    /// Largest area of a cell.
    pub cell_area_max_m2: f64,
    /// Fewest contact points in a cell.
    pub cell_points_min: usize,
    /// Most contact points in a cell.
    pub cell_points_max: usize,
}

/// A load.
#[derive(Serialize)]
pub struct LoadRow {
    /// Its name.
    pub load: String,
    /// The node set or surface it acts on.
    pub on: String,
    /// Its kind and amount in words.
    pub what: String,
}

/// The stiffness matrix and the memory of its factor.
#[derive(Serialize)]
pub struct MatrixSummary {
    /// Free dofs.
    pub equations: usize,
    /// Entries of the stiffness matrix.
    pub entries: f64,
    /// Memory of the LU factor, by MUMPS's analysis.
    pub factor_gb: f64,
}

impl ModelSummary {
    /// All but the matrices, for people.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n", self.title);
        // Writing to a string cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let MeshSummary { nodes, elements, size_m } = self.mesh;
        writeln!(out, "mesh: {nodes} nodes, {elements} elements, {} mm", joined(size_m, 1e3, 1, " x "))?;
        self.write_parts(out)?;
        self.write_pairs(out)?;
        if let Some(layouts) = &self.layouts {
            layouts.iter().try_for_each(|layout| layout.write(out))?;
            writeln!(out)?;
        }
        writeln!(out, "{} constrained dofs, {} connectors", self.held_displacements, self.connectors)?;
        self.loads.iter().try_for_each(|load| writeln!(out, "load {:?} on {}: {}", load.load, load.on, load.what))?;
        writeln!(out, "sum of the loads: {} N\n", joined(self.sum_of_loads_n, 1.0, 3, " "))
    }

    fn write_parts(&self, out: &mut String) -> std::fmt::Result {
        let width = width(self.parts.iter().map(|row| row.part.as_str()));
        writeln!(
            out,
            "{:width$}  {:>8}  {:>9}  {:>26}  {:>32}  {:>17}",
            "part", "elements", "mass kg", "centre mm", "inertia kg mm2 (xx yy zz)", "quality min / med"
        )?;
        for row in &self.parts {
            let (centre, moments) = (joined(row.centre_m, 1e3, 2, " "), joined(row.inertia_kg_m2, 1e6, 2, " "));
            let PartRow { part, elements, mass_kg, quality_min, quality_median, .. } = row;
            writeln!(
                out,
                "{part:width$}  {elements:>8}  {mass_kg:>9.4}  {centre:>26}  {moments:>32}  {quality_min:>8.3} {quality_median:>8.3}"
            )?;
        }
        writeln!(out)
    }

    fn write_pairs(&self, out: &mut String) -> std::fmt::Result {
        let width = width(self.pairs.iter().map(|row| row.pair.as_str()));
        writeln!(
            out,
            "{:width$}  {:>11}  {:>6}  {:>7}  {:>8}  {:>9}  {:>19}  {:>8}",
            "pair", "kind", "points", "dropped", "touching", "area mm2", "gap mm (min max)", "friction"
        )?;
        for row in &self.pairs {
            let PairRow { pair, kind, points, dropped, touching, friction, .. } = row;
            let gaps = format!("{:.2e} {:.2e}", 1e3 * row.gap_min_m, 1e3 * row.gap_max_m);
            let area = 1e6 * row.area_m2;
            writeln!(
                out,
                "{pair:width$}  {kind:>11}  {points:>6}  {dropped:>7}  {touching:>8}  {area:>9.2}  {gaps:>19}  {friction:>8}"
            )?;
        }
        writeln!(out)
    }
}

impl LayoutRow {
    fn write(&self, out: &mut String) -> std::fmt::Result {
        writeln!(
            out,
            "{}: {} reference nodes, cells of {:.1} to {:.1} mm2 (mean {:.1}) with {} to {} contact points",
            self.pair,
            self.reference_nodes,
            1e6 * self.cell_area_min_m2,
            1e6 * self.cell_area_max_m2,
            1e6 * self.cell_area_mean_m2,
            self.cell_points_min,
            self.cell_points_max
        )
    }
}

impl MatrixSummary {
    /// For people.
    pub fn text(&self) -> String {
        let MatrixSummary { equations, entries, factor_gb } = self;
        let millions = 1e-6 * entries;
        format!(
            "{equations} free dofs, {millions:.1} M entries in K; the LU factor will take about {factor_gb:.1} GB\n"
        )
    }
}

/// Width of a column of names.
fn width<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(str::len).max().unwrap_or(0).max(4)
}

/// Three numbers in another unit with so many decimals, where rounding leaves no `-0.00`.
fn joined(x: [f64; 3], unit: f64, decimals: usize, separator: &str) -> String {
    let scale = 10_f64.powi(decimals as i32);
    x.map(|x| format!("{:.decimals$}", ((unit * x * scale).round() + 0.0) / scale)).join(separator)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::output) fn summary() -> ModelSummary {
        let part = PartRow {
            part: "disc".into(),
            elements: 54,
            mass_kg: 0.0639,
            centre_m: [-1e-9, 0.015, 0.005],
            inertia_kg_m2: [1e-6; 3],
            quality_min: 0.5,
            quality_median: 0.75,
        };
        let pair = PairRow {
            pair: "disc / pad".into(),
            kind: "sliding".into(),
            points: 16,
            dropped: 0,
            touching: 16,
            area_m2: 4e-4,
            gap_min_m: 0.0,
            gap_max_m: 1e-6,
            friction: 0.4,
        };
        let layout = LayoutRow {
            pair: "disc / pad".into(),
            reference_nodes: 4,
            cell_area_min_m2: 9e-5,
            cell_area_mean_m2: 1e-4,
            cell_area_max_m2: 1.1e-4,
            cell_points_min: 3,
            cell_points_max: 5,
        };
        let load = LoadRow { load: "push".into(), on: "top".into(), what: "a pressure of 1 Pa".into() };
        ModelSummary {
            title: "blocks".into(),
            mesh: MeshSummary { nodes: 100, elements: 54, size_m: [0.03, 0.03, 0.01] },
            parts: vec![part],
            pairs: vec![pair],
            layouts: Some(vec![layout]),
            held_displacements: 12,
            connectors: 0,
            loads: vec![load],
            sum_of_loads_n: [0.0, 0.0, -1000.0],
            warnings: vec![],
            matrix: Some(MatrixSummary { equations: 288, entries: 2e4, factor_gb: 0.1 }),
        }
    }

    #[test]
    fn units_are_those_of_the_headings_and_no_zero_is_negative() {
        let text = summary().text();
        let expected = [
            "mesh: 100 nodes, 54 elements, 30.0 x 30.0 x 10.0 mm",
            "disc        54     0.0639             0.00 15.00 5.00                    1.00 1.00 1.00     0.500    0.750",
            "disc / pad      sliding      16        0        16     400.00       0.00e0 1.00e-3       0.4",
            "cells of 90.0 to 110.0 mm2 (mean 100.0) with 3 to 5 contact points",
            "sum of the loads: 0.000 0.000 -1000.000 N",
        ];
        expected.iter().for_each(|line| assert!(text.contains(line), "{line}\n{text}"));
    }
}
