//! `squeal study`: a brake with full contact, with fewer contacts, and as super-elements.
//!
//! Every model is a part of the study with a folder of its own, made as `squeal stability` makes it. `parts.toml` tells of each finished part what
//! it depends on, so that a study that is run again makes only what is missing or out of date.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::comparison::{Sizes, StudiedModel, Study, n_contacts};
use crate::native::Comm;
use crate::output::files::{write_file, write_whole};
use crate::output::study as tables;
use crate::reduction;
use crate::report::study_plot;
use crate::results::{Results, file};
use crate::sweep::Brake;
use crate::{Error, Result};

use super::friction::Frictions;
use super::subject::Subject;
use super::{Models, Reduce, Run, Shell, reduce, stability};
use crate::output::results_folder::RESULTS;

/// Makes what is missing, then compares all models with full contact. Collective.
pub fn run(shell: &Shell, arguments: &Models) -> Result<()> {
    let (comm, plan) = (shell.comm, Plan::new(shell, arguments)?);
    let mut record = comm.agree(if comm.is_root() { Record::open(&plan.place) } else { Ok(Record::default()) })?;
    for part in plan.parts() {
        plan.make(shell, &part, &mut record)?;
    }
    comm.agree(if comm.is_root() { plan.report(shell, &record) } else { Ok(()) })
}

/// What a study is made of.
struct Plan<'a> {
    arguments: &'a Models,
    place: PathBuf,
    frictions: Vec<f64>,
    /// Friction of the super-element for all frictions.
    reduced_at: f64,
    n_loaded: usize,
    /// What all parts depend on.
    identity: String,
}

/// A model of the study.
struct Part {
    /// Its name for people.
    name: String,
    /// Its file or folder.
    product: String,
    /// What it alone depends on.
    options: String,
    work: Work,
}

enum Work {
    Reduce(Reduce),
    Stability { run: Run, anew: bool, branches: bool },
}

