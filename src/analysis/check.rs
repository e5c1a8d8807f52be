//! What a model is, before anything is computed.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::Result;
use crate::assembly::JointKind;
use crate::assembly::joints::tie::TieSummary;
use crate::contact::interface::ContactPair;
use crate::contact::law::Tangential;
use crate::element::facet;
use crate::equilibrium::tangent_precision;
use crate::mesh::quality::scaled_jacobian;
use crate::model::{
    Connector, Load, LoadKind, Material, PointMass, ProposedStiffness, Rayleigh, RigidSet, Rotation, Tie,
};
use crate::native::{Comm, Factor, FactorKind};
use crate::output::model_summary::{
    LayoutRow, LoadRow, LossRow, MassRow, MatrixSummary, MeshSummary, ModelSummary, PairRow, PartRow, RigidRow,
    RotationRow, TieRow, ViscoelasticRow,
};
use crate::structure::{FullModel, Ranked, plausibility};

/// What gravity without a name acts on.
const ON_EVERYTHING: &str = "all parts and masses";

/// Masses, contact pairs, mesh quality, constraints and loads of a model; with reference contacts their cells, too. The
/// matrix is left open. Collective.
pub fn model_summary(comm: &Comm, full: &FullModel, with_layouts: bool) -> ModelSummary {
    let parts: Vec<PartRow> = (0..full.mesh.parts.len()).map(|i| part(comm, full, i)).collect();
    let flat = parts.iter().filter_map(|row| plausibility::quality(&row.part, row.quality_min));
    let warnings = plausibility::warnings(full, comm).into_iter().chain(flat).collect();
    let masses = &full.model.masses;
    let mass_kg = parts.iter().map(|row| row.mass_kg).chain(masses.iter().map(|own| own.mass)).sum();
    let load = |load: &Load| LoadRow {
        load: load.name.clone(),
        on: if load.on.is_empty() { ON_EVERYTHING.to_owned() } else { load.on.clone() },
        what: amount(full, &parts, load),
    };
    let loads: Vec<LoadRow> = full.model.loads.iter().map(load).collect();
    let mut weight = full.weights.iter().fold([0.0; 3], |sum, (_, f)| [0, 1, 2].map(|i| sum[i] + f[i]));
    comm.sum_all(&mut weight);
    let proposed = full.model.proposed(&full.mesh);
    let sliding = || full.interface.pairs.iter().filter(|pair| pair.is_sliding());
    ModelSummary {
        title: full.model.title.clone(),
        deck: full.deck.clone(),
        mesh: MeshSummary {
            nodes: full.nodes.n_global(),
            elements: comm.sum(full.own_elements().count()),
            size_m: full.extents(comm),
        },
        parts,
        rotations: full.model.rotations.iter().map(|own| rotation(comm, full, own)).collect(),
        pairs: full.interface.pairs.iter().map(|own| pair(full, own, &proposed)).collect(),
        layouts: with_layouts.then(|| sliding().map(|pair| layout(full, pair)).collect()),
        constrained_dofs: full.held.as_flattened().iter().filter(|&&h| h).count(),
        connectors: full.joints.count(JointKind::Connector),
        connector_loss_factors: full.model.connectors.iter().filter_map(loss_factor).collect(),
        ties: full.model.ties.iter().zip(&full.joints.ties).map(|(own, summary)| tie(own, summary)).collect(),
        rigid_sets: full.model.rigid_sets.iter().map(|own| rigid_set(full, own)).collect(),
        masses: masses.iter().map(mass).collect(),
        equations: full.joints.count(JointKind::Equation),
        mass_kg,
        loads,
        sum_of_loads_n: full.loads.iter().fold(weight, |sum, (_, f)| [0, 1, 2].map(|i| sum[i] + f[i])),
        warnings,
        matrix: None,
    }
}

