//! Axes of materials, springs and connectors.

use nalgebra::{Matrix3, Vector3};

use crate::Result;
use crate::deck::assembly::Assembly;
use crate::deck::types::Orientation;
use crate::model::elasticity::axes_from;
use crate::model::{Place, names};

/// The orientation that a space means by a name: its own, or one outside all instances.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where there is none, with the place that names it.
pub fn orientation<'d>(assembly: &Assembly<'d>, space: usize, name: &str, place: Place) -> Result<&'d Orientation> {
    let deck = assembly.deck;
    let own = assembly.spaces[space].scopes.iter().flat_map(|scope| &scope.orientations);
    let known: Vec<&Orientation> = own.chain(&deck.assembly.orientations).collect();
    known.iter().find(|own| own.name == name).copied().ok_or_else(|| {
        let advice = names::advice(name, known.iter().map(|own| own.name.as_str()));
        assembly.error(place, format_args!("there is no orientation {}. {advice}", deck.spelled(name)))
    })
}

/// The axes of an orientation as columns, turned as the instance of its space is.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) for axes that change from point to point, and points that give no axes.
pub fn axes(assembly: &Assembly, space: usize, orientation: &Orientation) -> Result<Matrix3<f64>> {
    if orientation.is_cylindrical {
        let what = "cylindrical axes are not supported here: they change from point to point. Give rectangular ones";
        return Err(assembly.error(orientation.place, what));
    }
    let unit = |v| Vector3::from(assembly.turned(space, v)).try_normalize(0.0).map(<[f64; 3]>::from);
    let axes = unit(orientation.a).zip(unit(orientation.b)).and_then(|(a, b)| axes_from(a, b));
    axes.ok_or_else(|| {
        assembly
            .error(orientation.place, "the two points of the axes lie on a line through the origin. Move one of them")
    })
}
