//! What a model is, before anything is computed: `squeal check` as text and JSON.

use serde::Serialize;

pub use super::contact_rows::{LayoutRow, PairRow, RotationRow};

use super::text::{aligned, joined, mass, paragraph};
use crate::deck::DeckSummary;
use crate::model::ROUGH;

/// A model, read and checked.
#[derive(Serialize)]
pub struct ModelSummary {
    /// Title of the model.
    pub title: String,
    /// What was understood of the deck, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deck: Option<DeckSummary>,
    /// The mesh as a whole.
    pub mesh: MeshSummary,
    /// One row a part.
    pub parts: Vec<PartRow>,
    /// One row a rotation.
    pub rotations: Vec<RotationRow>,
    /// One row a contact pair.
    pub pairs: Vec<PairRow>,
    /// The reference nodes of the sliding pairs, where contacts are reduced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layouts: Option<Vec<LayoutRow>>,
    /// Constrained dofs.
    pub constrained_dofs: usize,
    /// Connectors.
    pub connectors: usize,
    /// Loss factors of connectors.
    pub connector_loss_factors: Vec<LossRow>,
    /// One row a tie.
    pub ties: Vec<TieRow>,
    /// One row a rigid set.
    pub rigid_sets: Vec<RigidRow>,
    /// One row a point mass.
    pub masses: Vec<MassRow>,
    /// Equations.
    pub equations: usize,
    /// Mass of all parts and point masses.
    pub mass_kg: f64,
    /// One row a load.
    pub loads: Vec<LoadRow>,
    /// Sum of all loads.
    pub sum_of_loads_n: [f64; 3],
    /// Doubtful properties of the model.
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
    /// Mass-proportional damping.
    pub alpha_per_s: f64,
    /// Stiffness-proportional damping.
    pub beta_s: f64,
    /// Loss factor of its material.
    pub loss_factor: f64,
    /// Of a viscoelastic material.
    pub viscoelastic: Option<ViscoelasticRow>,
}

/// A viscoelastic material.
#[derive(Serialize)]
pub struct ViscoelasticRow {
    /// Young's modulus at rest.
    pub young_at_rest_pa: f64,
    /// That at the end of the band.
    pub young_at_band_end_pa: f64,
    /// The loss factor there.
    pub loss_factor_at_band_end: f64,
}

/// A connector with a loss factor.
#[derive(Serialize)]
pub struct LossRow {
    /// Its name.
    pub connector: String,
    /// Its loss factor.
    pub loss_factor: f64,
}

/// A tie.
#[derive(Serialize)]
pub struct TieRow {
    /// Its name.
    pub tie: String,
    /// Nodes of the slave that are tied.
    pub nodes: usize,
    /// Nodes of the slave that are not.
    pub dropped: usize,
    /// Area that is tied.
    pub area_m2: f64,
    /// Largest distance of a tied node from the master.
    pub distance_m: f64,
    /// Penalty.
    pub stiffness_n_per_m3: f64,
}

/// A rigid set.
#[derive(Serialize)]
pub struct RigidRow {
    /// Its name.
    pub rigid: String,
    /// Its nodes.
    pub nodes: usize,
}

/// A point mass.
#[derive(Serialize)]
pub struct MassRow {
    /// Its name.
    pub mass: String,
    /// The node set or surface that it moves with.
    pub on: String,
    /// Mass.
    pub mass_kg: f64,
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
    pub free_dofs: usize,
    /// Entries of the stiffness matrix.
    pub entries: f64,
    /// Memory of the LU factor, by MUMPS's analysis.
    pub factor_gb: f64,
}

impl ModelSummary {
    /// All but the matrices, for people.
    pub fn text(&self) -> String {
        let deck = self.deck.as_ref().map_or_else(String::new, |deck| deck.text() + "\n");
        let MeshSummary { nodes, elements, size_m } = self.mesh;
        let size = joined(size_m, 1e3, 1, " x ");
        let layouts: String = self.layouts.iter().flatten().map(LayoutRow::text).collect();
        let load = |load: &LoadRow| format!("load {:?} on {}: {}\n", load.load, load.on, load.what);
        let loads: String = self.loads.iter().map(load).collect();
        format!(
            "{}\n\n{deck}mesh: {nodes} nodes, {elements} elements, {size} mm\n{}{}{}{}\n{} constrained dofs, {} connectors\n\
             {}{loads}sum of the loads: {} N\n\n",
            self.title,
            self.parts_text(),
            paragraph(&self.rotations.iter().map(RotationRow::text).collect::<String>()),
            paragraph(&self.pairs_text()),
            paragraph(&layouts),
            self.constrained_dofs,
            self.connectors,
            self.joints_text(),
            joined(self.sum_of_loads_n, 1.0, 3, " ")
        )
    }

