//! Moduli, density and damping of a part as exact factors of its matrices in a super-element.
//!
//! ```text
//! K = sum_p e_p K_p + K_rest     M = sum_p d_p M_p + M_rest     C = sum_p (alpha_p d_p M_p + beta_p e_p K_p) + C_rest
//! G = sum_p g_p e_p K_p + G_rest     K_v = sum_p e_p K_p over the parts of the viscoelastic law v
//! ```
//!
//! The factors follow from two models: all moduli of a part's material have to change by one factor e_p. What is in no
//! part stays: joints, contacts that were linearised, geometric stiffness and loads. So what would change them is
//! refused: densities where loads are proportional to them (gravity, rotations with inertia), moduli where a contact
//! stiffness is proposed from them, both with geometric stiffness.

use crate::model::viscoelastic::ViscoelasticLaw;
use crate::model::{Inertia, LoadKind, Material, Model, Part, Place, Rayleigh, names};
use crate::{Error, Result};

use super::parts::{PartMatrices, add};
use super::super_element::SuperElement;

/// A part of a super-element as a study changes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartChange {
    /// Factor on its stiffness: on all moduli of its material.
    pub stiffness: f64,
    /// Factor on its mass: on its density.
    pub mass: f64,
    /// Its Rayleigh damping after the change.
    pub rayleigh: Rayleigh,
    /// The loss factor of its material after the change.
    pub loss_factor: f64,
}

/// Deviation of the moduli of a material from one factor, and of viscoelastic ratios, that rounding explains, relative
/// to the largest of them: moduli are the inverse of a compliance, which is nearly singular for nu near 1/2.
const ROUNDING: f64 = 1e-9;

impl PartChange {
    /// The change from the material and damping of a part to others; the reason where it is more than factors.
    fn between(own: &Part, changed: &Part) -> std::result::Result<PartChange, String> {
        let stiffness = one_factor(&own.material, &changed.material)
            .ok_or_else(|| format!("it changes the material {:?} by more than one factor", own.material.name))?;
        if !is_one_law(own.material.viscoelastic.as_ref(), changed.material.viscoelastic.as_ref()) {
            return Err(format!("it changes the viscoelastic law of the material {:?}", own.material.name));
        }
        let mass = changed.material.density / own.material.density;
        Ok(PartChange { stiffness, mass, rayleigh: changed.rayleigh, loss_factor: changed.material.loss_factor })
    }

    /// Whether the stiffness is another one.
    fn changes_stiffness(&self) -> bool {
        self.stiffness != 1.0
    }

    /// Whether the mass is another one.
    fn changes_mass(&self) -> bool {
        self.mass != 1.0
    }

    /// Whether stiffness or mass is another one.
    pub fn changes_matrices(&self) -> bool {
        self.changes_stiffness() || self.changes_mass()
    }
}

/// The factor between the moduli of two materials, where there is one.
fn one_factor(own: &Material, changed: &Material) -> Option<f64> {
    let (own, changed) = (own.elasticity.as_flattened(), changed.elasticity.as_flattened());
    let largest = (0..own.len()).max_by(|&i, &j| own[i].abs().total_cmp(&own[j].abs()))?;
    let factor = changed[largest] / own[largest];
    let is_one = own.iter().zip(changed).all(|(a, b)| (b - factor * a).abs() <= ROUNDING * changed[largest].abs());
    is_one.then_some(factor)
}

/// Whether two viscoelastic laws differ by no more than rounding.
fn is_one_law(own: Option<&ViscoelasticLaw>, changed: Option<&ViscoelasticLaw>) -> bool {
    match (own, changed) {
        (Some(own), Some(changed)) => own.is_close(changed, ROUNDING),
        _ => own == changed,
    }
}

/// What a change of the model does to the parts, by their names.
///
/// # Errors
/// [`Error::Input`] with the reason where a super-element cannot follow the change.
pub fn part_changes(own: &Model, changed: &Model) -> Result<Vec<(String, PartChange)>> {
    let refused = |what: String| Error::input(what);
    if without_parts(own) != without_parts(changed) || own.parts.len() != changed.parts.len() {
        return Err(refused("it changes more than moduli, densities and damping of parts".into()));
    }
    let pairs = own.parts.iter().zip(&changed.parts);
    let changes = pairs.map(|(own, changed)| Ok((own.name.clone(), PartChange::between(own, changed)?)));
    let changes = changes.collect::<std::result::Result<Vec<_>, _>>().map_err(refused)?;
    let any = |is: fn(&PartChange) -> bool| changes.iter().any(|(_, change)| is(change));
    if any(PartChange::changes_mass) && own.loads.iter().any(|load| matches!(load.kind, LoadKind::Gravity(_))) {
        return Err(refused("gravity changes with a density, and the super-element has the loads of the model".into()));
    }
    if any(PartChange::changes_mass) && own.rotations.iter().any(|rotation| rotation.inertia != Inertia::None) {
        return Err(refused(
            "inertia forces of a rotation change with a density, and the super-element keeps them".into(),
        ));
    }
    if let Some(contact) =
        own.contacts.iter().find(|contact| contact.law.is_none() && any(PartChange::changes_stiffness))
    {
        let what = format!("the law of the contact {:?} is \"auto\", which changes with moduli", contact.name);
        return Err(refused(format!(
            "{what}. Write the number that `squeal check` prints, and reduce the model again"
        )));
    }
    Ok(changes)
}

