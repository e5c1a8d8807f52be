//! Figures as SVG: a sheet to draw on and panels with axes.

use std::fmt::Write;

use crate::output::text::escaped;

/// Colours that differ for all kinds of sight (Okabe and Ito, *Color universal design*, 2008), the most distinct first.
pub const PALETTE: [&str; 6] = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
/// Text and axes.
pub const INK: &str = "#333333";
/// What is there for comparison.
pub const PALE: &str = "#9aa0a6";
const GRID: &str = "#e3e6ea";
const FONT: &str = "'Helvetica Neue', Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// The colour of the nth series.
pub fn colour(n: usize) -> &'static str {
    PALETTE[n % PALETTE.len()]
}

/// Where text stands relative to its point.
#[derive(Clone, Copy)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// A drawing under construction, in pixels from the upper left corner.
pub struct Sheet {
    size: [f64; 2],
    body: String,
}

impl Sheet {
    /// An empty sheet.
    pub fn new(size: [f64; 2]) -> Sheet {
        Sheet { size, body: String::new() }
    }

    /// A straight line; `style` is attributes.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], style: &str) {
        let _ = writeln!(self.body, r#"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" {style}/>"#);
    }

    /// A line through points.
    pub fn polyline(&mut self, points: &[[f64; 2]], style: &str) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(self.body, r#"<polyline points="{}" fill="none" {style}/>"#, points.join(" "));
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[[f64; 2]], style: &str) {
        let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(self.body, r#"<polygon points="{}" {style}/>"#, points.join(" "));
    }

    /// A circle.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        let _ = writeln!(self.body, r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius:.1}" {style}/>"#);
    }