    /// Connectors with loss factors, ties, rigid sets, equations and masses, a line each; nothing where there is none.
    fn joints_text(&self) -> String {
        let loss = |row: &LossRow| format!("connector {:?}: loss factor {}\n", row.connector, row.loss_factor);
        let losses = self.connector_loss_factors.iter().map(loss);
        let ties = self.ties.iter().map(TieRow::text);
        let rigid = self.rigid_sets.iter().map(|row| format!("rigid {:?}: {} nodes\n", row.rigid, row.nodes));
        let equations = (self.equations > 0).then(|| format!("{} equations\n", self.equations));
        let masses =
            self.masses.iter().map(|row| format!("mass {:?} on {}: {:.4} kg\n", row.mass, row.on, row.mass_kg));
        let total =
            (!self.masses.is_empty()).then(|| format!("mass of parts and point masses: {:.4} kg\n", self.mass_kg));
        losses.chain(ties).chain(rigid).chain(equations).chain(masses).chain(total).collect()
    }

    fn parts_text(&self) -> String {
        let row = |row: &PartRow| {
            let PartRow { part, elements, mass_kg, quality_min, quality_median, .. } = row;
            let of_mass = |text: String| if *mass_kg > 0.0 { text } else { "none".to_owned() };
            let centre = of_mass(joined(row.centre_m, 1e3, 2, " "));
            let inertia = of_mass(joined(row.inertia_kg_m2, 1e6, 2, " "));
            format!(
                "{part}\t{elements}\t{}\t{centre}\t{inertia}\t{quality_min:.3} {quality_median:.3}\t{}",
                mass(*mass_kg),
                row.damping()
            )
        };
        let heading =
            "part\telements\tmass kg\tcentre mm\tinertia kg mm2 (xx yy zz)\tscaled Jacobian min / med\tdamping 1/s, s";
        aligned(heading, self.parts.iter().map(row))
    }

    fn pairs_text(&self) -> String {
        let row = |row: &PairRow| {
            let PairRow { pair, kind, points, dropped, touching, friction, .. } = row;
            let (area, low, high) = (1e6 * row.area_m2, 1e3 * row.gap_min_m + 0.0, 1e3 * row.gap_max_m + 0.0);
            let friction = if *friction == ROUGH { "rough".to_owned() } else { friction.to_string() };
            format!("{pair}\t{kind}\t{points}\t{dropped}\t{touching}\t{area:.2}\t{low:.2e} {high:.2e}\t{friction}")
        };
        let heading = "pair\tkind\tpoints\tdropped\ttouching\tarea mm2\tgap mm (min max; below 0: overlap)\tfriction";
        let notes: String = self.pairs.iter().map(PairRow::notes).collect();
        aligned(heading, self.pairs.iter().map(row)) + &notes
    }
}

impl PartRow {
    /// Rayleigh's coefficients, the loss factor and the viscoelastic law, those that there are.
    fn damping(&self) -> String {
        let rayleigh = match (self.alpha_per_s, self.beta_s) {
            (0.0, 0.0) => None,
            (alpha, beta) => Some(format!("{alpha} {beta:e}")),
        };
        let loss = (self.loss_factor != 0.0).then(|| format!("loss factor {}", self.loss_factor));
        let law = self.viscoelastic.as_ref().map(|law| {
            let ViscoelasticRow { young_at_rest_pa, young_at_band_end_pa, loss_factor_at_band_end } = law;
            let end =
                format!("{young_at_band_end_pa:.3e} Pa and loss factor {loss_factor_at_band_end:.2} at the band's end");
            format!("viscoelastic (E {young_at_rest_pa:.3e} Pa at rest, {end})")
        });
        let all: Vec<String> = rayleigh.into_iter().chain(loss).chain(law).collect();
        if all.is_empty() { "none".to_owned() } else { all.join(", ") }
    }
}

