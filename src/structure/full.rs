//! A brake with all nodes of its mesh.

use std::collections::BTreeMap;
use std::path::Path;

use crate::assembly::joints::Sets;
use crate::assembly::{self, Boundary, Joints, System, add_prescribed};
use crate::contact::search::Team;
use crate::contact::{ContactPair, Interface, Response};
use crate::deck::DeckSummary;
use crate::element::solid::{MassProperties, mass_properties};
use crate::mesh::{Mesh, Numbering, Piece};
use crate::model::{self, Fix, Load, LoadKind, Model, is_deck};
use crate::native::{Comm, Vector};
use crate::reduction;
use crate::results::{About, ContactFaces, Pair, Part};
use crate::{Error, Result};

use super::contact_surface::{ContactSurface, Fields};
use super::digest::digest_of_text;
use super::distribution::distribute;
use super::files::{ModelFiles, SharedFiles};
use super::{digest, free_motions, pairs, plausibility};

/// A model with its mesh and contact interface. Each rank has its piece of the mesh ([`Piece`]), and all that is on
/// surfaces: contact, loads and supports, in the numbers of its own piece.
pub struct FullModel {
    /// What the user wrote.
    pub model: Model,
    /// This rank's piece of the mesh, m.
    pub mesh: Mesh,
    /// The numbers of its nodes among all, and which of them the rank owns.
    pub nodes: Numbering,
    /// Contact points of all pairs.
    pub interface: Interface,
    /// Forces (N) at nodes, without gravity.
    pub loads: Vec<(u32, [f64; 3])>,
    /// Forces of gravity (N) at the nodes that this rank owns.
    pub weights: Vec<(u32, [f64; 3])>,
    /// Which displacements of each node are prescribed.
    pub held: Vec<[bool; 3]>,
    /// Those of them that are not zero in the equilibrium, m.
    pub prescribed: BTreeMap<u32, [f64; 3]>,
    /// Connectors, ties, rigid sets, equations and point masses.
    pub joints: Joints,
    /// What was understood of the deck, where there is one.
    pub deck: Option<DeckSummary>,
    /// The text of the model file as it was read; none where a deck was read, or nothing.
    pub text: Option<String>,
}

/// An overlap of contact surfaces below this is rounding of the mesh, m: machined surfaces are rougher.
const SMALLEST_OVERLAP: f64 = 1e-8;

impl FullModel {
    /// Reads and checks model and mesh and finds the contact points; each rank has its piece of the mesh. Collective:
    /// all ranks fail together.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line, whatever is wrong.
    pub fn read(comm: &Comm, path: &Path) -> Result<FullModel> {
        FullModel::from_files(comm, path, &mut |_| (), |model, mesh| Ok((model, mesh)))
    }

    /// Reads model and mesh, changes both, and gives each rank its piece; `finished` is called with the name of each
    /// stage at its end. Collective.
    ///
    /// # Errors
    /// Those of reading and of the change.
    pub(super) fn from_files(
        comm: &Comm,
        path: &Path,
        finished: &mut dyn FnMut(&str),
        change: impl Fn(Model, Option<Mesh>) -> Result<(Model, Option<Mesh>)>,
    ) -> Result<FullModel> {
        let SharedFiles { model, mesh, deck, text } = ModelFiles::shared(comm, path)?;
        let (model, mesh) = comm.agree(change(model, mesh))?;
        finished("reading model and mesh");
        let piece = distribute(comm, || Ok(mesh.expect("the root has read it")))?;
        finished("dividing the mesh");
        let full = comm.agree(FullModel::new(model, piece, comm))?;
        finished("finding contact points");
        Ok(FullModel { deck, text, ..full })
    }

    /// Reads a brake, with so many reference pairs in place of the contact points of the sliding pairs where
    /// `n_contacts` asks for them. Collective.
    ///
    /// # Errors
    /// See [`FullModel::read`] and [`reduction::contacts::reduce`].
    pub fn read_with_contacts(comm: &Comm, path: &Path, n_contacts: Option<usize>) -> Result<FullModel> {
        FullModel::read_in_stages(comm, path, n_contacts, &mut |_| ())
    }

    /// As [`FullModel::read_with_contacts`]; `finished` is called with the name of each stage at its end. Collective.
    ///
    /// # Errors
    /// As [`FullModel::read_with_contacts`].
    pub fn read_in_stages(
        comm: &Comm,
        path: &Path,
        n_contacts: Option<usize>,
        finished: &mut dyn FnMut(&str),
    ) -> Result<FullModel> {
        let mut brake = FullModel::from_files(comm, path, finished, |model, mesh| Ok((model, mesh)))?;
        n_contacts.map_or(Ok(()), |n| brake.reduce_contacts(n))?;
        Ok(brake)
    }

