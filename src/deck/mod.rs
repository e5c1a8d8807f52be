//! Input files of Abaqus and CalculiX ("decks"), read and written.
//!
//! ```text
//!  .inp --lines--> cards and rows --parse--> Deck --convert--> Model + Mesh      (SI units, global axes)
//!        (includes, comments,      (plain data,    (one numbering, names resolved,
//!         continuation)             places)         what the model cannot express is refused)
//! ```
//!
//! A keyword is read, or listed as ignored because it changes no result, or refused ([`catalogue`]). Nothing is left
//! out silently.
//!
//! Source: Abaqus Keywords Reference Guide 6.14; CalculiX CrunchiX 2.20 User's Manual, chapter 7.

mod assembly;
mod card;
pub mod catalogue;
pub mod convert;
pub mod elements;
mod geometry;
mod lines;
mod numbers;
mod parse;
mod row;
mod sets;
mod summary;
pub mod types;
mod write;

use std::path::Path;

pub use convert::{Converted, KnownUnits, settle};
pub use parse::parse;
pub use summary::DeckSummary;
pub use types::Deck;
pub use write::write;

use crate::Result;

/// Place in our order xx yy zz xy yz zx of each of the deck's 11 22 33 12 13 23; also the other way round.
const VOIGT_ORDER: [usize; 6] = [0, 1, 2, 3, 5, 4];

/// Reads a deck and converts it.
///
/// # Errors
/// See [`parse`] and [`convert::convert`].
pub fn read(path: &Path, units: KnownUnits) -> Result<Converted> {
    convert::convert(&parse(path)?, units)
}
