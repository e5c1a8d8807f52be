//! Sections of the text of a study of many parameters.

use super::text::{aligned, or_dash, plural};
use crate::explore::{
    Bar, Bin, Estimate, Indices, Influence, Instability, PointMode, PointResult, Probability, Tornado,
};
use crate::results::FieldShare;

/// Bars of the squeal probability have so many signs at 100 %.
const BAR: f64 = 40.0;
/// Derivatives that explain less of a growth rate's variance over the points do not explain the points.
const EXPLAINED: f64 = 0.5;

/// A heading with what stands below it; nothing where that is empty.
pub(super) fn section(heading: &str, body: &str) -> String {
    if body.is_empty() { String::new() } else { format!("\n{heading}\n{body}") }
}

/// What failed points may change in the probability.
pub(super) fn with_failed(limits: Option<[f64; 2]>) -> String {
    let line = |[low, high]: [f64; 2]| {
        let [low, high] = [low, high].map(|p| 100.0 * p);
        format!("failed points are left out: with them it is {low:.1} to {high:.1} % (none or all of them unstable)\n")
    };
    limits.map_or_else(String::new, line)
}

pub(super) fn percent(own: Probability) -> String {
    if own.n_points == 0 {
        return "unknown, as no point that counts has a solution".into();
    }
    let [value, low, high] = [own.value, own.low, own.high].map(|p| 100.0 * p);
    format!("{value:.1} % (95 %: {low:.1} to {high:.1}), {} of {} points", own.n_true, own.n_points)
}

pub(super) fn instabilities(all: &[Instability]) -> String {
    let row = |own: &Instability| {
        let [low, high] = own.frequency_range_hz;
        let p = own.probability;
        format!(
            "{}\t{}\t{:.1}\t{:.1}\t{:.1}\t{low:.1}\t{high:.1}\t{:+.2}\t{}",
            or_dash(own.nominal, |number| number.to_string()),
            or_dash(own.nominal_frequency_hz, |f| format!("{f:.1}")),
            100.0 * p.value,
            100.0 * p.low,
            100.0 * p.high,
            own.largest_growth_rate_per_s,
            own.worst
        )
    };
    let heading = "mode at the\t\t\t95 %\t95 %\tfrequency where unstable\t\tlargest\tat\n\
                   nominal point\tHz\t%\tfrom\tto\tfrom\tto\tgrowth, 1/s\tpoint";
    let better = |own: &Instability| {
        let Estimate { value, low, high } = own.by_derivatives?;
        let [value, low, high] = [value, low, high].map(|p| 100.0 * p);
        let number = own.nominal?;
        Some(format!("mode {number} by points and derivatives: {value:.1} % (95 %: {low:.1} to {high:.1})\n"))
    };
    let better: String = all.iter().filter_map(better).collect();
    let others =
        if all.iter().any(|own| own.nominal.is_none()) { "-: modes without a link to the nominal point\n" } else { "" };
    if all.is_empty() { String::new() } else { aligned(heading, all.iter().map(row)) + others + &better }
}

/// A line for each random field.
pub(super) fn fields(all: &[FieldShare]) -> String {
    let line = |own: &FieldShare| {
        let FieldShare { name, n_points, n_modes, share } = own;
        let (modes, share) = (plural(*n_modes), 100.0 * share);
        format!(
            "field {name:?}: {n_modes} mode{modes} with {share:.1} % of the variance over {n_points} contact points\n"
        )
    };
    all.iter().map(line).collect()
}

/// Bins up to the last one with squeal.
pub(super) fn bins(all: &[Bin]) -> String {
    let n = all.iter().rposition(|bin| bin.probability.n_true > 0).map_or(0, |last| last + 1);
    let row = |bin: &Bin| {
        let p = bin.probability;
        let bar = "#".repeat((BAR * p.value).round() as usize);
        format!("{:.0}-{:.0} Hz\t{:.1} %\t{bar}", bin.from_hz, bin.to_hz, 100.0 * p.value)
    };
    if n == 0 { String::new() } else { aligned("frequency\t", all[..n].iter().map(row)) }
}

