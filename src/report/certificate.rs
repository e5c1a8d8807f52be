//! How well a super-element solves the full model's equations, as a table.

use maud::{Markup, html};

use super::findings::Findings;
use crate::results::Certificate;

const HEADINGS: [&str; 6] = [
    "\u{3bc}",
    "modes",
    "error of the equilibrium",
    "largest error of a frequency, %",
    "largest error of a growth rate, 1/s",
    "largest backward error",
];

/// A table with a row a friction value; nothing where the modes were not compared with a full model.
pub fn section(findings: &Findings) -> Markup {
    let of = |&v: &usize| findings.results.values[v].certificate.as_ref();
    let certificates: Vec<&Certificate> = findings.asked.iter().filter_map(of).collect();
    html! {
        @if !certificates.is_empty() {
            h3 { "The super-element compared with its full model" }
            div.over {
                table {
                    thead { tr { @for name in HEADINGS { th { (name) } } } }
                    tbody { @for certificate in certificates { (row(certificate)) } }
                }
            }
            p.hint {
                "Estimated by the residuals of the full model's equations: differences from the eigenvalues of the full model, which are \
                 known to first order."
            }
        }
    }
}

fn row(certificate: &Certificate) -> Markup {
    html! {
        tr {
            td { (certificate.friction) }
            td { (certificate.modes.len()) }
            td { (format!("{:.1e}", certificate.equilibrium_error)) }
            td { (format!("{:.5}", 100.0 * certificate.frequency_error())) }
            td { (format!("{:.2}", certificate.growth_error())) }
            td { (format!("{:.1e}", certificate.backward_error())) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{CertifiedMode, Results, testing};

    #[test]
    fn a_table_has_the_values_that_were_compared() {
        let mut results = testing::results();
        let text = |results: &Results| section(&Findings::new(results)).into_string();
        assert!(text(&results).is_empty());
        let value = results.values.iter_mut().find(|value| value.asked).unwrap();
        let lambda = value.modes[0].lambda;
        let modes = vec![CertifiedMode { lambda, corrected: 1.01 * lambda, backward_error: 1e-6 }];
        value.certificate = Some(Certificate { friction: value.friction, equilibrium_error: 2e-5, modes });

        let text = text(&results);
        assert!(text.contains("compared with its full model"));
        assert!(text.contains("<td>1.00000</td>") && text.contains("<td>1.0e-6</td>"), "{text}");
    }
}
