//! What the machine has, against what a factor will take.

use super::Comm;
use crate::{Error, Result};

/// Memory that the kernel could give now, MB; none where it does not say.
pub fn available_mb() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// Refuses a factor that the machine cannot hold. Collective; ranks are taken to share one machine.
pub(super) fn require(comm: &Comm, needed_mb: f64) -> Result<()> {
    let available = -comm.max(-available_mb().unwrap_or(f64::INFINITY));
    if needed_mb <= available {
        return Ok(());
    }
    Err(Error::input(format!(
        "the factor needs {:.1} GB and {:.1} GB are free: {:.1} GB are missing. A coarser mesh, other programs closed, or a \
         machine with more memory help",
        needed_mb / 1024.0,
        available / 1024.0,
        (needed_mb - available) / 1024.0
    )))
}
