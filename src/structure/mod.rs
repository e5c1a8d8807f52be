//! What is analysed: a brake with all of its nodes, or a super-element of it.
//!
//! ```text
//! model file + mesh --FullModel--\
//!                                 Structure --assemble--> System { M, C, K, load } + Interface { B, laws }
//! .se.h5 file ----ReducedModel---/
//! ```
//!
//! From [`Structure::assemble`] on, full and reduced models are the same to every analysis. What differs stands here:
//! how they are read and assembled, where their outer surface and their contacts are, and which parts their matrices
//! come from.

pub mod contact_surface;
mod damping_range;
mod digest;
mod distribution;
mod equilibrium_checks;
mod families;
mod files;
mod free_motions;
mod friction;
mod full;
mod loading;
pub mod nodal_basis;
pub mod plausibility;
mod ranked;
mod reduced;
mod rigid_motions;
mod rotations;
mod super_element;
mod surface_motion;
mod variants;

pub use digest::digest;
pub use equilibrium_checks::EquilibriumChecks;
pub use families::Families;
pub use files::ModelFiles;
pub use free_motions::{FreeMotion, free_motions};
pub use full::FullModel;
pub use ranked::Ranked;
pub use reduced::ReducedModel;
pub use rigid_motions::RigidMotions;
pub use surface_motion::{SurfaceMotion, coordinates};
pub use variants::ModelVariants;

use std::path::{Path, PathBuf};

use crate::assembly::{Prestress, System};
use crate::contact::{Interface, Response};
use crate::equilibrium::Equilibrium;
use crate::hdf::is_hdf5;
use crate::model::{InstabilityCriterion, NormalLaw, Rayleigh};
use crate::native::Comm;
use crate::results::{About, ContactFaces, Pair, Surface};
use crate::{Error, Result};

/// A brake, full or reduced.
pub enum Structure {
    /// With all nodes of its mesh.
    Full(Box<FullModel>),
    /// As a super-element.
    Reduced(Box<ReducedModel>),
}

/// How a structure differs from its file.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureOptions {
    /// Of a model: so many reference pairs in place of the contact points of the sliding pairs.
    pub contacts: Option<usize>,
    /// Of a super-element: the normal law of its contacts.
    pub law: Option<NormalLaw>,
    /// Of a super-element: a gap field (CSV) of its contacts in place of its model's.
    pub gap: Option<PathBuf>,
    /// Of a super-element: a factor on its loads.
    pub load_factor: f64,
    /// A factor on the normal stiffness of the swept pairs.
    pub contact_stiffness: f64,
    /// Of a super-element: the Rayleigh damping of some parts.
    pub damping: Vec<PartDamping>,
}

/// Another damping of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartDamping {
    /// Its name.
    pub part: String,
    /// The damping.
    pub rayleigh: Rayleigh,
}

impl Default for StructureOptions {
    /// The structure as its file has it.
    fn default() -> Self {
        StructureOptions {
            contacts: None,
            law: None,
            gap: None,
            load_factor: 1.0,
            contact_stiffness: 1.0,
            damping: Vec::new(),
        }
    }
}

