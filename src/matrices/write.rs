//! Matrices into files, to the last bit.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::native::Matrix;

use super::petsc_binary::MATRIX;

/// All rows of a matrix, compressed; entries that are zero are left out.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GatheredMatrix {
    /// Number of entries of each row.
    pub lengths: Vec<u32>,
    /// Columns from 0, row after row.
    pub columns: Vec<u32>,
    /// Their values.
    pub values: Vec<f64>,
}

impl GatheredMatrix {
    /// Brings a distributed matrix to the root; none on the other ranks. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn gather(matrix: &Matrix) -> Result<Option<GatheredMatrix>> {
        let comm = matrix.comm();
        let mut whole = GatheredMatrix::default();
        matrix.visit_rows(|_, columns, values| {
            let before = whole.columns.len();
            let entries = columns.iter().zip(values).filter(|(_, value)| **value != 0.0);
            for (&column, &value) in entries {
                whole.columns.push(column as u32);
                whole.values.push(value);
            }
            whole.lengths.push((whole.columns.len() - before) as u32);
        })?;
        Ok(comm.gather_values(whole).into_iter().reduce(GatheredMatrix::followed_by))
    }

    /// With the rows of another one below its own.
    fn followed_by(mut self, below: GatheredMatrix) -> GatheredMatrix {
        self.lengths.extend(below.lengths);
        self.columns.extend(below.columns);
        self.values.extend(below.values);
        self
    }

    /// Writes Matrix Market, coordinate real general. Numbers are as short as they can be and still the same.
    ///
    /// # Errors
    /// The writer's.
    pub fn matrix_market(&self, out: &mut dyn Write, comment: &str) -> io::Result<()> {
        let n = self.lengths.len();
        writeln!(out, "%%MatrixMarket matrix coordinate real general\n% {comment}\n{n} {n} {}", self.values.len())?;
        let mut at = 0;
        for (row, &length) in self.lengths.iter().enumerate() {
            for _ in 0..length {
                writeln!(out, "{} {} {:e}", row + 1, self.columns[at] + 1, self.values[at])?;
                at += 1;
            }
        }
        Ok(())
    }

    /// Writes PETSc's binary format with 32-bit indices.
    ///
    /// # Errors
    /// The writer's; where there are more entries than such indices count.
    pub fn petsc(&self, out: &mut dyn Write) -> io::Result<()> {
        let n = self.lengths.len() as i32;
        let n_entries = i32::try_from(self.values.len()).map_err(|_| {
            io::Error::other("the matrix has more entries than PETSc's 32-bit indices count. Export mtx")
        })?;
        for number in [MATRIX as i32, n, n, n_entries] {
            out.write_all(&number.to_be_bytes())?;
        }
        self.lengths.iter().chain(&self.columns).try_for_each(|number| out.write_all(&number.to_be_bytes()))?;
        self.values.iter().try_for_each(|value| out.write_all(&value.to_be_bytes()))
    }
}
