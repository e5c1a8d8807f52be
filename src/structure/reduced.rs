//! A brake as a super-element.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::assembly::System;
use crate::contact::{Interface, Response};
use crate::model::GapField;
use crate::native::{Block, Comm};
use crate::reduction::file;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::SuperElement;
use crate::results::{About, ContactFaces, Part};
use crate::{Error, Result};

use super::digest::digest_of_text;
use super::{FullModel, PartDamping, StructureOptions, contact_surface, digest, nodal_basis, pairs};

/// A super-element under a law and loads.
pub struct ReducedModel {
    place: PathBuf,
    /// The super-element.
    pub element: SuperElement,
    /// The outer surface and how the coordinates move it; of a file, on the root alone.
    pub surface: Rc<OuterSurface>,
    /// Contact points under the law.
    pub interface: Interface,
    /// How they differ from the file.
    options: StructureOptions,
}

impl ReducedModel {
    /// Reads the file of a super-element. Collective.
    ///
    /// # Errors
    /// See [`file::read`]; where arguments are for models.
    pub fn read(comm: &Comm, path: &Path, options: &StructureOptions) -> Result<ReducedModel> {
        if options.contacts.is_some() {
            let what = "a super-element has its contacts already; --contacts is for models";
            return Err(Error::input(format!("{}: {what}", path.display())));
        }
        // The first rank alone draws the surface.
        let bare = || Ok((file::read_element(path)?, OuterSurface::default()));
        let (element, surface) = comm.agree(if comm.is_root() { file::read(path) } else { bare() })?;
        if element.is_galerkin() && options.law.is_some() {
            let what =
                "--law is for node-to-node contacts, and this is a Galerkin super-element, whose contact points have";
            let advice = "the laws of the model. Multiply their stiffness by --contact-stiffness";
            return Err(Error::input(format!("{}: {what} {advice}", path.display())));
        }
        comm.agree(ReducedModel::with(path, element, surface, options))
    }

    /// A super-element under some options.
    ///
    /// # Errors
    /// [`Error::Input`] where it does not have a part whose damping is given, or a gap field is of another surface.
    pub fn with(
        file: &Path,
        mut element: SuperElement,
        surface: impl Into<Rc<OuterSurface>>,
        options: &StructureOptions,
    ) -> Result<ReducedModel> {
        for PartDamping { part, rayleigh } in &options.damping {
            element.set_rayleigh(part, *rayleigh)?;
        }
        let mut interface = element.interface(options.law.clone());
        interface.scale_contact_stiffness(options.contact_stiffness);
        options.gap.as_ref().map_or(Ok(()), |gap| set_gap_field(&mut interface, gap))?;
        let (place, options) = (file.to_owned(), options.clone());
        Ok(ReducedModel { place, element, surface: surface.into(), interface, options })
    }

    /// A super-element as it was made.
    pub fn new(file: &Path, element: SuperElement, surface: OuterSurface) -> ReducedModel {
        let (interface, options) = (element.interface(None), StructureOptions::default());
        ReducedModel { place: file.to_owned(), element, surface: surface.into(), interface, options }
    }

    /// Its file.
    pub fn file(&self) -> &Path {
        &self.place
    }

    /// Refuses a super-element that cannot be compared with its full model.
    ///
    /// # Errors
    /// [`Error::Input`] where its file does not have the basis.
    pub fn require_basis(&self) -> Result<()> {
        if file::has_basis(&self.place) {
            return Ok(());
        }
        let what = "the super-element's file has no basis, without which it cannot be compared with its full model";
        let advice = "Make it again with `squeal reduce --galerkin --keep-basis`";
        Err(Error::input(format!("{}: {what}. {advice}", self.place.display())))
    }

    /// The full model of a super-element under the same loads, contact stiffness and damping, and its basis there.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Input`] for a model that cannot be read, or with another mesh; PETSc's.
    pub fn full(&self, comm: &Comm, path: &Path) -> Result<(FullModel, System, Block)> {
        let mut full = FullModel::read(comm, path)?;
        let [_, mesh] = full.digests(comm)?;
        let is_other = comm.is_root() && mesh != self.element.origin.mesh_hash;
        let what = format!("{}: the super-element was made of another mesh. Give its model file", path.display());
        comm.agree(if is_other { Err(Error::input(what)) } else { Ok(()) })?;
        full.interface.scale_contact_stiffness(self.options.contact_stiffness);
        let gap = self.options.gap.as_ref();
        comm.agree(gap.map_or(Ok(()), |gap| set_gap_field(&mut full.interface, gap)))?;
        for PartDamping { part, rayleigh } in &self.options.damping {
            full.model.parts.iter_mut().filter(|own| own.name == *part).for_each(|own| own.rayleigh = *rayleigh);
        }
        let mut system = full.assemble(comm, &full.families()?)?;
        system.scale_load(self.options.load_factor)?;
        let columns = comm.agree(if comm.is_root() { file::read_basis(&self.place) } else { Ok(Vec::new()) })?;
        let basis = nodal_basis::distributed(&system, &full.nodes, &columns, self.element.n_coordinates())?;
        Ok((full, system, basis))
    }