impl Structure {
    /// Reads a model file (TOML) with its mesh, a deck of Abaqus or CalculiX, or a super-element's file (HDF5), and
    /// checks it. Collective.
    ///
    /// ```no_run
    /// use squeal::structure::StructureOptions;
    /// use squeal::{Session, Structure};
    ///
    /// let comm = Session::start(&[])?;
    /// let brake = Structure::read(&comm, "brake.toml".as_ref(), &StructureOptions::default())?;
    /// println!("{} contact points", brake.interface().points.len());
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] with file, line and advice: whatever is wrong with the files, options that are for the other
    /// kind of structure, a part that can move freely.
    pub fn read(comm: &Comm, path: &Path, options: &StructureOptions) -> Result<Structure> {
        if is_hdf5(path) {
            return Ok(Structure::Reduced(Box::new(ReducedModel::read(comm, path, options)?)));
        }
        let StructureOptions { law, gap, load_factor, damping, .. } = options;
        if law.is_some() || gap.is_some() || *load_factor != 1.0 || !damping.is_empty() {
            let what = "--law, --gap, --pressure and --damping are for super-elements";
            return Err(Error::input(format!("{what}; {} is a model, which has them in its file", path.display())));
        }
        let mut full = FullModel::read_with_contacts(comm, path, options.contacts)?;
        full.interface.scale_contact_stiffness(options.contact_stiffness);
        full.require_constrained(comm)?;
        Ok(Structure::Full(Box::new(full)))
    }

    /// The title.
    pub fn title(&self) -> &str {
        match self {
            Structure::Full(full) => &full.model.title,
            Structure::Reduced(reduced) => &reduced.element.origin.title,
        }
    }

    /// What is known before anything is computed: title, files, sizes, parts and contact pairs. Collective.
    ///
    /// # Errors
    /// The system's, with the file's path.
    pub fn about(&self, comm: &Comm) -> Result<About> {
        match self {
            Structure::Full(full) => full.about(comm),
            Structure::Reduced(reduced) => reduced.about(comm),
        }
    }

    /// Contact points and laws.
    pub fn interface(&self) -> &Interface {
        match self {
            Structure::Full(full) => &full.interface,
            Structure::Reduced(reduced) => &reduced.interface,
        }
    }

    /// The same, to be changed: [`Interface::set_friction_law`].
    pub fn interface_mut(&mut self) -> &mut Interface {
        match self {
            Structure::Full(full) => &mut full.interface,
            Structure::Reduced(reduced) => &mut reduced.interface,
        }
    }

    /// The band to analyse, Hz: the one given, else the file's.
    ///
    /// # Errors
    /// [`Error::Input`] where a super-element knows nothing of the band.
    pub fn band(&self, given: Option<[f64; 2]>) -> Result<[f64; 2]> {
        match self {
            Structure::Full(full) => Ok(given.unwrap_or(full.model.band)),
            Structure::Reduced(reduced) => reduced.band(given),
        }
    }

    /// Whether friction that turns with the velocity damps the modes (formulation: friction damping).
    pub fn friction_damping(&self) -> bool {
        match self {
            Structure::Full(full) => full.model.friction_damping,
            Structure::Reduced(reduced) => reduced.element.origin.friction_damping,
        }
    }

    /// What makes the geometric stiffness of an equilibrium, of a super-element that of the equilibrium at which it was
    /// made; none where modes have none.
    ///
    /// # Errors
    /// [`Error::Input`] where a part has no material.
    pub fn prestress(&self) -> Result<Option<Prestress<'_>>> {
        match self {
            Structure::Full(full) => full.prestress(),
            Structure::Reduced(reduced) => Ok(reduced.element.geometric_stiffness.as_deref().map(Prestress::Frozen)),
        }
    }

    /// What counts as an unstable mode.
    pub fn criterion(&self) -> InstabilityCriterion {
        match self {
            Structure::Full(full) => full.model.criterion,
            Structure::Reduced(reduced) => reduced.element.origin.criterion,
        }
    }

    /// The values of the friction coefficient to analyse: those given, else the file's sweep, else the swept pairs'
    /// own.
    ///
    /// # Errors
    /// [`Error::Input`] where no pair slides.
    pub fn friction_values(&self, given: Option<&[f64]>) -> Result<Vec<f64>> {
        match self {
            Structure::Full(full) => full.friction_values(given),
            Structure::Reduced(reduced) => reduced.friction_values(given),
        }
    }

    /// The friction coefficient of the swept pairs in the file; 0 where no pair slides.
    ///
    /// # Errors
    /// [`Error::Input`] where they differ.
    pub fn own_friction(&self) -> Result<f64> {
        match self {
            Structure::Full(full) => full.own_friction(),
            Structure::Reduced(reduced) => reduced.own_friction(),
        }
    }

    /// Refuses a structure without mass, which has no modes.
    ///
    /// # Errors
    /// [`Error::Input`]: see [`FullModel::require_mass`].
    pub fn require_mass(&self) -> Result<()> {
        match self {
            Structure::Full(full) => full.require_mass(),
            Structure::Reduced(_) => Ok(()),
        }
    }

    /// Assembles M, C, K and the load. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn assemble(&self, comm: &Comm) -> Result<System> {
        match self {
            Structure::Full(full) => full.assemble(comm, &full.families()?),
            Structure::Reduced(reduced) => reduced.assemble(comm),
        }
    }

    /// The outer surface, without samples: the same whatever the numbers of the model are. Collective.
    pub fn outer_surface(&self, comm: &Comm) -> Surface {
        match self {
            Structure::Full(full) => surface_motion::of_mesh(comm, &full.mesh, &full.nodes),
            Structure::Reduced(reduced) => surface_motion::without_samples(&reduced.surface),
        }
    }

    /// How the outer surface moves under a vector of the system. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn surface_motion<'s>(&'s self, system: &'s System) -> Result<SurfaceMotion<'s>> {
        match self {
            Structure::Full(full) => SurfaceMotion::of_nodes(full.boundary(system.k.comm(), system), system),
            Structure::Reduced(reduced) => Ok(SurfaceMotion::of_coordinates(&reduced.surface, system)),
        }
    }

    /// Where contact results are known.
    pub fn contact_faces(&self) -> ContactFaces {
        match self {
            Structure::Full(full) => full.contact_faces(),
            Structure::Reduced(reduced) => reduced.contact_faces(),
        }
    }

    /// Normal pressure (Pa) and status (0 open, 1 slip, 2 stick, -1 no contact point) at the nodes of the contact
    /// faces.
    pub fn contact_fields(&self, responses: &[Response]) -> (Vec<f64>, Vec<i32>) {
        match self {
            Structure::Full(full) => full.contact_fields(responses),
            Structure::Reduced(reduced) => reduced.contact_fields(responses),
        }
    }

    /// Forces of the contact pairs, and how well forces and moments balance. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn check_equilibrium(&self, system: &System, equilibrium: &Equilibrium) -> Result<EquilibriumChecks> {
        match self {
            Structure::Full(full) => EquilibriumChecks::of_full(full, system, equilibrium),
            Structure::Reduced(reduced) => Ok(EquilibriumChecks::of_reduced(reduced, equilibrium)),
        }
    }

    /// The super-element that a full model is about an equilibrium, with the model's limit of fixed-interface modes.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Input`] of a super-element; see [`FullModel::reduce`].
    pub fn reduced_about(&self, system: &System, equilibrium: &Equilibrium) -> Result<Structure> {
        match self {
            Structure::Full(full) => {
                let limit = full.reduction_limit();
                let (element, surface, _) = full.reduce(system.k.comm(), system, equilibrium, limit, &mut |_| ())?;
                let reduced = ReducedModel::new(&full.model.file, element, surface);
                Ok(Structure::Reduced(Box::new(reduced)))
            }
            Structure::Reduced(_) => {
                Err(Error::input("a super-element cannot be reduced again: --reduce-each is for models"))
            }
        }
    }

    /// A line for each of this rank's dofs: `kind,node,axis,x,y,z`. Not collective.
    pub fn dof_labels(&self, system: &System) -> Vec<String> {
        match self {
            Structure::Full(full) => full.dof_labels(system),
            Structure::Reduced(reduced) => reduced.dof_labels(system),
        }
    }

    /// The work of an analysis by all ranks, or, on a super-element, by the first rank alone: its few dofs are not
    /// worth sharing. `None` on ranks that have no part in it; all ranks end together. Collective.
    ///
    /// # Errors
    /// Those of the work.
    pub fn on_its_ranks<T>(&self, comm: &Comm, work: impl FnOnce(&Comm) -> Result<T>) -> Result<Option<T>> {
        match self {
            Structure::Reduced(_) if comm.size() > 1 => {
                let alone = comm.alone();
                comm.agree(if comm.is_root() { work(&alone).map(Some) } else { Ok(None) })
            }
            _ => work(comm).map(Some),
        }
    }
}

/// The pairs of an interface, as results list them.
fn pairs(interface: &Interface) -> Vec<Pair> {
    let of = |pair: &crate::contact::ContactPair| Pair {
        name: pair.name.clone(),
        sliding: pair.is_sliding(),
        swept: pair.swept,
        n_points: pair.points.len(),
        proposed_stiffness: None,
    };
    interface.pairs.iter().map(of).collect()
}
