//! What the pages have in common: one file each, with its style, that loads nothing. Its content security policy names
//! style and script by their digests.

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

/// A digest as a content security policy has it.
fn digest(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}