    /// Puts `n` reference pairs in place of the contact points of the sliding pairs.
    ///
    /// # Errors
    /// See [`reduction::contacts::reduce`].
    pub fn reduce_contacts(&mut self, n: usize) -> Result<()> {
        self.interface = reduction::contacts::reduce(&self.model, &self.mesh, &self.interface, n)?;
        Ok(())
    }

    /// A brake of a model and this rank's piece of its mesh, the contact points found by all of the team.
    ///
    /// # Errors
    /// [`Error::Input`] where the two do not go together, or a contact has no points.
    pub fn new(model: Model, piece: Piece, team: &dyn Team) -> Result<FullModel> {
        let Piece { mesh, nodes } = piece;
        model.check_against(&mesh)?;
        let interface = Interface::build(&model, &mesh, team)?;
        let held = assembly::constraints(&model, &mesh)?;
        let prescribed = assembly::prescribed(&model, &mesh)?;
        refuse_moved_contacts(&model, &interface, &prescribed)?;
        let sets = Sets::new(&model, &mesh, &nodes)?;
        let loads = assembly::loads(&model, &mesh, &sets)?;
        let weights = assembly::weights(&model, &mesh, &nodes, &sets)?;
        let joints = Joints::new(&model, &mesh, &nodes, &sets, team)?;
        let (deck, text) = (None, None);
        Ok(FullModel { model, mesh, nodes, interface, loads, weights, held, prescribed, joints, deck, text })
    }

    /// Refuses a brake of which a part is unconstrained, or constrained by contacts that nothing presses. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] that names the parts and their free motions.
    pub fn require_constrained(&self, comm: &Comm) -> Result<()> {
        let free = self.free_motions(comm, &self.interface);
        if free.is_empty() {
            return self.require_load(comm);
        }
        let open = self.interface.pairs.iter().filter(|pair| pair.separation && pair.statistics.touching == 0);
        let smallest = |pair: &ContactPair| pair.statistics.gap[0] / self.model.mesh_unit;
        let open: Vec<String> =
            open.map(|pair| format!("{} (at least {:.3e}, in the mesh's unit)", pair.name, smallest(pair))).collect();
        let gaps = match open[..] {
            [] => String::new(),
            _ => format!(
                ", or close the gap of {} by adjust = DISTANCE in its [[contact]]: a contact that may open constrains only where it \
                 touches",
                open.join(", ")
            ),
        };
        Err(Error::input(format!(
            "{}: unconstrained:\n{free}\nAdd a [[fix]], a [[connector]], a [[tie]] or a [[contact]] that stops these motions{gaps}. \
             Parts that are glued share nodes (BooleanFragments in Gmsh), or need a [[tie]]",
            self.model.file.display()
        )))
    }

    /// Refuses a brake with prescribed displacements, which a super-element does not retain.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the support.
    pub fn require_no_prescribed(&self) -> Result<()> {
        let what = "a displacement other than zero cannot be reduced. Press the parts together by a [[load]]";
        let moved = self.model.fixes.iter().find(|fix| fix.moves());
        moved.map_or(Ok(()), |fix| Err(self.model.error(fix.place, format_args!("fix of {:?}: {what}", fix.nodes))))
    }

    /// Refuses a brake with factors on a normal law, of which a super-element keeps one a pair.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the contact.
    pub fn require_pair_laws(&self) -> Result<()> {
        let what = "a super-element has one normal law a pair. Leave out stiffness_factor";
        let scaled = self.model.contacts.iter().find(|contact| contact.stiffness_field.is_some());
        let refuse =
            |own: &model::Contact| Err(self.model.error(own.place, format_args!("contact {:?}: {what}", own.name)));
        scaled.map_or(Ok(()), refuse)
    }

    /// Refuses a brake of which a part has no mass, so that it has no modes.
    ///
    /// # Errors
    /// [`Error::Input`] that names the material.
    pub fn require_mass(&self) -> Result<()> {
        match self.model.parts.iter().find(|part| part.material.density == 0.0) {
            None => Ok(()),
            Some(model::Part { name, material, place, .. }) => {
                let what = format_args!("the material {:?} of the part {name:?} has no density", material.name);
                Err(self.model.error(*place, format_args!("{what}, so that there are no modes. Give its density")))
            }
        }
    }

