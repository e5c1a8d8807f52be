//! Which entries a distributed matrix stores.

use super::Int;
use crate::{Error, Result};

/// The pattern of some rows, compressed by rows. Offsets wrap beyond 2^31 entries; `Rows::check` looks at the
/// columns' number.
#[derive(Debug, Clone)]
pub struct Csr {
    /// Where each row starts, and the end of the last.
    pub offsets: Vec<Int>,
    /// Columns, rising within each row.
    pub columns: Vec<Int>,
}

impl Default for Csr {
    fn default() -> Self {
        Csr { offsets: vec![0], columns: Vec::new() }
    }
}

impl Csr {
    fn push(&mut self, columns: &[i32]) {
        self.columns.extend(columns.iter().map(|&column| column as Int));
        self.offsets.push(self.columns.len() as Int);
    }
}

/// The pattern of this rank's rows, as PETSc keeps it: apart for the columns that this rank owns and for all others.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Columns that this rank owns, counted from its first.
    pub own: Csr,
    /// Columns that other ranks own, by their global numbers.
    pub other: Csr,
}

impl Rows {
    /// Appends a row with these columns, both lists rising.
    pub fn push(&mut self, own: &[i32], other: &[i32]) {
        self.own.push(own);
        self.other.push(other);
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.own.offsets.len() - 1
    }

    /// Refuses what PETSc's 32-bit numbers do not count: before they are used, whatever has wrapped. `n_rows` is that
    /// of all ranks.
    pub(super) fn check(&self, n_rows: usize) -> Result<()> {
        int("a matrix's rows", n_rows)?;
        countable("a matrix's entries on one rank", self.own.columns.len().max(self.other.columns.len()))
    }
}

/// Refuses more than PETSc's integers count.
fn countable(what: &str, n: usize) -> Result<()> {
    let refused = |_| Error::input(format!("{what}: {n} are more than PETSc's integers count. Use more ranks"));
    Int::try_from(n).map(|_| ()).map_err(refused)
}

/// A number as MUMPS and METIS count, and this crate its rows, whatever PETSc's integers.
///
/// # Errors
/// [`Error::Input`] where it is beyond 32 bits.
pub(in crate::native) fn int(what: &str, n: usize) -> Result<i32> {
    let text = || format!("{what}: {n} are more than 32-bit numbers count. Use more ranks or a coarser mesh");
    i32::try_from(n).map_err(|_| Error::input(text()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_rows_or_entries_than_can_be_counted_are_refused() {
        let mut rows = Rows::default();
        rows.push(&[0], &[]);
        let most = i32::MAX as usize;
        assert!(rows.check(most).is_ok());
        let error = rows.check(most + 1).unwrap_err();
        assert!(error.to_string().contains("rows: 2147483648"), "{error}");
        assert_eq!((int("rows", most).ok(), int("rows", most + 1).ok()), (Some(i32::MAX), None));
    }
}
