//! `squeal completions`: what a shell completes.

use clap::{Args, CommandFactory};
use clap_complete::Shell as Kind;

use crate::Result;

use super::{Arguments, Shell, print};

/// What `completions` takes.
#[derive(Args)]
#[group(skip)]
pub struct Completions {
    /// The shell
    shell: Kind,
}

pub fn run(shell: &Shell, arguments: &Completions) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "squeal", &mut script);
    if shell.comm.is_root() { print(&String::from_utf8_lossy(&script)) } else { Ok(()) }
}