    /// The motions that nothing resists, a line each, with the contacts of an interface. Collective.
    fn free_motions(&self, comm: &Comm, interface: &Interface) -> String {
        let free = free_motions(comm, &self.mesh, &self.nodes, interface, &self.held, &self.joints);
        free.iter().map(|motion| format!("  {motion}")).collect::<Vec<_>>().join("\n")
    }

    /// Whether nothing presses the contacts together: there is no load, and no overlap that is meant.
    pub fn is_unloaded(&self) -> bool {
        let is_zero = |load: &Load| match load.kind {
            LoadKind::ForceByNode(force) | LoadKind::ForceByArea(force) => force == [0.0; 3],
            LoadKind::ForceAt { force, moment, .. } => [force, moment] == [[0.0; 3]; 2],
            LoadKind::Pressure(pressure) => pressure == 0.0,
            LoadKind::Gravity(acceleration) => acceleration == [0.0; 3],
        };
        let overlaps = |pair: &ContactPair| pair.separation && pair.statistics.gap[0] < -SMALLEST_OVERLAP;
        let is_moved = self.model.fixes.iter().any(Fix::moves);
        self.model.loads.iter().all(is_zero) && !is_moved && !self.interface.pairs.iter().any(overlaps)
    }

    /// Refuses a brake whose parts only contacts constrain, where nothing presses these: its equilibrium is not unique.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Input`] that names the parts and their free motions.
    pub fn require_load(&self, comm: &Comm) -> Result<()> {
        if !self.is_unloaded() {
            return Ok(());
        }
        let mut open = self.interface.clone();
        open.points.iter_mut().for_each(|point| point.law.touching = false);
        let free = self.free_motions(comm, &open);
        if free.is_empty() {
            return Ok(());
        }
        Err(Error::input(format!(
            "{}: no load presses the contacts together, which alone stop these motions:\n{free}\n\
             Give a [[load]] with a force or a pressure other than zero: without pressure there is no friction and no squeal",
            self.model.file.display()
        )))
    }

