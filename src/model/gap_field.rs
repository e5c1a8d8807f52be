//! Gap fields: a measured topography of a contact surface, or what wear has taken off it, from a table or an image
//! ([`super::gap_image`]).
//!
//! ```text
//! contact,x_mm,y_mm,z_mm,gap_um    a head with units; two coordinates are enough; contact may be missing
//! disc / pad,12.5,98,0,3.2         rows in any order; other columns are left alone
//! ```
//!
//! A table of factors on the contact stiffness has the column `factor` in place of `gap_um`.

use std::path::{Path, PathBuf};

use csv::{Position, ReaderBuilder, StringRecord, Trim};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use serde::{Deserialize, Serialize};

use super::gap_image::{GapImage, ImageFrame};
use super::paths;
use super::read::UNITS;
use crate::algebra::{norm, sub};

/// Gaps (m) at points (m) of a contact surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GapField {
    /// The table or the image.
    #[serde(with = "paths::one")]
    pub file: PathBuf,
    gaps: Gaps,
}

/// Factors on the contact stiffness at points of a contact surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StiffnessField {
    /// The table.
    #[serde(with = "paths::one")]
    pub file: PathBuf,
    factors: Table,
}

impl StiffnessField {
    /// Reads the rows of a contact: all rows where the table has no column `contact`.
    ///
    /// # Errors
    /// What is wrong, with the line.
    pub fn read(file: &Path, contact: &str) -> Result<StiffnessField, String> {
        let factors = Table::read(file, contact, Quantity::Factor)?;
        StiffnessField::checked(file, factors)
    }

    /// The factors of points (m) themselves. `file` is what messages call them.
    ///
    /// # Errors
    /// What is wrong where a factor is not above 0.
    pub fn of_points(file: &Path, rows: Vec<([f64; 3], f64)>) -> Result<StiffnessField, String> {
        StiffnessField::checked(file, Table { axes: [true; 3], rows })
    }

    fn checked(file: &Path, factors: Table) -> Result<StiffnessField, String> {
        match factors.rows.iter().find(|(_, factor)| *factor <= 0.0) {
            Some((_, factor)) => Err(format!("{}: a factor is {factor}, not above 0", file.display())),
            None => Ok(StiffnessField { file: file.to_owned(), factors }),
        }
    }

    /// The factors at points (m) of a surface, as [`GapField::at`] interpolates.
    ///
    /// # Errors
    /// What is wrong where the rows do not cover the surface.
    pub fn at(&self, points: &[[f64; 3]]) -> Result<Vec<f64>, String> {
        self.factors.at(points).map_err(|what| format!("{}: {what}", self.file.display()))
    }
}

/// What a file has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Gaps {
    Table(Table),
    Image(GapImage),
}

/// Rows with places and gaps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Table {
    /// Which coordinates it has.
    axes: [bool; 3],
    /// Points, 0 along the axes that it does not have, and their gaps or factors.
    rows: Vec<([f64; 3], f64)>,
}

/// A gap is interpolated between so many rows.
const N_NEIGHBOURS: usize = 4;
/// A point this near to a row (m) has its gap.
const SAME_PLACE: f64 = 1e-9;
/// The nearest row of a point is within this fraction of the surface's size, or the table is of another surface.
const REACH: f64 = 0.25;

type Row = GeomWithData<[f64; 3], f64>;

impl GapField {
    /// Reads the rows of a contact: all rows where the table has no column `contact`.
    ///
    /// # Errors
    /// What is wrong, with the line.
    pub fn read(file: &Path, contact: &str) -> Result<GapField, String> {
        Ok(GapField { file: file.to_owned(), gaps: Gaps::Table(Table::read(file, contact, Quantity::Gap)?) })
    }

    /// The gaps (m) of points (m) themselves. `file` is what messages call them.
    pub fn of_points(file: &Path, rows: Vec<([f64; 3], f64)>) -> GapField {
        GapField { file: file.to_owned(), gaps: Gaps::Table(Table { axes: [true; 3], rows }) }
    }

    /// Reads an image (PNG) that lies as the frame says.
    ///
    /// # Errors
    /// What is wrong.
    pub fn read_image(file: &Path, frame: ImageFrame) -> Result<GapField, String> {
        Ok(GapField { file: file.to_owned(), gaps: Gaps::Image(GapImage::read(file, frame)?) })
    }

    /// Where the image lies; none of a table.
    pub fn frame(&self) -> Option<ImageFrame> {
        match &self.gaps {
            Gaps::Table(_) => None,
            Gaps::Image(image) => Some(image.frame),
        }
    }

