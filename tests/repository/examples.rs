//! The programs of `examples/` run as they stand there.

#[path = "../../examples/external_matrices.rs"]
mod external_matrices;
#[path = "../../examples/friction_law.rs"]
mod friction_law;
#[path = "../../examples/friction_sweep.rs"]
mod friction_sweep;
#[path = "../../examples/super_element.rs"]
mod super_element;

#[test]
fn a_friction_law_of_a_users_own() {
    friction_law::main().unwrap();
}

#[test]
fn a_friction_sweep() {
    friction_sweep::main().unwrap();
}

#[test]
fn a_super_element_has_the_modes_of_its_model() {
    super_element::main().unwrap();
}

#[test]
fn hoffmanns_model_from_external_matrices() {
    external_matrices::main().unwrap();
}
