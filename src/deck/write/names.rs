//! Names as decks may have them: letters, digits, `_` and `-`, no two alike but for their case.

use std::collections::HashMap;

use crate::mesh::Mesh;
use crate::model::{Model, Part};

/// Longest name that Abaqus and CalculiX read.
const LONGEST: usize = 72;

/// The deck's names of parts, regions and turning parts.
pub struct Names {
    parts: HashMap<String, String>,
    regions: HashMap<String, String>,
    turning: HashMap<String, String>,
    materials: HashMap<String, String>,
}

impl Names {
    /// Names for all that a model and its mesh have.
    pub fn new(model: &Model, mesh: &Mesh) -> Names {
        let regions: Vec<&String> = mesh.surfaces.keys().chain(mesh.node_sets.keys()).collect();
        let turning: Vec<String> = model.rotations.iter().map(|rotation| format!("{}-nodes", rotation.part)).collect();
        let own = distinct(regions.iter().map(|name| name.as_str()).chain(turning.iter().map(String::as_str)));
        let (of_regions, of_turning) = own.split_at(regions.len());
        let parts = model.rotations.iter().map(|rotation| rotation.part.clone());
        Names {
            parts: pairs(mesh.parts.iter().cloned(), &distinct(mesh.parts.iter().map(String::as_str))),
            regions: pairs(regions.into_iter().cloned(), of_regions),
            turning: pairs(parts, of_turning),
            materials: materials(&model.parts),
        }
    }

    /// The element set of a part.
    pub fn part(&self, name: &str) -> &str {
        self.parts.get(name).map_or("", String::as_str)
    }

    /// A surface or node set.
    pub fn region(&self, name: &str) -> &str {
        self.regions.get(name).map_or("", String::as_str)
    }

    /// The node set of a turning part.
    pub fn turning(&self, part: &str) -> &str {
        self.turning.get(part).map_or("", String::as_str)
    }

    /// The material of a part.
    pub fn material(&self, part: &str) -> &str {
        self.materials.get(part).map_or("", String::as_str)
    }
}

/// The materials of the parts: parts of the same material and damping share one.
fn materials(parts: &[Part]) -> HashMap<String, String> {
    let is_same = |a: &Part, b: &Part| a.material == b.material && a.rayleigh == b.rayleigh;
    let first = |part: &Part| parts.iter().position(|other| is_same(other, part)).expect("the part itself is there");
    let firsts: Vec<usize> = parts.iter().map(first).collect();
    let mut own: Vec<usize> = firsts.clone();
    own.sort_unstable();
    own.dedup();
    let names = distinct(own.iter().map(|&i| parts[i].material.name.as_str()));
    let name = |first: &usize| names[own.binary_search(first).expect("it is among them")].clone();
    parts.iter().zip(&firsts).map(|(part, first)| (part.name.clone(), name(first))).collect()
}

fn pairs(ours: impl Iterator<Item = String>, theirs: &[String]) -> HashMap<String, String> {
    ours.zip(theirs.iter().cloned()).collect()
}

/// Names that a deck may have, one for each.
fn distinct<'n>(names: impl Iterator<Item = &'n str>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for name in names {
        let plain: String =
            name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' }).collect();
        let mut plain = plain[..plain.len().min(LONGEST)].to_owned();
        if !plain.starts_with(|c: char| c.is_ascii_alphabetic()) {
            plain.insert(0, 'N');
        }
        let is_taken = |all: &[String], name: &str| all.iter().any(|other| other.eq_ignore_ascii_case(name));
        let numbered = (1..).map(|i| if i == 1 { plain.clone() } else { format!("{plain}-{i}") });
        let free = numbered.into_iter().find(|name| !is_taken(&all, name)).expect("one of them is free");
        all.push(free);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_distinct() {
        let names = distinct(["disc / pad", "disc_/_pad", "Disc___Pad", "12", "café"].into_iter());
        assert_eq!(names, ["disc___pad", "disc___pad-2", "Disc___Pad-3", "N12", "caf_"]);
    }
}