impl<'a> Plan<'a> {
    /// Reads and checks everything before anything is computed. Collective.
    fn new(shell: &Shell, arguments: &'a Models) -> Result<Plan<'a>> {
        let comm = shell.comm;
        let mut brake = Brake::read(comm, &arguments.model)?;
        brake.require_held(comm)?;
        let mut frictions = brake.frictions(arguments.friction.as_ref().map(|list| list.0.as_slice()))?;
        frictions.sort_by(f64::total_cmp);
        for &n in arguments.layouts.iter().chain([&arguments.super_element]) {
            let reduced = reduction::contacts::reduce(&brake.model, &brake.mesh, &brake.interface, n)?;
            let full = std::mem::replace(&mut brake.interface, reduced);
            brake.require_held(comm)?;
            brake.interface = full;
        }
        let own = brake.interface.pairs.iter().find(|pair| pair.swept).map_or(0.0, |pair| pair.friction);
        let mut loaded: Vec<&str> = brake.model.loads.iter().map(|load| load.on.as_str()).collect();
        loaded.sort_unstable();
        loaded.dedup();
        let about = brake.about(comm)?;
        let (program, petsc) = (env!("CARGO_PKG_VERSION"), shell.petsc.join(" "));
        let identity = format!("squeal {program} {petsc}, model {}, mesh {}", about.model_digest, about.mesh_digest);
        let place = arguments.place();
        Ok(Plan {
            arguments,
            place,
            frictions,
            reduced_at: arguments.reduced_at.unwrap_or(own),
            n_loaded: loaded.len(),
            identity,
        })
    }

    /// All parts, each after those that it needs.
    fn parts(&self) -> Vec<Part> {
        let n = self.arguments.super_element;
        let layouts = self.arguments.layouts.iter().map(|&n| {
            self.stability(
                &format!("{n} contacts"),
                &format!("contacts-{n}"),
                (&self.arguments.model, Some(n)),
                [false, false],
            )
        });
        let element = self.element();
        let (one, anew) = (
            format!("super-element of {n}, made at {}", self.reduced_at),
            format!("super-element of {n}, made at each"),
        );
        let one = self.stability(&one, &format!("super-element-{n}"), (&element, None), [false, true]);
        let anew =
            self.stability(&anew, &format!("super-element-{n}-anew"), (&self.arguments.model, Some(n)), [true, false]);
        let full = self.stability("full contact", FULL, (&self.arguments.model, None), [false, true]);
        [full].into_iter().chain(layouts).chain([self.reduction(), one, anew]).collect()
    }

    /// The file of the super-element for all frictions.
    fn element(&self) -> PathBuf {
        self.place.join(format!("brake-{}.se.h5", self.arguments.super_element))
    }

    fn reduction(&self) -> Part {
        let (n, output) = (self.arguments.super_element, self.element());
        let product = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (model, friction) = (self.arguments.model.clone(), Some(self.reduced_at));
        let work =
            Work::Reduce(Reduce { model, contacts: Some(n), friction, limit: None, output: Some(output), force: true });
        Part {
            name: format!("making the super-element of {n}"),
            product,
            options: format!("friction {}", self.reduced_at),
            work,
        }
    }

    /// The modes of a model, with so many contacts, a super-element anew at each friction or not, modes followed or not.
    fn stability(
        &self,
        name: &str,
        product: &str,
        (model, contacts): (&Path, Option<usize>),
        [anew, branches]: [bool; 2],
    ) -> Part {
        let mut options =
            format!("frictions {}", self.frictions.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
        if model != self.arguments.model {
            options += &format!(", super-element of friction {}", self.reduced_at);
        }
        let run = Run {
            model: model.to_owned(),
            friction: Some(Frictions(self.frictions.clone())),
            contacts,
            law: None,
            pressure: 1.0,
            output: Some(self.place.join(product)),
            force: true,
            verbose: self.arguments.verbose,
        };
        Part { name: name.into(), product: product.into(), options, work: Work::Stability { run, anew, branches } }
    }

    /// Makes a part, unless it is there. Collective.
    fn make(&self, shell: &Shell, part: &Part, record: &mut Record) -> Result<()> {
        let (comm, silent) = (shell.comm, Shell { silent: true, ..*shell });
        let identity = format!("{}, {}", self.identity, part.options);
        let is_made = comm.is_root() && record.has(part, &identity, &self.place);
        if comm.from_root(&[f64::from(u8::from(is_made))])[0] > 0.0 {
            say(comm, &format!("{}: made before", part.name));
            return Ok(());
        }
        say(comm, &format!("{}: begins", part.name));
        let start = Instant::now();
        match &part.work {
            Work::Reduce(arguments) => reduce::run(&silent, arguments)?,
            Work::Stability { run, anew, branches } => stability::run(&silent, run, None, *anew, *branches)?,
        }
        let seconds = start.elapsed().as_secs_f64();
        record.parts.insert(part.product.clone(), Done { identity, seconds });
        comm.agree(if comm.is_root() { record.write(&self.place) } else { Ok(()) })
    }

    /// Compares, writes and tells. Not collective.
    fn report(&self, shell: &Shell, record: &Record) -> Result<()> {
        let reference = self.read(FULL)?;
        let mut study = Study::new(&reference);
        let element = format!("super-element-{}", self.arguments.super_element);
        let n_coordinates = self.read(&element)?.about.n_equations;
        for part in self.parts().into_iter().filter(|part| part.product != FULL) {
            let Work::Stability { run, anew, .. } = &part.work else { continue };
            let results = self.read(&part.product)?;
            let is_one = run.model != self.arguments.model;
            let n_contacts = n_contacts(&results);
            let n_equations = if *anew { n_coordinates } else { results.about.n_equations };
            let sizes = Sizes { n_contacts, n_retained: Some(2 * n_contacts + self.n_loaded), n_equations };
            let making = record.parts.get(&self.reduction().product).filter(|_| is_one).map(|done| done.seconds);
            study.add(&part.name, [&reference, &results], sizes, making)?;
        }
        self.write(shell, &study)
    }

    fn read(&self, product: &str) -> Result<Results> {
        file::read(&self.place.join(product).join(RESULTS))
    }

    fn write(&self, shell: &Shell, study: &Study) -> Result<()> {
        let table = |name: &str, body: fn(&mut dyn std::io::Write, &Study) -> csv::Result<()>| {
            write_file(&self.place.join(name), |out| body(out, study).map_err(std::io::Error::other))
        };
        let (layouts, elements): (Vec<&StudiedModel>, Vec<&StudiedModel>) =
            study.models.iter().partition(|model| !model.name.starts_with("super-element"));
        let like = layouts.iter().copied().filter(|model| model.sizes.n_contacts == self.arguments.super_element);
        let of_elements: Vec<&StudiedModel> = like.chain(elements.iter().copied()).collect();
        let figures = [
            (
                "figure-7.svg",
                study_plot::instabilities(study, &layouts, "Contact layouts: frequencies and growth rates"),
            ),
            (
                "figure-8.svg",
                study_plot::instabilities(study, &of_elements, "Super-elements: frequencies and growth rates"),
            ),
        ];
        for (name, figure) in figures {
            if let Some(svg) = figure {
                write_file(&self.place.join(name), |out| out.write_all(svg.as_bytes()))?;
            }
        }
        table("sizes.csv", tables::sizes)?;
        table("errors.csv", tables::errors)?;
        table("curves.csv", tables::curves)?;
        let text = tables::text(study) + &format!("\nresults in {}\n", self.place.display());
        write_file(&self.place.join("summary.txt"), |out| out.write_all(text.as_bytes()))?;
        shell.tell(&text, || serde_json::json!(study))
    }
}

/// Folder of the reference.
const FULL: &str = "full";

fn say(comm: &Comm, text: &str) {
    if comm.is_root() {
        eprintln!("{text}");
    }
}

/// What is made.
#[derive(Default, Serialize, Deserialize)]
struct Record {
    /// By the names of their files and folders.
    #[serde(default)]
    parts: BTreeMap<String, Done>,
}

#[derive(Serialize, Deserialize)]
struct Done {
    /// What it depends on.
    identity: String,
    /// What it took, s.
    seconds: f64,
}

/// The record's file, which marks a folder as a study's.
const PARTS: &str = "parts.toml";

impl Record {
    /// Of a folder that is a study's, or empty, or not there.
    fn open(place: &Path) -> Result<Record> {
        let file = place.join(PARTS);
        if let Ok(text) = std::fs::read_to_string(&file) {
            let damaged =
                |reason| Error::input(format!("{} is damaged: {reason}. Remove it to start anew", file.display()));
            return toml::from_str(&text).map_err(damaged);
        }
        let is_free = std::fs::read_dir(place).map_or(!place.exists(), |mut entries| entries.next().is_none());
        if is_free {
            return Ok(Record::default());
        }
        let what = format!("{} exists and is not the folder of a study", place.display());
        Err(Error::input(format!("{what}. Choose another with --output")))
    }

    fn has(&self, part: &Part, identity: &str, place: &Path) -> bool {
        let file = match part.work {
            Work::Reduce(_) => place.join(&part.product),
            Work::Stability { .. } => place.join(&part.product).join(RESULTS),
        };
        self.parts.get(&part.product).is_some_and(|done| done.identity == identity) && file.is_file()
    }

    /// Appears whole or not at all.
    fn write(&self, place: &Path) -> Result<()> {
        let text = toml::to_string(self).expect("texts and numbers");
        write_whole(&place.join(PARTS), |out| out.write_all(text.as_bytes()))
    }
}
