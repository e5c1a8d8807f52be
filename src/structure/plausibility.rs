//! What can hardly be meant: numbers of a model that no brake has, mostly by a mistake of units.
//!
//! A warning is a sentence without its full stop: what is there, and what was probably meant. None of it stops a run,
//! but a run with a warning never ends in "stable".

use super::FullModel;
use nalgebra::{Matrix3, Vector3};

use crate::element::ElementKind;
use crate::element::solid::MassProperties;
use crate::model::{LoadKind, Material, Rotation, softest_young};
use crate::native::Comm;

/// Young's moduli of solids, from rubber to above diamond, Pa.
const YOUNG: [f64; 2] = [1e6, 1e12];
/// Densities of solids, from foam to above osmium, kg/m3.
const DENSITY: [f64; 2] = [100.0, 3e4];
/// Densities of what brakes are made of, kg/m3: what a wrong unit is recognised by.
const USUAL_DENSITY: [f64; 2] = [500.0, 2.5e4];
/// Largest extents of brakes and their parts, m.
const SIZE: [f64; 2] = [0.01, 10.0];
/// Normal stiffness of contacts over E/h of the softer neighbour: below, surfaces visibly overlap; above, digits are
/// lost.
const CONTACT_RATIO: [f64; 2] = [1e-3, 1e4];
/// Facets of a tie's slave over those of its master: above, nodes of the master between those of the slave are free.
const TIE_RATIO: f64 = 1.25;
/// Overlap over the edge of a facet: more than a curved wall and its mesh of first order differ by.
const OVERLAP_RATIO: f64 = 0.25;
/// Moment of inertia about the axis of rotation over the largest one.
const INERTIA_RATIO: f64 = 0.9;
/// Distance of the axis from the centre of mass over the radius.
const AXIS_RATIO: f64 = 0.1;
/// Scaled Jacobian below which an element is flat.
const QUALITY: f64 = 0.05;
/// N/m3 in a N/mm3.
const PER_CUBIC_MILLIMETRE: f64 = 1e9;
/// Brakes have pressures of 1 to 200 bar, 1e5 to 2e7 Pa.
const SMALLEST_PRESSURE: f64 = 1e3;

/// Whether a number lies outside.
fn is_outside(x: f64, [low, high]: [f64; 2]) -> bool {
    !(low..=high).contains(&x)
}

/// A Young's modulus, Pa.
pub fn young(material: &str, young: f64) -> Option<String> {
    let cause = match young {
        x if x < 1e3 => "Was it given in GPa",
        x if x < YOUNG[0] => "Was it given in MPa (N/mm2)",
        _ => "Was a factor of a thousand too many taken",
    };
    is_outside(young, YOUNG)
        .then(|| format!("Young's modulus of material {material:?} is {young:.3e} Pa. {cause}? Give Pa, such as 110e9"))
}

/// A density, kg/m3.
pub fn density(material: &str, density: f64) -> Option<String> {
    const UNITS: [(&str, f64); 4] = [("t/mm3", 1e12), ("kg/mm3", 1e9), ("g/cm3", 1e3), ("g/m3", 1e-3)];
    let meant = UNITS.iter().find(|(_, factor)| !is_outside(density * factor, USUAL_DENSITY));
    let cause = meant.map_or_else(String::new, |(unit, factor)| {
        format!(" Was it given in {unit}? That is {:.0} kg/m3", density * factor)
    });
    is_outside(density, DENSITY).then(|| {
        let cause = if cause.is_empty() { " Give kg/m3, such as 7100" } else { &cause };
        format!("density of material {material:?} is {density:.3e} kg/m3.{cause}")
    })
}

/// The largest extent of a model (m), whose mesh has this unit (m).
pub fn size(extent: f64, unit: f64) -> Option<String> {
    let meant = match unit {
        _ if !is_outside(extent, SIZE) => return None,
        1.0 if extent > SIZE[1] => "Is the mesh in mm? Then give unit = \"mm\"",
        unit if unit < 1.0 && extent < SIZE[0] => "Is the mesh in m? Then give unit = \"m\"",
        _ => "Look at the unit of the mesh ([mesh] unit)",
    };
    Some(format!("the model is {extent:.3e} m large. {meant}"))
}

/// The pressure of a load, Pa.
pub fn pressure(load: &str, pressure: f64) -> Option<String> {
    (pressure != 0.0 && pressure.abs() < SMALLEST_PRESSURE).then(|| {
        format!(
            "the pressure of load {load:?} is {pressure:.3e} Pa. Was it given in MPa? 1 MPa is 1e6 Pa, 1 bar 1e5 Pa"
        )
    })
}