    pub(super) fn about(&self, comm: &Comm) -> Result<About> {
        let origin = &self.element.origin;
        let file = if comm.is_root() && self.place.is_file() { self.digest() } else { Ok(String::new()) };
        let is_damped = origin.friction_damping
            || self.element.structural_damping.is_some()
            || !self.element.viscoelastic.is_empty()
            || self.element.damping.iter().any(|c| *c != 0.0);
        Ok(About {
            title: origin.title.clone(),
            model: self.place.display().to_string(),
            model_digest: comm.agree(file)?,
            mesh: origin.mesh.clone(),
            mesh_digest: origin.mesh_hash.clone(),
            parts: self.surface.parts.iter().map(|name| Part { name: name.clone(), ..Part::default() }).collect(),
            pairs: pairs(&self.interface),
            undamped: !is_damped,
            structural_damping: self.element.structural_damping.is_some(),
            viscoelastic: !self.element.viscoelastic.is_empty(),
            ..About::default()
        })
    }

    /// SHA-256 of the file, with its gap field where it has one. Not collective.
    fn digest(&self) -> Result<String> {
        let own = digest(&self.place)?;
        let with = |gap: &PathBuf| Ok(digest_of_text(&(own.clone() + &digest(gap)?)));
        self.options.gap.as_ref().map_or(Ok(own.clone()), with)
    }

    pub(super) fn band(&self, given: Option<[f64; 2]>) -> Result<[f64; 2]> {
        let band = given.unwrap_or(self.element.origin.band);
        if let Some(warning) = self.element.require_band(band)? {
            eprintln!("warning: {}: {warning}", self.place.display());
        }
        Ok(band)
    }

    pub(super) fn friction_values(&self, given: Option<&[f64]>) -> Result<Vec<f64>> {
        super::friction::friction_values(given, &[self.element.origin.friction], &self.interface, &self.place)
    }

    pub(super) fn own_friction(&self) -> Result<f64> {
        super::friction::own_friction(&self.interface, &self.place).map(|own| own.unwrap_or(0.0))
    }

    pub(super) fn assemble(&self, comm: &Comm) -> Result<System> {
        self.element.assemble(comm, &self.interface, self.options.load_factor)
    }

    pub(super) fn contact_faces(&self) -> ContactFaces {
        let points = &self.element.contacts;
        ContactFaces {
            nodes: points.iter().map(|contact| contact.point.position).collect(),
            pair_of_node: points.iter().map(|contact| contact.point.pair as i32).collect(),
            ..ContactFaces::default()
        }
    }

    pub(super) fn contact_fields(&self, responses: &[Response]) -> (Vec<f64>, Vec<i32>) {
        // Under a law of its own a contact has no area; that of the super-element has.
        let areas = self.element.contacts.iter().map(|contact| contact.point.law.weight);
        responses.iter().zip(areas).map(|(r, area)| (r.normal_force / area, contact_surface::status(r))).unzip()
    }

    pub(super) fn dof_labels(&self, system: &System) -> Vec<String> {
        let points = &self.element.points;
        let n_interface = points.len() * 3 + self.element.frequencies.len();
        let coordinate = |i: usize| match points.get(i / 3) {
            Some([x, y, z]) => format!("point,{},{},{x:e},{y:e},{z:e}", i / 3 + 1, ["x", "y", "z"][i % 3]),
            None if self.element.is_galerkin() => format!("basis vector,{},,,,", i + 1),
            None if i < n_interface => format!("fixed-interface mode,{},,,,", i + 1 - 3 * points.len()),
            None => format!("residual mode,{},,,,", i + 1 - n_interface),
        };
        let of = |node: u32| {
            let free = (0..3).filter(move |&i| system.dofs.node_dofs(node)[i] >= 0);
            free.map(move |i| 3 * node as usize + i)
        };
        system.dofs.owned_nodes().flat_map(of).map(coordinate).collect()
    }
}

/// Gives the contacts that wear, or those that slide where none wears, the gaps of a table in place of those of their
/// model's gap field.
fn set_gap_field(interface: &mut Interface, file: &Path) -> Result<()> {
    let wears = interface.pairs.iter().any(|pair| pair.wear.is_some());
    for pair in interface.pairs.iter().filter(|pair| if wears { pair.wear.is_some() } else { pair.is_sliding() }) {
        let points = &mut interface.points[pair.points.clone()];
        let places: Vec<[f64; 3]> = points.iter().map(|point| point.position).collect();
        let gaps = GapField::read(file, &pair.name).and_then(|field| field.at(&places));
        let gaps = gaps.map_err(|what| Error::input(format!("--gap, contact {:?}: {what}", pair.name)))?;
        points.iter_mut().zip(gaps).for_each(|(point, gap)| point.set_field_gap(gap));
    }
    Ok(())
}
