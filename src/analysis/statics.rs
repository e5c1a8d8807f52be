//! Static equilibria over the friction coefficient.

use crate::Result;
use crate::equilibrium::Equilibrium;
use crate::native::Comm;
use crate::output::summary;
use crate::results::Results;
use crate::structure::Structure;

use super::observer::Observer;
use super::run::{Job, Run, ValueResult};
use super::start::Output;

/// What [`statics`] is asked for.
#[derive(Debug, Clone, Default)]
pub struct StaticOptions {
    /// Values of the friction coefficient; the structure's own where there are none.
    pub friction_values: Option<Vec<f64>>,
    /// Where results are written; nowhere if none.
    pub output: Option<Output>,
}

/// Finds the equilibrium at each value of the friction coefficient of the swept pairs, each from the one before. Where
/// a value does not converge, the analysis ends there, and [`Results::failure`] says why. The root's results are
/// complete. Collective.
///
/// # Errors
/// [`crate::Error::Input`] for values or an output folder that cannot be used; [`crate::Error::Interrupted`]; PETSc's,
/// MUMPS's and the system's.
pub fn statics(
    comm: &Comm,
    structure: &Structure,
    options: &StaticOptions,
    observer: &mut dyn Observer,
) -> Result<Results> {
    let results = structure.on_its_ranks(comm, |comm| {
        let values = structure.friction_values(options.friction_values.as_deref())?;
        let job = Job {
            name: "static",
            options: String::new(),
            values,
            band: [0.0; 2],
            criterion: structure.criterion(),
            summary: summary::statics,
        };
        let none = |_: &mut Run, _: &Equilibrium| Ok(ValueResult::default());
        super::run::run(comm, structure, &job, options.output.as_ref(), observer, |run| run.each(none))
    })?;
    Ok(results.unwrap_or_default())
}