/// The normal stiffness of a contact beside E/h of its softer neighbour, both N/m3.
pub fn contact_stiffness(contact: &str, stiffness: f64, neighbour: f64) -> Option<String> {
    let ratio = stiffness / neighbour;
    let what = match ratio {
        r if r < CONTACT_RATIO[0] => "the surfaces will overlap far",
        r if r > CONTACT_RATIO[1] => "digits will be lost",
        _ => return None,
    };
    let meant = match is_outside(ratio * PER_CUBIC_MILLIMETRE, CONTACT_RATIO) {
        true => format!("Take about {neighbour:.0e} N/m3"),
        false => "Was it given in N/mm3? 1 N/mm3 is 1e9 N/m3".to_owned(),
    };
    Some(format!(
        "the normal stiffness of contact {contact:?} is {stiffness:.3e} N/m3, {ratio:.0e} times E/h of the softer elements beside it: {what}. \
         {meant}"
    ))
}

/// The facets of a tie's slave beside those of its master, edges in m.
pub fn tie_sizes(tie: &str, [slave, master]: [f64; 2]) -> Option<String> {
    let ratio = slave / master;
    (ratio > TIE_RATIO).then(|| {
        format!(
            "the facets of the slave of tie {tie:?} are {ratio:.1} times as long as those of its master, whose nodes between \
             those of the slave are then free. Swap slave and master"
        )
    })
}

/// The overlap of a contact's surfaces (m) beside the edge of the slave's facets.
pub fn overlap(contact: &str, overlap: f64, facet: f64) -> Option<String> {
    (overlap > OVERLAP_RATIO * facet).then(|| {
        let [overlap, facet] = [overlap, facet].map(|x| 1e3 * x);
        format!(
            "the surfaces of contact {contact:?} overlap by {overlap:.3e} mm at the start, where facets are {facet:.3e} mm long. Do the parts \
             overlap in the mesh, or are slave and master the wrong surfaces?"
        )
    })
}

/// The axis of a rotation beside the mass properties of its part.
pub fn axis(rotation: &Rotation, properties: &MassProperties) -> Option<String> {
    let (part, centre) = (&rotation.part, properties.centre());
    let inertia = Matrix3::from(properties.inertia_about(centre));
    let a = Vector3::from(rotation.axis);
    let (own, largest) = (a.dot(&(inertia * a)), inertia.symmetric_eigenvalues().max());
    if own < INERTIA_RATIO * largest {
        let what = "is not the one about which its moment of inertia is largest, as a disc's is";
        return Some(format!("the axis of rotation of part {part:?} {what}. Look at axis in its [[rotation]]"));
    }
    // The radius of a solid disc with this moment of inertia; a sector of a disc has its axis outside.
    let radius = (2.0 * own / properties.mass).sqrt();
    let distance = (Vector3::from(centre) - Vector3::from(rotation.through)).cross(&a).norm();
    (distance > AXIS_RATIO * radius && distance < radius).then(|| {
        let distance = 1e3 * distance;
        format!("the axis of rotation of part {part:?} passes {distance:.1} mm beside its centre of mass. Look at through in its [[rotation]]")
    })
}

/// The worst scaled Jacobian of a part's elements. One flat element does not spoil modes: only `squeal check` warns.
pub fn quality(part: &str, worst: f64) -> Option<String> {
    (worst < QUALITY).then(|| {
        format!(
            "part {part:?} has an element of quality {worst:.3} (scaled Jacobian, 1 is best). Mesh again where it is"
        )
    })
}

/// Everything about a brake that can hardly be meant. Collective.
pub fn warnings(full: &FullModel, comm: &Comm) -> Vec<String> {
    let model = &full.model;
    let mut materials: Vec<&Material> = model.parts.iter().map(|part| &part.material).collect();
    materials.sort_by(|a, b| a.name.cmp(&b.name));
    materials.dedup_by(|a, b| a.name == b.name);
    let stiffness = materials.iter().filter_map(|material| {
        let [low, high] = material.youngs();
        young(&material.name, low).or_else(|| young(&material.name, high))
    });
    // A deck without a density is noted.
    let with_mass = materials.iter().filter(|material| material.density != 0.0);
    let mass = with_mass.filter_map(|material| density(&material.name, material.density));
    let contacts = model.contacts.iter().zip(&full.interface.pairs).filter_map(|(contact, pair)| {
        let stiffness = pair.law.initial_stiffness();
        let young = softest_young(&model.parts, &full.mesh, &[&contact.slave, &contact.master]);
        let neighbour = young / full.mesh.surfaces[&contact.slave].facet_size(pair.statistics.area);
        contact_stiffness(&contact.name, stiffness, neighbour).filter(|_| neighbour.is_finite())
    });
    let pressures = model.loads.iter().filter_map(|load| match load.kind {
        LoadKind::Pressure(p) => pressure(&load.name, p),
        _ => None,
    });
    let ties = model.ties.iter().zip(&full.joints.ties).filter_map(|(tie, own)| tie_sizes(&tie.name, own.sizes));
    let extent = full.extents(comm).into_iter().fold(0.0, f64::max);
    let size = size(extent, model.mesh_unit);
    stiffness
        .chain(mass)
        .chain(contacts)
        .chain(pressures)
        .chain(ties)
        .chain(size)
        .chain(stiff_elements(full, comm))
        .chain(geometry(full, comm))
        .chain(super::loading::warnings(full, comm))
        .chain(super::damping_range::warnings(model))
        .collect()
}

