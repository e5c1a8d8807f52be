//! A super-element just made and what it cost: `squeal reduce` as text and JSON.

use std::path::Path;

use serde::Serialize;

use crate::reduction::craig_bampton::Costs;
use crate::reduction::super_element::SuperElement;

/// What was made, and the seconds that its steps took.
#[derive(Serialize)]
pub struct ReductionDocument<'a> {
    title: &'a str,
    model: &'a str,
    mesh: &'a str,
    mesh_sha256: &'a str,
    friction: f64,
    limit_hz: f64,
    contacts: usize,
    retained_points: usize,
    fixed_interface_modes: usize,
    inertia_modes: usize,
    coordinates: usize,
    equations_of_the_model: usize,
    constraint_seconds: f64,
    fixed_interface_seconds: f64,
    projection_seconds: f64,
    seconds: f64,
    file: String,
    #[serde(skip)]
    seconds_before: f64,
    #[serde(skip)]
    costs: &'a Costs,
}

impl<'a> ReductionDocument<'a> {
    /// The reduction to a file; `seconds` are those before it and those in all.
    pub fn new(element: &'a SuperElement, costs: &'a Costs, seconds: [f64; 2], file: &Path) -> ReductionDocument<'a> {
        let origin = &element.origin;
        ReductionDocument {
            title: &origin.title,
            model: &origin.model,
            mesh: &origin.mesh,
            mesh_sha256: &origin.mesh_hash,
            friction: origin.friction,
            limit_hz: origin.limit,
            contacts: element.contacts.len(),
            retained_points: element.points.len(),
            fixed_interface_modes: element.frequencies.len(),
            inertia_modes: element.n_inertia_modes(),
            coordinates: element.n_coordinates(),
            equations_of_the_model: origin.n_equations,
            constraint_seconds: costs.constraint_seconds,
            fixed_interface_seconds: costs.fixed_seconds,
            projection_seconds: costs.projection_seconds,
            seconds: seconds[1],
            file: file.display().to_string(),
            seconds_before: seconds[0],
            costs,
        }
    }

    /// For people.
    pub fn text(&self) -> String {
        let (factor, file) = (&self.costs.factor, &self.file);
        format!(
            "{}: super-element at friction {}\n\n\
             {} contacts, {} retained points, {} fixed-interface modes below {} Hz and {} inertia modes: {} coordinates \
             instead of {}\n\n\
             equilibrium            {:8.1} s\n\
             one LDL^T factor       {:8.1} s  {:.0} M entries, {:.0} MB, ordering {}\n\
             constraint modes       {:8.1} s  {} solves in blocks\n\
             fixed-interface modes  {:8.1} s  {} solves in blocks\n\
             projection of M, C, K  {:8.1} s\n\
             in all                 {:8.1} s\n\n\
             results in {file}\n",
            self.title,
            self.friction,
            self.contacts,
            self.retained_points,
            self.fixed_interface_modes,
            self.limit_hz,
            self.inertia_modes,
            self.coordinates,
            self.equations_of_the_model,
            self.seconds_before,
            factor.analysis_seconds + factor.factorisation_seconds,
            1e-6 * factor.entries,
            factor.used_mb,
            factor.ordering_name(),
            self.constraint_seconds,
            3 * self.retained_points,
            self.fixed_interface_seconds,
            self.costs.n_solves,
            self.projection_seconds,
            self.seconds,
        )
    }
}
