//! From the root's problem to matrices on all ranks, and their sums at a value of the parameter.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::Role;
use super::combined::{CombinedTerms, Names, Term};
use super::sparse::SparsityPattern;
use crate::Result;
use crate::native::{Comm, Matrix, Rows};

/// Which of the matrices are symmetric, whatever the parameter: all their terms are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetry {
    /// M.
    pub mass: bool,
    /// C.
    pub damping: bool,
    /// K.
    pub stiffness: bool,
    /// G; true where there is none.
    pub structural: bool,
}

/// A quadratic eigenproblem of external matrices, scaled: `D (lambda^2 M + lambda C + K + i G) D y = 0`, `x = D y`.
/// All terms share one symmetric pattern.
pub struct ExternalMatrices {
    terms: Vec<Term>,
    matrices: Vec<Matrix>,
    /// `(K_i + K_i^T) / 2` of the terms of an unsymmetric K; of other terms none.
    symmetric_parts: Vec<Option<Matrix>>,
    /// Diagonal of D on this rank's rows.
    pub scale: Vec<f64>,
    /// Which matrices are symmetric.
    pub symmetry: Symmetry,
    /// Number of rows over all ranks.
    pub n: usize,
    /// This rank's rows.
    pub owned: Range<usize>,
    /// Names of the rows: on the root all, on other ranks none.
    pub names: Names,
}

/// M, C, K, G and the symmetric part of K at a value of the parameter.
pub struct Sums {
    /// M.
    pub m: Matrix,
    /// C.
    pub c: Matrix,
    /// K.
    pub k: Matrix,
    /// G, where it has any term.
    pub g: Option<Matrix>,
    /// `(K + K^T) / 2`, where K is not symmetric.
    pub k_symmetric: Option<Matrix>,
}

/// Entries that differ by this much of the largest are the same: what assembly rounds.
const ROUNDING: f64 = 1e-10;

/// What a rank gets of a problem.
#[derive(Serialize, Deserialize)]
struct RowBlock {
    offsets: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<Vec<f64>>,
    scale: Vec<f64>,
}

impl ExternalMatrices {
    /// Reads the terms on the root and gives every rank its rows. `omega` is a typical frequency, rad/s. Collective.
    ///
    /// ```no_run
    /// use squeal::matrices::{ExternalMatrices, family};
    ///
    /// let comm = squeal::Session::start(&[])?;
    /// let family = family::read("brake.toml".as_ref())?;
    /// let matrices = ExternalMatrices::read(&comm, &family.terms, 2000.0)?;
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// See [`CombinedTerms::read`]; PETSc's.
    pub fn read(comm: &Comm, terms: &[Term], omega: f64) -> Result<ExternalMatrices> {
        let problem = if comm.is_root() { CombinedTerms::read(terms, omega).map(Some) } else { Ok(None) };
        let problem = comm.agree(problem)?;
        ExternalMatrices::distribute(comm, terms, problem)
    }

    /// Distributes what the root has. Collective.
    fn distribute(comm: &Comm, terms: &[Term], problem: Option<CombinedTerms>) -> Result<ExternalMatrices> {
        let (parts, is_symmetric) = problem.as_ref().map_or_else(Default::default, |problem| parts(terms, problem));
        let n = problem.as_ref().map_or(0, |problem| problem.scale.len());
        let (n, flags) = comm.broadcast_value(0, (n, is_symmetric));
        let owned = |rank: usize| rank * n / comm.size()..(rank + 1) * n / comm.size();
        let piece = match &problem {
            Some(problem) => {
                let piece = |rank: usize| RowBlock::of(problem, &parts, owned(rank));
                (1..comm.size()).for_each(|rank| comm.send_value(&piece(rank), rank));
                piece(0)
            }
            None => comm.receive_value(0),
        };
        let matrices = piece.matrices(comm, &owned(comm.rank()))?;
        let all = |role: Role| terms.iter().zip(&flags).filter(|(term, _)| term.role == role).all(|(_, flag)| *flag);
        let symmetry = Symmetry {
            mass: all(Role::Mass),
            damping: all(Role::Damping),
            stiffness: all(Role::Stiffness),
            structural: all(Role::Structural),
        };
        let mut matrices = matrices.into_iter();
        let own: Vec<Matrix> = matrices.by_ref().take(terms.len()).collect();
        let has_part = |i: usize| terms[i].role == Role::Stiffness && !flags[i];
        let symmetric_parts = (0..terms.len()).map(|i| if has_part(i) { matrices.next() } else { None }).collect();
        let names = problem.map_or_else(Names::default, |problem| problem.names);
        let (terms, owned) = (terms.to_vec(), owned(comm.rank()));
        Ok(ExternalMatrices { terms, matrices: own, symmetric_parts, scale: piece.scale, symmetry, n, owned, names })
    }