    /// A square on its tip.
    pub fn diamond(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        let (w, e, n, s) = (x - radius, x + radius, y - radius, y + radius);
        let _ = writeln!(self.body, r#"<path d="M{w:.1} {y:.1}L{x:.1} {n:.1}L{e:.1} {y:.1}L{x:.1} {s:.1}Z" {style}/>"#);
    }

    /// Text, escaped.
    pub fn text(&mut self, [x, y]: [f64; 2], anchor: Anchor, text: &str, style: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escaped(text);
        let _ = writeln!(self.body, r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" {style}>{text}</text>"#);
    }

    /// A heading in the upper left corner.
    pub fn heading(&mut self, text: &str) {
        self.text([70.0, 20.0], Anchor::Start, text, r#"font-weight="bold""#);
    }

    /// Text that reads upwards, its middle at a point.
    pub fn upward(&mut self, [x, y]: [f64; 2], text: &str) {
        let turned = format!(r#"transform="rotate(-90 {x:.1} {y:.1})""#);
        self.text([x, y], Anchor::Middle, text, &turned);
    }

    /// The whole as an SVG element, with its title for screen readers.
    pub fn finish(self, title: &str) -> String {
        let ([width, height], title) = (self.size, escaped(title));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"{title}\" font-family=\"{FONT}\" font-size=\"13\" fill=\"{INK}\">\n{}</svg>\n",
            self.body
        )
    }
}

/// From numbers to a length of 1.
#[derive(Clone, Copy)]
pub struct Scale {
    from: f64,
    to: f64,
    logarithmic: bool,
}

impl Scale {
    /// A linear scale; an interval without length is widened.
    pub fn linear([from, to]: [f64; 2]) -> Scale {
        let slack = if to > from { 0.0 } else { 0.5 * from.abs().max(0.1) };
        Scale { from: from - slack, to: to + slack, logarithmic: false }
    }

    /// A linear scale that leaves a margin on both sides.
    pub fn with_margin([from, to]: [f64; 2], margin: f64) -> Scale {
        let Scale { from, to, .. } = Scale::linear([from, to]);
        Scale::linear([from - margin * (to - from), to + margin * (to - from)])
    }

    /// A logarithmic scale over whole decades.
    pub fn logarithmic([from, to]: [f64; 2]) -> Scale {
        let (from, to) = (from.log10().floor(), to.log10().ceil());
        Scale { from: 10_f64.powf(from), to: 10_f64.powf(to.max(from + 1.0)), logarithmic: true }
    }

    fn place(&self, value: f64) -> f64 {
        match self.logarithmic {
            true => (value / self.from).log10() / (self.to / self.from).log10(),
            false => (value - self.from) / (self.to - self.from),
        }
    }

    /// Round numbers, about n of them.
    fn ticks(&self, n: f64) -> Vec<f64> {
        if self.logarithmic {
            let decades = (self.to / self.from).log10().round();
            let step = (decades / n).ceil().max(1.0);
            return (0..=(decades / step) as i32).map(|i| self.from * 10_f64.powf(f64::from(i) * step)).collect();
        }
        let rough = (self.to - self.from) / n;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * power).into_iter().find(|&s| s >= rough * 0.999).unwrap_or(rough);
        let (first, last) = ((self.from / step - 1e-9).ceil() as i64, (self.to / step + 1e-9).floor() as i64);
        (first..=last).map(|i| i as f64 * step).collect()
    }

    fn label(&self, tick: f64, ticks: &[f64]) -> String {
        if self.logarithmic {
            return format!("1e{:.0}", tick.log10());
        }
        let step = if ticks.len() > 1 { ticks[1] - ticks[0] } else { tick.abs().max(1.0) };
        let decimals = (-step.log10().floor() + if step.log10().fract() == 0.0 { 0.0 } else { 1e-9 }).max(0.0) as usize;
        format!("{tick:.decimals$}").replace('-', "\u{2212}")
    }
}

/// A rectangle with axes.
pub struct Panel {
    /// Left, top, width, height.
    pub area: [f64; 4],
    /// Abscissa.
    pub x: Scale,
    /// Ordinate, upwards.
    pub y: Scale,
}

impl Panel {
    /// The pixels of a point.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, top, width, height] = self.area;
        [left + width * self.x.place(x), top + height * (1.0 - self.y.place(y))]
    }

    /// Draws grid, numbers and names of the axes; without a name of x no numbers along it.
    pub fn draw(&self, sheet: &mut Sheet, x_name: Option<&str>, y_name: &str) {
        let [left, top, width, height] = self.area;
        self.draw_x(sheet, x_name);
        let grid = format!(r#"class="grid" stroke="{GRID}""#);
        let ticks = self.y.ticks((height / 36.0).max(3.0));
        for &tick in &ticks {
            let [_, y] = self.at(self.x.from, tick);
            sheet.line([left, y], [left + width, y], &grid);
            sheet.text([left - 8.0, y + 4.5], Anchor::End, &self.y.label(tick, &ticks), "");
        }
        sheet.line([left, top], [left, top + height], &format!(r#"class="axis" stroke="{INK}""#));
        sheet.upward([left - 50.0, top + 0.5 * height], y_name);
    }

    /// Draws what belongs to the abscissa alone.
    pub fn draw_x(&self, sheet: &mut Sheet, x_name: Option<&str>) {
        let [left, top, width, height] = self.area;
        let (bottom, right) = (top + height, left + width);
        let grid = format!(r#"class="grid" stroke="{GRID}""#);
        let ticks = self.x.ticks((width / 75.0).max(2.0));
        for &tick in &ticks {
            let [x, _] = self.at(tick, self.y.from);
            sheet.line([x, top], [x, bottom], &grid);
            if x_name.is_some() {
                sheet.text([x, bottom + 18.0], Anchor::Middle, &self.x.label(tick, &ticks), "");
            }
        }
        sheet.line([left, bottom], [right, bottom], &format!(r#"class="axis" stroke="{INK}""#));
        if let Some(name) = x_name {
            sheet.text([left + 0.5 * width, bottom + 38.0], Anchor::Middle, name, "");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside_and_their_labels_tell_them_apart() {
        for (from, to) in [(0.1, 0.9), (0.0, 6.0), (-35.2, 812.0), (1747.5, 1790.0), (0.5, 0.5), (-1e-3, 2e-3)] {
            let scale = Scale::linear([from, to]);
            let ticks = scale.ticks(6.0);
            assert!((2..=8).contains(&ticks.len()), "{from} to {to}: {ticks:?}");
            assert!(ticks.iter().all(|&t| (-1e-9..=1.0 + 1e-9).contains(&scale.place(t))));
            let mut labels: Vec<String> = ticks.iter().map(|&t| scale.label(t, &ticks)).collect();
            labels.dedup();
            assert_eq!(labels.len(), ticks.len(), "{labels:?}");
        }
        let scale = Scale::linear([0.0, 0.8]);
        let ticks = scale.ticks(8.0);
        assert_eq!(scale.label(ticks[3], &ticks), "0.3");
        let scale = Scale::logarithmic([3e-13, 0.7]);
        assert_eq!(scale.ticks(20.0).len(), 14);
        assert_eq!(scale.place(1e-13), 0.0);
    }

    #[test]
    fn a_panel_puts_its_corners_where_they_belong() {
        let panel =
            Panel { area: [10.0, 20.0, 100.0, 50.0], x: Scale::linear([0.0, 2.0]), y: Scale::linear([1.0, 3.0]) };
        assert_eq!(panel.at(0.0, 1.0), [10.0, 70.0]);
        assert_eq!(panel.at(2.0, 3.0), [110.0, 20.0]);
    }

    #[test]
    fn text_is_escaped_and_the_whole_is_xml() {
        let mut sheet = Sheet::new([100.0, 50.0]);
        let hostile = "<pad> & \"plate\"\u{7}</text>";
        sheet.text([1.0, 2.0], Anchor::End, hostile, "");
        sheet.diamond([5.0, 5.0], 2.0, "");
        let svg = sheet.finish(hostile);
        let xml = roxmltree::Document::parse(&svg).unwrap();
        let text = xml.descendants().find(|node| node.has_tag_name("text")).unwrap();
        assert_eq!(text.text(), Some("<pad> & \"plate\"\u{fffd}</text>"));
        assert_eq!(xml.root_element().attribute("aria-label"), text.text());
    }
}