/// What is wrong with overlaps and axes. Collective.
fn geometry(full: &FullModel, comm: &Comm) -> Vec<String> {
    let overlaps = full.interface.pairs.iter().filter(|pair| pair.separation).filter_map(|pair| {
        let facet = full.mesh.surfaces[&pair.slave].facet_size(pair.statistics.area);
        overlap(&pair.name, -pair.statistics.gap[0], facet)
    });
    let mut all: Vec<String> = overlaps.collect();
    for rotation in &full.model.rotations {
        if let Some(part) = full.mesh.parts.iter().position(|part| *part == rotation.part) {
            all.extend(axis(rotation, &full.part_properties(comm, part)));
        }
    }
    all.extend(full.revolution_warnings(comm));
    all
}

/// Parts that have elements too stiff for modes that bend. Collective.
fn stiff_elements(full: &FullModel, comm: &Comm) -> Vec<String> {
    let n_kinds = ElementKind::ALL.len();
    let mut counts = vec![0.0; full.mesh.parts.len() * n_kinds];
    for element in full.own_elements().map(|e| full.mesh.elements.get(e)) {
        counts[element.part as usize * n_kinds + element.kind as usize] += 1.0;
    }
    comm.sum_all(&mut counts);
    let parts = full.mesh.parts.iter().zip(counts.chunks_exact(n_kinds));
    parts.flat_map(|(part, counts)| too_stiff(part, counts)).collect()
}

/// A part's elements that are too stiff, from its number of elements of each kind.
fn too_stiff(part: &str, counts: &[f64]) -> Vec<String> {
    let stiff = |(kind, &n): (ElementKind, &f64)| {
        let why = kind.too_stiff().filter(|_| n > 0.0)?;
        Some(format!(
            "part {part:?} has {n} elements {}, too stiff for squeal: {why}. Mesh with second-order elements, or with C3D8I",
            kind.name()
        ))
    };
    ElementKind::ALL.into_iter().zip(counts).filter_map(stiff).collect()
}