    /// The elements that this rank counts where each is to be counted once: those of whose first node it is the owner.
    pub fn own_elements(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..self.mesh.elements.len()).filter(|&e| self.nodes.owns(self.mesh.elements.get(e).nodes[0]))
    }

    /// Mass and moments of a part, by its place in the mesh's list. Collective.
    ///
    /// # Panics
    /// Where the model does not have the part, against which it was checked.
    pub fn part_properties(&self, comm: &Comm, part: usize) -> MassProperties {
        let name = &self.mesh.parts[part];
        let density =
            self.model.parts.iter().find(|p| p.name == *name).expect("checked against the mesh").material.density;
        let mut own = MassProperties::default();
        for (e, element) in self.own_elements().map(|e| (e, self.mesh.elements.get(e))) {
            if element.part as usize == part {
                own += mass_properties(element.shape(), &self.mesh.element_nodes(e), density);
            }
        }
        let MassProperties { mass, first_moment, second_moment: [x, y, z] } = own;
        let mut sums = [[mass, 0.0, 0.0], first_moment, x, y, z];
        comm.sum_all(sums.as_flattened_mut());
        let [[mass, ..], first_moment, x, y, z] = sums;
        MassProperties { mass, first_moment, second_moment: [x, y, z] }
    }

    /// The outer surface of all parts. Collective.
    pub fn boundary(&self, comm: &Comm, system: &System) -> Boundary {
        Boundary::new(comm, &self.mesh, &self.nodes, &system.dofs)
    }

    /// Displacements (m) of an equilibrium at the nodes that this rank has, prescribed ones included. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn displacements(&self, system: &System, u: &Vector) -> Result<Vec<[f64; 3]>> {
        let mut nodal = system.nodal(&[u])?.remove(0);
        add_prescribed(&mut nodal, &self.prescribed);
        Ok(nodal)
    }

    /// The values of the friction coefficient to analyse: those given, else the model's sweep, else the swept pairs'
    /// own.
    ///
    /// # Errors
    /// [`Error::Input`] where no pair slides; where none is given and the pairs differ.
    pub fn friction_values(&self, given: Option<&[f64]>) -> Result<Vec<f64>> {
        super::friction::friction_values(given, &self.model.frictions, &self.interface, &self.model.file)
    }

    /// The friction coefficient of the swept pairs in the model file; 0 where no pair slides.
    ///
    /// # Errors
    /// [`Error::Input`] where they differ.
    pub fn own_friction(&self) -> Result<f64> {
        super::friction::own_friction(&self.interface, &self.model.file).map(|own| own.unwrap_or(0.0))
    }

    /// SHA-256 of the model's file, with its fields of gaps and factors where it has any, and of the mesh's; the root
    /// has them. Collective.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn digests(&self, comm: &Comm) -> Result<[String; 2]> {
        let both = || {
            let gaps = self.model.contacts.iter().filter_map(|contact| Some(&contact.gap_field.as_ref()?.file));
            let factors =
                self.model.contacts.iter().filter_map(|contact| Some(&contact.stiffness_field.as_ref()?.file));
            let fields = gaps.chain(factors).map(|file| digest(file)).collect::<Result<Vec<String>>>()?;
            let model = digest(&self.model.file)?;
            let model = if fields.is_empty() { model } else { digest_of_text(&(model + &fields.concat())) };
            Ok([model, digest(&self.model.mesh_file)?])
        };
        comm.agree(if comm.is_root() { both() } else { Ok([String::new(), String::new()]) })
    }

    /// Title, files with their digests, sizes, parts and pairs. Collective.
    pub(super) fn about(&self, comm: &Comm) -> Result<About> {
        let material =
            |name: &String| self.model.parts.iter().find(|part| part.name == *name).map(|p| p.material.name.clone());
        let part = |(i, name): (usize, &String)| Part {
            name: name.clone(),
            material: material(name).unwrap_or_default(),
            mass: self.part_properties(comm, i).mass,
        };
        let parts = self.mesh.parts.iter().enumerate().map(part).collect();
        let n_elements = comm.sum(self.own_elements().count());
        let [model_digest, mesh_digest] = self.digests(comm)?;
        let file = &self.model.file;
        // A deck is a mesh, too: its text would fill the results.
        let text = match is_deck(file) {
            true => Ok(model::write(&self.model, &file.display().to_string())),
            false => std::fs::read_to_string(file).map_err(Error::io(file)),
        };
        let text = comm.agree(text)?;
        Ok(About {
            title: self.model.title.clone(),
            model: self.model.file.display().to_string(),
            model_digest,
            model_text: text,
            mesh: self.model.mesh_file.display().to_string(),
            mesh_digest,
            n_nodes: self.nodes.n_global(),
            n_elements,
            parts,
            unloaded: self.is_unloaded(),
            undamped: !self.model.is_damped(),
            structural_damping: self.model.has_structural_damping(),
            viscoelastic: self.model.viscoelastic_part().is_some(),
            warnings: plausibility::warnings(self, comm),
            pairs: self.pairs(),
            ..About::default()
        })
    }

    /// The contact pairs, with the stiffness that the program proposes for those without one.
    fn pairs(&self) -> Vec<Pair> {
        let proposed = self.model.proposed(&self.mesh);
        let of = |name: &str| proposed.iter().find(|own| own.contact == name).map(|own| own.stiffness);
        let mut pairs = pairs(&self.interface);
        pairs.iter_mut().for_each(|pair| pair.proposed_stiffness = of(&pair.name));
        pairs
    }

    pub(super) fn contact_faces(&self) -> ContactFaces {
        ContactSurface::new(&self.mesh, &self.interface, &[]).faces(&self.mesh)
    }

    pub(super) fn contact_fields(&self, responses: &[Response]) -> (Vec<f64>, Vec<i32>) {
        let Fields { pressure, status, .. } = ContactSurface::new(&self.mesh, &self.interface, responses).fields;
        (pressure, status)
    }

    pub(super) fn dof_labels(&self, system: &System) -> Vec<String> {
        let label = |node: u32| {
            let ([x, y, z], number) = (self.mesh.nodes[node as usize], self.nodes.labels()[node as usize] + 1);
            let free = (0..3).filter(move |&i| system.dofs.node_dofs(node)[i] >= 0);
            free.map(move |i| format!("node,{number},{},{x:e},{y:e},{z:e}", ["x", "y", "z"][i]))
        };
        system.dofs.owned_nodes().flat_map(label).collect()
    }
}
/// Refuses prescribed displacements of contact points: their gaps would change without a displacement of the system.
fn refuse_moved_contacts(model: &Model, interface: &Interface, prescribed: &BTreeMap<u32, [f64; 3]>) -> Result<()> {
    let is_moved = |a: usize| interface.gap_operator.point(a).0.iter().any(|node| prescribed.contains_key(node));
    let Some(pair) = interface.pairs.iter().find(|pair| pair.points.clone().any(is_moved)) else { return Ok(()) };
    let place = model.contacts.iter().find(|own| own.name == pair.name).map_or(model.mesh_place, |own| own.place);
    let what = format_args!(
        "contact {:?}: a [[fix]] with a displacement moves nodes of the contact. Move nodes behind the contact's surfaces",
        pair.name
    );
    Err(model.error(place, what))
}
