//! Figures of a study of many parameters that need no script: probability over frequency, and rows of bars.

use super::svg::{Anchor, INK, PALE, Panel, Scale, Sheet, colour};
use crate::explore::{Bar, Bin, Indices, PointMode, PointResult, Study, Tornado, quantile, quantity};
use crate::results::Exploration;

/// A bar along a row.
struct Span {
    /// Both ends.
    ends: [f64; 2],
    /// Height in pixels, and how far its middle is below that of the row.
    height: f64,
    below: f64,
    colour: &'static str,
    /// Interval of confidence at its end.
    whisker: Option<[f64; 2]>,
}

/// A row of a figure: a name with bars.
struct Row {
    name: String,
    spans: Vec<Span>,
    /// A mark, such as a median.
    mark: Option<f64>,
}

/// A figure of rows.
struct Rows<'a> {
    title: String,
    x_name: &'a str,
    rows: Vec<Row>,
    /// Numbers that are always in view; a line stands at each.
    lines: Vec<f64>,
    key: &'a [(&'static str, &'a str)],
}

/// Height of a row, pixels.
const ROW: f64 = 30.0;
/// An axis covers no less, in its own unit.
const LEAST_RANGE: f64 = 0.1;
/// Intervals of Sobol indices are drawn as far as this.
const INDEX_RANGE: [f64; 2] = [-0.5, 1.5];
/// Names of rows are cut after so many letters.
const MAX_NAME: usize = 26;

