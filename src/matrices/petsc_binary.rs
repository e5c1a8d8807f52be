//! PETSc's binary matrices (`MatView` on a binary viewer): big-endian, compressed by rows.
//!
//! ```text
//! 1211216 | rows | columns | entries | entries of each row | columns of all entries, from 0 | values
//! ```
//!
//! Indices have 32 or 64 bits, as PETSc was configured; entries = -1 marks a dense matrix, its values by rows.
//! Source: PETSc's manual page of `MatLoad`.

use std::fmt::Display;

use super::entries::{Entries, Naming, Storage};
use super::lines::MatrixFile;
use crate::{Error, Result};

/// `MAT_FILE_CLASSID`.
pub const MATRIX: i64 = 1_211_216;
/// `VEC_FILE_CLASSID`.
const VECTOR: i64 = 1_211_214;

/// Bytes of an index in a file that begins so; none where it is no PETSc file.
pub fn index_width(head: &[u8]) -> Option<usize> {
    let narrow = head.first_chunk().map(|bytes| i64::from(i32::from_be_bytes(*bytes)));
    let wide = head.first_chunk().map(|bytes| i64::from_be_bytes(*bytes));
    let is_ours = |class: Option<i64>| class.is_some_and(|class| [MATRIX, VECTOR].contains(&class));
    if is_ours(narrow) { Some(4) } else { is_ours(wide).then_some(8) }
}

/// Reads a file whose indices have so many bytes.
///
/// # Errors
/// [`Error::Input`] with the file, whatever is wrong.
pub fn read(mut source: MatrixFile, width: usize) -> Result<Entries> {
    let (n, n_entries) = size(&mut source, width)?;
    // A dense matrix has no indices: its places are counted, not listed, as its size is only claimed.
    let places: Box<dyn Iterator<Item = (u32, u32)>> = match n_entries {
        Some(n_entries) => {
            let (lengths, columns) = pattern(&mut source, width, n, n_entries)?;
            let rows = (0..).zip(lengths).flat_map(|(i, length)| std::iter::repeat_n(i, length as usize));
            Box::new(rows.zip(columns.into_iter().map(|j| j as u32)))
        }
        None => Box::new((0..n as u32).flat_map(move |i| (0..n as u32).map(move |j| (i, j)))),
    };
    let mut entries = Entries::new(Naming::Rows(n), Storage::Full);
    let mut bytes = [0; 8];
    for (i, j) in places {
        source.fill(&mut bytes)?;
        let value = f64::from_be_bytes(bytes);
        if !value.is_finite() {
            return fail(&source, format!("row {}, column {}: {value} is no finite number", i + 1, j + 1));
        }
        if value != 0.0 || n_entries.is_some() {
            entries.items.push((i, j, value));
        }
    }
    if !source.is_at_end()? {
        let what = "there is more in the file than one matrix with real values. Complex ones are not read";
        return fail(&source, what);
    }
    Ok(entries)
}

fn fail<T>(source: &MatrixFile, what: impl Display) -> Result<T> {
    Err(Error::input(format!("{}: {what}", source.path().display())))
}

/// Number of rows, and of entries; none where the file has all of them.
fn size(source: &mut MatrixFile, width: usize) -> Result<(usize, Option<usize>)> {
    let head = indices(source, 4, width)?;
    let &[class, rows, columns, n_entries] = &head[..] else { unreachable!("four were read") };
    if class != MATRIX {
        return fail(source, "this is a PETSc vector, not a matrix");
    }
    if rows != columns || !(1..=i64::from(i32::MAX)).contains(&rows) {
        let what = "is not the size of a square matrix. M, C and K are square, all of one size";
        return fail(source, format!("{rows} x {columns} {what}"));
    }
    Ok((rows as usize, usize::try_from(n_entries).ok()))
}

/// Lengths of the rows, and the columns of their entries.
fn pattern(source: &mut MatrixFile, width: usize, n: usize, n_entries: usize) -> Result<(Vec<i64>, Vec<i64>)> {
    let rows = n as i64;
    let lengths = indices(source, n, width)?;
    if lengths.iter().any(|length| !(0..=rows).contains(length)) || lengths.iter().sum::<i64>() != n_entries as i64 {
        return fail(source, "the lengths of its rows do not add up. It is damaged, or has complex values");
    }
    let columns = indices(source, n_entries, width)?;
    match columns.iter().find(|j| !(0..rows).contains(*j)) {
        Some(j) => fail(source, format!("column {j} is outside a matrix of {n} rows. It is damaged")),
        None => Ok((lengths, columns)),
    }
}

/// So many indices; read in pieces, so that a wrong count does not take the memory.
fn indices(source: &mut MatrixFile, n: usize, width: usize) -> Result<Vec<i64>> {
    const PIECE: usize = 1 << 16;
    let mut found = Vec::new();
    let mut bytes = vec![0; PIECE.min(n) * width];
    while found.len() < n {
        let part = &mut bytes[..PIECE.min(n - found.len()) * width];
        source.fill(part)?;
        found.extend(part.chunks_exact(width).map(|bytes| match *bytes {
            [a, b, c, d] => i64::from(i32::from_be_bytes([a, b, c, d])),
            _ => i64::from_be_bytes(bytes.try_into().expect("eight bytes")),
        }));
    }
    Ok(found)
}
