//! A super-element without files, contacts and loads.

use crate::model::InstabilityCriterion;

use super::parts::MatricesByPart;
use super::super_element::{ContactMotion, Origin, Sample, SuperElement};

/// Of a model `a.toml`.
pub fn origin() -> Origin {
    Origin {
        title: String::new(),
        model: "a.toml".into(),
        mesh: String::new(),
        mesh_hash: String::new(),
        program: String::new(),
        friction: 0.3,
        n_dofs: 12,
        band: [0.0, 7.0],
        limit: 7.0,
        friction_damping: false,
        samples: vec![Sample::at(0.3)],
        criterion: InstabilityCriterion::default(),
        prestress_friction: None,
        made_for: None,
    }
}

/// With the matrices of parts, which are symmetric.
pub fn element(n: usize, by_part: MatricesByPart) -> SuperElement {
    let (total, viscoelastic) = (by_part.total(), by_part.viscoelastic());
    SuperElement {
        origin: origin(),
        model_text: None,
        points: Vec::new(),
        frequencies: Vec::new(),
        mass: total.m,
        damping: total.c,
        stiffness: total.k,
        viscoelastic,
        geometric_stiffness: None,
        structural_damping: total.g,
        parts: by_part.parts,
        rest: Some(by_part.rest_name),
        load: vec![0.0; n],
        preload: vec![0.0; n],
        pairs: Vec::new(),
        contacts: Vec::new(),
        motion: ContactMotion::Rows(Vec::new()),
    }
}
