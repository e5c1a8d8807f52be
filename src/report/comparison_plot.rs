//! Two results side by side, as a figure.

use super::svg::{Anchor, INK, PALE, Panel, Scale, Sheet, colour};
use crate::comparison::{Comparison, ModePair};
use crate::output::text::plural;

/// Frequency error, growth-rate error and MAC of all pairs against A's frequency; pairs that grow are in colour.
pub fn errors(comparison: &Comparison) -> String {
    let mut sheet = Sheet::new([720.0, 620.0]);
    let band = comparison.band.map(|f| f / 1000.0);
    type Quantity = fn(&ModePair) -> f64;
    let rows: [(&str, Quantity); 3] = [
        ("frequency error, %", |pair| 100.0 * pair.frequency_error),
        ("growth rate error, %", |pair| 100.0 * pair.growth_error),
        ("MAC", |pair| pair.mac),
    ];
    for (k, (name, of)) in rows.into_iter().enumerate() {
        let values = || pairs(comparison).map(of);
        let y = if k == 2 { Scale::linear([0.0, 1.0]) } else { symmetric(values()) };
        let area = [80.0, 60.0 + 175.0 * k as f64, 600.0, 150.0];
        let panel = Panel { area, x: Scale::linear(band), y };
        panel.draw(&mut sheet, (k == 2).then_some("frequency of A, kHz"), name);
        for (is_unstable, radius, fill) in [(false, 2.2, PALE), (true, 3.5, colour(0))] {
            for pair in pairs(comparison).filter(|pair| pair.is_unstable() == is_unstable) {
                sheet.circle(panel.at(pair.a.frequency / 1000.0, of(pair)), radius, &format!(r#"fill="{fill}""#));
            }
        }
    }
    let n = comparison.values.len();
    let title = format!("B compared with A, {n} friction value{}", plural(n));
    sheet.heading(&title);
    sheet.circle([80.0, 42.0], 3.5, &format!(r#"fill="{}""#, colour(0)));
    sheet.text([90.0, 46.0], Anchor::Start, "unstable in A or in B", &format!(r#"fill="{INK}""#));
    sheet.finish("Errors of frequencies and growth rates and MAC of all modes against frequency")
}

fn pairs(comparison: &Comparison) -> impl Iterator<Item = &ModePair> {
    comparison.values.iter().flat_map(|at| &at.pairs)
}

/// A scale about zero that contains all numbers.
fn symmetric(numbers: impl Iterator<Item = f64>) -> Scale {
    let most = numbers.map(f64::abs).fold(0.0, f64::max).max(1e-9);
    Scale::with_margin([-most, most], 0.05)
}