/// Mass, centre, moments of inertia and mesh quality of a part. Collective.
fn part(comm: &Comm, full: &FullModel, i: usize) -> PartRow {
    let mesh = &full.mesh;
    let own = full.own_elements().filter(|&e| mesh.elements.get(e).part as usize == i);
    let quality_of = |e: usize| scaled_jacobian(mesh.elements.get(e).shape(), &mesh.element_nodes(e));
    let properties = full.part_properties(comm, i);
    let quality = Ranked::new(comm, own.map(quality_of).collect());
    let centre = properties.centre();
    let inertia = properties.inertia_about(centre);
    let own = full.model.parts.iter().find(|own| own.name == mesh.parts[i]);
    let rayleigh = own.map_or_else(Rayleigh::default, |own| own.rayleigh);
    PartRow {
        part: mesh.parts[i].clone(),
        elements: quality.n_numbers(),
        mass_kg: properties.mass,
        centre_m: centre,
        inertia_kg_m2: [0, 1, 2].map(|k| inertia[k][k]),
        quality_min: quality.nth(0),
        quality_median: quality.nth(quality.n_numbers() / 2),
        alpha_per_s: rayleigh.alpha,
        beta_s: rayleigh.beta,
        loss_factor: own.map_or(0.0, |own| own.material.loss_factor),
        viscoelastic: own.and_then(|own| viscoelastic(&own.material, full.model.band[1])),
    }
}

/// The modulus of a viscoelastic material at rest and at the end of a band, Hz.
fn viscoelastic(material: &Material, end: f64) -> Option<ViscoelasticRow> {
    let r = material.viscoelastic.as_ref()?.factor(Complex64::new(0.0, TAU * end));
    let [young, _] = material.youngs();
    Some(ViscoelasticRow {
        young_at_rest_pa: young,
        young_at_band_end_pa: r.re * young,
        loss_factor_at_band_end: r.im / r.re,
    })
}

/// The loss factor of a connector, where it has one.
fn loss_factor(own: &Connector) -> Option<LossRow> {
    let row = || LossRow { connector: own.name.clone(), loss_factor: own.loss_factor };
    (own.loss_factor != 0.0).then(row)
}

fn rotation(comm: &Comm, full: &FullModel, own: &Rotation) -> RotationRow {
    let splitting = own.speed.abs() / PI;
    RotationRow {
        part: own.part.clone(),
        axis: own.axis,
        through_m: own.through,
        speed_rad_per_s: own.speed,
        inertia: own.inertia,
        speed_max_m_per_s: full.largest_speed(comm, own),
        splitting_hz: splitting,
        splitting_of_band: splitting / full.model.band[1],
    }
}

/// Mean sliding speed of a pair's points (m/s), weighted by their areas, and their mean distance from the axis
/// (m).
fn sliding(full: &FullModel, pair: &ContactPair) -> Option<[f64; 2]> {
    let speeds = full.interface.points[pair.points.clone()].iter().map(|point| match point.law.tangential {
        Tangential::Sliding { speed, .. } => point.law.weight * speed,
        _ => 0.0,
    });
    let mean = speeds.sum::<f64>() / pair.statistics.weight;
    let contact = full.model.contacts.iter().find(|contact| contact.name == pair.name)?;
    let rotation = full.model.sliding(contact, &full.mesh)?;
    Some([mean, mean / rotation.speed.abs()])
}

fn pair(full: &FullModel, pair: &ContactPair, proposed: &[ProposedStiffness]) -> PairRow {
    let statistics = &pair.statistics;
    let sliding = sliding(full, pair);
    let proposed = proposed.iter().find(|own| own.contact == pair.name);
    PairRow {
        pair: pair.name.clone(),
        kind: format!("{:?}", pair.kind).to_lowercase(),
        points: pair.points.len(),
        dropped: statistics.n_dropped,
        touching: statistics.touching,
        area_m2: statistics.weight,
        adjusted: statistics.n_adjusted,
        adjusted_gap_max_m: statistics.largest_adjusted,
        sliding_speed_m_per_s: sliding.map(|[speed, _]| speed),
        radius_m: sliding.map(|[_, radius]| radius),
        gap_min_m: statistics.gap[0],
        gap_max_m: statistics.gap[1],
        friction: pair.friction,
        proposed_stiffness_n_per_m3: proposed.map(|own| own.stiffness),
        proposed_stick_n_per_m3: proposed.and_then(|own| own.stick),
    }
}