impl TieRow {
    fn text(&self) -> String {
        let TieRow { tie, nodes, dropped, stiffness_n_per_m3, .. } = self;
        let (area, distance) = (1e6 * self.area_m2, 1e3 * self.distance_m);
        format!(
            "tie {tie:?}: {nodes} nodes on {area:.2} mm2 tied, {dropped} not; up to {distance:.1e} mm apart; \
             {stiffness_n_per_m3:.2e} N/m3\n"
        )
    }
}

impl MatrixSummary {
    /// For people.
    pub fn text(&self) -> String {
        let MatrixSummary { free_dofs, entries, factor_gb } = self;
        let millions = 1e-6 * entries;
        format!(
            "{free_dofs} free dofs, {millions:.1} M entries in K; the LU factor will take about {factor_gb:.1} GB\n"
        )
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::model::Inertia;

    pub(in crate::output) fn summary() -> ModelSummary {
        let part = PartRow {
            part: "disc".into(),
            elements: 54,
            mass_kg: 0.0639,
            centre_m: [-1e-9, 0.015, 0.005],
            inertia_kg_m2: [1e-6; 3],
            quality_min: 0.5,
            quality_median: 0.75,
            alpha_per_s: 5.0,
            beta_s: 1e-7,
            loss_factor: 0.0,
            viscoelastic: Some(ViscoelasticRow {
                young_at_rest_pa: 2e6,
                young_at_band_end_pa: 8e7,
                loss_factor_at_band_end: 0.9,
            }),
        };
        let pair = PairRow {
            pair: "disc / pad".into(),
            kind: "sliding".into(),
            points: 16,
            dropped: 0,
            touching: 16,
            area_m2: 4e-4,
            adjusted: 3,
            adjusted_gap_max_m: 2e-5,
            sliding_speed_m_per_s: Some(0.5),
            radius_m: Some(0.1),
            gap_min_m: 0.0,
            gap_max_m: 1e-6,
            friction: 0.4,
            proposed_stiffness_n_per_m3: None,
            proposed_stick_n_per_m3: None,
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
        let tie = TieRow {
            tie: "shim / plate".into(),
            nodes: 81,
            dropped: 3,
            area_m2: 4e-4,
            distance_m: 2e-6,
            stiffness_n_per_m3: 2.1e17,
        };
        let load = LoadRow { load: "push".into(), on: "top".into(), what: "a pressure of 1 Pa".into() };
        ModelSummary {
            title: "blocks".into(),
            mesh: MeshSummary { nodes: 100, elements: 54, size_m: [0.03, 0.03, 0.01] },
            deck: None,
            parts: vec![part],
            rotations: vec![RotationRow {
                part: "disc".into(),
                axis: [0.0, 0.0, 1.0],
                through_m: [0.0; 3],
                speed_rad_per_s: 5.0,
                inertia: Inertia::None,
                speed_max_m_per_s: 0.6,
                splitting_hz: 1.59,
                splitting_of_band: 0.00027,
            }],
            pairs: vec![pair],
            layouts: Some(vec![layout]),
            constrained_dofs: 12,
            connectors: 0,
            connector_loss_factors: vec![LossRow { connector: "pin".into(), loss_factor: 0.1 }],
            ties: vec![tie],
            rigid_sets: vec![RigidRow { rigid: "mount".into(), nodes: 12 }],
            masses: vec![MassRow { mass: "sensor".into(), on: "ear".into(), mass_kg: 0.05 }],
            equations: 2,
            mass_kg: 0.1139,
            loads: vec![load],
            sum_of_loads_n: [0.0, 0.0, -1000.0],
            warnings: vec![],
            matrix: Some(MatrixSummary { free_dofs: 288, entries: 2e4, factor_gb: 0.1 }),
        }
    }

    #[test]
    fn units_are_those_of_the_headings_and_no_zero_is_negative() {
        insta::assert_snapshot!(summary().text());
    }

    #[test]
    fn a_part_without_mass_has_no_centre() {
        let mut summary = summary();
        (summary.parts[0].mass_kg, summary.parts[0].centre_m) = (0.0, [f64::NAN; 3]);
        assert!(summary.text().contains("0.0000  none") && !summary.text().contains("NaN"), "{}", summary.text());
    }
}
