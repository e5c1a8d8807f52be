//! PETSc's binary matrices (`MatView` on a binary viewer): big-endian, compressed by rows.
//!
//! ```text
//! 1211216 | rows | columns | entries | entries of each row | columns of all entries, from 0 | values
//! ```
//!
//! Indices have 32 or 64 bits, as PETSc was configured; entries = -1 marks a dense matrix, its values by rows.
//! Source: PETSc's manual page of `MatLoad`.

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
    let place = source.path().display().to_string();
    let fail = |what: String| Err(Error::input(format!("{place}: {what}")));
    let head = indices(&mut source, 4, width)?;
    let &[class, rows, columns, n_entries] = &head[..] else { unreachable!("four were read") };
    if class != MATRIX {
        return fail("this is a PETSc vector, not a matrix".into());
    }
    if rows != columns || !(1..=i64::from(i32::MAX)).contains(&rows) {
        return fail(format!(
            "{rows} x {columns} is not the size of a square matrix. M, C and K are square, all of one size"
        ));
    }
    let mut entries = Entries::new(Naming::Rows(rows as usize), Storage::Full);
    let (n, n_entries) = (rows as usize, usize::try_from(n_entries).ok());
    let lengths = match n_entries {
        Some(_) => indices(&mut source, n, width)?,
        None => vec![rows; n],
    };
    let total: i64 = lengths.iter().sum();
    if lengths.iter().any(|length| !(0..=rows).contains(length)) || n_entries.is_some_and(|n| n as i64 != total) {
        return fail("the lengths of its rows do not add up. It is damaged, or has complex values".into());
    }
    let places = match n_entries {
        Some(n_entries) => indices(&mut source, n_entries, width)?,
        None => (0..n).flat_map(|_| 0..rows).collect(),
    };
    if let Some(j) = places.iter().find(|j| !(0..rows).contains(*j)) {
        return fail(format!("column {j} is outside a matrix of {n} rows. It is damaged"));
    }
    let row_of = lengths.iter().enumerate().flat_map(|(i, &length)| std::iter::repeat_n(i as u32, length as usize));
    let mut bytes = [0; 8];
    for (i, j) in row_of.zip(places) {
        source.fill(&mut bytes)?;
        let value = f64::from_be_bytes(bytes);
        if !value.is_finite() {
            return fail(format!("row {}, column {}: {value} is no finite number", i + 1, j + 1));
        }
        if value != 0.0 || n_entries.is_some() {
            entries.items.push((i, j as u32, value));
        }
    }
    match source.is_at_end()? {
        true => Ok(entries),
        false => fail("there is more in the file than one matrix with real values. Complex ones are not read".into()),
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
