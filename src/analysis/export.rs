//! M, C, K, G and the contact tangent about an equilibrium as files for other programs.

use crate::assembly::System;
use crate::matrices::write::GatheredMatrix;
use crate::native::{Comm, Matrix};
use crate::output::folder::Folder;
use crate::structure::Structure;
use crate::{Error, Result};

use super::observer::{Event, Observer};
use super::sweep::Sweep;

/// Formats of matrix files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixFormat {
    /// Matrix Market text, coordinate real general.
    MatrixMarket,
    /// PETSc binary.
    Petsc,
}

/// What [`export`] is asked for.
#[derive(Debug, Clone)]
pub struct ExportOptions {
    /// The friction coefficient of the equilibrium. The structure's own, where it has one value, if there is none
    /// given.
    pub friction: Option<Vec<f64>>,
    /// Whether the matrices are those about an equilibrium; else those of the structure itself, without contact.
    pub with_contact: bool,
    /// What the files are to be.
    pub format: MatrixFormat,
}

/// What [`export`] has written.
#[derive(Debug, Clone)]
pub struct Exported {
    /// Title of the structure.
    pub title: String,
    /// Friction coefficient of the equilibrium, if there is one.
    pub friction: Option<f64>,
    /// Free dofs.
    pub n_dofs: usize,
    /// Names of the files, each with what it holds.
    pub files: Vec<(String, &'static str)>,
}

/// A matrix file: its name, what it holds for the summary, and for the head of the file.
struct MatrixFile {
    name: &'static str,
    what: &'static str,
    head: &'static str,
}

const MASS: MatrixFile = MatrixFile { name: "mass", what: "M, kg", head: "M, kg" };
const DAMPING: MatrixFile = MatrixFile { name: "damping", what: "C, N s/m", head: "C, N s/m" };
const STIFFNESS: MatrixFile = MatrixFile {
    name: "stiffness",
    what: "K with all of contact's tangent, N/m",
    head: "K with the tangent of contact and friction, N/m",
};
const STIFFNESS_ALONE: MatrixFile = MatrixFile { name: "stiffness", what: "K, N/m", head: "K, N/m" };
const STRUCTURAL: MatrixFile = MatrixFile {
    name: "structural",
    what: "G of loss factors, N/m",
    head: "G, N/m, the imaginary part of the stiffness: structural damping by loss factors",
};
const CONTACT: MatrixFile = MatrixFile {
    name: "contact",
    what: "contact's tangent alone, which is in K",
    head: "tangent of contact and friction, N/m: a part of stiffness",
};

/// Writes matrices into a folder, which the root has, with node, axis and place of each row in `dofs.csv`.
/// Collective.
///
/// # Errors
/// [`Error::Input`] where there is more than one value of the friction coefficient; [`Error::NotConverged`]; PETSc's,
/// the system's.
pub fn export(
    comm: &Comm,
    structure: &Structure,
    options: &ExportOptions,
    folder: Option<&Folder>,
    observer: &mut dyn Observer,
) -> Result<Exported> {
    require_one_stiffness(structure)?;
    let friction = if options.with_contact { Some(one_value(structure, options)?) } else { None };
    observer.event(Event::Stage("assembling"));
    let system = structure.assemble(comm)?;
    let mut export = Export { format: options.format, folder, comm, files: Vec::new() };
    match friction {
        Some(friction) => export.about_equilibrium(structure, &system, friction, observer)?,
        None => {
            export.matrix(&MASS, &system.m)?;
            export.matrix(&DAMPING, &system.c)?;
            export.matrix(&STIFFNESS_ALONE, &system.k)?;
        }
    }
    system.g.iter().try_for_each(|g| export.matrix(&STRUCTURAL, g))?;
    export.rows(structure, &system)?;
    Ok(Exported { title: structure.title().to_owned(), friction, n_dofs: system.dofs.n_global(), files: export.files })
}

/// Refuses viscoelastic materials.
fn require_one_stiffness(structure: &Structure) -> Result<()> {
    const WHAT: &str = "the matrices written have one stiffness whatever the frequency";
    match structure {
        Structure::Full(full) => full.model.require_no_viscoelastic(WHAT),
        Structure::Reduced(reduced) if reduced.element.viscoelastic.is_empty() => Ok(()),
        Structure::Reduced(_) => {
            let advice = "Make one of a model whose materials have a young and a loss_factor";
            Err(Error::input(format!("{WHAT}, and the super-element has viscoelastic materials. {advice}")))
        }
    }
}

/// The friction coefficient of the equilibrium.
fn one_value(structure: &Structure, options: &ExportOptions) -> Result<f64> {
    match structure.friction_values(options.friction.as_deref())?[..] {
        [friction] => Ok(friction),
        _ => Err(Error::input("matrices are exported at one friction coefficient: give --friction MU")),
    }
}

/// An export under way.
struct Export<'a> {
    format: MatrixFormat,
    folder: Option<&'a Folder>,
    comm: &'a Comm,
    files: Vec<(String, &'static str)>,
}

impl Export<'_> {
    /// Writes the matrices about the equilibrium. Collective.
    fn about_equilibrium(
        &mut self,
        structure: &Structure,
        system: &System,
        friction: f64,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let prestress = structure.prestress()?;
        let mut sweep = Sweep::of(structure, system, prestress.as_ref())?;
        let equilibrium = sweep.equilibrium(friction, observer)?;
        observer.event(Event::Stage("writing"));
        sweep.linearise(&equilibrium, |problem| {
            let mut contact = problem.matrices.k.duplicate()?;
            contact.axpy(-1.0, &system.k)?;
            self.matrix(&MASS, problem.matrices.m)?;
            self.matrix(&DAMPING, problem.matrices.c)?;
            self.matrix(&STIFFNESS, problem.matrices.k)?;
            self.matrix(&CONTACT, &contact)
        })
    }

    /// Writes a matrix. Collective.
    fn matrix(&mut self, file: &MatrixFile, matrix: &Matrix) -> Result<()> {
        let ending = match self.format {
            MatrixFormat::MatrixMarket => "mtx",
            MatrixFormat::Petsc => "petsc",
        };
        let name = format!("{}.{ending}", file.name);
        let whole = GatheredMatrix::gather(matrix)?;
        let written = match (self.folder, whole) {
            (Some(folder), Some(whole)) => folder.write(&name, |out| match self.format {
                MatrixFormat::MatrixMarket => whole.matrix_market(out, file.head),
                MatrixFormat::Petsc => whole.petsc(out),
            }),
            _ => Ok(()),
        };
        self.files.push((name, file.what));
        self.comm.agree(written)
    }

    /// Writes what each row is. Collective.
    fn rows(&mut self, structure: &Structure, system: &System) -> Result<()> {
        const FILE: &str = "dofs.csv";
        self.files.push((FILE.into(), "node, axis and place of each row (nodes as the mesh file has them, from 1)"));
        let own = structure.dof_labels(system).join("\n");
        let all = self.comm.gather_values(own);
        let Some(folder) = self.folder else { return self.comm.agree(Ok(())) };
        self.comm.agree(folder.write(FILE, |out| {
            writeln!(out, "equation,kind,node,axis,x_m,y_m,z_m")?;
            let mut lines = all.iter().flat_map(|text| text.lines()).enumerate();
            lines.try_for_each(|(i, line)| writeln!(out, "{},{line}", i + 1))
        }))
    }
}
