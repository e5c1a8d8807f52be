//! A brake in several models: tables for people and programs.

use std::io::{Result, Write};

use serde::Serialize;

use super::columns::write_csv;
use super::text::{aligned, friction, or_dash, paragraph, plural};
use crate::comparison::{CurvePoint, Errors, Onset, Sizes, StudiedModel, Study};

/// Onsets whose frequencies differ by less than this part are those of one instability.
const NEAR: f64 = 0.05;

/// Sizes and times, errors, and the instabilities over friction.
pub fn text(study: &Study) -> String {
    let Study { title, band: [from, to], n_nodes, n_elements, friction_values, .. } = study;
    let n = friction_values.len();
    let head = format!(
        "{title}: reduced models compared with full contact, modes of {from}-{to} Hz at {n} friction value{}\n\
         mesh: {n_nodes} nodes, {n_elements} elements\n",
        plural(n)
    );
    let curves: String = (0..study.reference.curves.len()).map(|i| curve_text(study, i)).collect();
    head + "\n"
        + &sizes_text(study)
        + "\n"
        + &errors_text(study)
        + "\n"
        + &onsets_text(study)
        + &curves
        + &paragraph(&spurious_text(study))
}

fn models(study: &Study) -> impl Iterator<Item = &StudiedModel> {
    [&study.reference].into_iter().chain(&study.models)
}

/// Table 2 of the paper, with the time of a friction value.
fn sizes_text(study: &Study) -> String {
    let row = |model: &StudiedModel| {
        let StudiedModel { name, sizes: Sizes { n_contacts, n_retained, n_dofs }, seconds, making_seconds, .. } = model;
        let (retained, making) =
            (or_dash(*n_retained, |n| n.to_string()), or_dash(*making_seconds, |s| format!("{s:.1}")));
        let times = study.reference.seconds / seconds.max(f64::MIN_POSITIVE);
        format!("{name}\t{n_contacts}\t{retained}\t{n_dofs}\t{seconds:.3}\t{times:.1}\t{making}")
    };
    let heading =
        "\tcontact\tretained\t\tseconds\ttimes\tseconds\nmodel\tpoints\tpoints\tdofs\tper value\tfaster\tto make";
    aligned(heading, models(study).map(row))
}

fn errors_text(study: &Study) -> String {
    let curves = &study.reference.curves;
    let names: String = curves.iter().map(|curve| format!("\tat {}", name(curve))).collect();
    let heading = format!(
        "errors over all modes\tfrequency, %\t\tgrowth\tleast\tunmatched\t\textra{}\n\
         and values\tworst\tmean\trate, %\tMAC\tref.\tmodel\tunstable{names}",
        "\tunstable".repeat(curves.len())
    );
    let row = |model: &StudiedModel| {
        let Errors { worst_frequency, mean_frequency, worst_growth, least_mac, .. } = Errors::worst(&model.errors);
        let [worst, mean, growth] = [worst_frequency, mean_frequency, worst_growth].map(|error| 100.0 * error);
        let Errors { unmatched_reference, unmatched_model, .. } = Errors::worst(&model.errors);
        let found = (0..curves.len()).map(|i| study.found(i, model)).map(|[found, all]| format!("\t{found} of {all}"));
        let unmatched = format!("{unmatched_reference}\t{unmatched_model}\t{}", model.spurious.len());
        let found = found.collect::<String>();
        format!("{}\t{worst:.4}\t{mean:.4}\t{growth:.3}\t{least_mac:.4}\t{unmatched}{found}", model.name)
    };
    aligned(&heading, study.models.iter().map(row)) + "growth rates relative to the largest of the reference\n"
}

/// Where modes become unstable, in models whose modes were followed: a column for each onset of the reference, and one
/// for those that it does not have.
fn onsets_text(study: &Study) -> String {
    let expected = &study.reference.onsets;
    let heads: String = expected.iter().map(|onset| format!("\tat {:.0} Hz", onset.frequency)).collect();
    let row = |model: &StudiedModel| {
        let (own, others) = own_onsets(expected, &model.onsets);
        let own: String = own
            .iter()
            .map(|onset| "\t".to_owned() + &or_dash(*onset, |onset| format!("{:.4}", onset.friction)))
            .collect();
        let others: Vec<String> =
            others.iter().map(|onset| format!("{:.4} ({:.0} Hz)", onset.friction, onset.frequency)).collect();
        format!("{}{own}\t{}", model.name, if others.is_empty() { "-".into() } else { others.join(", ") })
    };
    let followed: Vec<&StudiedModel> = models(study).filter(|model| !model.onsets.is_empty()).collect();
    if followed.is_empty() {
        return String::new();
    }
    aligned(&format!("unstable from friction coefficient{heads}\tothers"), followed.into_iter().map(row))
}

