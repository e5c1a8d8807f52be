//! Modes of given matrices as tables; real eigenvalues are told as what they are.

use std::f64::consts::TAU;
use std::io::{self, Write};

use num_complex::Complex64;

/// A mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its number, from 1.
    pub number: usize,
    /// The eigenvalue, 1/s.
    pub lambda: Complex64,
    /// Backward error of the scaled problem.
    pub backward_error: f64,
    /// Whether it grows, beyond noise.
    pub is_unstable: bool,
    /// Row of the matrices in which its vector is largest, from 1.
    pub largest_row: usize,
    /// Node and degree of freedom there, where rows have names.
    pub largest_dof: Option<(i64, i32)>,
}

impl Row {
    fn damping_ratio(&self) -> f64 {
        -self.lambda.re / self.lambda.norm().max(f64::MIN_POSITIVE)
    }
}

/// Modes as CSV: the parameter under its name where there is one, `mode, frequency_hz, growth_rate_per_s, damping_ratio, backward_error,
/// unstable, largest_row`, and `largest_node, largest_dof` where rows have names.
///
/// # Errors
/// The writer's.
pub fn table(out: &mut dyn Write, parameter: Option<&str>, groups: &[(f64, &[Row])]) -> io::Result<()> {
    let has_names = groups.iter().flat_map(|(_, rows)| *rows).any(|row| row.largest_dof.is_some());
    let first = parameter.map_or_else(String::new, |name| format!("{name},"));
    let last = if has_names { ",largest_node,largest_dof" } else { "" };
    let columns = "mode,frequency_hz,growth_rate_per_s,damping_ratio,backward_error,unstable,largest_row";
    writeln!(out, "{first}{columns}{last}")?;
    for (value, rows) in groups {
        let first = parameter.map_or_else(String::new, |_| format!("{value},"));
        for row in *rows {
            let Row { number, lambda, backward_error, is_unstable, largest_row, largest_dof } = row;
            let (hertz, damping) = (lambda.im / TAU, row.damping_ratio());
            write!(out, "{first}{number},{hertz:.15e},{:.15e},{damping:.6e},{backward_error:.2e}", lambda.re)?;
            write!(out, ",{},{largest_row}", u8::from(*is_unstable))?;
            match largest_dof {
                Some((node, dof)) => writeln!(out, ",{node},{dof}")?,
                None => writeln!(out)?,
            }
        }
    }
    Ok(())
}

/// Modes for people.
pub fn text(rows: &[Row]) -> String {
    let mut text = String::from("  mode   frequency Hz    growth 1/s  damping %  backward error  largest in\n");
    for row in rows {
        let place = match row.largest_dof {
            Some((node, dof)) => format!("node {node}, dof {dof}"),
            None => format!("row {}", row.largest_row),
        };
        let mark = match (row.is_unstable, row.lambda.im == 0.0) {
            (true, true) => "  unstable: real eigenvalue, divergence",
            (true, false) => "  unstable",
            (false, true) => "  real eigenvalue",
            (false, false) => "",
        };
        let (number, hertz, growth) = (row.number, row.lambda.im / TAU, row.lambda.re);
        let (damping, error) = (100.0 * row.damping_ratio(), row.backward_error);
        text +=
            &format!("  {number:>4}  {hertz:>13.6}  {growth:>+12.5}  {damping:>9.4}  {error:>14.1e}  {place}{mark}\n");
    }
    text
}

/// Shapes as CSV, a line for each equation: `row`, `node, dof` where rows have names, and `re_1, im_1, re_2, ...` of the modes, the largest
/// entry of each of modulus 1.
///
/// # Errors
/// The writer's.
pub fn shapes(
    out: &mut dyn Write,
    rows: &[usize],
    dofs: Option<&[(i64, i32)]>,
    shapes: &[[Vec<f64>; 2]],
) -> io::Result<()> {
    write!(out, "row{}", if dofs.is_some() { ",node,dof" } else { "" })?;
    (1..=shapes.len()).try_for_each(|i| write!(out, ",re_{i},im_{i}"))?;
    writeln!(out)?;
    for (i, row) in rows.iter().enumerate() {
        write!(out, "{}", row + 1)?;
        if let Some(dofs) = dofs {
            write!(out, ",{},{}", dofs[i].0, dofs[i].1)?;
        }
        shapes.iter().try_for_each(|[re, im]| write!(out, ",{:.9e},{:.9e}", re[i], im[i]))?;
        writeln!(out)?;
    }
    Ok(())
}
