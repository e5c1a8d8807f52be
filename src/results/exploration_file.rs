//! The results file of a study of many parameters, HDF5.
//!
//! ```text
//! /                attributes: format "squeal exploration", version 1
//! about            text, TOML: the fields of [`super::About`]
//! parameters       text, TOML: [[parameter]] name, keys, factor, nominal, from and to (quantiles 5 and 95 %),
//!                  difference (how its derivatives were found)
//! failures         text, TOML: [[failure]] point, reason
//! values           n x k    values of the k parameters at the points; the first one is the nominal one
//! status           n        1: modes were found, 0: the point has failed
//! modes            one row a mode, point after point, by frequency: point, growth_rate (1/s), omega (rad/s),
//!                  backward_error, unstable (0 or 1), nominal (number of the nominal mode from 1; 0: none), share,
//!                  doubtful (0 or 1)
//! gradients        k x m x 2   derivatives of the m nominal modes by each parameter: growth rate (1/s) and omega
//!                  (rad/s) per unit of the parameter; NaN where there is none
//! surface/         nodes, triangles and part, as in the results file of `stability`; empty where there are no shapes
//! shaped           s        rows of `modes` that have a shape: of each point its unstable modes of largest growth
//!                  rate, three at most, or where none is unstable the mode of largest growth rate
//! shapes           s x n_s x 3 x 2   their displacements at the nodes of the surface, the last index real and
//!                  imaginary part; the largest of a shape is 1 and real
//! unstable, instabilities, hopf, bins, growth_rate, indices
//!                  the answers: tables of numbers, NaN where there is none, whose attributes `columns` and `units`
//!                  have a word a column
//! ```
//!
//! Arrays of other numbers have the attribute `units`, too.

use std::path::Path;

use hdf5::types::FixedUnicode;
use hdf5::{Group, H5Type};
use serde::Serialize;

use super::file::{numbers, write_surface};
use super::{Exploration, Shape};
use crate::Result;
use crate::explore::{
    Estimate, HopfPoint, Indices, Instability, Outcome, Parameter, PointMode, PointResult, Probability, Study,
    shaped_modes,
};
use crate::hdf::{self, Format, array, array_of_rows, list, table, text};

const FORMAT: Format =
    Format { name: "squeal exploration", version: 1, advice: "Make the results again with the same command" };

/// A mode at a point.
#[derive(H5Type, Clone, Copy)]
#[repr(C)]
struct ModeRow {
    point: u32,
    growth_rate: f64,
    omega: f64,
    backward_error: f64,
    unstable: u8,
    nominal: u32,
    share: f64,
    doubtful: u8,
}

impl ModeRow {
    fn new(point: u32, mode: &PointMode) -> ModeRow {
        ModeRow {
            point,
            growth_rate: mode.lambda.re,
            omega: mode.lambda.im,
            backward_error: mode.backward_error,
            unstable: u8::from(mode.unstable),
            nominal: mode.link.map_or(0, |link| link.nominal as u32),
            share: mode.link.map_or(0.0, |link| link.share),
            doubtful: u8::from(mode.link.is_some_and(|link| link.doubtful)),
        }
    }
}

#[derive(Serialize)]
struct Parameters {
    parameter: Vec<ParameterText>,
}

#[derive(Serialize)]
struct ParameterText {
    name: String,
    keys: Vec<String>,
    factor: bool,
    nominal: f64,
    from: f64,
    to: f64,
    difference: String,
}

#[derive(Serialize)]
struct Failures {
    failure: Vec<FailureText>,
}

#[derive(Serialize)]
struct FailureText {
    point: usize,
    reason: String,
}

/// Whether a file has the results of a study of many parameters. Not collective.
pub fn is_one(path: &Path) -> bool {
    hdf::is_of(path, &FORMAT)
}

/// Bytes of an attribute: the names or units of a table's columns.
const MAX_ATTRIBUTE_LENGTH: usize = 256;

/// The shapes of a point by its number, in the order of [`shaped_modes`].
pub type ShapesOf<'a> = &'a mut dyn FnMut(usize) -> Result<Vec<Shape>>;

