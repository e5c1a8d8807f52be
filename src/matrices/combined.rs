//! Several files put together: one numbering, one pattern, one scaling. On one rank.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use super::entries::{Dof, Entries, Naming, Storage};
use super::family::Coefficient;
use super::sparse::SparsityPattern;
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
    /// Names of the rows.
    pub names: Names,
}

/// Names of the rows of external matrices.
#[derive(Debug, Clone, Default)]
pub struct Names {
    /// Number of each row in the files, from 0.
    pub rows: Vec<usize>,
    /// Name of each row, where the files have names.
    pub dofs: Option<Vec<Dof>>,
    /// Number of rows left out because they are constrained.
    pub n_constrained: usize,
}

/// Abaqus's mark of a displacement that is constrained to zero is 1e36 on the diagonal; nothing real is as large.
const CONSTRAINED: f64 = 1e30;
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
        let may_be_constrained = files.iter().any(|file| file.storage == Storage::Triangle);
        files.iter_mut().for_each(add_other_triangle);
        require_entries(terms, &files, n)?;
        let mut rows: Vec<usize> = (0..n).collect();
        if may_be_constrained {
            let constrained = constrained_rows(terms, &files);
            rows.retain(|&i| !constrained.contains(&(i as u32)));
            restrict(&mut files, &rows, n);
        }
        let dofs = dofs.map(|dofs| rows.iter().map(|&i| dofs[i]).collect::<Vec<_>>());
        let names = Names { n_constrained: n - rows.len(), rows, dofs };
        require_filled(terms, &files, &names)?;
        let places = files.iter().flat_map(|file| file.items.iter().map(|&(i, j, _)| (i, j)));
        let pattern = SparsityPattern::new(names.rows.len(), places);
        let mut values: Vec<Vec<f64>> = files.iter().map(|file| pattern.values(&file.items)).collect();
        let scale = scaling(terms, &pattern, &values, omega);
        for values in &mut values {
            pattern.places().for_each(|(i, j, at)| values[at] *= scale[i] * scale[j]);
        }
        Ok(CombinedTerms { pattern, values, scale, names })
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
            Err(Error::input(format!("{what}. All matrices must be of one size")))
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

/// Refuses more rows than entries: some are empty. It comes before anything of the size that the files claim.
fn require_entries(terms: &[Term], files: &[Entries], n: usize) -> Result<()> {
    let n_entries: usize = files.iter().map(|file| file.items.len()).sum();
    if n <= n_entries {
        return Ok(());
    }
    let first = terms.first().map_or_else(String::new, |term| term.file.display().to_string());
    let what = format!("M, C and K have {n} rows, but only {n_entries} entries, so that rows are empty in all of them");
    Err(Error::input(format!("{first}: {what}. Look at the size and the largest row number in the files")))
}

/// Adds the other triangle where a file that may have one only has one only.
fn add_other_triangle(file: &mut Entries) {
    if file.storage == Storage::Full {
        return;
    }
    let below: Vec<_> = file.items.iter().filter(|(i, j, _)| i != j).map(|&(i, j, value)| (j, i, value)).collect();
    let places: HashSet<(u32, u32)> = below.iter().map(|&(j, i, _)| (i, j)).collect();
    if below.iter().all(|&(j, i, _)| !places.contains(&(j, i))) {
        file.items.extend(below);
    }
}

fn constrained_rows(terms: &[Term], files: &[Entries]) -> HashSet<u32> {
    let stiffnesses = terms.iter().zip(files).filter(|(term, _)| term.role == Role::Stiffness);
    let items = stiffnesses.flat_map(|(_, file)| &file.items);
    items.filter(|(i, j, value)| i == j && value.abs() >= CONSTRAINED).map(|(i, ..)| *i).collect()
}

/// Leaves the chosen rows and columns, which rise.
fn restrict(files: &mut [Entries], rows: &[usize], n: usize) {
    let mut new = vec![None; n];
    rows.iter().enumerate().for_each(|(place, &i)| new[i] = Some(place as u32));
    for file in files {
        let kept = file.items.iter().filter_map(|&(i, j, value)| Some((new[i as usize]?, new[j as usize]?, value)));
        file.items = kept.collect();
    }
}

/// Refuses a row or a column that is empty in all matrices: every lambda is then an eigenvalue.
fn require_filled(terms: &[Term], files: &[Entries], names: &Names) -> Result<()> {
    let first = terms.first().map_or_else(String::new, |term| term.file.display().to_string());
    if names.rows.is_empty() {
        return Err(Error::input(format!("{first}: every row of the matrices is constrained, no dof is left")));
    }
    let mut filled = vec![[false; 2]; names.rows.len()];
    for (i, j, _) in files.iter().flat_map(|file| &file.items).filter(|(.., value)| *value != 0.0) {
        filled[*i as usize][0] = true;
        filled[*j as usize][1] = true;
    }
    let masses = terms.iter().zip(files).filter(|(term, _)| term.role == Role::Mass);
    if masses.flat_map(|(_, file)| &file.items).all(|(.., value)| *value == 0.0) {
        let what = "the mass matrix is zero where nothing is constrained: without mass there are no vibrations";
        return Err(Error::input(format!("{first}: {what}. Give another M")));
    }
    let Some(i) = filled.iter().position(|[row, column]| !row || !column) else { return Ok(()) };
    let (what, number) = (if filled[i][0] { "column" } else { "row" }, names.rows[i] + 1);
    let name = names
        .dofs
        .as_ref()
        .map_or_else(String::new, |dofs| format!(" (node {}, degree of freedom {})", dofs[i].node, dofs[i].axis));
    Err(Error::input(format!(
        "{first}: the eigenproblem is singular: {what} {number}{name} is empty in M, C and K, so that every number is an \
         eigenvalue. Leave it out of the matrices"
    )))
}

/// Powers of two that bring the largest entries of all rows and columns of `sum |K| + omega |C| + omega^2 |M|` to one
/// size; G counts as K does.
///
/// One round divides by the square root of the largest: Ruiz, A scaling algorithm to equilibrate both rows and columns
/// norms in matrices, RAL-TR-2001-034.
fn scaling(terms: &[Term], pattern: &SparsityPattern, values: &[Vec<f64>], omega: f64) -> Vec<f64> {
    let mut d = vec![1.0_f64; pattern.n_rows()];
    for _ in 0..ROUNDS {
        let mut largest = vec![0.0_f64; d.len()];
        for (term, values) in terms.iter().zip(values) {
            let weight = match term.role {
                Role::Mass => omega * omega,
                Role::Damping => omega,
                Role::Stiffness | Role::Structural => 1.0,
            };
            for (i, j, at) in pattern.places() {
                let entry = weight * values[at].abs() * d[i] * d[j];
                largest[i] = largest[i].max(entry);
                largest[j] = largest[j].max(entry);
            }
        }
        d.iter_mut().zip(&largest).filter(|(_, largest)| **largest > 0.0).for_each(|(d, largest)| *d /= largest.sqrt());
    }
    d.iter().map(|d| d.log2().round().exp2()).collect()
}
