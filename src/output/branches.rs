//! Branches and Hopf points as tables.

use std::f64::consts::TAU;
use std::io::Write;

use crate::tracking::{Diagram, Hopf};

/// Points of all branches within a band (rad/s) as CSV: `branch`, the parameter under its name (`friction`), `frequency_hz,
/// growth_rate_per_s, damping_ratio`; branches are numbered from 1.
///
/// # Errors
/// The writer's.
pub fn points(out: &mut dyn Write, diagram: &Diagram, band: [f64; 2], parameter: &str) -> std::io::Result<()> {
    writeln!(out, "branch,{parameter},frequency_hz,growth_rate_per_s,damping_ratio")?;
    for (i, branch) in diagram.branches.iter().enumerate() {
        for point in branch.points.iter().filter(|point| (band[0]..=band[1]).contains(&point.lambda.im)) {
            let z = point.lambda;
            let (hertz, damping) = (z.im / TAU, -z.re / z.norm());
            writeln!(out, "{},{},{hertz:.12e},{:.12e},{damping:.6e}", i + 1, point.value, z.re)?;
        }
    }
    Ok(())
}

/// Hopf points as CSV: the parameter under its name, as `friction` with the two solved values `friction_low` and `friction_high` around it,
/// `frequency_hz`, `branch`, `becomes` (unstable or stable as the parameter rises), `partner` and its `share` (empty where no branch couples).
///
/// # Errors
/// The writer's.
pub fn hopf(out: &mut dyn Write, diagram: &Diagram, parameter: &str) -> std::io::Result<()> {
    writeln!(out, "{parameter},{parameter}_low,{parameter}_high,frequency_hz,branch,becomes,partner,share")?;
    for hopf in &diagram.hopf {
        let Hopf { branch, bracket: [low, high], value, omega, partner, .. } = hopf;
        let (partner, share) =
            partner.map_or_else(Default::default, |p| ((p.branch + 1).to_string(), format!("{:.4}", p.share)));
        let (hertz, becomes) = (omega / TAU, becomes(hopf));
        writeln!(out, "{value:.8},{low:.8},{high:.8},{hertz:.9e},{},{becomes},{partner},{share}", branch + 1)?;
    }
    Ok(())
}

/// What a branch becomes there as friction rises.
pub fn becomes(hopf: &Hopf) -> &'static str {
    if hopf.onset { "unstable" } else { "stable" }
}

/// Where growth rates pass zero, for people.
pub fn summary(diagram: &Diagram, parameter: &str) -> String {
    let Some(first) = diagram.values.first() else { return String::new() };
    let mut text =
        format!("\n{} branches over {} values of {parameter}\n", diagram.branches.len(), diagram.values.len());
    for hopf in &diagram.hopf {
        let hertz = |branch: usize| diagram.branches[branch].points[0].lambda.im / TAU;
        let coupled = match hopf.partner {
            Some(p) => format!("couples with {:.1} Hz, branch {}", hertz(p.branch), p.branch + 1),
            None => "by itself".into(),
        };
        text += &format!(
            "{} from {parameter} {:.4} on: {:.1} Hz, branch {} ({:.1} Hz at {}), {coupled}\n",
            becomes(hopf),
            hopf.value,
            hopf.omega / TAU,
            hopf.branch + 1,
            hertz(hopf.branch),
            (first * 1e6).round() / 1e6,
        );
    }
    for [low, high] in &diagram.doubtful {
        text += &format!("not all branches could be followed from {low:.4} to {high:.4}\n");
    }
    text
}
