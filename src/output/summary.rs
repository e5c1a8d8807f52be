//! What a run ends with on the screen.

use super::{branches, details, explain, sweep_text, text};
use crate::results::{ModeData, Results};

/// What the complex modes come to, and what is in the folder `place`.
pub fn stability(results: &Results, place: &str) -> String {
    let about = &results.about;
    let [from, to] = about.band;
    let damping = if about.structural_damping { ", with structural damping" } else { "" };
    let mut summary = format!("{}: complex modes {from}-{to} Hz{damping}\n\n", about.title);
    if results.asked().next().is_some() {
        summary += &format!("{}\n", sweep_text::sweep(results));
    }
    summary += &sweep_text::verdict(results);
    if about.viscoelastic {
        let error = results.modes().map(|(_, _, mode)| mode.backward_error).fold(0.0, f64::max);
        let what = "viscoelastic materials: each mode has the stiffness of its own frequency";
        summary += &format!("{what}, largest backward error {error:.1e}\n");
    }
    let explained = results.modes().filter(|(_, _, mode)| !mode.sources.is_empty());
    let strongest = explained.max_by(|(_, _, a), (_, _, b)| a.growth_rate().total_cmp(&b.growth_rate()));
    summary += &strongest.map_or_else(String::new, |(friction, _, mode)| explain::sentence(friction, mode) + "\n");
    if let Some((friction, ..)) = strongest {
        let unstable = results.modes().filter(|(other, _, mode)| *other == friction && mode.unstable);
        let unstable: Vec<&ModeData> = unstable.map(|(_, _, mode)| mode).collect();
        summary += &explain::of_proposed(&about.pairs, friction, &unstable);
    }
    summary += &results.diagram.as_ref().map_or_else(String::new, |diagram| branches::summary(diagram, "friction"));
    summary += &sweep_text::certificates(results);
    summary + "\n" + &results.costs + &files_text(results, place)
}

/// The equilibria in words, and where their pictures are.
pub fn statics(results: &Results, place: &str) -> String {
    format!("{}\n{}\nresults in {place}\n", results.about.title, details::text(results))
}

/// What is in the results folder: pictures of equilibria, of unstable modes, explanations, branches where there are
/// any.
fn files_text(results: &Results, place: &str) -> String {
    const TABLES: [(&str, &str); 6] = [
        ("summary.txt", "this text"),
        ("results.h5", "all of it, for programs"),
        ("modes.csv", "all modes"),
        ("contact.csv", "contact pairs"),
        ("convergence.csv", "Newton iterations"),
        ("details.txt", "equilibria and modes in words"),
    ];
    let is_super_element = results.about.n_nodes == 0;
    let alone = is_super_element || results.about.n_ranks == 1;
    let state = match (is_super_element, alone) {
        (true, _) => "equilibrium_*.vtu",
        (_, true) => "equilibrium_*.vtu, contact_*.vtu",
        (_, false) => "equilibrium_*.pvtu, contact_*.vtu",
    };
    let states = [(state, "displacements and contact, for ParaView")];
    let shape = if alone { "mode_*.vtu" } else { "mode_*.pvtu" };
    let shapes = [(shape, "shapes of the unstable modes, for ParaView")];
    let reasons = [("explained.csv", "energies, energy input, dissipation, sensitivities")];
    let curves = [("branches.csv", "modes followed over friction"), ("hopf.csv", "where they become unstable")];
    let any_equilibrium = results.asked().next().is_some();
    let any_unstable = results.modes().any(|(_, _, mode)| mode.unstable);
    let any_explained = results.modes().any(|(_, _, mode)| !mode.sources.is_empty());
    let certified = [("certified.csv", "the modes compared with the full model")];
    let any_certified = results.asked().any(|value| value.certificate.is_some());
    let files = TABLES
        .iter()
        .chain(curves.iter().filter(|_| results.diagram.is_some()))
        .chain(reasons.iter().filter(|_| any_explained))
        .chain(certified.iter().filter(|_| any_certified))
        .chain(states.iter().filter(|_| any_equilibrium))
        .chain(shapes.iter().filter(|_| any_unstable))
        .copied();
    text::files(place, &files.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::testing;

    #[test]
    fn a_summary_has_the_sweep_the_verdict_and_the_files() {
        insta::assert_snapshot!(stability(&testing::results(), "run"));
    }

    #[test]
    fn a_summary_says_that_there_are_loss_factors() {
        let mut results = testing::results();
        assert!(!stability(&results, "run").contains("structural damping"));
        results.about.structural_damping = true;
        assert!(stability(&results, "run").contains(" Hz, with structural damping\n"));
    }

    #[test]
    fn statics_have_their_pairs_and_steps() {
        let mut results = testing::results();
        results.values.truncate(2);
        insta::assert_snapshot!(statics(&results, "run"));
    }
}