pub(super) fn indices(all: &[Indices]) -> String {
    let three = |own: &Estimate| format!("{:.3}\t{:.3}\t{:.3}", own.value, own.low, own.high);
    let row = |own: &Indices| format!("{}\t{}\t{}", own.parameter, three(&own.first_order), three(&own.total));
    aligned("parameter\tfirst\tfrom\tto\ttotal\tfrom\tto", all.iter().map(row))
}

pub(super) fn tornado(bars: Option<&[Bar]>) -> String {
    let row = |bar: &Bar| {
        let Bar { parameter, lowest_at, lowest, highest_at, highest } = bar;
        format!("{parameter}\t{lowest:.2}\t{lowest_at:.4e}\t{highest:.2}\t{highest_at:.4e}")
    };
    bars.filter(|bars| !bars.is_empty())
        .map_or_else(String::new, |bars| aligned("parameter\tsmallest\tat\tlargest\tat", bars.iter().map(row)))
}

/// The tornado of a mode.
pub(super) fn influences(own: &Tornado) -> String {
    let text = |share: f64| {
        let explained = format!("; they explain {:.0} % of its variance over the points", 100.0 * share.max(0.0));
        let advice = if share < EXPLAINED { ": use them for small changes alone" } else { "" };
        explained + advice
    };
    let share = own.linear_share.map_or_else(String::new, text);
    let head = format!("mode {}: {:.1} Hz, {:+.2} 1/s{share}\n", own.nominal, own.frequency_hz, own.growth_rate_per_s);
    let row = |bar: &Influence| {
        format!(
            "{}\t{:+.2}\t{:+.2}\t{:.4e}\t{:.4e}",
            bar.parameter, bar.growth_rate_change_per_s, bar.frequency_change_hz, bar.from, bar.to
        )
    };
    head + &aligned("parameter\tgrowth, 1/s\tfrequency, Hz\tfrom\tto", own.bars.iter().map(row))
}

/// A line where Hopf points are not found.
pub(super) fn hopf_points_not_found(n_edges: usize) -> String {
    let edges = format!("{n_edges} edge{} of the grid", plural(n_edges));
    let line = format!(
        "on {edges} a mode turns unstable, but its Hopf point is not found: a solution there failed, or has no mode near \
                          the frequency. Give more levels\n"
    );
    if n_edges > 0 { line } else { String::new() }
}

/// How many modes are linked to the nominal point with doubt; nothing where none is.
pub(super) fn links(points: &[PointResult]) -> String {
    let modes = || points.iter().filter_map(PointResult::modes).flatten();
    let is_doubtful = |mode: &&PointMode| mode.link.is_some_and(|link| link.doubtful);
    let count = |unstable: bool| {
        let own = || modes().filter(|mode| !unstable || mode.unstable);
        [own().filter(is_doubtful).count(), own().count()]
    };
    let ([n_unstable, of_unstable], [n, of]) = (count(true), count(false));
    let text = format!("{n_unstable} of {of_unstable} unstable modes, and {n} of all {of},");
    if n == 0 { String::new() } else { format!("{text} have a doubtful link to the nominal point (modes.csv)\n") }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::explore::{Link, Outcome};

    #[test]
    fn doubtful_links_are_counted_among_unstable_and_all_modes() {
        let mode = |unstable, doubtful| PointMode {
            lambda: Complex64::new(1.0, 1.0),
            unstable,
            backward_error: 0.0,
            link: Some(Link { nominal: 1, share: 0.5, doubtful }),
        };
        let point = |modes: &[PointMode]| PointResult { values: Vec::new(), outcome: Outcome::Modes(modes.to_vec()) };
        let points = [point(&[mode(true, true), mode(false, true)]), point(&[mode(true, false), mode(false, false)])];
        assert!(
            links(&points).contains("1 of 2 unstable modes, and 2 of all 4, have a doubtful link"),
            "{}",
            links(&points)
        );
        assert_eq!(links(&points[1..]), "");
    }

    #[test]
    fn derivatives_that_do_not_explain_the_points_say_so() {
        let tornado = |share| Tornado {
            nominal: 3,
            frequency_hz: 900.0,
            growth_rate_per_s: -5.0,
            linear_share: Some(share),
            bars: Vec::new(),
        };
        assert!(influences(&tornado(0.6)).contains("explain 60 % of its variance over the points\n"));
        assert!(influences(&tornado(-3.0)).contains("explain 0 % of its variance over the points: use them for small"));
    }
}
