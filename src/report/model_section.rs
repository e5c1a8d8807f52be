//! The report's last section: what was analysed, and by what.

use maud::{Markup, html};

use crate::output::text::plural;
use crate::results::{About, Pair, Results};

/// The section.
pub fn section(results: &Results) -> Markup {
    let about = &results.about;
    html! {
        section #model aria-label="Model and provenance" {
            h2 { "Model and provenance" }
            div.split {
                dl { (facts(about)) }
                div.over { (parts(about)) (pairs(about)) }
            }
            details { summary { "Model file" } pre { (about.model_text) } }
            details { summary { "Costs" } pre { (results.costs) } }
        }
    }
}

fn facts(about: &About) -> Markup {
    let file = |name: &str, digest: &str| html! { dd { (name) br; span.digest { "SHA-256 " (digest) } } };
    html! {
        dt { "Model" } (file(&about.model, &about.model_digest))
        @if !about.mesh.is_empty() {
            dt { "Mesh" } (file(&about.mesh, &about.mesh_digest))
            dt { "Size" } dd { (about.n_nodes) " nodes, " (about.n_elements) " elements" }
        }
        dt { "Solved" } dd { (about.n_dofs) " dofs on " (about.n_ranks) " rank" (plural(about.n_ranks)) }
        @if about.structural_damping {
            dt { "Damping" } dd { "structural, by loss factors g: stiffness K (1 + i g) at positive frequencies" }
        }
        @if about.viscoelastic {
            dt { "Viscoelastic" } dd { "each mode has the stiffness of its own frequency; backward errors are those of that" }
        }
        dt { "Command" } dd { code { "squeal " (about.command) } }
        dt { "Program" } dd { (about.program) }
        dt { "Libraries" } dd { (about.libraries) }
    }
}

fn parts(about: &About) -> Markup {
    html! {
        @if !about.parts.is_empty() {
            table {
                thead { tr { th.left { "part" } th.left { "material" } th { "mass, kg" } } }
                tbody {
                    @for part in &about.parts {
                        tr { td.left { (part.name) } td.left { (part.material) } td { (format!("{:.3}", part.mass)) } }
                    }
                }
            }
        }
    }
}

fn pairs(about: &About) -> Markup {
    html! {
        @if !about.pairs.is_empty() {
            table {
                thead { tr { th.left { "contact pair" } th.left { "tangential law" } th { "points" } } }
                tbody {
                    @for pair in &about.pairs {
                        tr { td.left { (pair.name) } td.left { (law(pair)) } td { (pair.n_points) } }
                    }
                }
            }
        }
    }
}

fn law(pair: &Pair) -> &'static str {
    match (pair.sliding, pair.swept) {
        (true, true) => "sliding, \u{3bc} varied",
        (true, false) => "sliding, fixed \u{3bc}",
        (false, true) => "stick-slip, \u{3bc} varied",
        (false, false) => "stick-slip, fixed \u{3bc}",
    }
}
