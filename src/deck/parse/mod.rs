//! From lines to a [`Deck`]: one function a keyword, chosen by its name.

mod connectors;
mod constraints;
mod contact;
mod history;
mod material;
mod mesh;
mod properties;
mod scopes;
mod sets;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use sets::entry;

use super::card::Card;
use super::catalogue::{Treatment, treatment};
use super::lines::Lines;
use super::types::{Deck, Ignored, Scope};
use crate::Result;

/// Reads a deck with the files that it includes. What it means is not checked: names may mean nothing.
///
/// ```
/// let folder = tempfile::tempdir().unwrap();
/// let file = folder.path().join("disc.inp");
/// std::fs::write(&file, "*Material, name=Iron\n*Elastic\n1.1e5, 0.27\n*Density\n7.1e-9\n").unwrap();
/// let deck = squeal::deck::parse(&file)?;
/// assert_eq!((deck.n_lines, deck.materials.len()), (5, 1));
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`](crate::Error::Input), `file:line: what. what to do`, for the first line that cannot be read and for
/// the first keyword that changes the physics and is not supported.
pub fn parse(path: &Path) -> Result<Deck> {
    let mut parser =
        Parser { lines: Lines::open(path)?, deck: Deck::default(), at: At::Assembly, system: None, open_step: None };
    while let Some(card) = parser.lines.card()? {
        match treatment(&card)? {
            Treatment::Ignored => parser.ignore(&card),
            _ => parser.keyword(&card)?,
        }
    }
    parser.end()?;
    Ok(parser.deck)
}

/// Where definitions belong at present.
#[derive(Debug, Clone, Copy, PartialEq)]
enum At {
    /// Outside parts and instances.
    Assembly,
    /// In a part.
    Part(usize),
    /// In an instance.
    Instance(usize),
}

struct Parser {
    lines: Lines,
    deck: Deck,
    at: At,
    /// The axes of `*SYSTEM`.
    system: Option<mesh::Frame>,
    /// Index of the step that has not ended.
    open_step: Option<usize>,
}

impl Parser {
    fn keyword(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "HEADING" => self.heading(),
            "PART" | "ENDPART" | "ASSEMBLY" | "ENDASSEMBLY" | "INSTANCE" | "ENDINSTANCE" => self.scope_card(card),
            "NODE" => self.node(card),
            "SYSTEM" => self.system(card),
            "ELEMENT" => self.element(card),
            "NSET" | "ELSET" => self.set(card),
            "SURFACE" => self.surface(card),
            "SOLIDSECTION" => self.section(card),
            "ORIENTATION" => self.orientation(card),
            "SPRING" | "DASHPOT" | "MASS" | "ROTARYINERTIA" => self.property(card),
            "TIE" | "RIGIDBODY" | "EQUATION" | "MPC" | "TRANSFORM" | "CLEARANCE" => self.constraint(card),
            name if name.starts_with("CONNECTOR") => self.connector(card),
            "MATERIAL" | "ELASTIC" | "DENSITY" | "DAMPING" => self.material(card),
            "SURFACEINTERACTION" | "SURFACEBEHAVIOR" | "FRICTION" | "CONTACTPAIR" | "CHANGEFRICTION" => {
                self.contact(card)
            }
            "COUPLING" | "KINEMATIC" | "DISTRIBUTING" => self.coupling(card),
            _ => self.history(card),
        }
    }

    /// The first line of the heading is the title.
    fn heading(&mut self) -> Result<()> {
        while let Some(row) = self.lines.row()? {
            self.deck.title.get_or_insert_with(|| row.text.to_owned());
        }
        Ok(())
    }

    fn ignore(&mut self, card: &Card) {
        let known = self.deck.ignored.iter_mut().find(|ignored| ignored.keyword.eq_ignore_ascii_case(&card.spelled));
        match known {
            Some(ignored) => ignored.times += 1,
            None => {
                let keyword = card.spelled.to_uppercase();
                self.deck.ignored.push(Ignored { keyword, times: 1, place: card.place });
            }
        }
    }

    /// A name in capital letters; its spelling is kept.
    fn named(&mut self, spelled: &str) -> String {
        let name = spelled.to_uppercase();
        self.deck.spellings.entry(name.clone()).or_insert_with(|| spelled.to_owned());
        name
    }

    /// The name that a parameter gives, which must be there.
    fn name_of(&mut self, card: &Card, parameter: &str) -> Result<String> {
        let spelled = card.required(parameter)?.to_owned();
        Ok(self.named(&spelled))
    }

    /// Where definitions belong.
    fn scope(&mut self) -> &mut Scope {
        scope(&mut self.deck, self.at)
    }

    fn end(&mut self) -> Result<()> {
        self.end_of_step()?;
        self.end_of_scopes()?;
        self.deck.files = std::mem::take(&mut self.lines.files);
        self.deck.n_lines = self.lines.n_lines;
        Ok(())
    }
}

fn scope(deck: &mut Deck, at: At) -> &mut Scope {
    match at {
        At::Assembly => &mut deck.assembly,
        At::Part(i) => &mut deck.parts[i],
        At::Instance(i) => &mut deck.instances[i].own,
    }
}
