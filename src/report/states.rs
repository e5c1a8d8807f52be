//! Named states of one brake beside each other: instabilities by state, as table, CSV, JSON, figures and a page.

use std::path::Path;

use serde::Serialize;

use super::findings::{End, Findings, Instability};
use super::{page, states_page, words};
use crate::Result;
use crate::analysis::StateResults;
use crate::comparison::{Comparison, compare};
use crate::output::columns::write_csv;
use crate::output::files::write_file;
use crate::output::json;
use crate::output::text::{aligned, or_dash};
use crate::results::{PairWear, Results, Value};

/// The states of a brake, compared.
#[derive(Debug, Serialize)]
pub struct StatesDocument {
    /// Title of the brake.
    pub title: String,
    /// Band, Hz.
    pub band_hz: [f64; 2],
    /// What counts as unstable.
    pub criterion: String,
    /// In the order of the file.
    pub states: Vec<StateDocument>,
    /// Folder of the study.
    pub folder: String,
}

/// A state.
#[derive(Debug, Serialize)]
pub struct StateDocument {
    /// Its name.
    pub state: String,
    /// Its folder in that of the study.
    pub folder: String,
    /// Its verdict in a sentence.
    pub verdict: String,
    /// Sliding distance of its wear; none where it was not worn.
    pub wear_distance_m: Option<f64>,
    /// Its wear at the end, by pair.
    pub wear: Vec<PairWear>,
    /// Pressure on the sliding pairs, at the friction value in the middle.
    pub pressures: Vec<PressureRow>,
    /// The strongest first.
    pub instabilities: Vec<InstabilityRow>,
}

/// Pressure on a sliding pair.
#[derive(Debug, Default, Serialize)]
pub struct PressureRow {
    /// Its name.
    pub pair: String,
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Largest pressure.
    pub peak_pressure_pa: f64,
    /// Area of the closed points.
    pub closed_area_m2: f64,
    /// Mean pressure of the closed points.
    pub mean_pressure_pa: f64,
}

/// An instability of a state.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct InstabilityRow {
    /// The state.
    pub state: String,
    /// Frequency where it grows fastest.
    pub frequency_hz: f64,
    /// The growth rate there.
    pub growth_rate_per_s: f64,
    /// The damping ratio there.
    pub damping_ratio: f64,
    /// The friction coefficient there.
    pub friction: f64,
    /// The friction coefficient from which on it grows, as well as it is known.
    pub onset_friction: f64,
    /// The frequency there.
    pub onset_frequency_hz: f64,
    /// Whether the onset is a Hopf point; else it grows from the first value, or from one that follows a stable one.
    pub onset_is_followed: bool,
    /// Frequency of the first state's mode that has the most in common with it, at the same friction value.
    pub first_state_frequency_hz: Option<f64>,
    /// That mode's growth rate.
    pub first_state_growth_rate_per_s: Option<f64>,
    /// Modal assurance criterion of the two.
    pub mac: Option<f64>,
}

impl StatesDocument {
    /// Compares states with the first of them; there is at least one.
    ///
    /// # Errors
    /// See [`compare`].
    pub fn new(states: &[StateResults], folder: &Path) -> Result<StatesDocument> {
        let first = &states[0].results;
        Ok(StatesDocument {
            title: first.about.title.clone(),
            band_hz: first.about.band,
            criterion: first.about.criterion.to_string(),
            states: states.iter().map(|state| StateDocument::new(state, first)).collect::<Result<_>>()?,
            folder: folder.display().to_string(),
        })
    }

    /// All instabilities.
    fn rows(&self) -> impl Iterator<Item = &InstabilityRow> {
        self.states.iter().flat_map(|state| &state.instabilities)
    }

    /// The comparison for people.
    pub fn text(&self) -> String {
        let [from, to] = self.band_hz;
        let n = self.states.len();
        let head = format!("{}: {n} states, modes of {from}-{to} Hz; unstable: {}\n\n", self.title, self.criterion);
        let verdicts: String = self.states.iter().map(|own| format!("{}: {}\n", own.state, own.verdict)).collect();
        head + &verdicts + "\n" + &self.instabilities() + "\n" + &self.pressures() + &self.files()
    }

    fn instabilities(&self) -> String {
        let heading = "unstable modes\tonset\t\tfastest growth\t\t\tmode of the first state\t\t\n\
                       state\tmu\tHz\tmu\tHz\t1/s\tHz\t1/s\tMAC";
        let row = |row: &InstabilityRow| {
            let mark = if row.onset_is_followed { "" } else { " or below" };
            format!(
                "{}\t{:.4}{mark}\t{:.1}\t{}\t{:.1}\t{:+.1}\t{}\t{}\t{}",
                row.state,
                row.onset_friction,
                row.onset_frequency_hz,
                row.friction,
                row.frequency_hz,
                row.growth_rate_per_s,
                or_dash(row.first_state_frequency_hz, |f| format!("{f:.1}")),
                or_dash(row.first_state_growth_rate_per_s, |a| format!("{a:+.1}")),
                or_dash(row.mac, |mac| format!("{mac:.3}")),
            )
        };
        aligned(heading, self.rows().map(row))
    }

