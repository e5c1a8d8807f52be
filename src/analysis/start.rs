//! What every analysis begins with: where it writes, what it reports, and what its numbers depend on.

use std::path::{Path, PathBuf};

use crate::Result;
use crate::native::{Comm, libraries};
use crate::output::folder::Folder;
use crate::results::About;
use crate::structure::Structure;

use super::observer::{Event, Observer};

/// A results folder that an analysis writes, and from whose unfinished state it goes on.
#[derive(Debug, Clone, Default)]
pub struct Output {
    /// The folder.
    pub folder: PathBuf,
    /// Whether results of another run may be replaced, and what another analysis has left unfinished.
    pub force: bool,
    /// How the analysis was started, for the results.
    pub command: String,
    /// What the numbers depend on beside structure and options, by name: an unfinished analysis with others does not go
    /// on.
    pub identity: Vec<(&'static str, String)>,
}

/// The folder of an output, which the root has. Collective.
///
/// # Errors
/// See [`Folder::open`].
pub(super) fn open_folder(comm: &Comm, output: Option<&Output>) -> Result<Option<Folder>> {
    let open = |output: &Output| Folder::open(&output.folder, output.force).map(Some);
    comm.agree(output.filter(|_| comm.is_root()).map_or(Ok(None), open))
}

/// What an earlier run has finished.
#[derive(Clone, Copy)]
pub(super) struct Earlier {
    pub n: usize,
    /// What it is, in the plural.
    pub unit: &'static str,
}

/// What is analysed, and by what. Collective.
pub(super) fn about(comm: &Comm, structure: &Structure, output: Option<&Output>) -> Result<About> {
    Ok(About {
        program: format!("squeal {}", env!("CARGO_PKG_VERSION")),
        libraries: libraries(),
        command: output.map_or_else(String::new, |output| output.command.clone()),
        n_ranks: comm.size(),
        ..structure.about(comm)?
    })
}

/// Reports what is known before anything is computed: warnings, proposed stiffnesses, the number of items, and how many
/// of them an earlier run has finished.
pub(super) fn announce(
    about: &About,
    n_planned: usize,
    place: Option<&Path>,
    earlier: Earlier,
    observer: &mut dyn Observer,
) {
    about.warnings.iter().for_each(|warning| observer.event(Event::Warning(warning)));
    for (pair, stiffness) in
        about.pairs.iter().filter_map(|own| own.proposed_stiffness.map(|stiffness| (own, stiffness)))
    {
        observer.event(Event::Proposed { pair: &pair.name, stiffness });
    }
    observer.event(Event::Planned(n_planned));
    let Earlier { n, unit } = earlier;
    if let Some(place) = place.filter(|_| n > 0) {
        observer.event(Event::Resumed { place: &place.display().to_string(), n, unit });
    }
}

/// The name of the number of ranks in what numbers depend on.
pub(super) const N_RANKS: &str = "number of ranks";

/// All that the numbers of an analysis depend on, by name: `own` alone, the rest every analysis.
pub(super) fn identity(
    analysis: String,
    own: impl IntoIterator<Item = (&'static str, String)>,
    output: Option<&Output>,
    about: &About,
) -> Vec<(&'static str, String)> {
    let mut identity = vec![("program", about.program.clone()), ("analysis", analysis)];
    identity.extend(own);
    identity.extend([
        ("SHA-256 of the model", about.model_digest.clone()),
        ("SHA-256 of the mesh", about.mesh_digest.clone()),
        (N_RANKS, about.n_ranks.to_string()),
    ]);
    identity.extend(output.into_iter().flat_map(|output| output.identity.iter().cloned()));
    identity
}

/// Numbers as people give them.
pub(super) fn numbers(list: &[f64]) -> String {
    list.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}