fn tie(tie: &Tie, summary: &TieSummary) -> TieRow {
    TieRow {
        tie: tie.name.clone(),
        nodes: summary.n_tied,
        dropped: summary.n_dropped,
        area_m2: summary.area,
        distance_m: summary.distance,
        stiffness_n_per_m3: summary.stiffness,
    }
}

fn rigid_set(full: &FullModel, own: &RigidSet) -> RigidRow {
    let nodes = full.mesh.node_set(&own.nodes).map_or(0, |nodes| nodes.len());
    RigidRow { rigid: own.name.clone(), nodes }
}

fn mass(mass: &PointMass) -> MassRow {
    MassRow { mass: mass.name.clone(), on: mass.nodes.clone(), mass_kg: mass.mass }
}

/// The reference nodes of a sliding pair.
fn layout(full: &FullModel, pair: &ContactPair) -> LayoutRow {
    let own = &full.interface.points[pair.points.clone()];
    let areas = || own.iter().map(|point| point.law.weight);
    let points = || own.iter().map(|point| point.places.len());
    LayoutRow {
        pair: pair.name.clone(),
        reference_nodes: own.len(),
        cell_area_min_m2: areas().fold(f64::INFINITY, f64::min),
        cell_area_mean_m2: areas().sum::<f64>() / own.len() as f64,
        cell_area_max_m2: areas().fold(0.0, f64::max),
        cell_points_min: points().min().unwrap_or(0),
        cell_points_max: points().max().unwrap_or(0),
    }
}

fn amount(full: &FullModel, parts: &[PartRow], load: &Load) -> String {
    let force = |f: &[f64; 3]| f.map(|f| f.to_string()).join(" ");
    let newtons = |f: [f64; 3]| f.map(|f| format!("{:.3}", (1e3 * f).round() / 1e3 + 0.0)).join(" ");
    match &load.kind {
        LoadKind::ForceByNode(f) => format!("{} N, the same on each node", force(f)),
        LoadKind::ForceByArea(f) => format!("{} N, spread over the area", force(f)),
        LoadKind::ForceAt { force: f, moment: m, .. } => format!("{} N and {} N m at a point", force(f), force(m)),
        LoadKind::Pressure(p) => {
            let facets = full.mesh.surfaces.get(&load.on).into_iter().flat_map(|surface| &surface.facets);
            let nodal = facets.flat_map(|own| facet::pressure_load(&own.positions(&full.mesh.nodes), *p));
            let total = nodal.fold([0.0; 3], |sum, f| [0, 1, 2].map(|i| sum[i] + f[i]));
            format!("a pressure of {p} Pa, in total {} N", newtons(total))
        }
        LoadKind::Gravity(g) => {
            let of_parts = parts.iter().map(|row| (&row.part, row.mass_kg));
            let of_masses = full.model.masses.iter().map(|own| (&own.name, own.mass));
            let own = of_parts.chain(of_masses).filter(|(name, _)| load.is_gravity_on(name));
            let mass: f64 = own.map(|(_, mass)| mass).sum();
            format!("gravity of {} m/s2, in total {} N", force(g), newtons(g.map(|g| mass * g)))
        }
    }
}

/// Size of the stiffness matrix and of its factor, which is not made; `finished` is called with the name of each stage
/// at its end. Collective.
///
/// # Errors
/// PETSc's and MUMPS's.
pub fn matrix_summary(comm: &Comm, full: &FullModel, finished: &mut dyn FnMut(&str)) -> Result<MatrixSummary> {
    let system = full.assemble(comm, &full.families()?)?;
    finished("assembling M, C and K");
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.set_precision(tangent_precision(&system));
    factor.analyse(&system.k)?;
    finished("analysing the factor");
    Ok(MatrixSummary {
        free_dofs: system.dofs.n_global(),
        entries: system.k.n_entries()?,
        factor_gb: factor.stats().estimated_mb / 1024.0,
    })
}
