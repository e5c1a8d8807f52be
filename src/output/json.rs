//! Results as one JSON document: the columns of the tables are its keys.

use std::f64::consts::TAU;

use serde_json::{Value as Json, json};

use super::branches::becomes;
use super::tables;
use crate::results::Source;
use crate::results::{ModeData, Results, Value};
use crate::tracking::{Branch, Diagram, Hopf, Point};

/// What was analysed (`about`), each friction with its contact pairs and modes (`frictions`), `branches` and `hopf` points where modes were
/// followed, the `verdict` (`status`, `reason`, and both in the `text` of the summary), `warnings`, and the folder of the results.
pub fn document(results: &Results, place: &str) -> Json {
    let about = &results.about;
    let (branches, hopf) = results.diagram.as_ref().map_or((Json::Null, Json::Null), |d| (branches(d), hopf(d)));
    json!({
        "about": {
            "title": about.title,
            "program": about.program,
            "libraries": about.libraries,
            "command": about.command,
            "model": about.model,
            "model_sha256": about.model_digest,
            "mesh": about.mesh,
            "mesh_sha256": about.mesh_digest,
            "nodes": about.n_nodes,
            "tetrahedra": about.n_tets,
            "equations": about.n_equations,
            "ranks": about.n_ranks,
            "band_hz": about.band,
            "frictions": about.frictions,
            "parts": about.parts.iter().map(|p| json!({"part": p.name, "material": p.material, "mass_kg": p.mass})).collect::<Vec<_>>(),
        },
        "frictions": results.values.iter().map(|value| friction(results, value)).collect::<Vec<_>>(),
        "branches": branches,
        "hopf": hopf,
        "verdict": (about.band[1] > 0.0).then(|| verdict(results)),
        "warnings": about.warnings,
        "failure": results.failure.as_ref().map(|failure| &failure.reason),
        "costs": results.costs,
        "folder": place,
    })
}

fn verdict(results: &Results) -> Json {
    let verdict = results.verdict();
    json!({"status": verdict.status, "reason": verdict.reason(), "text": tables::verdict(results).trim_end()})
}

fn friction(results: &Results, value: &Value) -> Json {
    let pairs = results.about.pairs.iter().zip(&value.pairs).map(|(pair, forces)| {
        json!({
            "pair": pair.name,
            "open": forces.counts.open,
            "stick": forces.counts.stick,
            "slip": forces.counts.slip,
            "normal_force_n": forces.normal,
            "tangential_force_n": forces.tangential,
            "closed_area_m2": forces.closed_area,
            "peak_pressure_pa": forces.peak_pressure,
            "peak_force_n": forces.peak_force,
        })
    });
    let modes = (1..).zip(&value.modes).map(|(number, data)| mode(number, data));
    let count = value.count.map(|c| json!({"below_hz": c.below, "expected": c.expected, "found": c.found}));
    json!({
        "friction": value.friction,
        "asked": value.asked,
        "seconds": value.seconds,
        "newton_steps": value.steps.iter().map(|step| step.iterations.len().saturating_sub(1)).sum::<usize>(),
        "contact": pairs.collect::<Vec<_>>(),
        "count": count,
        "modes": value.count.map(|_| modes.collect::<Vec<_>>()),
    })
}

fn mode(number: usize, data: &ModeData) -> Json {
    json!({
        "mode": number,
        "frequency_hz": data.frequency(),
        "growth_rate_per_s": data.growth_rate(),
        "damping_ratio": data.damping_ratio(),
        "backward_error": data.backward_error,
        "unstable": data.unstable,
        "explained": data.sources.iter().map(source).collect::<Vec<_>>(),
    })
}

fn source(source: &Source) -> Json {
    json!({
        "kind": source.kind,
        "name": source.name,
        "kinetic_share": source.share.kinetic,
        "strain_share": source.share.strain,
        "fed_per_s": source.share.fed,
        "damped_per_s": source.share.damped,
        "growth_per_friction": source.friction.map(|z| z.re),
        "frequency_per_friction": source.friction.map(|z| z.im / TAU),
        "growth_per_damping": source.sensitivity.map(|s| s.damping.re),
        "frequency_per_damping": source.sensitivity.map(|s| s.damping.im / TAU),
        "growth_per_stiffness": source.sensitivity.map(|s| s.stiffness.re),
        "frequency_per_stiffness": source.sensitivity.map(|s| s.stiffness.im / TAU),
        "growth_per_mass": source.sensitivity.map(|s| s.mass.re),
        "frequency_per_mass": source.sensitivity.map(|s| s.mass.im / TAU),
    })
}

fn branches(diagram: &Diagram) -> Json {
    let branch = |(number, branch): (usize, &Branch)| {
        let point = |point: &Point| {
            let z = point.lambda;
            json!({
                "friction": point.value,
                "frequency_hz": z.im / TAU,
                "growth_rate_per_s": z.re,
                "damping_ratio": -z.re / z.norm(),
            })
        };
        json!({"branch": number, "points": branch.points.iter().map(point).collect::<Vec<_>>()})
    };
    (1..).zip(&diagram.branches).map(branch).collect()
}

fn hopf(diagram: &Diagram) -> Json {
    let point = |hopf: &Hopf| {
        json!({
            "friction": hopf.value,
            "friction_low": hopf.bracket[0],
            "friction_high": hopf.bracket[1],
            "frequency_hz": hopf.omega / TAU,
            "branch": hopf.branch + 1,
            "becomes": becomes(hopf),
            "partner": hopf.partner.map(|partner| partner.branch + 1),
            "share": hopf.partner.map(|partner| partner.share),
        })
    };
    diagram.hopf.iter().map(point).collect()
}
