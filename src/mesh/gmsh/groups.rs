//! Physical groups: which name an entity goes by, each name with one meaning.

use super::sections::{ElementBlock, Sections};
use std::collections::{HashMap, HashSet};

/// What Gmsh calls a group of a dimension.
pub fn noun(dimension: i32) -> &'static str {
    match dimension {
        0 => "physical point",
        1 => "physical curve",
        2 => "physical surface",
        _ => "physical volume",
    }
}

/// The named groups of a file.
pub struct Groups<'a> {
    sections: &'a Sections,
    names: HashMap<(i32, i32), &'a str>,
}

impl<'a> Groups<'a> {
    /// The groups of a file, once no name means two things.
    pub fn new(sections: &'a Sections) -> Result<Self, String> {
        let mut seen: HashMap<&str, i32> = HashMap::new();
        let mut names = HashMap::new();
        for group in &sections.groups {
            if let Some(other) = seen.insert(&group.name, group.dimension) {
                let (one, two) = (noun(other), noun(group.dimension));
                let name = &group.name;
                return Err(format!(
                    "the name {name:?} is used twice, for a {one} and a {two}. Give each its own name"
                ));
            }
            names.insert((group.dimension, group.tag), group.name.as_str());
        }
        let groups = Groups { sections, names };
        groups.check_used()?;
        Ok(groups)
    }

    /// Names of the groups of a dimension, in the order of the file.
    pub fn names(&self, dimension: i32) -> impl Iterator<Item = &'a str> {
        let groups = self.sections.groups.iter();
        groups.filter(move |group| group.dimension == dimension).map(|group| group.name.as_str())
    }

    /// The named groups that a block of elements is in.
    pub fn of_block(&self, block: &ElementBlock) -> Vec<&'a str> {
        let tags = self.tags(block);
        tags.iter().filter_map(|&tag| self.names.get(&(block.dimension, tag)).copied()).collect()
    }

    /// The one part that a block of volume elements is in.
    pub fn part_of_block(&self, block: &ElementBlock) -> Result<&'a str, String> {
        let (entity, tags) = (block.entity, self.tags(block));
        match (&self.of_block(block)[..], tags) {
            ([part], [_]) => Ok(part),
            (_, []) => Err(format!(
                "volume {entity} is in no physical volume. Add Physical Volume(\"name\") = {{{entity}}}, or leave Mesh.SaveAll off"
            )),
            (_, [tag]) => Err(format!("physical volume {tag} has no name. Write Physical Volume(\"name\") = {{...}}")),
            (parts, _) => {
                Err(format!("volume {entity} is in several physical volumes: {}. Leave it in one", parts.join(", ")))
            }
        }
    }

    fn tags(&self, block: &ElementBlock) -> &'a [i32] {
        self.sections.entities.get(&(block.dimension, block.entity)).map_or(&[], Vec::as_slice)
    }

    /// A named group without elements is a mistake of the geometry script (mostly a number that is no longer right).
    fn check_used(&self) -> Result<(), String> {
        let blocks = self.sections.blocks.iter().filter(|block| !block.elements.is_empty());
        let used: HashSet<&str> = blocks.flat_map(|block| self.of_block(block)).collect();
        match self.sections.groups.iter().find(|group| !used.contains(group.name.as_str())) {
            None => Ok(()),
            Some(group) => Err(format!(
                "the {} {:?} has no elements. Correct the entities it lists, or remove it",
                noun(group.dimension),
                group.name
            )),
        }
    }
}
