//! A super-element just made and what it cost: `squeal reduce` as text and JSON.

use std::path::Path;

use serde::Serialize;

use crate::reduction::craig_bampton::Costs;
use crate::reduction::galerkin::BasisReport;
use crate::reduction::made_for::MadeFor;
use crate::reduction::super_element::{Origin, SuperElement};
use crate::results::Certificate;

/// What was made, and the seconds that its steps took.
#[derive(Serialize)]
pub struct ReductionDocument<'a> {
    #[serde(flatten)]
    origin: &'a Origin,
    contacts: usize,
    retained_points: usize,
    fixed_interface_modes: usize,
    residual_modes: usize,
    coordinates: usize,
    #[serde(flatten)]
    costs: &'a Costs,
    seconds: f64,
    file: String,
    #[serde(skip)]
    seconds_before: f64,
}

impl<'a> ReductionDocument<'a> {
    /// The reduction to a file; `seconds` are those before it and those in all.
    pub fn new(element: &'a SuperElement, costs: &'a Costs, seconds: [f64; 2], file: &Path) -> ReductionDocument<'a> {
        ReductionDocument {
            origin: &element.origin,
            contacts: element.contacts.len(),
            retained_points: element.points.len(),
            fixed_interface_modes: element.frequencies.len(),
            residual_modes: element.n_residual_modes(),
            coordinates: element.n_coordinates(),
            costs,
            seconds: seconds[1],
            file: file.display().to_string(),
            seconds_before: seconds[0],
        }
    }

    /// For people.
    pub fn text(&self) -> String {
        let (factor, file) = (&self.costs.factor, &self.file);
        format!(
            "{}: super-element at friction {}\n\n\
             {} contacts, {} retained points, {} fixed-interface modes below {} Hz and {} residual modes: {} coordinates \
             instead of {}\n{}\n\
             equilibrium            {:8.1} s\n\
             one LDL^T factor       {:8.1} s  {:.0} M entries, {:.0} MB, ordering {}\n\
             constraint modes       {:8.1} s  {} solves in blocks\n\
             fixed-interface modes  {:8.1} s  {} solves in blocks\n\
             samples of parts       {:8.1} s\n\
             projection of M, C, K  {:8.1} s\n\
             in all                 {:8.1} s\n\n\
             results in {file}\n",
            self.origin.title,
            self.origin.friction,
            self.contacts,
            self.retained_points,
            self.fixed_interface_modes,
            self.origin.limit,
            self.residual_modes,
            self.coordinates,
            self.origin.n_dofs,
            notes(self.origin),
            self.seconds_before,
            factor.analysis_seconds + factor.factorisation_seconds,
            1e-6 * factor.entries,
            factor.used_mb,
            factor.ordering_name(),
            self.costs.constraint_seconds,
            3 * self.retained_points,
            self.costs.fixed_seconds,
            self.costs.n_solves,
            self.costs.sample_seconds,
            self.costs.projection_seconds,
            self.seconds,
        )
    }
}

/// What else is to be known of it.
fn notes(origin: &Origin) -> String {
    prestress(origin) + &origin.made_for.as_ref().map_or(String::new(), made_for)
}

/// A line about the geometric stiffness, where there is one.
fn prestress(origin: &Origin) -> String {
    let what = "its modes have the geometric stiffness of the equilibrium at friction";
    origin.prestress_friction.map_or(String::new(), |mu| format!("prestress is frozen: {what} {mu}\n"))
}

/// What samples of other moduli and densities found.
fn made_for(own: &MadeFor) -> String {
    let percent = |errors: &[f64]| {
        let errors: Vec<String> = errors.iter().map(|error| format!("{:.4}", 100.0 * error)).collect();
        errors.join(", ")
    };
    let ranges = own.parts.iter().flat_map(|part| {
        let range = |what: &str, [from, to]: [f64; 2]| match from == to {
            true => None,
            false => Some(format!("  {} of {} {from:.3} to {to:.3} times the model's\n", what, part.part)),
        };
        [range("stiffness", part.stiffness), range("mass", part.mass)].into_iter().flatten()
    });
    let ranges: String = ranges.collect();
    let largest = "largest error of a frequency";
    let errors = match own.test_friction {
        None => {
            let errors = percent(&own.sample_errors);
            format!("{largest} at each sample, estimated before its vectors joined the basis, %: {errors}")
        }
        Some(mu) => {
            let errors = percent(&own.test_errors);
            format!("{largest} at other points, friction {mu}, by the full model's residuals, %: {errors}")
        }
    };
    let (study, n_samples, n) = (&own.study, own.n_samples, own.sample_coordinates);
    format!("made for the parts of {study}: {n} of the coordinates are of {n_samples} samples\n{ranges}{errors}\n")
}

