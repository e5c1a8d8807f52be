//! Elasticity of materials in the global axes, and the system of units that they are in.

use nalgebra::Matrix6;

use super::KnownUnits;
use super::bodies::SectionOf;
use super::orientations::axes;
use crate::Result;
use crate::deck::VOIGT_ORDER;
use crate::deck::assembly::Assembly;
use crate::deck::types::{Deck, Elastic, ElasticKind, Material};
use crate::model::elasticity::{
    from_compliance, is_positive_definite, isotropic_compliance, orthotropic_compliance, rotate, youngs,
};
use crate::model::{self, UnitSystem, names};

/// The elasticity in the material's axes, in the deck's unit; none where no material has these constants.
fn elasticity(elastic: &Elastic) -> Option<Matrix6<f64>> {
    let c = &elastic.constants;
    let matrix = match elastic.kind {
        ElasticKind::Isotropic => from_compliance(&isotropic_compliance(c[0], c[1]))?,
        ElasticKind::EngineeringConstants => {
            // nu_zx = nu_31 = nu_13 E_3 / E_1; shear moduli 12, 13, 23 to xy, yz, zx.
            let poisson = [c[3], c[5], c[4] * c[2] / c[0]];
            from_compliance(&orthotropic_compliance([c[0], c[1], c[2]], poisson, [c[6], c[8], c[7]]))?
        }
        ElasticKind::Orthotropic => {
            let mut triangle = [0.0; 21];
            triangle[..6].copy_from_slice(&c[..6]);
            [9, 14, 20].into_iter().zip(&c[6..9]).for_each(|(at, &shear)| triangle[at] = shear);
            symmetric(&triangle)
        }
        ElasticKind::Anisotropic => symmetric(c),
    };
    is_positive_definite(&matrix).then_some(matrix)
}

/// A symmetric matrix from its upper triangle by columns, in the deck's order.
fn symmetric(triangle: &[f64]) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    let places = (0..6).flat_map(|column| (0..=column).map(move |row| (VOIGT_ORDER[row], VOIGT_ORDER[column])));
    for ((i, j), &value) in places.zip(triangle) {
        matrix[(i, j)] = value;
        matrix[(j, i)] = value;
    }
    matrix
}

/// The material of a section.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where there is none, or it lacks elasticity, or density where a step asks for
/// modes.
fn of_section<'d>(deck: &'d Deck, section: &SectionOf) -> Result<(&'d Material, &'d Elastic, Option<f64>)> {
    let place = section.section.place;
    let name = &section.section.material;
    let material = deck.materials.iter().find(|material| material.name == *name).ok_or_else(|| {
        let advice = names::advice(name, deck.materials.iter().map(|material| material.name.as_str()));
        place.error(&deck.files, format_args!("there is no material {}. {advice}", deck.spelled(name)))
    })?;
    let missing = |what: &str| {
        let name = deck.spelled(name);
        material.place.error(&deck.files, format_args!("the material {name} has no {what}, which every part needs"))
    };
    let elastic = material.elastic.as_ref().ok_or_else(|| missing("*ELASTIC"))?;
    let density = material.density.map(|(density, _)| density);
    let asks_for_modes = deck.steps.iter().any(|step| step.procedure.is_of_modes());
    if density.is_none() && asks_for_modes { Err(missing("*DENSITY")) } else { Ok((material, elastic, density)) }
}

/// The material of a section, in SI units and global axes.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) for materials that are not there or cannot be.
pub fn material(
    assembly: &Assembly,
    section: &SectionOf,
    units: &UnitSystem,
) -> Result<(model::Material, model::Rayleigh)> {
    let deck = assembly.deck;
    let (material, elastic, density) = of_section(deck, section)?;
    let impossible = "no material has these constants: the elasticity is not positive definite";
    let own = elasticity(elastic).ok_or_else(|| elastic.place.error(&deck.files, impossible))? * units.stress();
    let mut name = deck.spelled(&material.name);
    let elasticity = match section.orientation.filter(|_| elastic.kind != ElasticKind::Isotropic) {
        None => own,
        Some(orientation) => {
            name = format!("{name} in {}", deck.spelled(&orientation.name));
            rotate(&own, &axes(assembly, section.space, orientation)?)
        }
    };
    let rows = [0, 1, 2, 3, 4, 5].map(|i| [0, 1, 2, 3, 4, 5].map(|j| elasticity[(i, j)]));
    let rayleigh = model::Rayleigh { alpha: material.alpha / units.time, beta: material.beta * units.time };
    let density = density.map_or(0.0, |density| density * units.density());
    let loss_factor = material.structural;
    Ok((model::Material { name, density, elasticity: rows, loss_factor, viscoelastic: None }, rayleigh))
}

