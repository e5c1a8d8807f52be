//! Wear as text, tables and JSON.

use serde::Serialize;

use super::columns::write_csv;
use super::folder::Folder;
use super::text::{aligned, cost, files as files_text, friction};
use crate::Result;
use crate::results::{PairWear, Wear, WearEnd};

/// Name of the table of worn gaps, which `gap` of a contact reads.
pub const GAPS: &str = "worn.csv";

/// The steps in words, with the files of their folder.
pub fn summary(wear: &Wear, place: &str) -> String {
    let gaps = match wear.is_reduced {
        false => "gaps and pressures by contact point: gap = \"worn.csv\" of a [[contact]] reads it",
        true => "gaps and pressures by contact: --gap reads it",
    };
    let files = [
        ("summary.txt", "this text"),
        ("steps.csv", "wear by step and pair"),
        (GAPS, gaps),
        ("contact_before.vtu, _worn.vtu", "pressure before and after, for ParaView"),
    ];
    let n_files = if wear.is_reduced { 3 } else { 4 };
    text(wear) + &cost(wear.seconds, wear.n_ranks) + &files_text(place, &files[..n_files])
}

/// The steps in words.
pub fn text(wear: &Wear) -> String {
    let head = format!("{}: wear at friction {}\n\n", wear.title, friction(wear.friction));
    head + &steps_text(wear) + &end_text(wear) + &balance_text(wear)
}

fn steps_text(wear: &Wear) -> String {
    let heading = "\tsliding\tp v kW/m2\t\t\tspread\tpressure\tdepth\tworn\t\n\
                   pair\tdistance m\tmean\tleast\tmost\tof p v %\tmax MPa\tmax um\tvolume mm3\tmass g";
    let row = |distance: f64, pair: &PairWear| {
        let [mean, least, most] = [pair.mean, pair.smallest, pair.largest].map(|heating| 1e-3 * heating);
        format!(
            "{}\t{distance:.4e}\t{mean:.2}\t{least:.2}\t{most:.2}\t{:.3}\t{:.3}\t{:.3}\t{:.4}\t{:.5}",
            pair.pair,
            100.0 * pair.spread,
            1e-6 * pair.pressure,
            1e6 * pair.depth,
            1e9 * pair.volume,
            1e3 * pair.mass
        )
    };
    let rows = wear.steps.iter().flat_map(|step| step.pairs.iter().map(|pair| row(step.distance, pair)));
    aligned(heading, rows)
}

fn end_text(wear: &Wear) -> String {
    let spread = wear.steps.last().map_or(0.0, |step| 100.0 * step.spread());
    match wear.end {
        WearEnd::Distance => String::new(),
        WearEnd::Uniform => format!("\nthe wear rate is uniform: p v differs by {spread:.3} % (standard deviation)\n"),
        WearEnd::Steady => format!(
            "\nthe wear rate changes no more and is not uniform: p v differs by {spread:.3} %. Parts tilt at a constant rate, \
             or points have no contact\n"
        ),
    }
}

/// Volume of the gaps beside Archard's.
fn balance_text(wear: &Wear) -> String {
    let Some(last) = wear.steps.last() else { return String::new() };
    let off = |pair: &PairWear| (pair.volume - pair.archard_volume).abs() / pair.archard_volume.max(f64::MIN_POSITIVE);
    let worst = last.pairs.iter().map(off).fold(0.0, f64::max);
    format!("\nmass balance: worn volume and k sum p v dt differ by {worst:.1e}\n")
}

/// A pair after a step.
#[derive(Default, Serialize)]
struct StepRow<'a> {
    step: usize,
    distance_m: f64,
    #[serde(flatten)]
    pair: Option<&'a PairWear>,
}

/// Writes the folder's files beside the pressures. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(wear: &Wear, folder: &Folder, summary: &str) -> Result<()> {
    folder.write("summary.txt", |out| out.write_all(summary.as_bytes()))?;
    let steps = wear.steps.iter().enumerate();
    let rows = steps.flat_map(|(step, own)| {
        own.pairs.iter().map(move |pair| StepRow { step, distance_m: own.distance, pair: Some(pair) })
    });
    folder.write("steps.csv", |out| write_csv(out, rows))?;
    folder.write(GAPS, |out| write_csv(out, wear.points.iter().cloned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::WearStep;

    fn wear(end: WearEnd) -> Wear {
        let pair = |volume: f64| PairWear {
            pair: "disc / pad".into(),
            mean: 2.5e6,
            spread: 0.21,
            depth: 3e-6,
            volume,
            archard_volume: 2e-9,
            ..PairWear::default()
        };
        let step = |distance: f64, volume: f64| WearStep { distance, pairs: vec![pair(volume)] };
        Wear { title: "brake".into(), end, steps: vec![step(0.0, 0.0), step(50.0, 2.002e-9)], ..Wear::default() }
    }

    #[test]
    fn the_text_has_each_step_the_end_and_the_balance() {
        let text = text(&wear(WearEnd::Steady));
        assert!(text.contains("p v differs by 21.000 %. Parts tilt at a constant rate"), "{text}");
        assert!(text.contains("differ by 1.0e-3\n"), "{text}");
        let last = text.lines().find(|line| line.contains("5.0000e1")).unwrap();
        assert!(last.starts_with("disc / pad") && last.contains("2500.00") && last.contains("2.0020"), "{last}");
        assert!(super::text(&wear(WearEnd::Uniform)).contains("the wear rate is uniform"));
        assert!(!super::text(&wear(WearEnd::Distance)).contains("wear rate"));
    }

    #[test]
    fn a_row_has_its_step_and_pair() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(&place.path().join("run"), false).unwrap();
        write(&wear(WearEnd::Distance), &folder, "summary").unwrap();
        folder.finish().unwrap();
        let steps = std::fs::read_to_string(place.path().join("run/steps.csv")).unwrap();
        assert!(steps.starts_with("step,distance_m,pair,pv_mean_w_per_m2,pv_spread,"), "{steps}");
        assert!(steps.lines().nth(2).unwrap().starts_with("1,50,disc / pad,2500000,0.21,"), "{steps}");
    }
}
