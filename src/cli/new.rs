//! `squeal new`: a model file for a mesh, filled in as far as the mesh says.

use std::path::PathBuf;

use clap::Args;

use crate::analysis::propose_model;
use crate::output::files::write_whole;
use crate::{Error, Result, mesh, model};

use super::{Shell, print};

/// What `new` takes.
#[derive(Args)]
#[group(skip)]
pub struct New {
    /// The mesh: Gmsh 4.1 with physical names
    mesh: PathBuf,
    /// The model file (default: the mesh's name with .toml)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub fn run(shell: &Shell, New { mesh, output }: &New) -> Result<()> {
    let file = output.clone().unwrap_or_else(|| mesh.with_extension("toml"));
    let work = || {
        if file.exists() || file.is_symlink() {
            let place = file.display();
            return Err(Error::input(format!("{place} exists and is not replaced. Choose another name with --output")));
        }
        let read = mesh::read(mesh, 1.0)?;
        // A model file names its mesh from its own folder.
        let named = match mesh.strip_prefix(file.parent().unwrap_or("".as_ref())) {
            Ok(relative) => relative.to_owned(),
            Err(_) => mesh.canonicalize().map_err(Error::io(mesh))?,
        };
        let text = propose_model(&read, &named);
        write_whole(&file, |out| out.write_all(text.as_bytes()))
    };
    shell.comm.agree(if shell.comm.is_root() { work() } else { Ok(()) })?;
    let place = file.display();
    let text = format!("wrote {place}\nChoose what the mesh does not say, then: squeal check {place}\n");
    shell.print(&text, &serde_json::json!({ "model": place.to_string() }))
}

/// Prints a model file with every key, each explained.
pub fn example(shell: &Shell) -> Result<()> {
    shell.print(model::EXAMPLE, &serde_json::json!({ "example": model::EXAMPLE }))
}

/// Prints the JSON schema of model files; it is a JSON document itself.
pub fn schema(shell: &Shell) -> Result<()> {
    if shell.comm.is_root() { print(model::SCHEMA) } else { Ok(()) }
}
