//! Matrix Market files: coordinate and array, real and integer, general, symmetric and skew-symmetric.
//!
//! Source: Boisvert, Pozo and Remington, The Matrix Market exchange formats, NISTIR 5935 (1996).

use super::entries::{Entries, Naming, Storage};
use super::lines::Lines;
use crate::Result;

/// First word of the header.
pub const BANNER: &str = "%%matrixmarket";

#[derive(Clone, Copy, PartialEq)]
enum MarketSymmetry {
    General,
    Symmetric,
    Skew,
}

/// Reads a file whose header is the current line.
///
/// # Errors
/// [`crate::Error::Input`] with file and line, whatever is wrong.
pub fn read(lines: &mut Lines) -> Result<Entries> {
    let (is_array, symmetry) = header(lines)?;
    next_data(lines, "the line with the size")?;
    let sizes: Vec<i64> = lines.text().split_whitespace().map(|word| lines.whole(word)).collect::<Result<_>>()?;
    let (rows, columns, n_entries) = match (&sizes[..], is_array) {
        (&[rows, columns], true) => (rows, columns, 0),
        (&[rows, columns, n_entries], false) => (rows, columns, n_entries),
        _ => {
            return Err(
                lines.error("this should be the size: rows, columns, and in coordinate files the number of entries")
            );
        }
    };
    if rows != columns || !(1..=i64::from(i32::MAX)).contains(&rows) || n_entries < 0 {
        let what =
            format!("{rows} x {columns} is not the size of a square matrix. M, C and K are square, all of one size");
        return Err(lines.error(what));
    }
    let mut entries = Entries::new(Naming::Rows(rows as usize), Storage::Full);
    match is_array {
        true => array(lines, rows as u32, symmetry, &mut entries)?,
        false => coordinates(lines, [rows, n_entries], symmetry, &mut entries)?,
    }
    while lines.advance()? {
        if !is_comment(lines.text()) {
            return Err(lines.error("there are more entries than the header says"));
        }
    }
    Ok(entries)
}

/// Whether the values stand without their places, and the symmetry.
fn header(lines: &Lines) -> Result<(bool, MarketSymmetry)> {
    let words: Vec<String> = lines.text().split_whitespace().map(str::to_lowercase).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let &[_, "matrix", format, field, symmetry] = &words[..] else {
        return Err(lines.error("the header should read %%MatrixMarket matrix coordinate real general, or alike"));
    };
    let is_array = match format {
        "coordinate" => false,
        "array" => true,
        _ => return Err(lines.error(format!("unknown format {format:?}: coordinate and array are known"))),
    };
    match field {
        "real" | "double" | "integer" => {}
        "complex" => {
            return Err(lines.error(
                "the matrix is complex. All matrices are real: give the imaginary part of the stiffness as a matrix of its own",
            ));
        }
        "pattern" => return Err(lines.error("the file has a pattern without values. Write it as real")),
        _ => return Err(lines.error(format!("unknown field {field:?}: real and integer are known"))),
    }
    match symmetry {
        "general" => Ok((is_array, MarketSymmetry::General)),
        "symmetric" => Ok((is_array, MarketSymmetry::Symmetric)),
        "skew-symmetric" => Ok((is_array, MarketSymmetry::Skew)),
        _ => {
            Err(lines.error(format!("unknown symmetry {symmetry:?}: general, symmetric and skew-symmetric are known")))
        }
    }
}

fn is_comment(text: &str) -> bool {
    text.is_empty() || text.starts_with('%')
}

/// Goes to the next line with data.
fn next_data(lines: &mut Lines, what: &str) -> Result<()> {
    while lines.advance()? {
        if !is_comment(lines.text()) {
            return Ok(());
        }
    }
    Err(lines.error(format!("the file ends where {what} should stand. Copy it again")))
}

fn coordinates(
    lines: &mut Lines,
    [n, n_entries]: [i64; 2],
    symmetry: MarketSymmetry,
    entries: &mut Entries,
) -> Result<()> {
    for k in 0..n_entries {
        next_data(lines, &format!("entry {} of {n_entries}", k + 1))?;
        let mut words = lines.text().split_whitespace();
        let (Some(i), Some(j), Some(value), None) = (words.next(), words.next(), words.next(), words.next()) else {
            return Err(lines.error(format!("{:?} should be row, column and value", lines.text())));
        };
        let (i, j, value) = (lines.whole(i)?, lines.whole(j)?, lines.number(value)?);
        if !(1..=n).contains(&i) || !(1..=n).contains(&j) {
            return Err(lines.error(format!("row {i}, column {j} is outside a matrix of {n} rows")));
        }
        add(lines, [i as u32 - 1, j as u32 - 1], value, symmetry, entries)?;
    }
    Ok(())
}

/// Values column by column; of symmetric matrices from the diagonal down, of skew ones from below it.
fn array(lines: &mut Lines, n: u32, symmetry: MarketSymmetry, entries: &mut Entries) -> Result<()> {
    for j in 0..n {
        let first = match symmetry {
            MarketSymmetry::General => 0,
            MarketSymmetry::Symmetric => j,
            MarketSymmetry::Skew => j + 1,
        };
        for i in first..n {
            next_data(lines, &format!("the value of row {}, column {}", i + 1, j + 1))?;
            let value = lines.number(lines.text())?;
            if value != 0.0 {
                add(lines, [i, j], value, symmetry, entries)?;
            }
        }
    }
    Ok(())
}

fn add(lines: &Lines, [i, j]: [u32; 2], value: f64, symmetry: MarketSymmetry, entries: &mut Entries) -> Result<()> {
    entries.items.push((i, j, value));
    match symmetry {
        MarketSymmetry::General => {}
        MarketSymmetry::Symmetric if i != j => entries.items.push((j, i, value)),
        MarketSymmetry::Symmetric => {}
        MarketSymmetry::Skew if i != j => entries.items.push((j, i, -value)),
        MarketSymmetry::Skew if value == 0.0 => {}
        MarketSymmetry::Skew => return Err(lines.error("a skew-symmetric matrix has nothing on its diagonal")),
    }
    Ok(())
}
