//! Parts and their elements: a part for each section of the deck, in each instance.

use super::materials;
use super::orientations::orientation;
use crate::Result;
use crate::deck::assembly::Assembly;
use crate::deck::elements::Class;
use crate::deck::sets::Kind;
use crate::deck::types::{Entry, Orientation, Section};
use crate::element::ElementKind;
use crate::element::solid::is_inverted;
use crate::mesh::Mesh;
use crate::model::{Part, UnitSystem};

/// Mark of a node that no solid uses, and of an element without a section.
pub const UNUSED: u32 = u32::MAX;

/// Kinds of element that are read as another: Abaqus's modified and hybrid tetrahedra.
const READ_AS: [(&str, ElementKind); 2] = [("C3D10M", ElementKind::C3D10), ("C3D10HS", ElementKind::C3D10)];

/// A section in an instance.
pub struct SectionOf<'d> {
    /// The section.
    pub section: &'d Section,
    /// Axes of its material.
    pub orientation: Option<&'d Orientation>,
    /// Name of the part that it makes.
    pub name: String,
    /// Index of its space.
    pub space: usize,
}

/// All sections of all instances.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where there is none, or an orientation is missing.
pub fn sections<'d>(assembly: &Assembly<'d>) -> Result<Vec<SectionOf<'d>>> {
    let deck = assembly.deck;
    let mut all: Vec<SectionOf> = Vec::new();
    for (space, scopes) in assembly.spaces.iter().enumerate() {
        let sections: Vec<&Section> = scopes.scopes.iter().flat_map(|scope| &scope.sections).collect();
        for section in &sections {
            let wanted = section.orientation.as_ref();
            let orientation = wanted.map(|name| orientation(assembly, space, name, section.place)).transpose()?;
            let own = deck.spelled(&section.set);
            let instance = deck.spelled(&scopes.name);
            let name = match (instance.is_empty(), sections.len()) {
                (true, _) => own,
                (false, 1) => instance,
                (false, _) => format!("{instance}.{own}"),
            };
            let name = super::regions::unlike(&name, |name| all.iter().any(|other| other.name == name), "part");
            all.push(SectionOf { section, orientation, name, space });
        }
    }
    if all.is_empty() {
        let what = "there is no *SOLID SECTION, so that no element has a material";
        return Err(crate::Error::input(format!("{}: {what}", deck.files[0].display())));
    }
    Ok(all)
}

/// The parts, and where nodes and elements of the assembly are in the mesh.
pub struct Bodies {
    /// The parts, in the order of the sections.
    pub parts: Vec<Part>,
    /// Part of each element of the assembly.
    pub part_of: Vec<u32>,
    /// Mesh node of each node of the assembly.
    pub node_of: Vec<u32>,
}

impl Bodies {
    /// Parts and mesh; what was done with them is noted.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input): elements that cannot be analysed, that are inverted, or whose section is
    /// missing or not the only one.
    pub fn new(
        assembly: &Assembly,
        sections: &[SectionOf],
        units: &UnitSystem,
        notes: &mut Vec<String>,
    ) -> Result<(Bodies, Mesh)> {
        let mut bodies = Bodies {
            parts: Vec::new(),
            part_of: vec![UNUSED; assembly.elements.len()],
            node_of: vec![UNUSED; assembly.coordinates.len()],
        };
        for section in sections {
            bodies.add(assembly, section, units)?;
        }
        notes.extend(bodies.separate(assembly)?);
        let mut mesh = Mesh { parts: bodies.parts.iter().map(|part| part.name.clone()).collect(), ..Mesh::default() };
        bodies.elements(assembly, &mut mesh)?;
        bodies.nodes(assembly, units.length, &mut mesh);
        check_inverted(assembly, &mesh)?;
        Ok((bodies, mesh))
    }