impl FullModel {
    /// The extents along the axes, m. Collective.
    pub fn extents(&self, comm: &Comm) -> [f64; 3] {
        let most = |sign: f64, i: usize| self.mesh.nodes.iter().map(|x| sign * x[i]).fold(f64::MIN, f64::max);
        let mut ends = [1.0, -1.0].map(|sign| [0, 1, 2].map(|i| most(sign, i)));
        comm.max_all(ends.as_flattened_mut());
        [0, 1, 2].map(|i| ends[0][i] + ends[1][i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Inertia, Place};

    #[test]
    fn constant_strain_and_locking_elements_are_named_and_others_are_not() {
        for kind in ElementKind::ALL {
            let counts: Vec<f64> =
                ElementKind::ALL.iter().map(|&other| if other == kind { 7.0 } else { 0.0 }).collect();
            let warnings = too_stiff("disc", &counts);
            let stiff = matches!(kind, ElementKind::C3D4 | ElementKind::C3D6 | ElementKind::C3D8);
            assert_eq!(warnings.len(), usize::from(stiff), "{warnings:?}");
            let start = format!("part \"disc\" has 7 elements {}, too stiff for squeal", kind.name());
            assert!(warnings.iter().all(|warning| warning.starts_with(&start)), "{warnings:?}");
        }
    }

    /// Requires a warning that says this.
    #[track_caller]
    fn warns(warning: Option<String>, says: &str) {
        let text = warning.expect("no warning");
        assert!(text.contains(says), "{says:?} is not in {text:?}");
    }

    #[test]
    fn overlaps() {
        assert_eq!([1e-3, -1e-3, 0.0].map(|depth| overlap("pad", depth, 8e-3)), [None, None, None]);
        warns(overlap("pad", 5e-3, 8e-3), "overlap by 5.000e0 mm at the start, where facets are 8.000e0 mm long");
    }

    /// A disc of radius 0.1 m, 0.02 m thick, of 1 kg about the point c.
    fn disc(c: [f64; 3]) -> MassProperties {
        let own = [0.01 / 4.0, 0.01 / 4.0, 0.0004 / 12.0];
        let moment = |i: usize, j: usize| c[i] * c[j] + if i == j { own[i] } else { 0.0 };
        let second_moment = [0, 1, 2].map(|i| [0, 1, 2].map(|j| moment(i, j)));
        MassProperties { mass: 1.0, first_moment: c, second_moment }
    }

    #[test]
    fn axes_of_discs() {
        let rotation = |axis: [f64; 3], through: [f64; 3]| Rotation {
            part: "disc".into(),
            axis,
            through,
            speed: 5.0,
            inertia: Inertia::None,
            place: Place::default(),
        };
        let about = |a: [f64; 3], through: [f64; 3]| axis(&rotation(a, through), &disc([0.3, 0.0, 0.5]));
        assert_eq!(about([0.0, 0.0, 1.0], [0.3, 0.009, 0.0]), None);
        assert_eq!(about([0.0, 0.0, -1.0], [0.0; 3]), None, "a sector of a disc");
        warns(about([1.0, 0.0, 0.0], [0.3, 0.0, 0.5]), "is not the one about which its moment of inertia is largest");
        warns(about([0.0, 0.0, 1.0], [0.3, 0.02, 0.0]), "passes 20.0 mm beside its centre of mass");
    }

    #[test]
    fn flat_elements() {
        assert_eq!(quality("disc", 0.06), None);
        warns(quality("disc", 0.002), "has an element of quality 0.002");
    }

    #[test]
    fn youngs_modulus() {
        for e in [1e6, 8e9, 210e9, 1e12] {
            assert_eq!(young("iron", e), None);
        }
        warns(young("iron", 110.0), "is 1.100e2 Pa. Was it given in GPa?");
        warns(young("iron", 110e3), "Was it given in MPa (N/mm2)?");
        warns(young("iron", 0.99e6), "MPa");
        warns(young("iron", 1.01e12), "factor of a thousand");
    }

    #[test]
    fn pressures() {
        assert_eq!([2e6, -2e6, 1e5, 0.0].map(|p| pressure("piston", p)), [None, None, None, None]);
        warns(pressure("piston", 2.0), "is 2.000e0 Pa. Was it given in MPa?");
    }

    #[test]
    fn densities() {
        for rho in [100.0, 2600.0, 7850.0, 3e4] {
            assert_eq!(density("iron", rho), None);
        }
        warns(density("iron", 7.1e-9), "Was it given in t/mm3? That is 7100 kg/m3");
        warns(density("iron", 7.1e-6), "in kg/mm3?");
        warns(density("iron", 7.1), "in g/cm3?");
        warns(density("iron", 7.1e6), "in g/m3?");
        warns(density("iron", 99.0), "is 9.900e1 kg/m3. Give kg/m3");
        warns(density("iron", 3.1e4), "Give kg/m3");
    }

    #[test]
    fn ties() {
        assert_eq!(tie_sizes("bond", [1.24e-3, 1e-3]), None);
        warns(tie_sizes("bond", [1.5e-3, 1e-3]), "slave of tie \"bond\" are 1.5 times as long");
    }

    #[test]
    fn sizes() {
        for extent in [0.01, 0.3, 10.0] {
            assert_eq!(size(extent, 1e-3), None);
        }
        warns(size(240.0, 1.0), "is 2.400e2 m large. Is the mesh in mm?");
        warns(size(2.4e-4, 1e-3), "Is the mesh in m?");
        warns(size(0.0099, 1.0), "Look at the unit");
        warns(size(10.1, 1e-3), "Look at the unit");
    }

    #[test]
    fn contact_stiffnesses() {
        let neighbour = 1e12;
        for k in [1e9, 2e13, 1e16] {
            assert_eq!(contact_stiffness("pad", k, neighbour), None);
        }
        warns(contact_stiffness("pad", 2e4, neighbour), "Was it given in N/mm3?");
        warns(contact_stiffness("pad", 2e4, neighbour), "2e-8 times E/h of the softer elements beside it");
        warns(contact_stiffness("pad", 0.1, neighbour), "will overlap far. Take about 1e12 N/m3");
        warns(contact_stiffness("pad", 1.1e16, neighbour), "digits will be lost. Take about 1e12 N/m3");
    }
}