/// For each expected onset that with the nearest frequency, at most 5 % away, the first of several; and the onsets that
/// are left.
fn own_onsets<'a>(expected: &[Onset], all: &'a [Onset]) -> (Vec<Option<&'a Onset>>, Vec<&'a Onset>) {
    let mut left: Vec<&Onset> = all.iter().collect();
    let mut take = |expected: &Onset| {
        let distance = |onset: &&Onset| (onset.frequency / expected.frequency - 1.0).abs();
        let (place, nearest) = left.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
        (distance(nearest) < NEAR).then(|| left.remove(place))
    };
    let own = expected.iter().map(&mut take).collect();
    (own, left)
}

/// An instability by its frequency where it begins to grow.
fn name(curve: &[CurvePoint]) -> String {
    curve.iter().find(|point| point.unstable).map_or_else(String::new, |point| format!("{:.0} Hz", point.frequency))
}

/// An instability over friction in all models: figures 7 and 8 of the paper in numbers.
fn curve_text(study: &Study, i: usize) -> String {
    let cell = |model: &StudiedModel, mu: f64| {
        let point = model.curves[i].iter().find(|point| point.friction == mu);
        or_dash(point, |point| format!("{:.1} {:+.1}", point.frequency, point.growth_rate))
    };
    let line = |name: &str, cell: &dyn Fn(f64) -> String| {
        study.friction_values.iter().fold(name.to_owned(), |line, &mu| line + "\t" + &cell(mu))
    };
    let heading = line("friction", &friction);
    let rows = models(study).map(|model| line(&model.name, &|mu| cell(model, mu)));
    format!(
        "\nthe mode at {}: Hz and growth rate in 1/s\n{}",
        name(&study.reference.curves[i]),
        aligned(&heading, rows)
    )
}

fn spurious_text(study: &Study) -> String {
    let line = |model: &StudiedModel| {
        let one =
            |p: &CurvePoint| format!("{:.1} Hz at {} ({:+.1} /s)", p.frequency, friction(p.friction), p.growth_rate);
        let list: Vec<String> = model.spurious.iter().map(one).collect();
        format!("{} is unstable where the reference is not: {}\n", model.name, list.join(", "))
    };
    study.models.iter().filter(|model| !model.spurious.is_empty()).map(line).collect()
}

/// Errors of a model at a friction value.
#[derive(Default, Serialize)]
struct ErrorsRow<'a> {
    model: &'a str,
    #[serde(flatten)]
    errors: Errors,
}

/// An instability (from 1) in a model at a friction value.
#[derive(Default, Serialize)]
struct CurveRow<'a> {
    instability: usize,
    model: &'a str,
    #[serde(flatten)]
    point: CurvePoint,
}

/// Sizes and times as CSV.
///
/// # Errors
/// The writer's.
pub fn sizes(out: &mut dyn Write, study: &Study) -> Result<()> {
    write_csv(out, models(study).cloned())
}

/// Errors as CSV.
///
/// # Errors
/// The writer's.
pub fn errors(out: &mut dyn Write, study: &Study) -> Result<()> {
    let mut rows = Vec::new();
    for model in &study.models {
        rows.extend(model.errors.iter().map(|&errors| ErrorsRow { model: &model.name, errors }));
    }
    write_csv(out, rows)
}

/// The instabilities over friction as CSV.
///
/// # Errors
/// The writer's.
pub fn curves(out: &mut dyn Write, study: &Study) -> Result<()> {
    let mut rows = Vec::new();
    for model in models(study) {
        for (instability, curve) in (1..).zip(&model.curves) {
            rows.extend(curve.iter().map(|&point| CurveRow { instability, model: &model.name, point }));
        }
    }
    write_csv(out, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::comparison::tests::reference_and_model;

    #[test]
    fn a_study_has_sizes_errors_and_curves() {
        let [reference, model] = reference_and_model();
        let mut study = Study::new(&reference);
        let sizes = Sizes { n_contacts: 104, n_retained: Some(209), n_dofs: 700 };
        study.add("104 contacts", [&reference, &model], sizes, Some(12.5)).unwrap();
        let header = |table: fn(&mut dyn Write, &Study) -> Result<()>| {
            let mut out = Vec::new();
            table(&mut out, &study).unwrap();
            String::from_utf8(out).unwrap().lines().next().unwrap().to_owned() + "\n"
        };
        insta::assert_snapshot!(super::text(&study) + &[super::sizes, errors, curves].map(header).concat());
    }

    #[test]
    fn an_onset_belongs_to_the_nearest_frequency_and_once() {
        let onset = |friction, frequency| Onset { friction, frequency };
        let expected = [onset(0.2, 5900.0), onset(0.3, 1770.0)];
        let all = [onset(0.35, 1780.0), onset(0.25, 5950.0), onset(0.8, 1775.0), onset(0.9, 5100.0)];
        let (own, others) = own_onsets(&expected, &all);
        assert_eq!(own, [Some(&all[1]), Some(&all[2])], "by frequency");
        assert_eq!(others, [&all[0], &all[3]]);
        let (own, others) = own_onsets(&expected, &all[3..]);
        assert_eq!((own, others), (vec![None, None], vec![&all[3]]), "5 % away at most");
    }
}
