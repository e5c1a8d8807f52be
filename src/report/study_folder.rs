//! The files of a study's folder: tables, figures 7 and 8 of the paper, and the summary.

use std::path::Path;

use crate::Result;
use crate::comparison::{StudiedModel, Study};
use crate::output::files::write_file;
use crate::output::study as tables;

use super::study_plot;

/// Writes the files, and gives the summary. The second figure shows the super-elements of `n` contacts with their
/// layout. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(place: &Path, study: &Study, n: usize) -> Result<String> {
    let table = |name: &str, body: fn(&mut dyn std::io::Write, &Study) -> std::io::Result<()>| {
        write_file(&place.join(name), |out| body(out, study))
    };
    let (layouts, elements): (Vec<&StudiedModel>, Vec<&StudiedModel>) =
        study.models.iter().partition(|model| !model.name.starts_with("super-element"));
    let like = layouts.iter().copied().filter(|model| model.sizes.n_contacts == n);
    let of_elements: Vec<&StudiedModel> = like.chain(elements.iter().copied()).collect();
    let figures = [
        ("figure-7.svg", &layouts, "Contact layouts: frequencies and growth rates"),
        ("figure-8.svg", &of_elements, "Super-elements: frequencies and growth rates"),
    ];
    for (name, models, title) in figures {
        if let Some(svg) = study_plot::instabilities(study, models, title) {
            write_file(&place.join(name), |out| out.write_all(svg.as_bytes()))?;
        }
    }
    table("sizes.csv", tables::sizes)?;
    table("errors.csv", tables::errors)?;
    table("curves.csv", tables::curves)?;
    let text = tables::text(study) + &format!("\nresults in {}\n", place.display());
    write_file(&place.join("summary.txt"), |out| out.write_all(text.as_bytes()))?;
    Ok(text)
}