/// All of a model but what parts are made of, and the friction values of its sweep.
fn without_parts(model: &Model) -> String {
    let mut rest = model.clone();
    for part in &mut rest.parts {
        part.rayleigh = Rayleigh::default();
        let name = std::mem::take(&mut part.material.name);
        part.material =
            Material { name, density: 0.0, elasticity: [[0.0; 6]; 6], loss_factor: 0.0, viscoelastic: None };
    }
    (rest.swept, rest.frictions, rest.sweep_place) = (Vec::new(), Vec::new(), Place::default());
    format!("{rest:?}")
}

impl SuperElement {
    /// Changes a part: its matrices, and those of the super-element by as much.
    ///
    /// # Errors
    /// [`Error::Input`] where no part has this name, or its stress is in the geometric stiffness.
    pub fn change_part(&mut self, part: &str, change: &PartChange) -> Result<()> {
        if change.changes_matrices() {
            self.require_no_prestress()?;
        }
        let Some(at) = self.parts.iter().position(|own| own.name == part) else {
            let advice = names::advice(part, self.parts.iter().map(|own| own.name.as_str()));
            return Err(Error::input(format!("no part of the super-element is called {part:?}. {advice}")));
        };
        let own = &mut self.parts[at];
        let (PartChange { stiffness: e, mass: d, rayleigh, loss_factor }, before) = (*change, own.rayleigh);
        add(&mut self.mass, d - 1.0, &own.mass);
        add(&mut self.stiffness, e - 1.0, &own.stiffness);
        add(&mut self.damping, rayleigh.alpha * d - before.alpha, &own.mass);
        add(&mut self.damping, rayleigh.beta * e - before.beta, &own.stiffness);
        let structural = loss_factor * e - own.loss_factor;
        if structural != 0.0 {
            let zeros = || vec![0.0; own.stiffness.len()];
            add(self.structural_damping.get_or_insert_with(zeros), structural, &own.stiffness);
        }
        let terms = self.viscoelastic.iter_mut().filter(|term| own.law.as_ref() == Some(&term.law));
        terms.for_each(|term| add(&mut term.stiffness, e - 1.0, &own.stiffness));
        own.change(change);
        Ok(())
    }

    /// Refuses an element whose moduli and densities cannot change.
    ///
    /// # Errors
    /// [`Error::Input`] where it has a geometric stiffness.
    pub fn require_no_prestress(&self) -> Result<()> {
        let what = "the super-element has the geometric stiffness of one equilibrium, which changes with moduli and \
                    densities. Reduce the model without prestress, or change the model itself";
        if self.geometric_stiffness.is_some() { Err(Error::input(what)) } else { Ok(()) }
    }

    /// Gives a part another Rayleigh damping.
    ///
    /// # Errors
    /// [`Error::Input`] where no part has this name.
    pub fn set_rayleigh(&mut self, part: &str, rayleigh: Rayleigh) -> Result<()> {
        let loss_factor = self.parts.iter().find(|own| own.name == part).map_or(0.0, |own| own.loss_factor);
        self.change_part(part, &PartChange { stiffness: 1.0, mass: 1.0, rayleigh, loss_factor })
    }
}

impl PartMatrices {
    fn change(&mut self, change: &PartChange) {
        let PartChange { stiffness, mass, rayleigh, loss_factor } = *change;
        for (matrix, factor) in [(&mut self.mass, mass), (&mut self.stiffness, stiffness)] {
            if factor != 1.0 {
                matrix.iter_mut().for_each(|entry| *entry *= factor);
            }
        }
        (self.rayleigh, self.loss_factor) = (rayleigh, loss_factor);
    }
}

#[cfg(test)]
mod tests {
    use super::super::parts::MatricesByPart;
    use super::super::testing;
    use super::*;
    use crate::model;
    use crate::model::viscoelastic::MaxwellElement;
    use crate::native::Mck;

