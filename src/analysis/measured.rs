//! Measured shapes from a table.

use std::path::Path;

use crate::{Error, Result};

/// A measured shape at some points.
#[derive(Debug)]
pub struct Measured {
    /// Where, in the mesh's unit.
    pub points: Vec<[f64; 3]>,
    /// Unit vectors of the directions.
    pub directions: Vec<[f64; 3]>,
    /// Frequency (Hz) and values of each mode.
    pub modes: Vec<(f64, Vec<f64>)>,
}

/// Reads `x, y, z, direction, FREQUENCY, ...`.
///
/// # Errors
/// [`Error::Input`] with file and line.
pub fn read(path: &Path) -> Result<Measured> {
    let place = path.display().to_string();
    let fail = |reason: csv::Error| Error::input(format!("{place}: the measured modes cannot be read: {reason}"));
    let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(fail)?;
    let header = table.headers().map_err(fail)?.clone();
    let columns: Vec<&str> = header.iter().collect();
    if columns.len() < 5 || columns[..4] != ["x", "y", "z", "direction"] {
        let what = "the first line should read x,y,z,direction and the frequency of each mode in Hz";
        return Err(Error::input(format!("{place}:1: {what}")));
    }
    let number = |line: u64, text: &str| match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Error::input(format!("{place}:{line}: {text:?} is no finite number"))),
    };
    let frequencies = columns[4..].iter().map(|text| number(1, text)).collect::<Result<Vec<f64>>>()?;
    if let Some(f) = frequencies.iter().find(|f| **f <= 0.0) {
        return Err(Error::input(format!("{place}:1: a mode has the frequency {f} Hz. Give Hz above 0")));
    }
    let mut modes: Vec<(f64, Vec<f64>)> = frequencies.into_iter().map(|f| (f, Vec::new())).collect();
    let (mut points, mut directions) = (Vec::new(), Vec::new());
    for record in table.records() {
        let record = record.map_err(fail)?;
        let line = record.position().map_or(0, csv::Position::line);
        let at = |i: usize| number(line, &record[i]);
        points.push([at(0)?, at(1)?, at(2)?]);
        let direction = direction(&record[3]).ok_or_else(|| {
            Error::input(format!(
                "{place}:{line}: {:?} is no direction: give x, -y or three numbers \"nx ny nz\"",
                &record[3]
            ))
        })?;
        directions.push(direction);
        for (i, (_, values)) in modes.iter_mut().enumerate() {
            values.push(at(4 + i)?);
        }
    }
    if points.is_empty() {
        return Err(Error::input(format!("{place}: there are no measured points")));
    }
    Ok(Measured { points, directions, modes })
}

/// `x`, `+x`, `-x` and alike, or the components of any vector.
fn direction(text: &str) -> Option<[f64; 3]> {
    let (sign, axis) = match text.strip_prefix('-') {
        Some(axis) => (-1.0, axis),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    if let Some(i) = ["x", "y", "z"].iter().position(|name| name.eq_ignore_ascii_case(axis)) {
        return Some(std::array::from_fn(|k| if k == i { sign } else { 0.0 }));
    }
    let parts: Vec<f64> = text.split_whitespace().map(str::parse).collect::<std::result::Result<_, _>>().ok()?;
    let vector: [f64; 3] = parts.try_into().ok()?;
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length.is_normal()).then(|| vector.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_axes_or_vectors() {
        assert_eq!(direction("-Y"), Some([0.0, -1.0, 0.0]));
        assert_eq!(direction("0 3 4"), Some([0.0, 0.6, 0.8]));
        assert_eq!((direction("up"), direction("0 0 0"), direction("1 2")), (None, None, None));
    }
}