/// A Galerkin super-element just made: where its coordinates come from, and the seconds that its steps took.
#[derive(Serialize)]
pub struct GalerkinDocument<'a> {
    #[serde(flatten)]
    origin: &'a Origin,
    contacts: usize,
    coordinates: usize,
    #[serde(flatten)]
    report: &'a BasisReport,
    /// Between the samples.
    tests: &'a [Certificate],
    file: String,
}

impl<'a> GalerkinDocument<'a> {
    /// The reduction to a file.
    pub fn new(
        element: &'a SuperElement,
        report: &'a BasisReport,
        tests: &'a [Certificate],
        file: &Path,
    ) -> GalerkinDocument<'a> {
        GalerkinDocument {
            origin: &element.origin,
            contacts: element.contacts.len(),
            coordinates: element.n_coordinates(),
            report,
            tests,
            file: file.display().to_string(),
        }
    }

    /// For people.
    pub fn text(&self) -> String {
        let (report, file) = (self.report, &self.file);
        let test = |test: &Certificate| test.text(self.origin.criterion) + "\n";
        let tests: String = match self.tests {
            [] => "none: one sample\n".to_owned(),
            tests => Certificate::HEAD.to_owned() + &tests.iter().map(test).collect::<String>(),
        };
        let values: Vec<String> = self.origin.samples.iter().map(|sample| sample.friction.to_string()).collect();
        format!(
            "{}: Galerkin super-element, modes of the full model at friction {}\n\n\
             all {} contact points, {} coordinates instead of {}\n\n\
             {:4} of {} equilibria\n\
             {:4} of the right and left modes below {} Hz at {} samples\n\
             {:4} of static answers at {} points that open or close\n{}\n\
             between the samples, estimated by the full model's residuals:\n{tests}\n\
             equilibria             {:8.1} s\n\
             modes                  {:8.1} s\n\
             their left vectors     {:8.1} s\n\
             basis                  {:8.1} s\n\
             projection, file       {:8.1} s\n\
             tests                  {:8.1} s\n\
             in all                 {:8.1} s\n\n\
             results in {file}\n",
            self.origin.title,
            values.join(", "),
            self.contacts,
            self.coordinates,
            self.origin.n_dofs,
            report.coordinates_of_equilibria,
            report.equilibria,
            report.coordinates_of_modes,
            self.origin.limit,
            report.mode_samples,
            report.coordinates_of_static_answers,
            report.switching_points,
            notes(self.origin),
            report.equilibrium_seconds,
            report.mode_seconds,
            report.left_seconds,
            report.basis_seconds,
            report.projection_seconds,
            report.test_seconds,
            report.seconds,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reduction::made_for::PartRange;

    #[test]
    fn errors_at_samples_and_at_other_points_have_their_own_words() {
        let parts = vec![PartRange { stiffness: [0.7, 1.4], ..PartRange::nominal("pad") }];
        let own =
            MadeFor { study: "for.toml".into(), n_samples: 3, sample_coordinates: 7, parts, ..MadeFor::default() };
        let sampled = made_for(&MadeFor { sample_errors: vec![0.01, 2e-5, 1e-6], ..own.clone() });
        assert_eq!(
            sampled,
            "made for the parts of for.toml: 7 of the coordinates are of 3 samples\n  stiffness of pad 0.700 to 1.400 \
             times the model's\nlargest error of a frequency at each sample, estimated before its vectors joined the \
             basis, %: 1.0000, 0.0020, 0.0001\n"
        );
        let tested = made_for(&MadeFor { test_errors: vec![0.02, 0.01], test_friction: Some(0.35), ..own });
        assert!(tested.contains("7 of the coordinates are of 3 samples"), "{tested}");
        let end = "frequency at other points, friction 0.35, by the full model's residuals, %: 2.0000, 1.0000\n";
        assert!(tested.ends_with(end) && !tested.contains("joined"), "{tested}");
    }
}
