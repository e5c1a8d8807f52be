//! Several files put together: one numbering, one pattern, one scaling. On one rank.

use std::collections::HashMap;
use std::path::PathBuf;

use super::entries::{Dof, Entries, Naming, Storage};
use super::family::Coefficient;
use super::sparse::{Sparse, SparsityPattern};
use super::{Role, read};
use crate::{Error, Result};

/// A file and what it is multiplied by.
#[derive(Debug, Clone)]
pub struct Term {
    /// The sum that it belongs to.
    pub role: Role,
    /// The file.
    pub file: PathBuf,
    /// Its factor.
    pub factor: Coefficient,
}

/// All terms on one pattern.
pub struct CombinedTerms {
    /// The pattern: that of all terms and their transposes.
    pub pattern: SparsityPattern,
    /// `D A_i D` of each term, in the order of the terms.
    pub values: Vec<Vec<f64>>,
    /// The diagonal of D: powers of two.
    pub scale: Vec<f64>,
    /// For each row its number in the files, from 0.
    pub rows: Vec<usize>,
    /// For each row its name, where the files have names.
    pub dofs: Option<Vec<Dof>>,
    /// Number of rows left out because they are held.
    pub n_held: usize,
}

/// Abaqus's sign of a displacement that is held at zero is 1e36 on the diagonal; nothing real is as large.
const HELD: f64 = 1e30;
/// Rounds of scaling; three decades become a factor of two in two.
const ROUNDS: usize = 8;

impl CombinedTerms {
    /// Reads the files of all terms. The scaling takes `omega` (rad/s) for a typical frequency.
    ///
    /// # Errors
    /// [`Error::Input`] where a file is wrong, files do not go together, or a row is empty in all of them.
    pub fn read(terms: &[Term], omega: f64) -> Result<CombinedTerms> {
        let mut files = terms.iter().map(|term| read(&term.file, term.role)).collect::<Result<Vec<_>>>()?;
        let (n, dofs) = common_numbering(terms, &mut files)?;
        let may_be_held = files.iter().any(|file| file.storage == Storage::Triangle);
        let mut matrices: Vec<Sparse> = files.into_iter().map(|file| whole(n, file)).collect();
        let mut rows: Vec<usize> = (0..n).collect();
        if may_be_held {
            rows.retain(|&i| !is_held(terms, &matrices, i as u32));
            if rows.len() < n {
                matrices = matrices.iter().map(|matrix| restricted(matrix, &rows)).collect();
            }
        }
        let dofs = dofs.map(|dofs| rows.iter().map(|&i| dofs[i]).collect::<Vec<_>>());
        require_filled(terms, &matrices, &rows, dofs.as_deref())?;
        let scale = scaling(terms, &matrices, omega);
        let pattern =
            SparsityPattern::symmetric_union(rows.len(), &matrices.iter().map(|a| &a.pattern).collect::<Vec<_>>());
        let values = matrices.into_iter().map(|matrix| scaled(matrix, &scale).on(&pattern)).collect();
        Ok(CombinedTerms { pattern, values, scale, n_held: n - rows.len(), rows, dofs })
    }
}

/// The number of rows, and their names where the files have them; brings all files to it.
fn common_numbering(terms: &[Term], files: &mut [Entries]) -> Result<(usize, Option<Vec<Dof>>)> {
    let of = |i: usize| format!("{} ({})", terms[i].role.name(), terms[i].file.display());
    let has_names = |file: &Entries| matches!(file.naming, Naming::Dofs(_));
    let named = files.iter().position(has_names);
    if let (Some(a), Some(b)) = (named, files.iter().position(|file| !has_names(file))) {
        let what =
            format!("the rows of the {} have nodes and degrees of freedom, those of the {} have numbers", of(a), of(b));
        return Err(Error::input(format!("{what}. Write all matrices in one format")));
    }
    if named.is_some() {
        let dofs = union(files);
        return Ok((dofs.len(), Some(dofs)));
    }
    let exact = |file: &Entries| if let Naming::Rows(n) = file.naming { Some(n) } else { None };
    let at_least = |file: &Entries| if let Naming::Rows(n) | Naming::AtLeast(n) = file.naming { n } else { 0 };
    let largest = (0..files.len()).max_by_key(|&i| at_least(&files[i])).expect("there are terms");
    let n = at_least(&files[largest]);
    match (0..files.len()).find(|&i| exact(&files[i]).is_some_and(|rows| rows != n)) {
        None => Ok((n, None)),
        Some(i) => {
            let what = format!("the {} has {} rows, the {} has {n}", of(i), at_least(&files[i]), of(largest));
            Err(Error::input(format!("{what}. M, C and K must be of one size")))
        }
    }
}

