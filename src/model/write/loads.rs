//! The loads of a model file.

use super::{Text, list, number, quoted};
use crate::model::{LoadKind, Model};

/// Writes the loads.
pub fn loads(out: &mut Text, model: &Model) {
    for load in &model.loads {
        out.table("[[load]]");
        out.line("name", quoted(&load.name));
        if !load.on.is_empty() {
            out.line("on", quoted(&load.on));
        }
        match load.kind {
            LoadKind::Pressure(pressure) => out.line("pressure", number(pressure)),
            LoadKind::Gravity(acceleration) => out.line("gravity", list(&acceleration)),
            LoadKind::ForceByNode(force) => out.line("force", list(&force)),
            LoadKind::ForceByArea(force) => {
                out.line("force", list(&force));
                out.line("spread", quoted("area"));
            }
            LoadKind::ForceAt { force, moment, at } => {
                out.line("force", list(&force));
                out.line("moment", list(&moment));
                out.point("at", at, model.mesh_unit);
            }
        }
    }
}