/// Writes what a study has found, with the shapes of each point; the file appears when it is complete. Not collective.
///
/// # Errors
/// The system's and HDF5's, with the path; those of the shapes.
pub fn write(path: &Path, study: &Study, found: &Exploration, shapes_of: ShapesOf) -> Result<()> {
    hdf::create(path, &FORMAT, |file| {
        words(file, "about", &found.about)?;
        words(file, "parameters", &parameters(study, found))?;
        words(file, "failures", &Failures { failure: failures(&found.points) })?;
        let values: Vec<f64> = found.points.iter().flat_map(|point| point.values.iter().copied()).collect();
        table(file, "values", study.parameters.len(), &values)?;
        let status: Vec<u8> = found.points.iter().map(|point| u8::from(point.modes().is_some())).collect();
        list(file, "status", &status)?;
        let rows = |(point, own): (u32, &PointResult)| -> Vec<ModeRow> {
            own.modes().unwrap_or_default().iter().map(|mode| ModeRow::new(point, mode)).collect()
        };
        list(file, "modes", &(0..).zip(&found.points).flat_map(rows).collect::<Vec<_>>())?;
        word(file, "modes", "units", "-,1/s,rad/s,-,-,-,-,-")?;
        write_gradients(file, study, found)?;
        write_shapes(file, found, shapes_of)?;
        write_answers(file, found)
    })
}

fn parameters(study: &Study, found: &Exploration) -> Parameters {
    let text = |(i, own): (usize, &Parameter)| {
        let [from, to] = own.range();
        ParameterText {
            name: own.name.clone(),
            keys: own.keys.iter().map(|key| key.text().to_owned()).collect(),
            factor: own.is_factor,
            nominal: found.points[0].values[i],
            from,
            to,
            difference: found.gradients.get(i).map_or("", |gradient| gradient.difference.text()).to_owned(),
        }
    };
    Parameters { parameter: study.parameters.iter().enumerate().map(text).collect() }
}

fn failures(points: &[PointResult]) -> Vec<FailureText> {
    let failure = |(point, own): (usize, &PointResult)| match &own.outcome {
        Outcome::Failed(reason) => Some(FailureText { point, reason: reason.clone() }),
        Outcome::Modes(_) => None,
    };
    points.iter().enumerate().filter_map(failure).collect()
}

fn write_gradients(file: &Group, study: &Study, found: &Exploration) -> hdf5::Result<()> {
    let n_modes = found.points[0].modes().map_or(0, <[PointMode]>::len);
    let slope = |parameter: usize, mode: usize| {
        let slope = found.gradients.get(parameter).and_then(|gradient| gradient.slopes.get(mode));
        slope.map_or([f64::NAN; 2], |slope| [slope.re, slope.im])
    };
    let n = study.parameters.len();
    let numbers: Vec<f64> = (0..n).flat_map(|i| (0..n_modes).flat_map(move |j| slope(i, j))).collect();
    array(file, "gradients", &[n, n_modes, 2], &numbers)?;
    word(file, "gradients", "units", "1/s,rad/s")
}

/// Shapes are not all in memory at the same time.
fn write_shapes(file: &Group, found: &Exploration, shapes_of: ShapesOf) -> hdf5::Result<()> {
    write_surface(file, &found.surface)?;
    word(file, "surface/nodes", "units", "m")?;
    let n_nodes = found.surface.nodes.len();
    let points: &[PointResult] = if n_nodes == 0 { &[] } else { &found.points };
    let (mut rows, mut first): (Vec<u32>, usize) = (Vec::new(), 0);
    for modes in points.iter().filter_map(PointResult::modes) {
        rows.extend(shaped_modes(modes).into_iter().map(|mode| (first + mode) as u32));
        first += modes.len();
    }
    list(file, "shaped", &rows)?;
    let of_point = |point| -> Vec<hdf5::Result<Vec<f32>>> {
        match shapes_of(point) {
            Ok(shapes) => shapes.iter().map(|shape| Ok(numbers(shape).collect())).collect(),
            Err(error) => vec![Err(error.to_string().into())],
        }
    };
    let solved = (0..points.len()).filter(|&i| points[i].modes().is_some());
    array_of_rows(file, "shapes", [rows.len(), n_nodes, 3, 2], solved.flat_map(of_point))?;
    word(file, "shapes", "units", "-")
}

