//! What the inertia of a rotation asks of the model.

use std::f64::consts::FRAC_PI_4;

use nalgebra::{Matrix6, Rotation3, Unit};

use super::{ModelCheck, turn_together};
use crate::model::elasticity::rotate;
use crate::model::{Inertia, Material, Rotation};

/// Elasticities that differ by no more, relative to the largest entry, are the same.
const SAME_ELASTICITY: f64 = 1e-6;

impl ModelCheck<'_> {
    /// A rotating frame turns with all of the model; the parts of a fixed frame are the same all around their axes.
    pub(super) fn rotations(&mut self) {
        for rotation in &self.model.rotations {
            match rotation.inertia {
                Inertia::None => {}
                Inertia::FixedFrame => self.solid_of_revolution(rotation),
                Inertia::RotatingFrame => {
                    self.rotor(rotation);
                    // The others would get the same messages.
                    break;
                }
            }
        }
    }

    fn solid_of_revolution(&mut self, rotation: &Rotation) {
        let Some(part) = self.model.parts.iter().find(|part| part.name == rotation.part) else { return };
        if !is_same_around(&part.material, rotation.axis) {
            let what = format!(
                "the material {:?} is not the same in all directions across the axis (rotation of {:?})",
                part.material.name, part.name
            );
            let advice =
                "inertia = \"fixed_frame\" is for solids of revolution: give the material an axis along the rotation's";
            self.complain(rotation.place, format!("{what}. {advice}, or leave inertia out"));
        }
    }

    fn rotor(&mut self, rotation: &Rotation) {
        let (model, mesh) = (self.model, self.mesh);
        let is_with = |own: &Rotation| own.inertia == Inertia::RotatingFrame && turn_together(own, rotation);
        let turns = |part: &String| model.rotations.iter().any(|own| own.part == *part && is_with(own));
        let item = format!("rotation of {:?}", rotation.part);
        for part in mesh.parts.iter().filter(|part| !turns(part)) {
            let what =
                format!("the rotating frame turns with all of the model, but the part {part:?} does not ({item})");
            let advice = "Give each part the same [[rotation]], or inertia = \"fixed_frame\" to a solid of revolution";
            self.complain(rotation.place, format!("{what}. {advice}"));
        }
        for mass in &model.masses {
            let what = format!("a [[mass]] has no inertia forces of a rotating frame (mass {:?})", mass.name);
            self.complain(mass.place, format!("{what}. Mesh it, or leave inertia of the [[rotation]] out"));
        }
    }
}

/// Whether the elasticity does not change when the material turns about an axis: by 45 degrees, and by one radian.
fn is_same_around(material: &Material, axis: [f64; 3]) -> bool {
    let own = Matrix6::from_fn(|i, j| material.elasticity[i][j]);
    let turned = |angle: f64| {
        let axes = Rotation3::from_axis_angle(&Unit::new_normalize(axis.into()), angle);
        rotate(&own, axes.matrix())
    };
    [FRAC_PI_4, 1.0].into_iter().all(|angle| (turned(angle) - own).amax() <= SAME_ELASTICITY * own.amax())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::model::{EXAMPLE, Model, Part, Place, PointMass, parse};

    fn brake() -> Model {
        parse(EXAMPLE, "brake.toml".as_ref()).unwrap()
    }

    fn part(name: &str, material: &str) -> Part {
        let parts = brake().parts;
        let own = parts.iter().find(|part| part.material.name == material).expect("a part of this material");
        Part { name: name.into(), ..own.clone() }
    }

    /// What is wrong with a disc on a hub, of a material, with these rotations.
    fn complaints(material: &str, rotations: &[Rotation], masses: &[PointMass]) -> String {
        let model = Model {
            parts: vec![part("disc", material), part("hub", "iron")],
            rotations: rotations.to_vec(),
            masses: masses.to_vec(),
            ..brake()
        };
        let mesh = Mesh { parts: vec!["disc".into(), "hub".into()], ..Mesh::default() };
        let mut check = ModelCheck { model: &model, mesh: &mesh, messages: Vec::new() };
        check.rotations();
        check.messages.join("\n")
    }

    fn about(part: &str, axis: [f64; 3], inertia: Inertia) -> Rotation {
        Rotation { part: part.into(), axis, through: [0.0; 3], speed: 5.0, inertia, place: Place::default() }
    }

    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn a_material_of_a_solid_of_revolution_is_the_same_around_the_axis() {
        let of =
            |material: &str, axis: [f64; 3]| complaints(material, &[about("disc", axis, Inertia::FixedFrame)], &[]);
        assert_eq!((of("iron", [0.6, 0.0, 0.8]), of("lining", Z)), (String::new(), String::new()));
        assert!(of("lining", [1.0, 0.0, 0.0]).contains("\"lining\" is not the same in all directions across the axis"));
        assert!(of("shim", Z).contains("is not the same"), "orthotropic");
        assert_eq!(complaints("shim", &[about("disc", Z, Inertia::None)], &[]), "");
    }

    #[test]
    fn a_rotating_frame_turns_with_every_part() {
        let [disc, hub] = ["disc", "hub"].map(|part| about(part, Z, Inertia::RotatingFrame));
        assert_eq!(complaints("iron", &[disc.clone(), hub.clone()], &[]), "");
        for other in [
            Rotation { speed: 6.0, ..hub.clone() },
            Rotation { through: [0.1, 0.0, 0.0], ..hub.clone() },
            Rotation { inertia: Inertia::FixedFrame, ..hub.clone() },
        ] {
            let message = complaints("iron", &[disc.clone(), other], &[]);
            assert!(message.contains("the part \"hub\" does not (rotation of \"disc\")"), "{message}");
        }
        assert!(complaints("iron", std::slice::from_ref(&disc), &[]).contains("the part \"hub\" does not"));
        let masses = brake().masses;
        assert!(complaints("iron", &[disc, hub], &masses).contains("(mass \"wear sensor\")"));
    }
}
