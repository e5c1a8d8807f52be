//! Matrices into files, to the last bit.

use std::io::{self, Write};

use crate::Result;
use crate::native::Matrix;

use super::petsc_binary::MATRIX;

/// All rows of a matrix, compressed; entries that are zero are left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GatheredMatrix {
    /// Number of entries of each row.
    pub lengths: Vec<u32>,
    /// Columns from 0, row after row.
    pub columns: Vec<u32>,
    /// Their values.
    pub values: Vec<f64>,
}

impl GatheredMatrix {
    /// Brings a distributed matrix to the root; none elsewhere. Collective.
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
        if !comm.is_root() {
            comm.send(&whole.to_bytes(), 0);
            return Ok(None);
        }
        (1..comm.size()).for_each(|rank| whole.append_bytes(&comm.receive(rank)));
        Ok(Some(whole))
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = (self.lengths.len() as u64).to_le_bytes().to_vec();
        self.lengths.iter().chain(&self.columns).for_each(|number| bytes.extend(number.to_le_bytes()));
        self.values.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        bytes
    }

    fn append_bytes(&mut self, bytes: &[u8]) {
        let (head, rest) = bytes.split_at(8);
        let n = u64::from_le_bytes(head.try_into().expect("eight bytes")) as usize;
        let (lengths, rest) = rest.split_at(4 * n);
        // An entry takes four bytes of column and eight of value.
        let (columns, values) = rest.split_at(rest.len() / 3);
        self.lengths.extend(lengths.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)));
        self.columns.extend(columns.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)));
        self.values.extend(values.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)));
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