    const FILE: &str = "tests/data/pads_on_disc.toml";

    fn changes(edits: &[(&str, &str)]) -> Result<Vec<(String, PartChange)>> {
        let text = std::fs::read_to_string(FILE).unwrap();
        let text = text.replace("[part.disc]", "[part.disc]\nrayleigh = { alpha = 1, beta = 0 }");
        changes_of(&text.replace("density = 2600", "density = 2600\nloss_factor = 0.01"), edits)
    }

    fn changes_of(text: &str, edits: &[(&str, &str)]) -> Result<Vec<(String, PartChange)>> {
        let changed = edits.iter().fold(text.to_owned(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replace(old, new)
        });
        let model = |text: &str| model::parse(text, FILE.as_ref()).unwrap();
        part_changes(&model(text), &model(&changed))
    }

    #[test]
    fn moduli_densities_and_damping_are_factors_of_parts() {
        let edits =
            [("young = 8e9", "young = 6e9"), ("7850", "8000"), ("alpha = 1, beta = 0", "alpha = 3, beta = 1e-7")];
        let found = changes(&edits).unwrap();
        let of = |name: &str| found.iter().find(|(own, _)| own == name).unwrap().1;
        for lining in ["lining_inner", "lining_outer"] {
            assert!((of(lining).stiffness - 0.75).abs() < 1e-15 && of(lining).mass == 1.0);
        }
        assert!((of("backplate_inner").mass - 8000.0 / 7850.0).abs() < 1e-15);
        assert_eq!(of("disc").rayleigh, Rayleigh { alpha: 3.0, beta: 1e-7 });
        assert_eq!(of("disc").stiffness, 1.0);
        let lossy = changes(&[("loss_factor = 0.01", "loss_factor = 0.02")]).unwrap();
        assert_eq!(lossy.iter().filter(|(_, change)| change.loss_factor == 0.02).count(), 2);
    }

    #[test]
    fn what_is_more_than_factors_of_parts_is_refused() {
        let message = |edits: &[(&str, &str)]| changes(edits).unwrap_err().to_string();
        assert!(message(&[("poisson = 0.27", "poisson = 0.28")]).contains("\"iron\" by more than one factor"));
        assert!(message(&[("speed = 5.0", "speed = 6.0")]).contains("more than moduli, densities and damping"));
        assert!(message(&[("[0, 0, 4000]", "[0, 0, 4100]")]).contains("more than moduli"));
        assert!(changes(&[("friction = 0.4", "friction = 0.5")]).is_err(), "each contact has its own");
    }

    #[test]
    fn what_changes_with_parts_and_is_in_no_part_is_refused() {
        let text = std::fs::read_to_string(FILE).unwrap();
        let heavy = text.replace("[stability]", "[[load]]\ngravity = [0, 0, -9.81]\n[stability]");
        let (denser, softer) = (("7100", "7000"), ("young = 8e9", "young = 7e9"));
        let message = |text: &str, edit| changes_of(text, &[edit]).unwrap_err().to_string();
        assert!(message(&heavy, denser).contains("gravity changes with a density"));
        assert!(changes_of(&heavy, &[softer]).is_ok());
        let turning = text.replace("speed = 5.0", "speed = 5.0\ninertia = \"fixed_frame\"");
        assert!(message(&turning, denser).contains("inertia forces of a rotation"));
        let auto = text.replacen("law = { linear = 2e13 }", "law = \"auto\"", 1);
        assert!(message(&auto, softer).contains("contact \"disc / inner pad\" is \"auto\""));
        assert!(changes_of(&auto, &[denser]).is_ok());
    }

