//! Which entries a distributed matrix stores.

/// The pattern of some rows, compressed by rows.
#[derive(Debug, Clone)]
pub struct Csr {
    /// Where each row starts, and the end of the last.
    pub offsets: Vec<i32>,
    /// Columns, rising within each row.
    pub columns: Vec<i32>,
}

impl Default for Csr {
    fn default() -> Self {
        Csr { offsets: vec![0], columns: Vec::new() }
    }
}

impl Csr {
    fn push(&mut self, columns: &[i32]) {
        self.columns.extend_from_slice(columns);
        self.offsets.push(self.columns.len() as i32);
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
}