    /// The gaps (m) at points (m) of a surface: of a table between the nearest rows with weights `1/r^2`, so that a
    /// row's own place has its gap; of an image bilinear between its pixels.
    ///
    /// # Errors
    /// What is wrong where rows or image do not cover the surface.
    pub fn at(&self, points: &[[f64; 3]]) -> Result<Vec<f64>, String> {
        let gaps = match &self.gaps {
            Gaps::Table(table) => table.at(points),
            Gaps::Image(image) => points.iter().map(|&x| image.at(x)).collect(),
        };
        gaps.map_err(|what| format!("{}: {what}", self.file.display()))
    }

    /// The gap (m) of the row that stands at a point (m), if there is one.
    pub fn of_row_at(&self, point: [f64; 3]) -> Option<f64> {
        let Gaps::Table(table) = &self.gaps else { return None };
        let point = table.flat(&point);
        table.rows.iter().find(|(x, _)| norm(sub(*x, point)) <= SAME_PLACE).map(|(_, gap)| *gap)
    }
}

/// What the rows of a table have.
#[derive(Clone, Copy)]
enum Quantity {
    Gap,
    Factor,
}

impl Table {
    fn read(file: &Path, contact: &str, quantity: Quantity) -> Result<Table, String> {
        let place = file.display();
        let what = match quantity {
            Quantity::Gap => "gaps",
            Quantity::Factor => "factors",
        };
        let fail = |reason: csv::Error| format!("the {what} of {place} cannot be read: {reason}");
        let mut table = ReaderBuilder::new().trim(Trim::All).from_path(file).map_err(fail)?;
        let columns = Columns::of(table.headers().map_err(fail)?, quantity);
        let columns = columns.map_err(|what| format!("{place}:1: {what}"))?;
        let mut rows = Vec::new();
        for record in table.records() {
            let record = record.map_err(fail)?;
            if columns.contact.is_none_or(|column| &record[column] == contact) {
                let line = record.position().map_or(0, Position::line);
                rows.push(columns.row(&record).map_err(|what| format!("{place}:{line}: {what}"))?);
            }
        }
        match rows.is_empty() {
            true => Err(format!("{place} has no row of this contact")),
            false => Ok(Table { axes: columns.place.map(|column| column.is_some()), rows }),
        }
    }

    /// A place without the coordinates that the table does not have.
    fn flat(&self, x: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| if self.axes[i] { x[i] } else { 0.0 })
    }

    fn at(&self, points: &[[f64; 3]]) -> Result<Vec<f64>, String> {
        let points: Vec<[f64; 3]> = points.iter().map(|x| self.flat(x)).collect();
        let tree = RTree::bulk_load(self.rows.iter().map(|(x, gap)| Row::new(*x, *gap)).collect());
        let reach = REACH * extent(&points);
        let gap = |x: &[f64; 3]| {
            let near: Vec<(f64, f64)> = tree
                .nearest_neighbor_iter_with_distance_2(*x)
                .take(N_NEIGHBOURS)
                .map(|(row, square)| (row.data, square))
                .collect();
            let distance = near[0].1.sqrt();
            match distance <= reach.max(SAME_PLACE) {
                true => Ok(interpolated(&near)),
                false => Err(format!(
                    "no row lies within {reach:.1e} m of the contact point at {x:?} m, the nearest is {distance:.1e} m away"
                )),
            }
        };
        points.iter().map(gap).collect()
    }
}

/// The mean of gaps by the squares of their distances: `sum gap / r^2 / sum 1 / r^2`; the nearest comes first.
fn interpolated(near: &[(f64, f64)]) -> f64 {
    if near[0].1 <= SAME_PLACE * SAME_PLACE {
        return near[0].0;
    }
    let sum: f64 = near.iter().map(|(gap, square)| gap / square).sum();
    sum / near.iter().map(|(_, square)| 1.0 / square).sum::<f64>()
}

/// Diagonal of the box around points.
fn extent(points: &[[f64; 3]]) -> f64 {
    let bound = |i: usize, of: fn(f64, f64) -> f64, start: f64| points.iter().map(|x| x[i]).fold(start, of);
    norm([0, 1, 2].map(|i| (bound(i, f64::max, f64::NEG_INFINITY) - bound(i, f64::min, f64::INFINITY)).max(0.0)))
}

/// A column and metres per unit of its numbers.
type Column = (usize, f64);

/// Where the quantities stand in the rows.
struct Columns {
    contact: Option<usize>,
    place: [Option<Column>; 3],
    value: Column,
}

