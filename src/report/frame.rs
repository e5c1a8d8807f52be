//! What the pages have in common: one file each, with its style, that loads nothing. Its content security policy names
//! style and script by their digests. Also the figure of a mode shape.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("assets/page.css");

/// A page that is one file: it loads nothing, and runs no other script than this one.
pub(super) fn frame(title: &str, script: Option<&str>, body: &Markup) -> String {
    let scripts = script.map_or_else(String::new, |script| format!(" script-src '{}';", digest(script)));
    let policy = format!("default-src 'none'; style-src '{}';{scripts} img-src data:", digest(STYLE));
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="generator" content="squeal";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(PreEscaped(policy));
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

/// The moving shape, which assets/shape.js draws.
pub(super) fn shape_figure() -> Markup {
    const KEYS: &str = "Mode shape in 3D. Arrow keys turn it, plus and minus zoom, space plays and pauses.";
    html! {
        figure #shape.card hidden {
            figcaption { strong #shape-title {} " " span #shape-note {} }
            div #stage {
                canvas #view tabindex="0" aria-label=(KEYS) {}
                div #legend aria-hidden="true" {
                    span #legend-top { "1" }
                    canvas width="12" height="90" {}
                    span { "0" }
                }
            }
            div.controls {
                button #play type="button" aria-pressed="true" { "Pause" }
                label { "Mode " select #shape-mode {} }
                label { "Amplitude " input #amplitude type="range" min="0" max="100" value="40"; }
                label {
                    "Colour "
                    select #colouring { option value="size" { "displacement" } option value="part" { "parts" } }
                }
                span.views {
                    "View "
                    @for (view, name) in [("iso", "3D"), ("x", "x"), ("y", "y"), ("z", "z")] {
                        button type="button" data-view=(view) { (name) }
                    }
                }
            }
            fieldset #parts { legend { "Parts shown" } }
        }
    }
}

/// A digest as a content security policy has it.
fn digest(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}
