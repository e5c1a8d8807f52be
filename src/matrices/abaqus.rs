//! Matrices as Abaqus writes them, as text:
//!
//! ```text
//! *MATRIX OUTPUT, FORMAT=MATRIX INPUT or LABELS     101,2, 101,1,  3.57142857142857e+01   node, dof, node, dof, value
//! *MATRIX OUTPUT, FORMAT=COORDINATE                 2  1  3.57142857142857e+01            row, column, value
//! *SUBSTRUCTURE MATRIX OUTPUT, and CalculiX's       *USER ELEMENT, NODES= 4, LINEAR
//!                                                   ** ELEMENT NODES
//!                                                   ** 101, 102, 103, 104
//!                                                   1, 2                             dofs of the first node
//!                                                   3, 1, 2, 6                       those from the third node on
//!                                                   *MATRIX,TYPE=STIFFNESS
//!                                                   98.9, 35.7, 98.9, ...            rows up to the diagonal, or whole
//! ```
//!
//! Of a symmetric matrix one triangle is there, of an unsymmetric one both. Internal nodes have negative labels. A
//! displacement that is constrained to zero has 1e36 on its diagonal. Source: Abaqus Analysis User's Guide, *Generating
//! matrices* and *User-defined elements*; keywords `*MATRIX OUTPUT`, `*MATRIX INPUT`, `*SUBSTRUCTURE MATRIX OUTPUT`,
//! `*USER ELEMENT`.

use std::collections::HashMap;

use super::Role;
use super::entries::{Dof, Entries, Naming, Storage};
use super::lines::Lines;
use crate::Result;

/// Where a file is.
enum Section {
    /// Lines of entries.
    Entries,
    /// A comment has said that the element's nodes come.
    Nodes,
    /// Lines of the element's dofs.
    Dofs,
    /// Values of an element's matrix; whether it is the one wanted.
    Values(bool),
}

/// Reads a file whose first line is the current one; of a substructure, which may hold several, the matrix of this
/// role.
///
/// # Errors
/// [`crate::Error::Input`] with file and line, whatever is wrong.
pub fn read(lines: &mut Lines, role: Role) -> Result<Entries> {
    let mut section = Section::Entries;
    let (mut listed, mut element) = (Listed::default(), Element::default());
    loop {
        let text = lines.text().to_owned();
        if let Some(comment) = text.strip_prefix("**") {
            section = element.comment(lines, comment, section)?;
        } else if let Some(keyword) = text.strip_prefix('*') {
            section = element.keyword(lines, keyword, role, section, &mut listed)?;
        } else if !text.is_empty() {
            match section {
                Section::Entries => listed.add(lines, &text)?,
                Section::Nodes | Section::Dofs => element.add_dofs(lines, &text)?,
                Section::Values(true) => element.add_values(lines, &text)?,
                Section::Values(false) => {}
            }
        }
        if !lines.advance()? {
            break;
        }
    }
    match (element.nodes.is_empty(), listed.items.is_empty()) {
        (true, true) => Err(lines.error("there is no matrix in this file")),
        (true, false) => Ok(listed.entries()),
        (false, _) => element.entries(lines, role),
    }
}

/// Parts of a line between commas, or where there are none between white space.
fn fields(text: &str) -> Vec<&str> {
    match text.contains(',') {
        true => text.split(',').map(str::trim).filter(|field| !field.is_empty()).collect(),
        false => text.split_whitespace().collect(),
    }
}

/// Entries one to a line.
#[derive(Default)]
struct Listed {
    dofs: Vec<Dof>,
    place: HashMap<Dof, u32>,
    n_rows: usize,
    items: Vec<(u32, u32, f64)>,
    is_unsymmetric: bool,
}

impl Listed {
    fn add(&mut self, lines: &Lines, text: &str) -> Result<()> {
        let fields = fields(text);
        let is_labelled = match (fields.len(), self.items.is_empty(), self.dofs.is_empty()) {
            (5, true, _) | (5, _, false) => true,
            (3, true, _) | (3, _, true) => false,
            (3 | 5, ..) => return Err(lines.error("this line has another number of fields than the ones before")),
            _ => {
                let what = "Matrix Market (%%MatrixMarket), Abaqus's (node, dof, node, dof, value or row, column, value) nor PETSc's";
                return Err(lines.error(format!("{text:?} is no entry of a matrix: the file is neither {what}")));
            }
        };
        let value = lines.number(fields[fields.len() - 1])?;
        let [i, j] = if is_labelled {
            [self.labelled(lines, &fields[..2])?, self.labelled(lines, &fields[2..4])?]
        } else {
            [row(lines, fields[0])?, row(lines, fields[1])?]
        };
        self.n_rows = self.n_rows.max(i as usize + 1).max(j as usize + 1);
        self.items.push((i, j, value));
        Ok(())
    }

    fn labelled(&mut self, lines: &Lines, fields: &[&str]) -> Result<u32> {
        let axis = lines.whole(fields[1])?;
        let axis = i32::try_from(axis).map_err(|_| lines.error(format!("{axis} is no degree of freedom")))?;
        let dof = Dof { node: lines.whole(fields[0])?, axis };
        Ok(*self.place.entry(dof).or_insert_with(|| {
            self.dofs.push(dof);
            self.dofs.len() as u32 - 1
        }))
    }