    fn add(&mut self, assembly: &Assembly, of: &SectionOf, units: &UnitSystem) -> Result<()> {
        let place = of.section.place;
        let part = self.parts.len() as u32;
        let entry = Entry::Name(of.section.set.as_str().into());
        for element in assembly.set(Kind::Element, of.space, &entry, place)? {
            if !matches!(assembly.elements[element as usize].kind.class, Class::Solid(_)) {
                continue;
            }
            let known = std::mem::replace(&mut self.part_of[element as usize], part);
            if known != UNUSED {
                let number = assembly.elements[element as usize].number;
                let (one, two) = (&self.parts[known as usize].name, &of.name);
                let what = format_args!("element {number} is in two sections, of {one} and of {two}. Leave it in one");
                return Err(assembly.error(place, what));
            }
        }
        let (material, rayleigh) = materials::material(assembly, of, units)?;
        self.parts.push(Part { name: of.name.clone(), material, rayleigh, elements: Vec::new(), place });
        Ok(())
    }

    /// The elements in the order of the deck.
    fn elements(&self, assembly: &Assembly, mesh: &mut Mesh) -> Result<()> {
        let mut has_elements = vec![false; mesh.parts.len()];
        for e in assembly.solids() {
            let (element, part) = (&assembly.elements[e as usize], self.part_of[e as usize]);
            let (number, kind) = (element.number, element.kind.name);
            if part == UNUSED {
                let what = format_args!("element {number} is in no *SOLID SECTION, so that it has no material");
                return Err(assembly.error(element.place, what));
            }
            let alias = READ_AS.iter().find(|(name, _)| *name == kind).map(|(_, as_kind)| *as_kind);
            let kind = alias.or_else(|| ElementKind::from_name(kind)).ok_or_else(|| {
                assembly.error(element.place, format_args!("element {number} is a {kind}, which is not analysed"))
            })?;
            mesh.elements.push(kind, part, assembly.nodes(e));
            has_elements[part as usize] = true;
        }
        match mesh.parts.iter().enumerate().find(|(part, _)| !has_elements[*part]) {
            None => Ok(()),
            Some((part, name)) => {
                Err(assembly.error(self.parts[part].place, format_args!("the section of {name} has no solid elements")))
            }
        }
    }

    /// Numbers the nodes that solids use in the order of the assembly, and scales them to metres.
    fn nodes(&mut self, assembly: &Assembly, length: f64, mesh: &mut Mesh) {
        mesh.elements.all_nodes().0.iter().for_each(|&node| self.node_of[node as usize] = 0);
        for (node, x) in self.node_of.iter_mut().zip(&assembly.coordinates) {
            if *node != UNUSED {
                *node = mesh.nodes.len() as u32;
                mesh.nodes.push(x.map(|x| x * length));
            }
        }
        mesh.elements.renumber(|node| self.node_of[node as usize]);
    }

    /// Mesh nodes of nodes of the assembly; those that no solid uses are left out.
    pub fn used(&self, nodes: &[u32]) -> Vec<u32> {
        let mut used: Vec<u32> = nodes.iter().map(|&node| self.node_of[node as usize]).collect();
        used.retain(|&node| node != UNUSED);
        used.sort_unstable();
        used.dedup();
        used
    }
}

/// Refuses inverted elements.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) that names the first one.
pub fn check_inverted(assembly: &Assembly, mesh: &Mesh) -> Result<()> {
    let is_bad = |e: &usize| is_inverted(mesh.elements.get(*e).shape(), &mesh.element_nodes(*e));
    let inverted: Vec<usize> = (0..mesh.elements.len()).filter(is_bad).collect();
    let Some(&first) = inverted.first() else { return Ok(()) };
    let element = assembly.solids().nth(first).map(|e| &assembly.elements[e as usize]).expect("as many as in the mesh");
    let (n, all, number) = (inverted.len(), mesh.elements.len(), element.number);
    let part = &mesh.parts[mesh.elements.get(first).part as usize];
    let what = format_args!(
        "{n} of {all} elements are inverted (Jacobian 0 or below), first element {number} of the part {part:?}. Mesh finer \
         where the surface is curved, or straighten its edges"
    );
    Err(assembly.error(element.place, what))
}