    /// All moduli are inverses of a compliance with rounding of their own.
    #[test]
    fn rounding_of_moduli_is_no_change_of_the_law() {
        let text = std::fs::read_to_string(FILE).unwrap();
        let soft = "young = 8e9\npoisson = 0.3";
        assert!(text.contains(soft));
        let stiff = |young: f64| format!("young = {young:e}\npoisson = 0.4999");
        let rubber = text.replace(soft, &stiff(8e9));
        let law = |young: f64| {
            let ratios = [0.3, 0.7].map(|ratio| ratio * young);
            format!(
                "{}\nviscoelastic = {{ maxwell = [[{:e}, 1e-4], [{:e}, 1e-3]] }}",
                stiff(young),
                ratios[0],
                ratios[1]
            )
        };
        let maxwell = text.replace(soft, &law(8e9));
        for i in 0..60 {
            let factor = 0.5 + 0.0437 * f64::from(i);
            let young = 8e9 * factor;
            for (text, own, other) in [(&rubber, stiff(8e9), stiff(young)), (&maxwell, law(8e9), law(young))] {
                let found = changes_of(text, &[(&own, &other)]).unwrap();
                let lining = found.iter().find(|(part, _)| part == "lining_inner").unwrap().1;
                assert!((lining.stiffness - factor).abs() < 1e-9, "{factor}");
            }
        }
        let own = model::parse(&maxwell, FILE.as_ref()).unwrap();
        let is_followed = |change: &dyn Fn(&mut Material)| {
            let mut changed = own.clone();
            changed.parts.iter_mut().for_each(|part| change(&mut part.material));
            part_changes(&own, &changed).is_ok()
        };
        for (deviation, is_rounding) in [(1e-10, true), (1e-8, false)] {
            assert_eq!(is_followed(&|own| own.elasticity[0][0] *= 1.0 + deviation), is_rounding);
            let ratio = |own: &mut Material| {
                if let Some(ViscoelasticLaw::Maxwell(elements)) = &mut own.viscoelastic {
                    elements[1].ratio *= 1.0 + deviation;
                }
            };
            assert_eq!(is_followed(&ratio), is_rounding);
        }
        let slower = ("1e-3]", "1.001e-3]");
        assert!(changes_of(&maxwell, &[slower]).unwrap_err().to_string().contains("changes the viscoelastic law"));
    }

    const N: usize = 2;

    /// Two parts of two coordinates.
    fn parts() -> Vec<PartMatrices> {
        let law = ViscoelasticLaw::Maxwell(vec![MaxwellElement { ratio: 0.5, relaxation_time: 1e-4 }]);
        let part = |name: &str, x: f64, loss_factor, law| PartMatrices {
            name: name.into(),
            mass: vec![x, 0.25, 0.25, 2.0 * x],
            stiffness: vec![100.0 * x, -7.0, -7.0, 30.0],
            rayleigh: Rayleigh { alpha: 2.0 * x, beta: 1e-3 },
            loss_factor,
            law,
        };
        vec![part("disc", 1.0, 0.0, None), part("pad", 3.0, 0.0, Some(law)), part("plate", 2.0, 0.01, None)]
    }

    fn element(parts: Vec<PartMatrices>) -> SuperElement {
        let rest = Mck { m: vec![0.1; N * N], c: vec![0.2; N * N], k: vec![0.3; N * N], g: None };
        testing::element(N, MatricesByPart { parts, rest, rest_name: "joints".into() })
    }

    const OTHER: PartChange =
        PartChange { stiffness: 0.7, mass: 1.3, rayleigh: Rayleigh { alpha: 9.0, beta: 2e-4 }, loss_factor: 0.04 };

    /// The sums over changed parts, put together from the beginning.
    #[test]
    fn a_changed_element_is_the_sum_of_changed_parts() {
        let mut found = element(parts());
        let mut changed = parts();
        for (part, loss_factor) in [("pad", 0.0), ("plate", 0.04), ("disc", 0.02)] {
            let change = PartChange { loss_factor, ..OTHER };
            found.change_part(part, &change).unwrap();
            let own = changed.iter_mut().find(|own| own.name == part).unwrap();
            own.mass.iter_mut().for_each(|m| *m *= 1.3);
            own.stiffness.iter_mut().for_each(|k| *k *= 0.7);
            (own.rayleigh, own.loss_factor) = (change.rayleigh, loss_factor);
        }
        let expected = element(changed);
        let is_close = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(is_close(&found.mass, &expected.mass) && is_close(&found.stiffness, &expected.stiffness));
        assert!(is_close(&found.damping, &expected.damping));
        let structural = [&found, &expected].map(|own| own.structural_damping.as_deref().unwrap());
        assert!(is_close(structural[0], structural[1]));
        assert!(is_close(&found.viscoelastic[0].stiffness, &expected.viscoelastic[0].stiffness));
        assert_eq!(found.parts, expected.parts);
    }

    #[test]
    fn prestress_and_unknown_parts_are_refused() {
        let mut own = element(parts());
        let message = own.change_part("padd", &OTHER).unwrap_err().to_string();
        assert!(message.contains("\"padd\"") && message.contains("Did you mean \"pad\""), "{message}");
        own.geometric_stiffness = Some(vec![0.0; N * N]);
        let message = own.change_part("pad", &OTHER).unwrap_err().to_string();
        assert!(message.contains("geometric stiffness of one equilibrium"), "{message}");
        own.change_part("pad", &PartChange { stiffness: 1.0, mass: 1.0, ..OTHER }).unwrap();
    }
}
