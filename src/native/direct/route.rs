//! How solutions get from where MUMPS has them to the ranks that own them.

use super::mumps_data::Real;
use crate::native::Comm;

/// How the unknowns get from where MUMPS has them to the ranks that own them.
pub(super) struct Route {
    /// Of this rank: where MUMPS has the unknown, and its row.
    own: Vec<(usize, usize)>,
    /// For each other rank, where MUMPS has its unknowns here.
    sent: Vec<Vec<usize>>,
    /// For each other rank, the rows of the unknowns that it has for this one.
    received: Vec<Vec<usize>>,
}

impl Route {
    /// For unknowns by their global numbers from 1; this rank owns `n` from the `first` on. Collective.
    pub(super) fn new(comm: &Comm, unknowns: &[i32], first: usize, n: usize) -> Route {
        let ends = comm.join(&[first + n]);
        let (mut own, mut sent) = (Vec::new(), vec![Vec::new(); comm.size()]);
        for (place, &unknown) in unknowns.iter().enumerate() {
            let row = unknown as usize - 1;
            let owner = ends.partition_point(|&end| end <= row);
            if owner == comm.rank() {
                own.push((place, row - first));
            } else {
                sent[owner].push(place);
            }
        }
        let rows = |places: &Vec<usize>| places.iter().map(|&place| unknowns[place] - 1).collect();
        let received = comm.exchange(&sent.iter().map(rows).collect::<Vec<_>>());
        let rows = |numbers: Vec<i32>| numbers.iter().map(|&row| row as usize - first).collect();
        Route { own, sent, received: received.into_iter().map(rows).collect() }
    }

    /// Brings solutions, times their scales and those of the rows. Collective.
    pub(super) fn bring<T: Real>(
        &self,
        comm: &Comm,
        solution: &[T],
        n_unknowns: usize,
        x: &mut [f64],
        [scales, of_rows]: [&[f64]; 2],
    ) {
        let n = of_rows.len();
        let column = |j: usize| &solution[j * n_unknowns..(j + 1) * n_unknowns];
        let packed = |places: &Vec<usize>| -> Vec<T> {
            (0..scales.len()).flat_map(|j| places.iter().map(move |&place| column(j)[place])).collect()
        };
        let others = comm.exchange(&self.sent.iter().map(packed).collect::<Vec<_>>());
        for (j, &scale) in scales.iter().enumerate() {
            let x = &mut x[j * n..(j + 1) * n];
            let mut set = |row: usize, value: T| x[row] = scale * of_rows[row] * Into::<f64>::into(value);
            self.own.iter().for_each(|&(place, row)| set(row, column(j)[place]));
            for (rows, values) in self.received.iter().zip(&others) {
                let values = &values[j * rows.len()..(j + 1) * rows.len()];
                rows.iter().zip(values).for_each(|(&row, &value)| set(row, value));
            }
        }
    }
}
