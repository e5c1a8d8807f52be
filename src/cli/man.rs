//! `squeal man`: manual pages, one a command.

use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory};

use crate::{Error, Result};

use super::{Arguments, Shell};

/// What `man` takes.
#[derive(Args)]
#[group(skip)]
pub struct Man {
    /// An existing folder, where squeal.1, squeal-check.1 and the others are written
    folder: PathBuf,
}

pub fn run(shell: &Shell, Man { folder }: &Man) -> Result<()> {
    shell.comm.agree(if shell.comm.is_root() { write(folder) } else { Ok(()) })
}

fn write(folder: &Path) -> Result<()> {
    clap_mangen::generate_to(Arguments::command().disable_help_subcommand(true), folder).map_err(Error::io(folder))
}