impl Rows<'_> {
    fn draw(&self) -> String {
        let height = ROW * self.rows.len() as f64;
        let mut sheet = Sheet::new([640.0, height + 110.0]);
        let panel = Panel { area: [190.0, 56.0, 430.0, height], x: self.scale(), y: Scale::linear([0.0, 1.0]) };
        panel.draw_x(&mut sheet, Some(self.x_name));
        for line in &self.lines {
            let style = format!(r#"stroke="{PALE}" stroke-dasharray="4 3""#);
            sheet.line(panel.at(*line, 0.0), panel.at(*line, 1.0), &style);
        }
        for (k, row) in self.rows.iter().enumerate() {
            let y = 56.0 + ROW * (k as f64 + 0.5);
            let name: String = row.name.chars().take(MAX_NAME).collect();
            sheet.text([182.0, y + 4.5], Anchor::End, &name, "");
            row.spans.iter().for_each(|span| span.draw(&mut sheet, &panel, y));
            if let Some(mark) = row.mark {
                let [x, _] = panel.at(mark, 0.0);
                sheet.line([x, y - 9.0], [x, y + 9.0], &format!(r#"class="ink" stroke="{INK}" stroke-width="2""#));
            }
        }
        sheet.heading(&self.title);
        for (k, (colour, text)) in self.key.iter().enumerate() {
            let x = 190.0 + 190.0 * k as f64;
            rectangle(&mut sheet, [x, 32.0], [x + 14.0, 42.0], colour);
            sheet.text([x + 20.0, 42.0], Anchor::Start, text, "");
        }
        sheet.finish(&self.title)
    }

    fn scale(&self) -> Scale {
        let spans = || self.rows.iter().flat_map(|row| &row.spans);
        let ends = spans().flat_map(|span| span.ends.into_iter().chain(span.whisker.into_iter().flatten()));
        let all: Vec<f64> = ends.chain(self.lines.iter().copied()).collect();
        let (low, high) = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
        // Rounding does not fill a figure.
        let slack = (0.5 * (LEAST_RANGE - (high - low))).max(0.0);
        Scale::with_margin([low - slack, high + slack], 0.04)
    }
}

impl Span {
    fn new(ends: [f64; 2], colour: &'static str) -> Span {
        Span { ends, height: 16.0, below: 0.0, colour, whisker: None }
    }

    fn draw(&self, sheet: &mut Sheet, panel: &Panel, y: f64) {
        let y = y + self.below;
        let x = |value: f64| panel.at(value, 0.0)[0];
        let [from, to] = self.ends.map(x);
        rectangle(sheet, [from, y - 0.5 * self.height], [to, y + 0.5 * self.height], self.colour);
        if let Some([low, high]) = self.whisker {
            let style = format!(r#"class="ink" stroke="{INK}""#);
            sheet.line([x(low), y], [x(high), y], &style);
            [low, high].into_iter().for_each(|end| sheet.line([x(end), y - 4.0], [x(end), y + 4.0], &style));
        }
    }
}

fn rectangle(sheet: &mut Sheet, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], colour: &str) {
    sheet.polygon(&[[x1, y1], [x2, y1], [x2, y2], [x1, y2]], &format!(r#"fill="{colour}""#));
}

/// The probability of squeal over frequency with intervals of confidence, those only where points are a sample.
pub(super) fn frequencies(bins: &[Bin], is_sample: bool) -> String {
    let mut sheet = Sheet::new([640.0, 330.0]);
    let top = bins.iter().map(|bin| if is_sample { bin.probability.high } else { bin.probability.value });
    let top = 100.0 * top.fold(0.1, f64::max);
    let band = [bins.first().map_or(0.0, |bin| bin.from_hz), bins.last().map_or(1.0, |bin| bin.to_hz)];
    let panel = Panel { area: [80.0, 40.0, 540.0, 230.0], x: Scale::linear(band), y: Scale::linear([0.0, top]) };
    panel.draw(&mut sheet, Some("frequency, Hz"), if is_sample { "probability, %" } else { "points, %" });
    for bin in bins.iter().filter(|bin| bin.probability.n_true > 0) {
        let at = |f: f64, p: f64| panel.at(f, 100.0 * p);
        let gap = 0.05 * (bin.to_hz - bin.from_hz);
        rectangle(&mut sheet, at(bin.from_hz + gap, bin.probability.value), at(bin.to_hz - gap, 0.0), colour(1));
        if is_sample {
            let middle = 0.5 * (bin.from_hz + bin.to_hz);
            let [low, high] = [at(middle, bin.probability.low), at(middle, bin.probability.high)];
            sheet.line(low, high, &format!(r#"class="ink" stroke="{INK}" stroke-width="1.5""#));
        }
    }
    sheet.heading("Squeal over frequency");
    sheet.finish("Probability of squeal over frequency")
}

/// First-order and total Sobol indices.
pub(super) fn indices(all: &[Indices]) -> String {
    let row = |own: &Indices| {
        let span = |estimate: &crate::explore::Estimate, below: f64, n: usize| Span {
            ends: [0.0, estimate.value],
            height: 9.0,
            below,
            colour: colour(n),
            whisker: Some([estimate.low, estimate.high].map(|end| end.clamp(INDEX_RANGE[0], INDEX_RANGE[1]))),
        };
        Row {
            name: own.parameter.clone(),
            spans: vec![span(&own.first_order, -6.0, 1), span(&own.total, 6.0, 4)],
            mark: None,
        }
    };
    let mut rows: Vec<&Indices> = all.iter().collect();
    rows.sort_by(|a, b| b.total.value.total_cmp(&a.total.value));
    let key = [(colour(1), "alone (first order)"), (colour(4), "with interactions (total)")];
    let title = "Share of the variance of the largest growth rate (Sobol indices)".to_owned();
    Rows { title, x_name: "share", rows: rows.into_iter().map(row).collect(), lines: vec![0.0, 1.0], key: &key }.draw()
}

/// Growth of a mode over the range of each parameter, to first order.
pub(super) fn tornado(own: &Tornado) -> String {
    let a = own.growth_rate_per_s;
    let row = |bar: &crate::explore::Influence| {
        let [from, to] = bar.ends(a);
        let spans = vec![Span::new([from, a], colour(1)), Span::new([a, to], colour(0))];
        Row { name: bar.parameter.clone(), spans, mark: None }
    };
    let key = [(colour(1), "at its quantile 5 %"), (colour(0), "at its quantile 95 %")];
    let title = format!("Mode {}: {:.1} Hz, {a:+.1} 1/s", own.nominal, own.frequency_hz);
    let rows = own.bars.iter().map(row).collect();
    Rows { title, x_name: "growth rate to first order, 1/s", rows, lines: vec![0.0, a], key: &key }.draw()
}

/// The largest growth rate while one parameter alone varies.
pub(super) fn swings(bars: &[Bar]) -> String {
    let row = |bar: &Bar| Row {
        name: bar.parameter.clone(),
        spans: vec![Span::new([bar.lowest, bar.highest], colour(1))],
        mark: None,
    };
    let title = "Largest growth rate, one parameter at a time".to_owned();
    Rows { title, x_name: "growth rate, 1/s", rows: bars.iter().map(row).collect(), lines: vec![0.0], key: &[] }.draw()
}

/// How the growth rates of the instabilities are distributed over the points, and that of the mode which grows most.
pub(super) fn distributions(study: &Study, found: &Exploration) -> String {
    let sample: Vec<&PointResult> = found.points[1..]
        .iter()
        .enumerate()
        .filter(|(i, _)| study.is_independent(*i))
        .map(|(_, point)| point)
        .collect();
    let largest = sample.iter().filter_map(|point| quantity(point)).collect();
    let of_mode = |nominal: usize| -> Vec<f64> {
        let is_own = |mode: &&PointMode| mode.link.is_some_and(|link| link.nominal == nominal);
        sample.iter().filter_map(|point| point.modes()?.iter().find(is_own)).map(PointMode::growth_rate).collect()
    };
    let instabilities =
        found.answers.instabilities.iter().filter_map(|own| Some((own.nominal?, own.nominal_frequency_hz?)));
    let rows =
        instabilities.take(MAX_DISTRIBUTIONS).map(|(n, hertz)| box_row(format!("mode {n}, {hertz:.0} Hz"), of_mode(n)));
    let rows: Vec<Row> = [box_row("largest of a point".into(), largest)].into_iter().chain(rows).flatten().collect();
    let key = [(colour(5), "5 to 95 % of the points"), (colour(1), "25 to 75 %")];
    let title = "Distribution of growth rates over the points, with the median".to_owned();
    Rows { title, x_name: "growth rate, 1/s", rows, lines: vec![0.0], key: &key }.draw()
}

/// Instabilities in the figure of distributions.
const MAX_DISTRIBUTIONS: usize = 15;

fn box_row(name: String, mut values: Vec<f64>) -> Option<Row> {
    values.sort_by(f64::total_cmp);
    let at = |u: f64| quantile(&values, u);
    let thin = Span { height: 6.0, ..Span::new([at(0.05)?, at(0.95)?], colour(5)) };
    Some(Row { name, spans: vec![thin, Span::new([at(0.25)?, at(0.75)?], colour(1))], mark: at(0.5) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::{Estimate, Influence, Probability};

    /// Left ends and widths of the rectangles of a colour.
    fn rectangles(svg: &str, colour: &str) -> Vec<[f64; 2]> {
        let xml = roxmltree::Document::parse(svg).unwrap();
        let own =
            xml.descendants().filter(|node| node.has_tag_name("polygon") && node.attribute("fill") == Some(colour));
        let ends = |text: &str| {
            let x: Vec<f64> = text.split(' ').map(|pair| pair.split(',').next().unwrap().parse().unwrap()).collect();
            [x[0], x[1] - x[0]]
        };
        own.map(|node| ends(node.attribute("points").unwrap())).collect()
    }

    #[test]
    fn indices_are_sorted_bars_from_zero() {
        let estimate = |value: f64| Estimate { value, low: value - 0.1, high: value + 0.1 };
        let of = |name: &str, first, total| Indices {
            parameter: name.into(),
            first_order: estimate(first),
            total: estimate(total),
        };
        let svg = indices(&[of("a", 0.1, 0.2), of("b", 0.5, 0.8)]);
        let total = &rectangles(&svg, colour(4))[..2];
        assert!((total[0][1] / total[1][1] - 4.0).abs() < 0.01 && total[0][0] == total[1][0], "{total:?}");
        assert!(svg.find(">b<").unwrap() < svg.find(">a<").unwrap(), "the largest total first");
    }

    #[test]
    fn a_tornado_reaches_from_quantile_to_quantile() {
        let bar = Influence {
            parameter: "mu".into(),
            nominal: 0.4,
            from: 0.2,
            to: 0.5,
            growth_rate_slope: 100.0,
            frequency_slope: 0.0,
            growth_rate_change_per_s: 30.0,
            frequency_change_hz: 0.0,
            difference: "central".into(),
        };
        let own =
            Tornado { nominal: 3, frequency_hz: 900.0, growth_rate_per_s: -5.0, linear_share: None, bars: vec![bar] };
        let svg = tornado(&own);
        let (low, high) = (rectangles(&svg, colour(1))[0], rectangles(&svg, colour(0))[0]);
        assert!((low[1] / high[1] - 2.0).abs() < 0.01 && (low[0] + low[1] - high[0]).abs() < 0.11, "{low:?} {high:?}");
    }

    #[test]
    fn confidence_is_drawn_for_samples_alone() {
        let bin = |from: f64, n: usize| Bin { from_hz: from, to_hz: from + 100.0, probability: Probability::of(n, 10) };
        let bins = [bin(0.0, 5), bin(100.0, 0)];
        assert_eq!(rectangles(&frequencies(&bins, true), colour(1)).len(), 1);
        let n_whiskers = |is_sample| frequencies(&bins, is_sample).matches("class=\"ink\"").count();
        assert_eq!((n_whiskers(true), n_whiskers(false)), (1, 0));
    }
}
