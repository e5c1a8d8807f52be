//! Constants that no material can have.

use super::{GOOD, complains, parsed};

#[test]
fn impossible_constants_are_refused() {
    complains(
        "young = 110e9",
        "young = -110e9",
        0,
        "young must be above 0, not -110e9 (material \"iron\"). Give Pa, such as 110e9",
    );
    complains(
        "poisson = 0.27",
        "poisson = 0.5",
        0,
        "poisson must be above -1 and below 0.5, not 0.5 (material \"iron\"). Give Poisson's ratio, such as 0.3",
    );
    complains(
        "poisson = 0.27",
        "poisson = -1",
        0,
        "poisson must be above -1 and below 0.5, not -1 (material \"iron\"). Give Poisson's ratio, such as 0.3",
    );
    complains(
        "density = 2600",
        "density = nan",
        0,
        "density must be above 0, not nan (material \"lining\"). Give kg/m3, such as 7850",
    );
    complains(
        "axis = [0, 0, 2]",
        "axis = [0, 0, 0]",
        0,
        "axis has no direction: it is zero (material \"lining\"). Give a vector such as [0, 0, 1]",
    );
    let said = parsed(&GOOD.replace("poisson_axial = 0.10", "poisson_axial = 0.3")).unwrap_err();
    assert!(
        said.contains(
            ":9: no material has these constants: the elasticity is not positive definite (material \"lining\")"
        ),
        "{said}"
    );
    let said = parsed(&GOOD.replace("alpha = 10", "alpha = -10")).unwrap_err();
    assert!(said.contains(":20: rayleigh alpha must be 0 or above, not -10 (part \"disc\")"), "{said}");
}

#[test]
fn constants_must_belong_to_the_kind() {
    complains(
        "kind = \"transverse\"",
        "kind = \"tranverse\"",
        0,
        "unknown kind of material \"tranverse\" (material \"lining\"). \
         Did you mean \"transverse\"? There is: isotropic, transverse, orthotropic, full",
    );
    let said = "young_axial is no constant of the kind \"isotropic\" (material \"iron\"). \
                Leave it out, or give kind = one of transverse";
    complains("density = 7100", "density = 7100\nyoung_axial = 1e9", 1, said);
    let said = "young is one number here, not three (material \"iron\"). Three of them need kind = \"orthotropic\"";
    complains("young = 110e9", "young = [1e9, 1e9, 1e9]", 0, said);
}

#[test]
fn full_matrices_must_be_symmetric_and_positive_definite() {
    let with = |first_row: &str, axes: &str| {
        let identity = "[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]";
        let material = format!("kind = \"full\"\nelasticity = [{first_row},{identity}]\n{axes}\n");
        parsed(&GOOD.replace("young = 110e9\npoisson = 0.27\n", &material))
    };
    assert!(with("[1,0,0,0,0,0]", "").is_ok());
    let said = with("[1,0.1,0,0,0,0]", "").unwrap_err();
    assert!(said.contains(":7: elasticity is not symmetric"), "{said}");
    let said = with("[nan,0,0,0,0,0]", "").unwrap_err();
    assert!(said.contains(":7: elasticity is not finite"), "{said}");
    let said = with("[-1,0,0,0,0,0]", "").unwrap_err();
    assert!(said.contains(":7: elasticity is not positive definite"), "{said}");
    let said = with("[1,0,0,0,0,0]", "x_axis = [1,0,0]").unwrap_err();
    assert!(said.contains(":8: one of x_axis and y_axis alone"), "{said}");
    let said = with("[1,0,0,0,0,0]", "x_axis = [1,0,0]\ny_axis = [2,0,0]").unwrap_err();
    assert!(said.contains(":9: x_axis and y_axis are parallel"), "{said}");
}

#[test]
fn loss_factors_belong_to_materials_of_any_kind_and_to_connectors() {
    let with = |material: &str, connector: &str| {
        let text = GOOD.replace("density = 2600", &format!("density = 2600\n{material}"));
        parsed(&text.replace("stiffness = [1, 2, 3]", &format!("stiffness = [1, 2, 3]\n{connector}")))
    };
    let model = with("loss_factor = 0.05", "loss_factor = 0.2").unwrap();
    let of_parts: Vec<f64> = model.parts.iter().map(|part| part.material.loss_factor).collect();
    assert_eq!((of_parts, model.connectors[0].loss_factor), (vec![0.0, 0.05], 0.2));
    for (material, connector) in [("loss_factor = 0.05", ""), ("", "loss_factor = 0.2")] {
        assert!(with(material, connector).unwrap().has_structural_damping());
    }
    let said = "loss_factor must be 0 or above, not -0.1 (material \"lining\"). \
                Give the imaginary over the real part of the stiffness, such as 0.02";
    complains("density = 2600", "density = 2600\nloss_factor = -0.1", 1, said);
}