    fn entries(self) -> Entries {
        let naming = if self.dofs.is_empty() { Naming::AtLeast(self.n_rows) } else { Naming::Dofs(self.dofs) };
        let storage = if self.is_unsymmetric { Storage::Full } else { Storage::Triangle };
        Entries { naming, items: self.items, storage }
    }
}

fn row(lines: &Lines, text: &str) -> Result<u32> {
    let number = lines.whole(text)?;
    let place = number.checked_sub(1).filter(|i| (0..i64::from(i32::MAX)).contains(i));
    place.map(|i| i as u32).ok_or_else(|| lines.error(format!("row and column numbers begin with 1; here is {number}")))
}

/// A user element: a substructure.
#[derive(Default)]
struct Element {
    nodes: Vec<i64>,
    /// From which node on (from 0) which dofs.
    dofs: Vec<(usize, Vec<i32>)>,
    values: Vec<f64>,
}

impl Element {
    fn comment(&mut self, lines: &Lines, comment: &str, section: Section) -> Result<Section> {
        if comment.to_uppercase().contains("ELEMENT NODES") {
            return Ok(Section::Nodes);
        }
        if matches!(section, Section::Nodes) {
            for field in fields(comment) {
                self.nodes.push(lines.whole(field)?);
            }
        }
        Ok(section)
    }

    fn keyword(
        &mut self,
        lines: &Lines,
        keyword: &str,
        role: Role,
        section: Section,
        listed: &mut Listed,
    ) -> Result<Section> {
        let upper: String = keyword.to_uppercase().split_whitespace().collect();
        if upper.starts_with("USERELEMENT") {
            if !self.nodes.is_empty() {
                return Err(lines.error("a second element begins here. One substructure a file is read"));
            }
            return Ok(Section::Dofs);
        }
        let Some(options) = upper.strip_prefix("MATRIX") else { return Ok(section) };
        if self.nodes.is_empty() {
            listed.is_unsymmetric |= options.contains("TYPE=UNSYMMETRIC");
            return Ok(Section::Entries);
        }
        let wanted = match role {
            Role::Mass => "TYPE=MASS",
            Role::Damping => "TYPE=VISCOUSDAMPING",
            Role::Stiffness => "TYPE=STIFFNESS",
            Role::Structural => "TYPE=STRUCTURALDAMPING",
        };
        let is_wanted = options.contains(wanted);
        if is_wanted && !self.values.is_empty() {
            return Err(lines.error("here is a second matrix of this kind"));
        }
        Ok(Section::Values(is_wanted))
    }

    /// Dofs of the first node, or `node, dofs` where they change.
    fn add_dofs(&mut self, lines: &Lines, text: &str) -> Result<()> {
        let numbers: Vec<i64> = fields(text).into_iter().map(|field| lines.whole(field)).collect::<Result<_>>()?;
        let (from, dofs) = match self.dofs.is_empty() {
            true => (1, &numbers[..]),
            false => (numbers[0], &numbers[1..]),
        };
        if !(1..=self.nodes.len() as i64).contains(&from) {
            return Err(lines.error(format!("the element has {} nodes, and no node {from}", self.nodes.len())));
        }
        self.dofs.push((from as usize - 1, dofs.iter().map(|&dof| dof as i32).collect()));
        Ok(())
    }

    fn add_values(&mut self, lines: &Lines, text: &str) -> Result<()> {
        for field in fields(text) {
            self.values.push(lines.number(field)?);
        }
        Ok(())
    }

    fn entries(self, lines: &Lines, role: Role) -> Result<Entries> {
        let last = |node: usize| self.dofs.iter().rfind(|(from, _)| *from <= node).map(|(_, dofs)| dofs);
        let of = |(place, &node): (usize, &i64)| {
            last(place).into_iter().flatten().map(move |&axis| Dof { node, axis }).collect::<Vec<_>>()
        };
        let n: usize = (0..self.nodes.len()).map(|node| last(node).map_or(0, Vec::len)).sum();
        let found = self.values.len();
        if found == 0 {
            return Err(lines.error(format!("the substructure has no matrix of {}", role.name())));
        }
        let places: Vec<(u32, u32)> = match found {
            _ if found == n * (n + 1) / 2 => (0..n as u32).flat_map(|i| (0..=i).map(move |j| (i, j))).collect(),
            _ if found == n * n => (0..n as u32).flat_map(|j| (0..n as u32).map(move |i| (i, j))).collect(),
            _ => {
                let what = format!("the substructure has {n} degrees of freedom and {found} values of {}", role.name());
                return Err(lines.error(format!("{what}: {} or {} would be whole", n * (n + 1) / 2, n * n)));
            }
        };
        let dofs: Vec<Dof> = self.nodes.iter().enumerate().flat_map(of).collect();
        let items = places.into_iter().zip(self.values).map(|((i, j), value)| (i, j, value)).collect();
        Ok(Entries { naming: Naming::Dofs(dofs), items, storage: Storage::Triangle })
    }
}
