//! A brake in several models: frequencies and growth rates of its instabilities over friction (figures 7 and 8 of the
//! paper).

use super::svg::{Anchor, INK, Panel, Scale, Sheet, colour};
use crate::algebra::span;
use crate::comparison::{CurvePoint, StudiedModel, Study};

/// The reference and some of the models: a column an instability, frequency above growth rate. None where nothing
/// grows.
pub fn instabilities(study: &Study, models: &[&StudiedModel], title: &str) -> Option<String> {
    const COLUMN: f64 = 430.0;
    let (n, friction_values) = (study.reference.curves.len(), &study.friction_values);
    let (Some(first), Some(last)) = (friction_values.first(), friction_values.last()) else { return None };
    let x = Scale::with_margin([*first, *last], 0.03);
    let mut sheet = Sheet::new([COLUMN * n as f64 + 20.0, 520.0 + 20.0 * models.len().div_ceil(2) as f64]);
    for i in 0..n {
        let all: Vec<&StudiedModel> = [&study.reference].into_iter().chain(models.iter().copied()).collect();
        let left = 80.0 + COLUMN * i as f64;
        let upper = Panel { area: [left, 50.0, 330.0, 185.0], x, y: scale(&all, i, |point| point.frequency) };
        upper.draw(&mut sheet, None, "frequency, Hz");
        let lower = Panel { area: [left, 260.0, 330.0, 185.0], x, y: scale(&all, i, |point| point.growth_rate) };
        lower.draw(&mut sheet, Some("friction coefficient \u{3bc}"), "growth rate, 1/s");
        for (panel, of) in [(&upper, frequency as fn(&CurvePoint) -> f64), (&lower, growth_rate)] {
            for (k, model) in all.iter().enumerate() {
                curve(&mut sheet, panel, &model.curves[i], of, k);
            }
        }
    }
    sheet.heading(title);
    for (k, name) in [&study.reference.name].into_iter().chain(models.iter().map(|model| &model.name)).enumerate() {
        let (x, y) = (80.0 + 380.0 * (k % 2) as f64, 510.0 + 20.0 * (k / 2) as f64);
        sheet.polyline(&[[x, y], [x + 28.0, y]], &line(k));
        sheet.circle([x + 14.0, y], 3.0, &format!(r#"fill="{}""#, ink(k)));
        sheet.text([x + 36.0, y + 4.5], Anchor::Start, name, "");
    }
    (n > 0).then(|| sheet.finish(title))
}

fn frequency(point: &CurvePoint) -> f64 {
    point.frequency
}

fn growth_rate(point: &CurvePoint) -> f64 {
    point.growth_rate
}

fn scale(models: &[&StudiedModel], i: usize, of: fn(&CurvePoint) -> f64) -> Scale {
    let values = models.iter().flat_map(|model| &model.curves[i]).map(of);
    Scale::with_margin(span(values), 0.06)
}

/// The reference in the colour of the axes, the models in the palette's.
fn ink(k: usize) -> &'static str {
    if k == 0 { INK } else { colour(k - 1) }
}

fn line(k: usize) -> String {
    let width = if k == 0 { 3.0 } else { 1.6 };
    format!(r#"stroke="{}" stroke-width="{width}""#, ink(k))
}

fn curve(sheet: &mut Sheet, panel: &Panel, points: &[CurvePoint], of: fn(&CurvePoint) -> f64, k: usize) {
    let places: Vec<[f64; 2]> = points.iter().map(|point| panel.at(point.friction, of(point))).collect();
    sheet.polyline(&places, &line(k));
    for place in places {
        sheet.circle(place, 3.0, &format!(r#"fill="{}""#, ink(k)));
    }
}