#[test]
fn a_model_with_a_loss_factor_alone_is_damped() {
    let text = GOOD.replace("rayleigh = { alpha = 10, beta = 1e-8 }\n", "");
    let model = parsed(&text).unwrap();
    assert!(!model.is_damped() && !model.has_structural_damping());
    assert!(parsed(&text.replace("density = 2600", "density = 2600\nloss_factor = 0.01")).unwrap().is_damped());
}

const LINING: &str = "density = 2600";

/// The material "iron" with a law in the place of its modulus.
fn with_law(young: &str, law: &str) -> Result<crate::model::Model, String> {
    parsed(&GOOD.replace("young = 110e9\n", &format!("{young}\nviscoelastic = {law}\n")))
}

#[test]
fn viscoelastic_laws_have_the_modulus_at_rest() {
    let maxwell = with_law("young = 2e6", "{ maxwell = [[4e6, 1e-4]] }").unwrap();
    let zener = with_law("young = 2e6", "{ unrelaxed = 1e9, relaxation_time = 1e-7, order = 0.6 }").unwrap();
    let table = "{ by = [\"frequency\", \"temperature\"], temperature = 30, table = [[1e6, 0.2, 100, 20], [4e6, 0.4, 100, 40], \
                 [1e7, 0.9, 1e4, 20], [1e7, 0.9, 1e4, 40]] }";
    let table = with_law("", table).unwrap();
    for model in [maxwell, zener, table] {
        let part = model.viscoelastic_part().unwrap();
        let [young, _] = part.material.youngs();
        assert!((young / 2e6 - 1.0).abs() < 1e-12, "{young}");
        assert!(model.is_damped() && !model.has_structural_damping());
        assert!(model.require_no_viscoelastic("it").unwrap_err().to_string().contains("is viscoelastic. Give"));
    }
    assert!(parsed(GOOD).unwrap().require_no_viscoelastic("it").is_ok());
}

#[test]
fn impossible_viscoelastic_laws_are_refused() {
    let zener = |text: &str| format!("{{ {text} }}");
    for (young, law, said) in [
        ("young = 2e6", "{ maxwell = [] }", "viscoelastic has maxwell = []"),
        ("young = 2e6", "{ maxwell = [[1e6, 0]] }", "viscoelastic has maxwell = [[1000000.0, 0.0]]"),
        ("", "{ maxwell = [[1e6, 1e-3]] }", "young is missing"),
        (
            "young = 2e6",
            &zener("unrelaxed = 1e6, relaxation_time = 1, order = 0.5"),
            "viscoelastic has unrelaxed = 1e6",
        ),
        ("young = 2e6", &zener("unrelaxed = 1e9, relaxation_time = 1, order = 1.5"), "order = 1.5"),
        (
            "young = 2e6",
            "{ by = [\"frequency\"], table = [[1e6, 0.1, 10]] }",
            "young is in the viscoelastic table, too",
        ),
        ("", "{ by = [\"speed\"], table = [[1e6, 0.1, 10]] }", "the viscoelastic table is by [\"speed\"]"),
        (
            "",
            "{ by = [\"frequency\"], table = [[1e6, 0.1, 0]] }",
            "the viscoelastic table has the row [1000000.0, 0.1, 0.0]",
        ),
        ("", "{ by = [\"frequency\"], table = [[1e6, 0.1]] }", "the viscoelastic table has the row"),
        ("", "{ by = [\"frequency\"], table = [] }", "the viscoelastic table is empty"),
        ("", "{ by = [\"temperature\"], table = [[1e6, 0.1, 10]] }", "do not go together"),
    ] {
        let complaint = with_law(young, law).unwrap_err();
        assert!(complaint.contains(said), "{law}: {complaint}");
    }
    let said = "viscoelastic is for isotropic materials (material \"lining\"). Leave kind out, or give a loss_factor";
    complains(LINING, &format!("{LINING}\nviscoelastic = {{ maxwell = [[1e6, 1e-3]] }}"), 1, said);
    let said =
        "viscoelastic and loss_factor are both given (material \"iron\"). Leave loss_factor out: the law has the loss";
    let both = "young = 110e9\nloss_factor = 0.1\nviscoelastic = { maxwell = [[1e6, 1e-3]] }";
    complains("young = 110e9", both, 2, said);
}
