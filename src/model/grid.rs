//! Tables on a full grid: rows of values, then the arguments that they belong to, linear between neighbours.

/// Rows on the full grid of N variables.
pub struct Grid<const N: usize> {
    /// Rising values of each variable; one where the table does not depend on it.
    pub axes: [Vec<f64>; N],
    /// The rows, by the first variable, in it by the second, and so on.
    pub rows: Vec<Vec<f64>>,
}

impl<const N: usize> Grid<N> {
    /// Orders rows that have a variable's value at its column, where there is one; none where a combination of values
    /// is missing or there twice.
    pub fn new(rows: &[Vec<f64>], columns: [Option<usize>; N]) -> Option<Grid<N>> {
        let place = |row: &[f64]| columns.map(|column| column.map_or(0.0, |column| row[column]));
        let axes = std::array::from_fn(|variable| {
            let mut values: Vec<f64> = rows.iter().map(|row| place(row)[variable]).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        });
        let mut sorted = rows.to_vec();
        sorted.sort_by(|a, b| place(a).partial_cmp(&place(b)).expect("all are finite"));
        // A full grid has as many rows as combinations, and no combination twice.
        let is_twice = sorted.windows(2).any(|pair| place(&pair[0]) == place(&pair[1]));
        let n_combinations = axes.iter().map(Vec::len).product::<usize>();
        (!is_twice && rows.len() == n_combinations).then_some(Grid { axes, rows: sorted })
    }
}

/// The column of each variable in rows that begin with so many values, where the table depends on it; none where `by`
/// has an unknown variable or one twice.
pub fn columns<const N: usize>(variables: [&str; N], by: &[&str], n_values: usize) -> Option<[Option<usize>; N]> {
    let mut columns = [None; N];
    for (i, name) in by.iter().enumerate() {
        let variable = variables.iter().position(|known| known == name)?;
        if columns[variable].replace(i + n_values).is_some() {
            return None;
        }
    }
    Some(columns)
}

/// Where an argument lies among rising values.
pub struct GridInterval {
    /// Place of the last value that is not above the argument; the first beyond that end.
    pub lower: usize,
    /// Place of the next value; `lower` beyond the ends.
    pub upper: usize,
    /// How far the argument is on the way; 0 beyond the ends.
    fraction: f64,
    /// 1 over the distance of the two values; 0 beyond the ends.
    per_unit: f64,
}

impl GridInterval {
    /// The interval that x is in; at a value that is the one above it.
    pub fn around(values: &[f64], x: f64) -> GridInterval {
        let above = values.partition_point(|&value| value <= x);
        if above == 0 || above == values.len() {
            let lower = above.saturating_sub(1);
            return GridInterval { lower, upper: lower, fraction: 0.0, per_unit: 0.0 };
        }
        let (lower, upper) = (above - 1, above);
        let per_unit = 1.0 / (values[upper] - values[lower]);
        GridInterval { lower, upper, fraction: per_unit * (x - values[lower]), per_unit }
    }

    /// A function linear between its values at the two ends.
    pub fn between(&self, lower: f64, upper: f64) -> f64 {
        lower + self.fraction * (upper - lower)
    }

    /// Its slope.
    pub fn slope(&self, lower: f64, upper: f64) -> f64 {
        self.per_unit * (upper - lower)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_between_their_neighbours_and_at_the_ends_beyond() {
        let values = [1.0, 2.0, 4.0];
        for (x, expected) in [
            (0.5, (0, 0, 0.0)),
            (1.0, (0, 1, 0.0)),
            (1.5, (0, 1, 0.5)),
            (2.0, (1, 2, 0.0)),
            (3.5, (1, 2, 0.75)),
            (4.0, (2, 2, 0.0)),
            (9.0, (2, 2, 0.0)),
        ] {
            let GridInterval { lower, upper, fraction, .. } = GridInterval::around(&values, x);
            assert_eq!((lower, upper, fraction), expected, "{x}");
        }
        assert_eq!(GridInterval::around(&[3.0], 7.0).upper, 0);
    }

    #[test]
    fn rows_are_in_the_order_of_the_grid_and_complete() {
        let rows = [[7.0, 2.0, 30.0], [5.0, 1.0, 30.0], [6.0, 2.0, 20.0], [4.0, 1.0, 20.0]].map(|row| row.to_vec());
        let grid = Grid::new(&rows, [Some(1), Some(2)]).unwrap();
        assert_eq!(grid.axes, [[1.0, 2.0], [20.0, 30.0]]);
        assert_eq!(grid.rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [4.0, 5.0, 6.0, 7.0]);
        assert!(Grid::new(&rows[1..], [Some(1), Some(2)]).is_none(), "a combination is missing");
        assert!(Grid::new(&rows, [Some(1), None]).is_none(), "each is there twice");
    }

    #[test]
    fn columns_follow_the_values() {
        assert_eq!(columns(["f", "t"], &["t", "f"], 2), Some([Some(3), Some(2)]));
        assert_eq!(columns(["f", "t"], &["t"], 1), Some([None, Some(1)]));
        assert_eq!(columns(["f", "t"], &["t", "t"], 1), None);
        assert_eq!(columns(["f", "t"], &["p"], 1), None);
    }
}