fn write_answers(file: &Group, found: &Exploration) -> hdf5::Result<()> {
    let answers = &found.answers;
    let own = |p: &Probability| [p.n_true as f64, p.n_points as f64, p.value, p.low, p.high];
    let (names, units) = ("n_true,n_points,value,low,high", "-,-,-,-,-");
    named(file, "unstable", [names, units], &[own(&answers.unstable).to_vec()])?;
    let bins = answers.bins.iter().map(|bin| [&[bin.from_hz, bin.to_hz][..], &own(&bin.probability)].concat());
    let columns = [format!("from_hz,to_hz,{names}"), format!("Hz,Hz,{units}")];
    named(file, "bins", columns.each_ref().map(String::as_str), &bins.collect::<Vec<_>>())?;
    let of_mode = "nominal,nominal_frequency,lowest_frequency,highest_frequency,largest_growth_rate,worst";
    let instability = |one: &Instability| {
        let [lowest, highest] = one.frequency_range_hz;
        let nominal = one.nominal.map_or(f64::NAN, |n| n as f64);
        let frequency = one.nominal_frequency_hz.unwrap_or(f64::NAN);
        let numbers = [nominal, frequency, lowest, highest, one.largest_growth_rate_per_s, one.worst as f64];
        let by_derivatives = one.by_derivatives.map_or([f64::NAN; 3], |own| [own.value, own.low, own.high]);
        [&numbers[..], &own(&one.probability), &by_derivatives].concat()
    };
    let by_derivatives = "by_derivatives,by_derivatives_low,by_derivatives_high";
    let columns = [format!("{of_mode},{names},{by_derivatives}"), format!("-,Hz,Hz,Hz,1/s,-,{units},-,-,-")];
    let rows: Vec<Vec<f64>> = answers.instabilities.iter().map(instability).collect();
    named(file, "instabilities", columns.each_ref().map(String::as_str), &rows)?;
    let hopf = |own: &HopfPoint| {
        let nominal = own.nominal.map_or(f64::NAN, |n| n as f64);
        [&own.values[..], &[own.frequency_hz, nominal]].concat()
    };
    let rows: Vec<Vec<f64>> = answers.hopf.points.iter().map(hopf).collect();
    named(file, "hopf", ["first_parameter,second_parameter,frequency,nominal", "-,-,Hz,-"], &rows)?;
    let quantiles = answers.growth_rate.iter().map(|own| vec![own.fraction, own.growth_rate_per_s]);
    named(file, "growth_rate", ["fraction,growth_rate", "-,1/s"], &quantiles.collect::<Vec<_>>())?;
    let three = |own: &Estimate| [own.value, own.low, own.high];
    let indices = |own: &Indices| [three(&own.first_order), three(&own.total)].concat();
    let indices: Vec<Vec<f64>> = answers.indices.iter().flatten().map(indices).collect();
    named(file, "indices", ["first,first_low,first_high,total,total_low,total_high", "-,-,-,-,-,-"], &indices)
}

/// A table of numbers, with a word a column for its names and its units.
fn named(file: &Group, name: &str, [columns, units]: [&str; 2], rows: &[Vec<f64>]) -> hdf5::Result<()> {
    table(file, name, columns.split(',').count(), &rows.concat())?;
    word(file, name, "columns", columns)?;
    word(file, name, "units", units)
}

/// An attribute of an array.
fn word(file: &Group, name: &str, attribute: &str, value: &str) -> hdf5::Result<()> {
    let value: FixedUnicode<MAX_ATTRIBUTE_LENGTH> =
        value.parse().map_err(|reason| hdf5::Error::from(format!("{reason:?}")))?;
    file.dataset(name)?.new_attr::<FixedUnicode<MAX_ATTRIBUTE_LENGTH>>().create(attribute)?.write_scalar(&value)
}

