//! Text for people: columns under headings, lists of files, small words.

use std::borrow::Cow;

/// Rows in columns under a heading of one or more lines, cells separated by tabs: words to the left, numbers to the
/// right.
pub fn aligned(heading: &str, rows: impl IntoIterator<Item = String>) -> String {
    let rows: Vec<String> = rows.into_iter().collect();
    let cells = |line: &str| line.split('\t').map(String::from).collect::<Vec<_>>();
    let (heads, rows): (Vec<_>, Vec<_>) =
        (heading.lines().map(cells).collect(), rows.iter().map(|row| cells(row)).collect());
    let column = |k: usize| {
        let width = heads.iter().chain(&rows).filter_map(|line| line.get(k)).map(|cell| cell.chars().count()).max();
        (width.unwrap_or(0), rows.iter().filter_map(|row| row.get(k)).all(|cell| is_number(cell)))
    };
    let text = |line: &Vec<String>| {
        let cell_text = |(k, cell): (usize, &String)| match column(k) {
            (width, true) => format!("{cell:>width$}"),
            (width, false) => format!("{cell:width$}"),
        };
        line.iter().enumerate().map(cell_text).collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    heads.iter().chain(&rows).map(text).collect()
}

/// Whether a cell is a number, several of them, or the mark of a missing one.
fn is_number(cell: &str) -> bool {
    cell.trim_start().chars().next().is_none_or(|first| first.is_ascii_digit() || "+-".contains(first))
}

/// A value, or the mark of a missing one.
pub fn or_dash<T>(value: Option<T>, shown: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".into(), shown)
}

/// What the files of a results folder contain.
pub fn files(place: &str, files: &[(&str, &str)]) -> String {
    let lines: String = files.iter().map(|(name, what)| format!("  {name:36}{what}\n")).collect();
    format!("\nresults in {place}:\n{lines}")
}

/// A friction coefficient for people: three decimals, up to seven where it has them.
pub fn friction(value: f64) -> String {
    let long = format!("{value:.7}");
    let n_zeros = long.chars().rev().take_while(|&c| c == '0').count();
    long[..long.len() - n_zeros.min(4)].to_owned()
}

/// What a run took.
pub fn cost(seconds: f64, n_ranks: usize) -> String {
    format!("\n{seconds:.1} s on {n_ranks} rank{}\n", plural(n_ranks))
}

/// The ending of a noun after a number.
pub fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}

/// Lines below an empty one; nothing where there are none.
pub fn paragraph(lines: &str) -> String {
    if lines.is_empty() { String::new() } else { format!("\n{lines}") }
}

/// A text for a terminal: control characters, which a name in a mesh may have, are spelled out.
pub fn printable(text: &str) -> Cow<'_, str> {
    let acts = |c: char| c.is_control() && !"\n\t".contains(c);
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let spelled = |c: char| if acts(c) { c.escape_unicode().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(spelled).collect())
}

/// A text inside XML or HTML, in elements and in attributes.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // XML allows no other control characters.
            c if c.is_control() && !"\n\t\r".contains(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A mass in kg; with an exponent where digits would be lost, as by a density in a wrong unit.
pub fn mass(kg: f64) -> String {
    if kg == 0.0 || (1e-3..1e6).contains(&kg) { format!("{kg:.4}") } else { format!("{kg:.3e}") }
}

/// Three numbers in another unit with so many decimals, where rounding leaves no `-0.00`.
pub fn joined(x: [f64; 3], unit: f64, decimals: usize, separator: &str) -> String {
    let scale = 10_f64.powi(decimals as i32);
    x.map(|x| format!("{:.decimals$}", ((unit * x * scale).round() + 0.0) / scale)).join(separator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_of_a_wrong_unit_keep_their_digits() {
        assert_eq!(
            [0.0, 0.0639, 4.8, 4.8e-12, 2.65e9].map(mass),
            ["0.0000", "0.0639", "4.8000", "4.800e-12", "2.650e9"]
        );
    }

    #[test]
    fn control_characters_are_spelled_out() {
        assert_eq!(printable("disc\t1\n"), "disc\t1\n");
        assert_eq!(printable("\u{1b}[2Jdisc\u{7}"), "\\u{1b}[2Jdisc\\u{7}");
    }

    #[test]
    fn friction_values_have_the_digits_that_keep_them_apart() {
        let shown = [0.1, 0.100001, 0.1 + 0.2, 0.17823456789, 1.0, 0.0].map(friction);
        assert_eq!(shown, ["0.100", "0.100001", "0.300", "0.1782346", "1.000", "0.000"]);
    }

    #[test]
    fn words_stand_to_the_left_and_numbers_to_the_right() {
        let rows = ["disc\t1.5\tunstable\t-", "a pad\t-12\t\t3"].map(String::from);
        let expected = [
            "                           left",
            "part   mass, kg  remark    over",
            "disc        1.5  unstable     -",
            "a pad       -12               3",
            "",
        ];
        assert_eq!(aligned("\t\t\tleft\npart\tmass, kg\tremark\tover", rows), expected.join("\n"));
        assert_eq!(aligned("part\tmass", []), "part  mass\n");
    }
}
