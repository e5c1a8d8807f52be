//! `squeal export`: M, C and K about an equilibrium, for other programs.

use std::path::Path;

use clap::ValueEnum;
use serde_json::json;

use crate::assembly::System;
use crate::matrices::write::GatheredMatrix;
use crate::native::Matrix;
use crate::output::folder::Folder;
use crate::sweep::{Brake, Sweep};
use crate::{Error, Result};

use super::modes;
use super::progress::Progress;
use super::subject::{self, Subject};
use super::{Run, Shell};

/// Formats of matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Matrix Market text, coordinate real general
    Mtx,
    /// PETSc binary
    Petsc,
}

pub fn run(shell: &Shell, run: &Run, format: Format, part: Option<&str>) -> Result<()> {
    let comm = shell.comm;
    let subject: Box<dyn Subject> = match part {
        Some(part) => Box::new(Brake::read_part(comm, &run.model, part)?),
        None => subject::read(comm, run)?,
    };
    let friction = if part.is_some() { None } else { Some(one_friction(&*subject, run)?) };
    let folder = modes::folder(comm, &run.folder("export"), run.force)?;
    let progress = Progress::new(comm, 1, run.verbose);
    progress.say("assembling");
    let system = subject.assemble(comm)?;
    let export = Export { format, folder: folder.as_ref(), system: &system };
    match friction {
        None => {
            export.write("mass", "M, kg", &system.m)?;
            export.write("damping", "C, N s/m", &system.c)?;
            export.write("stiffness", "K, N/m", &system.k)?;
        }
        Some(friction) => export.about(&*subject, friction, &progress)?,
    }
    export.rows(&*subject)?;
    progress.finish();
    let place = run.folder("export");
    let text = export.text(&subject.about(comm)?.title, friction, &place);
    let written = folder.map_or(Ok(()), |folder| {
        folder.write("summary.txt", |out| out.write_all(text.as_bytes()))?;
        folder.finish()
    });
    comm.agree(written)?;
    let n = system.dofs.n_global();
    shell.tell(&text, || json!({"folder": place.display().to_string(), "friction": friction, "equations": n}))
}

/// The friction of the equilibrium.
fn one_friction(subject: &dyn Subject, run: &Run) -> Result<f64> {
    match subject.frictions(run.friction.as_ref().map(|list| list.0.as_slice()))?[..] {
        [friction] => Ok(friction),
        _ => Err(Error::input("matrices are exported at one friction: give --friction MU")),
    }
}

/// An export under way; the root has the folder.
struct Export<'a> {
    format: Format,
    folder: Option<&'a Folder>,
    system: &'a System,
}

impl Export<'_> {
    /// Writes the matrices about the equilibrium at a friction. Collective.
    fn about(&self, subject: &dyn Subject, friction: f64, progress: &Progress) -> Result<()> {
        let mut sweep = Sweep::new(self.system, subject.interface())?;
        sweep.friction_damping = subject.friction_damping();
        let doing = format!("equilibrium at friction {friction}");
        let equilibrium = sweep.equilibrium(friction, &mut |_| progress.say(doing.clone()))?;
        progress.say("writing");
        sweep.linearise(&equilibrium, |pencil| {
            let mut contact = pencil.k.duplicate()?;
            contact.axpy(-1.0, &self.system.k)?;
            self.write("mass", "M, kg", pencil.m)?;
            self.write("damping", "C, N s/m", pencil.c)?;
            self.write("stiffness", "K with the tangent of contact and friction, N/m", pencil.k)?;
            self.write("contact", "tangent of contact and friction, N/m: a part of stiffness", &contact)
        })
    }

    /// Writes a matrix. Collective.
    fn write(&self, name: &str, what: &str, matrix: &Matrix) -> Result<()> {
        let whole = GatheredMatrix::gather(matrix)?;
        let written = match (self.folder, whole) {
            (Some(folder), Some(whole)) => folder.write(&self.file(name), |out| match self.format {
                Format::Mtx => whole.matrix_market(out, what),
                Format::Petsc => whole.petsc(out),
            }),
            _ => Ok(()),
        };
        self.system.k.comm().agree(written)
    }

    fn file(&self, name: &str) -> String {
        match self.format {
            Format::Mtx => format!("{name}.mtx"),
            Format::Petsc => format!("{name}.petsc"),
        }
    }

    /// Writes what each equation is. Collective.
    fn rows(&self, subject: &dyn Subject) -> Result<()> {
        let comm = self.system.k.comm();
        let own = subject.rows(self.system).join("\n");
        let Some(folder) = self.folder else {
            comm.send(own.as_bytes(), 0);
            return comm.agree(Ok(()));
        };
        let others = (1..comm.size()).map(|rank| String::from_utf8_lossy(&comm.receive(rank)).into_owned());
        let all: Vec<String> = std::iter::once(own).chain(others).collect();
        comm.agree(folder.write("equations.csv", |out| {
            writeln!(out, "equation,kind,node,axis,x_m,y_m,z_m")?;
            let mut lines = all.iter().flat_map(|text| text.lines()).enumerate();
            lines.try_for_each(|(i, line)| writeln!(out, "{},{line}", i + 1))
        }))
    }

    fn text(&self, title: &str, friction: Option<f64>, place: &Path) -> String {
        let n = self.system.dofs.n_global();
        let about = match friction {
            Some(friction) => format!("about the equilibrium at friction {friction}"),
            None => "of a free part".into(),
        };
        let [m, c, k] = ["mass", "damping", "stiffness"].map(|name| self.file(name));
        let mut files =
            vec![(m.clone(), "M, kg"), (c.clone(), "C, N s/m"), (k.clone(), "K with all of contact's tangent, N/m")];
        if friction.is_some() {
            files.push((self.file("contact"), "contact's tangent alone, which is in K"));
        }
        files.push((
            "equations.csv".into(),
            "node, axis and place of each row (nodes as the mesh file has them, from 1)",
        ));
        let lines: String = files.iter().map(|(name, what)| format!("  {name:20}{what}\n")).collect();
        let folder = place.display();
        format!(
            "{title}: M, C and K {about}, {n} equations\n\nresults in {folder}:\n{lines}\nIts modes: squeal modes --mass {folder}/{m} --damping \
             {folder}/{c} --stiffness {folder}/{k} --band 0:6000\n"
        )
    }
}