/// Keeps a record as TOML.
fn words(group: &Group, name: &str, record: &impl Serialize) -> hdf5::Result<()> {
    text(group, name, &toml::to_string(record).map_err(|reason| hdf5::Error::from(reason.to_string()))?)
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::explore::{Answers, Difference, Gradient, Link};
    use crate::model::InstabilityCriterion;
    use crate::results::{About, Surface};

    /// A study with two points that have modes and one that has failed.
    fn study_and_results(place: &Path) -> (Study, Exploration) {
        let file = place.join("explore.toml");
        let study = "model = \"m.toml\"\nbin = 100\n[design]\nkind = \"sobol\"\npoints = 2\n\
            [parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.6]\n[parameter.p]\nkey = \"pressure\"\nvalues = [1]\n";
        std::fs::write(&file, study).unwrap();
        let study = crate::explore::read(&file).unwrap();
        let link = Some(Link { nominal: 1, share: 0.5, doubtful: true });
        let mode = PointMode { lambda: Complex64::new(2.0, 600.0), unstable: true, backward_error: 1e-12, link };
        let point = |mu, outcome| PointResult { values: vec![mu, 1.0], outcome };
        let points = vec![
            point(0.4, Outcome::Modes(vec![mode])),
            point(0.5, Outcome::Modes(vec![mode, PointMode { link: None, ..mode }])),
            point(0.6, Outcome::Failed("no \"equilibrium\"".into())),
        ];
        let slopes = vec![Complex64::new(1.0, -3.0)];
        let none = Gradient { slopes: Vec::new(), difference: Difference::None("lost".into()) };
        let gradients = vec![Gradient { slopes, difference: Difference::Central }, none];
        let answers = Answers::new(&study, &points, &gradients, [0.0, 200.0], InstabilityCriterion::default());
        let found = Exploration {
            about: About::default(),
            points,
            gradients,
            answers,
            worst: None,
            contacts: None,
            fields: Vec::new(),
            surface: Surface { nodes: vec![[0.0; 3]; 2], ..Surface::default() },
            shapes: Vec::new(),
        };
        (study, found)
    }

    /// Shapes at two nodes, one more for each point; the first number names point and mode.
    fn shapes_of(number: usize) -> Result<Vec<Shape>> {
        let shape = |x: f32| Shape { re: vec![[x, 1.0, 0.0]; 2], im: vec![[0.5, 0.0, -x]; 2] };
        Ok((0..=number).map(|mode| shape((10 * number + mode) as f32)).collect())
    }

    #[test]
    fn a_file_has_points_modes_gradients_and_answers() {
        let place = tempfile::tempdir().unwrap();
        let (study, found) = study_and_results(place.path());
        let path = place.path().join("results.h5");
        write(&path, &study, &found, &mut shapes_of).unwrap();
        assert!(is_one(&path));
        let file = hdf::open(&path, &FORMAT).unwrap();
        let numbers = |name: &str| hdf::values::<f64>(&file, name).unwrap();
        assert_eq!(numbers("values"), [0.4, 1.0, 0.5, 1.0, 0.6, 1.0]);
        assert_eq!(hdf::values::<u8>(&file, "status").unwrap(), [1, 1, 0]);
        let modes: Vec<ModeRow> = hdf::values(&file, "modes").unwrap();
        assert_eq!(modes.iter().map(|mode| (mode.point, mode.nominal)).collect::<Vec<_>>(), [(0, 1), (1, 1), (1, 0)]);
        let slopes = numbers("gradients");
        assert!(slopes[..2] == [1.0, -3.0] && slopes[2..].iter().all(|slope| slope.is_nan()));
        assert_eq!(numbers("bins")[..5], [0.0, 100.0, 1.0, 1.0, 1.0]);
        let columns: FixedUnicode<MAX_ATTRIBUTE_LENGTH> =
            file.dataset("instabilities").unwrap().attr("columns").unwrap().read_scalar().unwrap();
        let n_columns = columns.split(',').count();
        assert_eq!(file.dataset("instabilities").unwrap().shape(), [2, n_columns]);
        assert!(hdf::read_text(&file, "failures").unwrap().contains("point = 2"));
        assert!(hdf::read_text(&file, "parameters").unwrap().contains("difference = \"lost\""));
    }

    #[test]
    fn a_file_has_the_shapes_of_the_points_and_none_may_be_missing() {
        let place = tempfile::tempdir().unwrap();
        let (study, found) = study_and_results(place.path());
        let path = place.path().join("results.h5");
        write(&path, &study, &found, &mut shapes_of).unwrap();
        let file = hdf::open(&path, &FORMAT).unwrap();
        assert_eq!(hdf::values::<u32>(&file, "shaped").unwrap(), [0, 2, 1]);
        let shapes: Vec<f32> = hdf::values(&file, "shapes").unwrap();
        assert_eq!(file.dataset("shapes").unwrap().shape(), [3, 2, 3, 2]);
        assert_eq!(shapes[24..30], [11.0, 0.5, 1.0, 0.0, 0.0, -11.0]);
        drop(file);
        assert!(write(&path, &study, &found, &mut |_| Ok(Vec::new())).is_err(), "shapes are missing");
    }
}
