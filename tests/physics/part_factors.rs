//! Moduli, densities and damping of parts as factors of a super-element's matrices, against the layout of the changed
//! model: the pad of [`crate::damped_pad`], whose lining is viscoelastic, with loss factors and Rayleigh's damping.

use crate::damped_pad::{FRICTION, text};
use crate::reduced_terms::{reduced, solution, with_contacts};
use crate::super_element::largest_error;
use crate::viscoelastic::MATERIALS;
use squeal::model::Model;
use squeal::reduction::part_change::part_changes;
use squeal::{Session, Structure};
use tempfile::TempDir;

/// The model with all moduli of both materials, their densities, loss factors and Rayleigh damping changed.
fn changed(model: &Model) -> Model {
    let mut changed = model.clone();
    for (part, factor) in changed.parts.iter_mut().zip([0.7, 1.4, 1.2]) {
        part.material.elasticity.as_flattened_mut().iter_mut().for_each(|c| *c *= factor);
        part.material.density *= 1.6 - 0.5 * factor;
        part.material.loss_factor += 0.01 * factor;
        (part.rayleigh.alpha, part.rayleigh.beta) = (10.0 * factor, 3e-7 * factor);
    }
    changed
}

fn model_of(structure: &Structure) -> &Model {
    let Structure::Full(full) = structure else { panic!("a model") };
    &full.model
}

/// With all modes kept: the eigenvalues of the layout of the changed model, to 1e-9, at the friction value of the
/// reduction and at half of it; those of the model as it was are far away.
#[test]
fn factors_on_parts_are_exact_with_all_modes_kept() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let own = with_contacts(&folder, &text(MATERIALS, ""));
    let mut other = with_contacts(&folder, &text(MATERIALS, ""));
    let Structure::Full(full) = &mut other else { panic!("a model") };
    full.model = changed(model_of(&own));
    let Structure::Reduced(mut element) = reduced(&comm, &folder, &own, f64::INFINITY) else { panic!("reduced") };
    for (part, change) in part_changes(model_of(&own), model_of(&other)).unwrap() {
        element.element.change_part(&part, &change).unwrap();
    }
    let element = Structure::Reduced(element);
    let before = solution(&comm, &own, FRICTION).0;
    for friction in [FRICTION, 0.2] {
        let exact = solution(&comm, &other, friction).0;
        let found = solution(&comm, &element, friction).0;
        let n = before.len().min(exact.len());
        let effect = largest_error(&before[..n], &exact[..n]);
        let error = largest_error(&found, &exact);
        println!("friction {friction}: {} modes, largest error {error:.1e}, effect {effect:.1e}", found.len());
        assert!(error < 1e-9 && effect > 1e-2, "{error} {effect}");
    }
}