/// All names of all files by node and degree of freedom, internal nodes last; renumbers the files.
fn union(files: &mut [Entries]) -> Vec<Dof> {
    let names = |file: &Entries| if let Naming::Dofs(dofs) = &file.naming { dofs.clone() } else { Vec::new() };
    let mut all: Vec<Dof> = files.iter().flat_map(names).collect();
    all.sort_unstable_by_key(|dof| (dof.node < 0, dof.node.abs(), dof.axis));
    all.dedup();
    let place: HashMap<Dof, u32> = all.iter().enumerate().map(|(i, &dof)| (dof, i as u32)).collect();
    for file in files {
        let new: Vec<u32> = names(file).iter().map(|dof| place[dof]).collect();
        file.items.iter_mut().for_each(|(i, j, _)| (*i, *j) = (new[*i as usize], new[*j as usize]));
    }
    all
}

/// The matrix with both of its triangles.
fn whole(n: usize, file: Entries) -> Sparse {
    let Entries { mut items, storage, .. } = file;
    let matrix = Sparse::new(n, &items);
    if storage == Storage::Full || !matrix.is_triangle() {
        return matrix;
    }
    let mirrored: Vec<_> = items.iter().filter(|(i, j, _)| i != j).map(|&(i, j, value)| (j, i, value)).collect();
    items.extend(mirrored);
    Sparse::new(n, &items)
}

fn is_held(terms: &[Term], matrices: &[Sparse], i: u32) -> bool {
    let stiffnesses = terms.iter().zip(matrices).filter(|(term, _)| term.role == Role::Stiffness);
    let mut diagonals = stiffnesses.filter_map(|(_, matrix)| matrix.pattern.place(i, i).map(|at| matrix.values[at]));
    diagonals.any(|value| value.abs() >= HELD)
}

/// The chosen rows and columns, which rise.
fn restricted(matrix: &Sparse, rows: &[usize]) -> Sparse {
    let mut new = vec![u32::MAX; matrix.pattern.n_rows()];
    rows.iter().enumerate().for_each(|(place, &i)| new[i] = place as u32);
    let mut items = Vec::new();
    for (place, &i) in rows.iter().enumerate() {
        let kept = matrix.row(i).filter(|(j, _)| new[*j as usize] != u32::MAX);
        items.extend(kept.map(|(j, value)| (place as u32, new[j as usize], value)));
    }
    Sparse::new(rows.len(), &items)
}

/// Refuses a row or a column that is empty in all matrices: every lambda is then an eigenvalue.
fn require_filled(terms: &[Term], matrices: &[Sparse], rows: &[usize], dofs: Option<&[Dof]>) -> Result<()> {
    let n = rows.len();
    let first = terms.first().map_or_else(String::new, |term| term.file.display().to_string());
    if n == 0 {
        return Err(Error::input(format!("{first}: every row of the matrices is held, nothing is left")));
    }
    let mut filled = vec![[false; 2]; n];
    for matrix in matrices {
        for i in 0..n {
            for (j, _) in matrix.row(i).filter(|(_, value)| *value != 0.0) {
                filled[i][0] = true;
                filled[j as usize][1] = true;
            }
        }
    }
    let Some(i) = filled.iter().position(|[row, column]| !row || !column) else { return Ok(()) };
    let (what, number) = (if filled[i][0] { "column" } else { "row" }, rows[i] + 1);
    let name =
        dofs.map_or_else(String::new, |dofs| format!(" (node {}, degree of freedom {})", dofs[i].node, dofs[i].axis));
    Err(Error::input(format!(
        "{first}: the pencil is singular: {what} {number}{name} is empty in M, C and K, so that every number is an eigenvalue. \
         Leave it out of the matrices"
    )))
}

/// Powers of two that bring the largest entries of all rows and columns of `sum |K| + omega |C| + omega^2 |M|` to one
/// size.
///
/// One round divides by the square root of the largest: Ruiz, A scaling algorithm to equilibrate both rows and columns
/// norms in matrices, RAL-TR-2001-034.
fn scaling(terms: &[Term], matrices: &[Sparse], omega: f64) -> Vec<f64> {
    let n = matrices.first().map_or(0, |matrix| matrix.pattern.n_rows());
    let mut d = vec![1.0_f64; n];
    for _ in 0..ROUNDS {
        let mut largest = vec![0.0_f64; n];
        for (term, matrix) in terms.iter().zip(matrices) {
            let weight = match term.role {
                Role::Mass => omega * omega,
                Role::Damping => omega,
                Role::Stiffness => 1.0,
            };
            for i in 0..n {
                for (j, value) in matrix.row(i) {
                    let j = j as usize;
                    let entry = weight * value.abs() * d[i] * d[j];
                    largest[i] = largest[i].max(entry);
                    largest[j] = largest[j].max(entry);
                }
            }
        }
        d.iter_mut().zip(&largest).filter(|(_, largest)| **largest > 0.0).for_each(|(d, largest)| *d /= largest.sqrt());
    }
    d.iter().map(|d| d.log2().round().exp2()).collect()
}

fn scaled(mut matrix: Sparse, scale: &[f64]) -> Sparse {
    for i in 0..matrix.pattern.n_rows() {
        for at in matrix.pattern.offsets[i]..matrix.pattern.offsets[i + 1] {
            matrix.values[at] *= scale[i] * scale[matrix.pattern.columns[at] as usize];
        }
    }
    matrix
}
