//! Motions, centrifugal forces, and stresses that stiffen.

use super::*;
use crate::model::Inertia;

const MOTION: &str = "*MOTION, ROTATION\nTURNING, 5., 0,0,0, 0,0,1\n";
const MODES: &str = "*STEP\n*COMPLEX FREQUENCY, FRICTION DAMPING=YES\n";

/// A deck that is written of a model and read back.
fn written(converted: &Converted) -> Model {
    let mut deck = Vec::new();
    crate::deck::write(&converted.model, &converted.mesh, UnitSystem::ALL[0], "a test", &mut deck).unwrap();
    read(&String::from_utf8(deck).unwrap()).unwrap().model
}

#[test]
fn a_motion_with_its_centrifugal_force_is_of_a_solid_of_revolution() {
    let both = |force: &str| with(MOTION, &format!("{MOTION}*DLOAD\nDISC, CENTRIF, {force}\n"));
    let own = both("25., 0,0,3, 0,0,-2").unwrap();
    let rotation = &own.model.rotations[0];
    assert_eq!((rotation.speed, rotation.axis, rotation.inertia), (5.0, [0.0, 0.0, 1.0], Inertia::FixedFrame));
    assert!(own.summary.notes.iter().any(|note| note.starts_with("CENTRIF: modes have Coriolis forces")));
    let again = &written(&own).rotations[0];
    assert_eq!((again.speed, again.inertia), (5.0, Inertia::FixedFrame));
    for other in ["26., 0,0,0, 0,0,1", "25., 1,0,0, 0,0,1", "25., 0,0,0, 0,1,0"] {
        let message = both(other).unwrap_err();
        assert!(message.contains("the centrifugal force of Disc is that of"), "{message}");
    }
}

#[test]
fn a_centrifugal_force_alone_is_of_a_rotor_which_turns_as_a_whole() {
    let force = |sets: &[&str]| {
        let rows: String = sets.iter().map(|set| format!("{set}, CENTRIF, 9., 1,0,0, 0,0,-2\n")).collect();
        with(MOTION, &format!("*DLOAD\n{rows}"))
    };
    let own = force(&["DISC", "PAD"]).unwrap();
    for model in [&own.model, &written(&own)] {
        let [disc, pad] = &model.rotations[..] else { panic!("{:?}", model.rotations) };
        assert_eq!((disc.part.as_str(), pad.part.as_str()), ("Disc", "PAD"));
        assert!(close(disc.speed, 3.0) && disc.axis == [0.0, 0.0, -1.0] && close(disc.through[0], 1e-3));
        assert!([disc, pad].iter().all(|rotation| rotation.inertia == Inertia::RotatingFrame));
    }
    assert!(force(&["DISC"]).unwrap_err().contains("the part \"PAD\" does not"));
    assert!(force(&["NONE"]).unwrap_err().contains("there is no element set NONE"));
}

#[test]
fn coriolis_forces_need_a_rotation() {
    let coriolis = MODES.replace("YES", "YES, CORIOLIS");
    assert!(with(MODES, &coriolis).unwrap_err().contains("CORIOLIS needs a rotation"));
    let both = good().replace(MOTION, &format!("{MOTION}*DLOAD\nDISC, CENTRIF, 25., 0,0,0, 0,0,1\n"));
    let Converted { summary, .. } = read(&both.replace(MODES, &coriolis)).unwrap();
    assert!(!summary.notes.iter().any(|note| note.starts_with("CENTRIF")), "{:?}", summary.notes);
}

#[test]
fn stresses_stiffen_modes_after_nlgeom_with_perturbation() {
    let deck = |first: &str, second: &str| {
        let text = good().replace("*STEP\n*STATIC", &format!("*STEP{first}\n*STATIC"));
        read(&text.replace("*STEP\n*COMPLEX", &format!("*STEP{second}\n*COMPLEX"))).unwrap()
    };
    assert_eq!(deck("", "").model.prestress, None);
    assert_eq!(deck(", NLGEOM", "").model.prestress, None);
    let own = deck(", NLGEOM", ", PERTURBATION");
    assert_eq!((own.model.prestress, written(&own).prestress), (Some(true), Some(true)));
    let Converted { model, summary, .. } = deck("", ", PERTURBATION");
    assert_eq!(model.prestress, None);
    assert!(summary.notes.iter().any(|note| note.starts_with("PERTURBATION without NLGEOM")), "{:?}", summary.notes);
}
