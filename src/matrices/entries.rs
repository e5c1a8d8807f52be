//! A matrix as a file gives it: its entries, and how it names their rows.

/// A degree of freedom by the name that the program gave it which wrote the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dof {
    /// Label of the node; internal nodes have negative ones.
    pub node: i64,
    /// Number of the displacement or rotation there, from 1.
    pub axis: i32,
}

/// How rows and columns are named.
#[derive(Debug, Clone, PartialEq)]
pub enum Naming {
    /// By number, so many in all.
    Rows(usize),
    /// By number; the file does not give their number, and has the last of these.
    AtLeast(usize),
    /// Row i is that of dof i, in any order.
    Dofs(Vec<Dof>),
}

/// Which of the entries a file has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Storage {
    /// All of them.
    Full,
    /// All of them, or one triangle: where of no two entries (i, j) and (j, i) both are there, the other is the same.
    Triangle,
}

/// A square matrix as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Entries {
    /// The names of its rows and columns.
    pub naming: Naming,
    /// Row, column (from 0) and value, in any order; entries of one place add up.
    pub items: Vec<(u32, u32, f64)>,
    /// What is there.
    pub storage: Storage,
}

impl Entries {
    /// A matrix without entries.
    pub fn new(naming: Naming, storage: Storage) -> Entries {
        Entries { naming, items: Vec::new(), storage }
    }
}