/// What is noted of materials without a density.
pub fn without_density(deck: &Deck) -> Option<String> {
    let without = deck.materials.iter().filter(|material| material.density.is_none());
    let names: Vec<String> = without.map(|material| deck.spelled(&material.name)).collect();
    let what = "no *DENSITY: its parts have no mass, and the model no modes";
    (!names.is_empty()).then(|| format!("the material {} has {what}", names.join(", ")))
}

/// The system of units: the one named, or the first that makes all materials solids.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where no system does.
pub fn units(deck: &Deck, sections: &[SectionOf], known: KnownUnits) -> Result<UnitSystem> {
    let mut used = Vec::new();
    for section in sections {
        let (_, elastic, density) = of_section(deck, section)?;
        let impossible = "no material has these constants: the elasticity is not positive definite";
        let matrix = elasticity(elastic).ok_or_else(|| elastic.place.error(&deck.files, impossible))?;
        used.push((section, youngs(&matrix)[1], density));
    }
    if let Some(system) = known.system {
        return Ok(system);
    }
    let pairs: Vec<(f64, Option<f64>)> = used.iter().map(|(_, young, density)| (*young, *density)).collect();
    match &UnitSystem::fitting(&pairs, known.length)[..] {
        [system, ..] => Ok(*system),
        [] => {
            let (section, young, density) = used.first().expect("sections are there");
            let name = deck.spelled(&section.section.material);
            let of_length =
                known.length.map_or_else(String::new, |length| format!(" with a unit of length of {length} m"));
            let density = density.map_or("no density".to_owned(), |density| format!("a density of {density}"));
            let what = format_args!(
                "no system of units{of_length} makes solids of all materials: {name} has a modulus of {young} and {density}. \
                 Correct them, or name the units: {}",
                UnitSystem::ALL.map(|system| system.name).join(", ")
            );
            Err(section.section.place.error(&deck.files, what))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Place;

    fn matrix(kind: ElasticKind, constants: &[f64]) -> Matrix6<f64> {
        elasticity(&Elastic { kind, constants: constants.to_vec(), place: Place::default() }).unwrap()
    }

    #[test]
    fn one_material_in_all_four_forms() {
        let (e, nu) = (2.1, 0.3);
        let g = e / (2.0 * (1.0 + nu));
        let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let d = lambda + 2.0 * g;
        let isotropic = matrix(ElasticKind::Isotropic, &[e, nu]);
        let engineering = matrix(ElasticKind::EngineeringConstants, &[e, e, e, nu, nu, nu, g, g, g]);
        let orthotropic = matrix(ElasticKind::Orthotropic, &[d, lambda, d, lambda, lambda, d, g, g, g]);
        let mut triangle = vec![d, lambda, d, lambda, lambda, d];
        triangle.extend([0.0, 0.0, 0.0, g, 0.0, 0.0, 0.0, 0.0, g, 0.0, 0.0, 0.0, 0.0, 0.0, g]);
        let anisotropic = matrix(ElasticKind::Anisotropic, &triangle);
        for other in [engineering, orthotropic, anisotropic] {
            assert!((other - isotropic).norm() < 1e-14, "{other}");
        }
        assert!((youngs(&isotropic)[0] - e).abs() < 1e-14);
    }

    /// Shears 12, 13, 23 of the deck are xy, zx, yz, and nu_13 is the contraction along 3 under a stress along 1.
    #[test]
    fn engineering_constants_have_their_axes() {
        let c = matrix(ElasticKind::EngineeringConstants, &[4.0, 3.0, 2.0, 0.1, 0.2, 0.15, 1.0, 1.2, 1.4]);
        assert_eq!([c[(3, 3)], c[(4, 4)], c[(5, 5)]].map(|g| (g * 10.0).round()), [10.0, 14.0, 12.0]);
        let s = c.try_inverse().unwrap();
        for ((i, j), expected) in [((0, 1), -0.1 / 4.0), ((0, 2), -0.2 / 4.0), ((1, 2), -0.15 / 3.0), ((2, 2), 0.5)] {
            assert!((s[(i, j)] - expected).abs() < 1e-14, "{i} {j}");
        }
    }
}
