//! The pressure on a contact face in several states, side by side, as SVG.

use super::drawing::mean_plane;
use super::svg::{Anchor, Sheet};
use crate::algebra::dot;
use crate::results::Results;

/// Width of a map, pixels.
const WIDTH: f64 = 340.0;
/// Space between maps, pixels.
const MARGIN: f64 = 20.0;
/// Height of title and names, pixels.
const HEAD: f64 = 50.0;
/// Height of the scale of colours, pixels.
const FOOT: f64 = 50.0;
/// Maps in a row.
const N_COLUMNS: usize = 3;
/// Colours from no pressure to the largest, red, green and blue.
const COLOURS: [[f64; 3]; 4] =
    [[222.0, 226.0, 231.0], [253.0, 219.0, 130.0], [227.0, 100.0, 30.0], [110.0, 10.0, 40.0]];

/// The maps of a pair: name, results and nodal pressures (Pa) of each state. None where the pair has no face.
pub fn side_by_side(name: &str, pair: usize, states: &[(&str, &Results, &[f64])]) -> Option<String> {
    let top = largest(pair, states);
    let faces: Vec<Vec<([[f64; 2]; 3], f64)>> =
        states.iter().map(|(_, results, pressure)| flat(results, pair, pressure)).collect();
    let all = || faces.iter().flatten().flat_map(|(corners, _)| corners);
    all().next()?;
    let bound = |i: usize, of: fn(f64, f64) -> f64, start: f64| all().map(|x| x[i]).fold(start, of);
    let low = [0, 1].map(|i| bound(i, f64::min, f64::INFINITY));
    let high = [0, 1].map(|i| bound(i, f64::max, f64::NEG_INFINITY));
    let scale = WIDTH / (high[0] - low[0]).max(f64::MIN_POSITIVE);
    let height = scale * (high[1] - low[1]) + HEAD;
    let n_rows = states.len().div_ceil(N_COLUMNS) as f64;
    let n_columns = states.len().min(N_COLUMNS) as f64;
    let mut sheet = Sheet::new([n_columns * (WIDTH + MARGIN) + MARGIN, n_rows * height + HEAD + FOOT]);
    sheet.text([MARGIN, 24.0], Anchor::Start, name, r#"font-weight="bold""#);
    for (k, ((state, _, pressure), face)) in states.iter().zip(&faces).enumerate() {
        let left = MARGIN + (k % N_COLUMNS) as f64 * (WIDTH + MARGIN);
        let upper = HEAD + (k / N_COLUMNS) as f64 * height;
        let peak = nodes(states[k].1, pair).map(|n| pressure.get(n).copied().unwrap_or(0.0)).fold(0.0, f64::max);
        sheet.text([left, upper], Anchor::Start, &format!("{state}: peak {:.2} MPa", 1e-6 * peak), "");
        let pixel = |x: &[f64; 2]| [left + scale * (x[0] - low[0]), upper + 12.0 + scale * (high[1] - x[1])];
        for (corners, p) in face {
            let fill = colour(p / top);
            sheet.polygon(
                &corners.each_ref().map(pixel),
                &format!(r#"fill="{fill}" stroke="{fill}" stroke-width="0.5""#),
            );
        }
    }
    legend(&mut sheet, n_rows * height + HEAD + 10.0, top);
    Some(sheet.finish(&format!("Contact pressure of {name} in each state")))
}

/// The scale of colours.
fn legend(sheet: &mut Sheet, upper: f64, top: f64) {
    const N: usize = 40;
    let step = 240.0 / N as f64;
    for i in 0..N {
        let [left, right] = [i, i + 1].map(|i| MARGIN + step * i as f64);
        let fill = colour((i as f64 + 0.5) / N as f64);
        let corners = [[left, upper], [right, upper], [right, upper + 10.0], [left, upper + 10.0]];
        sheet.polygon(&corners, &format!(r#"fill="{fill}" stroke="{fill}""#));
    }
    sheet.text([MARGIN, upper + 26.0], Anchor::Start, "0", "");
    sheet.text([MARGIN + 240.0, upper + 26.0], Anchor::End, &format!("{:.2} MPa and above", 1e-6 * top), "");
}

/// The end of the scale: what 98 % of the nodes under pressure stay below, in all states.
fn largest(pair: usize, states: &[(&str, &Results, &[f64])]) -> f64 {
    let of = |(_, results, pressure): &(&str, &Results, &[f64])| {
        nodes(results, pair).filter_map(|n| pressure.get(n).copied()).filter(|p| *p > 0.0).collect::<Vec<_>>()
    };
    let mut all: Vec<f64> = states.iter().flat_map(of).collect();
    all.sort_by(f64::total_cmp);
    all.get((0.98 * all.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(1.0)
}

/// The nodes of a pair's face.
fn nodes(results: &Results, pair: usize) -> impl Iterator<Item = usize> + '_ {
    let pairs = &results.contact.pair_of_node;
    (0..pairs.len()).filter(move |&n| pairs[n] as usize == pair)
}

/// Triangles of a pair's face laid flat, each with the mean pressure of its corners.
fn flat(results: &Results, pair: usize, pressure: &[f64]) -> Vec<([[f64; 2]; 3], f64)> {
    let faces = &results.contact;
    let own: Vec<[u32; 3]> =
        faces.triangles.iter().zip(&faces.pair).filter(|(_, of)| **of as usize == pair).map(|(t, _)| *t).collect();
    let (right, up) = mean_plane(&faces.nodes, &own);
    let corner = |n: u32| [right, up].map(|axis| dot(axis, faces.nodes[n as usize]));
    let mean = |t: &[u32; 3]| t.iter().map(|&n| pressure.get(n as usize).copied().unwrap_or(0.0)).sum::<f64>() / 3.0;
    own.iter().map(|t| (t.map(corner), mean(t))).collect()
}

/// The colour of a fraction of the scale.
fn colour(fraction: f64) -> String {
    let place = fraction.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let i = (place as usize).min(COLOURS.len() - 2);
    let part = place - i as f64;
    let [r, g, b] = [0, 1, 2].map(|k| ((1.0 - part) * COLOURS[i][k] + part * COLOURS[i + 1][k]).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::testing;

    #[test]
    fn colours_run_from_the_first_to_the_last() {
        assert_eq!([0.0, 1.0, 7.0].map(colour), ["#dee2e7", "#6e0a28", "#6e0a28"]);
        assert_eq!(colour(1.0 / 3.0), "#fddb82");
    }

    #[test]
    fn each_state_has_the_triangles_of_the_face() {
        let results = testing::results();
        let pressure = &results.values[0].pressure[..];
        let svg = side_by_side("disc / pad", 0, &[("new", &results, pressure), ("worn", &results, pressure)]).unwrap();
        let n_triangles = results.contact.pair.iter().filter(|pair| **pair == 0).count();
        assert_eq!(svg.matches("<polygon").count(), 2 * n_triangles + 40);
        assert!(svg.contains("new: peak") && svg.contains("worn: peak"));
        roxmltree::Document::parse(&svg).unwrap();
        assert!(side_by_side("none", 99, &[("new", &results, pressure)]).is_none());
    }
}