    fn pressures(&self) -> String {
        let heading = "\t\tpeak\tmean\tclosed\tspread of\tworn\nstate\tpair\tMPa\tMPa\tcm2\tp v, %\tum";
        let row = |state: &StateDocument, own: &PressureRow| {
            let wear = state.wear.iter().find(|wear| wear.pair == own.pair);
            let (peak, mean, area) =
                (1e-6 * own.peak_pressure_pa, 1e-6 * own.mean_pressure_pa, 1e4 * own.closed_area_m2);
            let spread = or_dash(wear, |wear| format!("{:.2}", 100.0 * wear.spread));
            let depth = or_dash(wear, |wear| format!("{:.2}", 1e6 * wear.depth));
            format!("{}\t{}\t{peak:.3}\t{mean:.3}\t{area:.3}\t{spread}\t{depth}", state.state, own.pair)
        };
        let rows = self.states.iter().flat_map(|state| state.pressures.iter().map(move |own| row(state, own)));
        aligned(heading, rows)
    }

    fn files(&self) -> String {
        let pages: Vec<String> = self.states.iter().map(|state| format!("{}.html", state.folder)).collect();
        format!("\nresults in {}: states.html, {}\n", self.folder, pages.join(", "))
    }
}

impl StateDocument {
    fn new(state: &StateResults, first: &Results) -> Result<StateDocument> {
        let findings = Findings::new(&state.results);
        let comparison = compare(first, &state.results)?;
        let last = state.wear.as_ref().and_then(|wear| wear.steps.last());
        Ok(StateDocument {
            state: state.name.clone(),
            folder: state.folder.clone(),
            verdict: words::headline(&findings),
            wear_distance_m: last.map(|step| step.distance),
            wear: last.map_or_else(Vec::new, |step| step.pairs.clone()),
            pressures: pressures(&state.results),
            instabilities: findings
                .instabilities
                .iter()
                .map(|one| InstabilityRow::new(&state.name, &findings, one, &comparison))
                .collect(),
        })
    }
}

impl InstabilityRow {
    fn new(state: &str, findings: &Findings, one: &Instability, comparison: &Comparison) -> InstabilityRow {
        let (mode, friction) = (findings.mode(one.worst), findings.friction(one.worst));
        let range = one.ranges.first();
        let (onset, frequency) = range.map_or((End::Edge(friction), mode.frequency()), |own| (own.from, own.frequency));
        let at = comparison.values.iter().find(|at| at.friction == friction);
        let partner = at.and_then(|at| at.pairs.iter().find(|pair| pair.b.mode == one.worst.mode + 1));
        InstabilityRow {
            state: state.to_owned(),
            frequency_hz: mode.frequency(),
            growth_rate_per_s: mode.growth_rate(),
            damping_ratio: mode.damping_ratio(),
            friction,
            onset_friction: onset.value(),
            onset_frequency_hz: frequency,
            onset_is_followed: matches!(onset, End::Hopf(_)),
            first_state_frequency_hz: partner.map(|pair| pair.a.frequency),
            first_state_growth_rate_per_s: partner.map(|pair| pair.a.growth_rate),
            mac: partner.map(|pair| pair.mac),
        }
    }
}

/// The value in the middle of those asked for.
pub(super) fn middle(results: &Results) -> Option<&Value> {
    let mut asked: Vec<&Value> = results.asked().collect();
    asked.sort_by(|a, b| a.friction.total_cmp(&b.friction));
    asked.get(asked.len() / 2).copied()
}

/// Pressures of the sliding pairs at the value in the middle.
fn pressures(results: &Results) -> Vec<PressureRow> {
    let Some(value) = middle(results) else { return Vec::new() };
    let pairs = results.about.pairs.iter().zip(&value.pairs).filter(|(pair, _)| pair.sliding);
    let row = |(pair, own): (&crate::results::Pair, &crate::equilibrium::PairForces)| PressureRow {
        pair: pair.name.clone(),
        friction: value.friction,
        peak_pressure_pa: own.peak_pressure,
        closed_area_m2: own.closed_area,
        mean_pressure_pa: if own.closed_area > 0.0 { own.normal / own.closed_area } else { 0.0 },
    };
    pairs.map(row).collect()
}

/// Writes the comparison and a page of each state. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(place: &Path, document: &StatesDocument, states: &[StateResults]) -> Result<()> {
    write_file(&place.join("summary.txt"), |out| out.write_all(document.text().as_bytes()))?;
    write_file(&place.join("states.json"), |out| out.write_all(json::text(document).as_bytes()))?;
    write_file(&place.join("states.csv"), |out| write_csv(out, document.rows().cloned()))?;
    let page = states_page::page(document, states);
    write_file(&place.join("states.html"), |out| out.write_all(page.as_bytes()))?;
    states.iter().try_for_each(|state| {
        let page = page::page(&state.results)?;
        write_file(&place.join(format!("{}.html", state.folder)), |out| out.write_all(page.as_bytes()))
    })
}