impl Columns {
    fn of(head: &StringRecord, quantity: Quantity) -> Result<Columns, String> {
        let find = |wanted: &str| {
            let column = |(i, name): (usize, &str)| {
                let (quantity, unit) = name.rsplit_once('_')?;
                let metres = UNITS.iter().find(|(known, _)| *known == unit)?.1;
                (quantity == wanted).then_some((i, metres))
            };
            head.iter().enumerate().find_map(column)
        };
        let place = ["x", "y", "z"].map(find);
        let called = |wanted: &str| head.iter().position(|name| name == wanted);
        let (value, missing) = match quantity {
            Quantity::Gap => (find("gap"), "there is no column gap_um, gap_mm or gap_m"),
            Quantity::Factor => (called("factor").map(|column| (column, 1.0)), "there is no column factor"),
        };
        match (value, place.iter().flatten().count()) {
            (None, _) => Err(missing.into()),
            (_, 0 | 1) => Err("there are fewer than two of the columns x_mm, y_mm, z_mm (or x_m and so on)".into()),
            (Some(value), _) => Ok(Columns { contact: called("contact"), place, value }),
        }
    }

    fn row(&self, record: &StringRecord) -> Result<([f64; 3], f64), String> {
        let number = |(i, metres): Column| match record[i].parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(metres * value),
            _ => Err(format!("{:?} is no finite number", &record[i])),
        };
        let mut place = [0.0; 3];
        for (x, column) in place.iter_mut().zip(self.place) {
            *x = column.map_or(Ok(0.0), number)?;
        }
        Ok((place, number(self.value)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(text: &str) -> Result<GapField, String> {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("gap.csv");
        std::fs::write(&file, text).unwrap();
        GapField::read(&file, "disc / pad")
    }

    #[test]
    fn a_table_has_units_in_its_head_and_rows_by_contact() {
        let text = "gap_um, y_mm, remark, x_cm, contact\n2, 100, a, 1, disc / pad\n9, 0, b, 0, other\n3, 50, c, 2, disc / pad\n";
        let field = field(text).unwrap();
        let Gaps::Table(table) = &field.gaps else { panic!("a table") };
        assert_eq!((table.axes, table.rows.len(), field.frame()), ([true, true, false], 2, None));
        let found = field.at(&[[0.02, 0.05, 7.0], [0.01, 0.1, -1.0]]).unwrap();
        assert!((found[0] - 3e-6).abs() < 1e-20 && (found[1] - 2e-6).abs() < 1e-20, "{found:?}");
    }

    #[test]
    fn a_table_of_factors_has_them_above_zero() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("factors.csv");
        let read = |text: &str| {
            std::fs::write(&file, text).unwrap();
            StiffnessField::read(&file, "pad")
        };
        let field = read("contact,x_mm,y_mm,factor\npad,1,0,0.5\npad,5,0,2\nother,1,0,-7\n").unwrap();
        assert_eq!(field.at(&[[0.001, 0.0, 3.0], [0.005, 0.0, 0.0]]).unwrap(), [0.5, 2.0]);
        assert!(read("x_mm,y_mm,factor\n1,0,0\n").unwrap_err().contains("a factor is 0, not above 0"));
        assert!(read("x_mm,y_mm,gap_um\n1,0,1\n").unwrap_err().contains(":1: there is no column factor"));
    }

    #[test]
    fn between_rows_a_gap_is_their_mean_by_the_squares_of_distances() {
        let field = field("x_m,z_m,gap_m\n0,0,1\n1,0,2\n0,1,1\n1,1,2\n9,9,5\n").unwrap();
        let found = field.at(&[[0.5, 3.0, 0.5], [0.25, 3.0, 0.5], [1.0, 0.0, 0.0], [9.0, 0.0, 9.0]]).unwrap();
        // 1/r^2 = 1/0.3125 and 1/0.8125, twice each
        let (near, far) = (1.0 / 0.3125, 1.0 / 0.8125);
        assert!((found[0] - 1.5).abs() < 1e-15);
        assert!((found[1] - (near + 2.0 * far) / (near + far)).abs() < 1e-14);
        assert_eq!(found[2..], [2.0, 5.0]);
    }

    #[test]
    fn tables_of_another_surface_or_unit_are_refused() {
        let field = field("x_m,y_m,gap_m\n100,0,1\n").unwrap();
        let message = field.at(&[[0.1, 0.0, 0.0], [0.1, 0.05, 0.0]]).unwrap_err();
        assert!(
            message.contains("gap.csv: no row lies") && message.contains("the nearest is 1.0e2 m away"),
            "{message}"
        );
    }

    #[test]
    fn what_is_missing_in_a_table_is_named() {
        let message = |text: &str| field(text).unwrap_err();
        assert!(message("x_mm,y_mm\n1,2\n").contains(":1: there is no column gap_um"));
        assert!(message("x_mm,gap_um\n1,2\n").contains(":1: there are fewer than two of the columns"));
        assert!(message("x_mm,y_mm,gap_um\n1,2,3\n1,2,deep\n").contains(":3: \"deep\" is no finite number"));
        assert!(message("contact,x_mm,y_mm,gap_um\nother,1,2,3\n").contains("has no row of this contact"));
        assert!(GapField::read("no.csv".as_ref(), "pad").unwrap_err().contains("cannot be read"));
    }
}