    /// The sums at a value of the parameter. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a factor is not finite; PETSc's.
    pub fn at(&self, parameter: f64) -> Result<Sums> {
        let factors = self.terms.iter().map(|term| term.factor.at(parameter)).collect::<Result<Vec<f64>>>()?;
        let own = |i: usize| &self.matrices[i];
        let part = |i: usize| self.symmetric_parts[i].as_ref().unwrap_or(&self.matrices[i]);
        Ok(Sums {
            m: self.sum(Role::Mass, &factors, own)?,
            c: self.sum(Role::Damping, &factors, own)?,
            k: self.sum(Role::Stiffness, &factors, own)?,
            g: self.has_structural_damping().then(|| self.sum(Role::Structural, &factors, own)).transpose()?,
            k_symmetric: match self.symmetry.stiffness {
                true => None,
                false => Some(self.sum(Role::Stiffness, &factors, part)?),
            },
        })
    }

    /// `sum_i f_i A_i` of the terms of a role.
    fn sum<'a>(&'a self, role: Role, factors: &[f64], choose: impl Fn(usize) -> &'a Matrix) -> Result<Matrix> {
        let mut sum = self.matrices[0].zeros_like()?;
        for i in (0..self.terms.len()).filter(|&i| self.terms[i].role == role) {
            sum.axpy(factors[i], choose(i))?;
        }
        Ok(sum)
    }

    /// The communicator.
    pub fn comm(&self) -> &Comm {
        self.matrices[0].comm()
    }

    /// A number for each of this rank's rows that does not depend on the number of ranks.
    pub fn labels(&self) -> Vec<u64> {
        self.owned.clone().map(|i| i as u64).collect()
    }

    /// Whether anything depends on the parameter.
    pub fn varies(&self) -> bool {
        self.terms.iter().any(|term| term.factor.varies())
    }

    /// Whether there is any C.
    pub fn is_damped(&self) -> bool {
        self.has(Role::Damping)
    }

    /// Whether there is any G.
    pub fn has_structural_damping(&self) -> bool {
        self.has(Role::Structural)
    }

    fn has(&self, role: Role) -> bool {
        self.terms.iter().any(|term| term.role == role)
    }
}

/// The symmetric parts of the terms of K that need them, and which terms are symmetric.
fn parts(terms: &[Term], problem: &CombinedTerms) -> (Vec<Vec<f64>>, Vec<bool>) {
    let (mut parts, mut flags) = (Vec::new(), Vec::new());
    for (term, values) in terms.iter().zip(&problem.values) {
        let (part, difference) = problem.pattern.symmetric_part(values);
        let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let is_symmetric = difference <= ROUNDING * largest;
        if term.role == Role::Stiffness && !is_symmetric {
            parts.push(part);
        }
        flags.push(is_symmetric);
    }
    (parts, flags)
}

impl RowBlock {
    /// Some rows of a problem, with the symmetric parts after the terms.
    fn of(problem: &CombinedTerms, parts: &[Vec<f64>], rows: Range<usize>) -> RowBlock {
        let SparsityPattern { offsets, columns } = &problem.pattern;
        let range = offsets[rows.start]..offsets[rows.end];
        RowBlock {
            offsets: offsets[rows.start..=rows.end].iter().map(|&at| (at - range.start) as u32).collect(),
            columns: columns[range.clone()].to_vec(),
            values: problem.values.iter().chain(parts).map(|values| values[range.clone()].to_vec()).collect(),
            scale: problem.scale[rows].to_vec(),
        }
    }

    /// The matrices of all values on one pattern. Collective.
    fn matrices(&self, comm: &Comm, owned: &Range<usize>) -> Result<Vec<Matrix>> {
        let is_own = |j: u32| owned.contains(&(j as usize));
        let mut rows = Rows::default();
        let (mut own, mut other) = (Vec::new(), Vec::new());
        for bounds in self.offsets.windows(2) {
            own.clear();
            other.clear();
            for &j in &self.columns[bounds[0] as usize..bounds[1] as usize] {
                match is_own(j) {
                    true => own.push(j as i32 - owned.start as i32),
                    false => other.push(j as i32),
                }
            }
            rows.push(&own, &other);
        }
        let pattern = Matrix::zeros(comm, rows)?;
        let mut made = Vec::new();
        for values in &self.values {
            let mut matrix = pattern.zeros_like()?;
            Matrix::change_values(&mut [&mut matrix], |arrays| {
                let [mut own, mut other] = arrays[0].each_mut().map(|values| values.iter_mut());
                for (&j, &value) in self.columns.iter().zip(values) {
                    let next = if is_own(j) { own.next() } else { other.next() };
                    *next.expect("a place for every value") = value;
                }
            })?;
            made.push(matrix);
        }
        Ok(made)
    }
}
