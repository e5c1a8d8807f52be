//! A model as the text of a model file.

mod joints;
mod loads;

use std::fmt::{Display, Write};

use nalgebra::Matrix6;

use super::elasticity::{from_compliance, isotropic_compliance};
use super::friction::{FrictionCurve, FrictionTable, SpeedDecay, Stribeck};
use super::read::UNITS;
use super::viscoelastic::{FractionalZener, MaxwellElement, ModulusTable, ViscoelasticLaw};
use super::{Contact, GapField, ImageFrame, Inertia, Material, Model, NormalLaw, ROUGH};
use loads::loads;

/// Elasticities are isotropic to this relative difference.
const ISOTROPIC: f64 = 1e-12;

/// The text of a model file that says what `model` does, with its mesh in `mesh_file`.
///
/// Lengths that are coordinates of the mesh are written in the model's unit.
pub fn write(model: &Model, mesh_file: &str) -> String {
    let mut out = Text(String::new());
    let unit = UNITS.iter().find(|(_, metres)| *metres == model.mesh_unit).map_or("m", |(name, _)| name);
    out.line("title", quoted(&model.title));
    out.table("[mesh]");
    out.line("file", quoted(mesh_file));
    out.line("unit", quoted(unit));
    parts(&mut out, model);
    for fix in &model.fixes {
        let axes: String = "xyz".chars().zip(fix.axes).filter(|(_, held)| *held).map(|(axis, _)| axis).collect();
        out.table("[[fix]]");
        out.line("nodes", quoted(&fix.nodes));
        out.line("axes", quoted(&axes));
        out.point("displacement", fix.moves().then_some(fix.displacement), model.mesh_unit);
    }
    for rotation in &model.rotations {
        out.table("[[rotation]]");
        out.line("part", quoted(&rotation.part));
        out.line("axis", list(&rotation.axis));
        out.line("through", list(&rotation.through.map(|x| x / model.mesh_unit)));
        out.line("speed", number(rotation.speed));
        match rotation.inertia {
            Inertia::None => {}
            Inertia::FixedFrame => out.line("inertia", quoted("fixed_frame")),
            Inertia::RotatingFrame => out.line("inertia", quoted("rotating_frame")),
        }
    }
    model.contacts.iter().for_each(|own| contact(&mut out, own, model.mesh_unit));
    joints::write(&mut out, model);
    loads(&mut out, model);
    analysis(&mut out, model);
    out.0
}

/// A text that grows by tables and keys.
struct Text(String);

impl Text {
    fn table(&mut self, header: impl Display) {
        self.0 += &format!("\n{header}\n");
    }

    fn line(&mut self, key: &str, value: impl Display) {
        self.0 += &format!("{key} = {value}\n");
    }

    /// A line of a number, where there is one.
    fn optional(&mut self, key: &str, value: Option<f64>) {
        value.into_iter().for_each(|value| self.line(key, number(value)));
    }

    /// A line of a point (m) in a unit of so many metres, where there is one.
    fn point(&mut self, key: &str, point: Option<[f64; 3]>, unit: f64) {
        point.into_iter().for_each(|point| self.line(key, list(&point.map(|x| x / unit))));
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// The shortest text that is read as the same number.
fn number(x: f64) -> String {
    const SHORT: usize = 7;
    let (plain, exponent) = (format!("{x:?}"), format!("{x:e}"));
    if plain.len() <= SHORT.max(exponent.len()) { plain } else { exponent }
}

fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|&x| number(x)).collect();
    format!("[{}]", numbers.join(", "))
}

/// Materials, each once, and parts.
fn parts(out: &mut Text, model: &Model) {
    let mut written: Vec<(String, &Material)> = Vec::new();
    let mut names = Vec::new();
    for part in &model.parts {
        let same = |own: &Material| Material { name: part.material.name.clone(), ..own.clone() } == part.material;
        if let Some((name, _)) = written.iter().find(|(_, own)| own.name == part.material.name && same(own)) {
            names.push(name.clone());
            continue;
        }
        let is_taken = written.iter().any(|(name, _)| *name == part.material.name);
        let name =
            if is_taken { format!("{} of {}", part.material.name, part.name) } else { part.material.name.clone() };
        material(out, &name, &part.material);
        written.push((name.clone(), &part.material));
        names.push(name);
    }
    for (part, material) in model.parts.iter().zip(names) {
        out.table(format!("[part.{}]", quoted(&part.name)));
        out.line("material", quoted(&material));
        let (alpha, beta) = (part.rayleigh.alpha, part.rayleigh.beta);
        if alpha != 0.0 || beta != 0.0 {
            out.line("rayleigh", format_args!("{{ alpha = {}, beta = {} }}", number(alpha), number(beta)));
        }
        let kinds: Vec<String> = part.elements.iter().map(|kind| quoted(kind.name()).to_string()).collect();
        if !kinds.is_empty() {
            out.line("elements", format_args!("[{}]", kinds.join(", ")));
        }
    }
}

fn material(out: &mut Text, name: &str, material: &Material) {
    out.table(format!("[material.{}]", quoted(name)));
    match isotropic(material) {
        Some([young, poisson]) => {
            if !matches!(material.viscoelastic, Some(ViscoelasticLaw::Table(_))) {
                out.line("young", number(young));
            }
            out.line("poisson", number(poisson));
            material.viscoelastic.iter().for_each(|law| out.line("viscoelastic", viscoelastic(law, young)));
        }
        None => {
            let rows: Vec<String> = material.elasticity.iter().map(|row| format!("    {},\n", list(row))).collect();
            out.line("kind", quoted("full"));
            out.line("elasticity", format_args!("[\n{}]", rows.concat()));
        }
    }
    out.line("density", number(material.density));
    if material.loss_factor != 0.0 {
        out.line("loss_factor", number(material.loss_factor));
    }
}

/// The key `viscoelastic` of a material with a Young's modulus at rest, Pa.
fn viscoelastic(law: &ViscoelasticLaw, young: f64) -> String {
    let modulus = |ratio: f64| number(rounded(ratio * young));
    match law {
        ViscoelasticLaw::Maxwell(elements) => {
            let row = |own: &MaxwellElement| format!("[{}, {}]", modulus(own.ratio), number(own.relaxation_time));
            format!("{{ maxwell = [{}] }}", elements.iter().map(row).collect::<Vec<_>>().join(", "))
        }
        ViscoelasticLaw::FractionalZener(FractionalZener { unrelaxed_ratio, relaxation_time, order }) => {
            let [unrelaxed, time, order] = [modulus(*unrelaxed_ratio), number(*relaxation_time), number(*order)];
            format!("{{ unrelaxed = {unrelaxed}, relaxation_time = {time}, order = {order} }}")
        }
        ViscoelasticLaw::Table(ModulusTable { frequencies, ratios, loss_factors }) => {
            // Of a table by temperature alone one frequency is left, which is any.
            let frequencies = frequencies.iter().map(|&f| if f > 0.0 { f } else { 1.0 });
            let values = ratios.iter().zip(loss_factors).zip(frequencies);
            let row = |((ratio, loss), f): ((&f64, &f64), f64)| {
                format!("[{}, {}, {}]", modulus(*ratio), number(*loss), number(f))
            };
            format!("{{ by = [\"frequency\"], table = [{}] }}", values.map(row).collect::<Vec<_>>().join(", "))
        }
    }
}

/// Young's modulus (Pa) and Poisson's ratio of an isotropic material.
pub fn isotropic(material: &Material) -> Option<[f64; 2]> {
    let given = Matrix6::from_fn(|i, j| material.elasticity[i][j]);
    // lambda = C_xxyy, G = C_xyxy; E = G (3 lambda + 2 G) / (lambda + G), nu = lambda / (2 (lambda + G)).
    let (lambda, shear) = (given[(0, 1)], given[(3, 3)]);
    let young = shear * (3.0 * lambda + 2.0 * shear) / (lambda + shear);
    let poisson = rounded(lambda / (2.0 * (lambda + shear)));
    let young = rounded(young);
    let back = from_compliance(&isotropic_compliance(young, poisson))?;
    ((back - given).norm() <= ISOTROPIC * given.norm()).then_some([young, poisson])
}

/// A number without the digits that rounding has changed.
fn rounded(x: f64) -> f64 {
    format!("{x:.13e}").parse().unwrap_or(x)
}

fn contact(out: &mut Text, contact: &Contact, unit: f64) {
    out.table("[[contact]]");
    out.line("name", quoted(&contact.name));
    out.line("slave", quoted(&contact.slave));
    out.line("master", quoted(&contact.master));
    match &contact.law {
        None => out.line("law", quoted("auto")),
        Some(NormalLaw::Linear { stiffness }) => out.line("law", format_args!("{{ linear = {} }}", number(*stiffness))),
        Some(NormalLaw::Cubic { k1, k3 }) => out.line("law", format_args!("{{ cubic = {} }}", list(&[*k1, *k3]))),
        Some(NormalLaw::Table { rows }) => {
            let rows: Vec<String> = rows.iter().map(|row| list(row)).collect();
            out.line("law", format_args!("{{ table = [{}] }}", rows.join(", ")));
        }
    }
    match &contact.friction_curve {
        None if contact.friction == ROUGH => out.line("friction", quoted("rough")),
        None => out.line("friction", number(contact.friction)),
        Some(curve) => out.line("friction", friction_curve(curve, contact.friction)),
    }
    out.optional("stick", contact.stick);
    out.line("separation", contact.separation);
    out.optional("search", contact.search_distance.map(|distance| distance / unit));
    out.optional("adjust", (contact.adjust > 0.0).then_some(contact.adjust / unit));
    out.optional("clearance", contact.clearance.map(|gap| gap / unit));
    let gap = contact.gap_field.as_ref().map(|field| std::path::absolute(&field.file).unwrap_or(field.file.clone()));
    gap.into_iter().for_each(|file| out.line("gap", quoted(&file.display().to_string())));
    let frame = contact.gap_field.as_ref().and_then(GapField::frame);
    frame.into_iter().for_each(|frame| out.line("gap_image", gap_image(frame, unit)));
    let factors =
        contact.stiffness_field.as_ref().map(|field| std::path::absolute(&field.file).unwrap_or(field.file.clone()));
    factors.into_iter().for_each(|file| out.line("stiffness_factor", quoted(&file.display().to_string())));
    out.optional("wear", contact.wear);
}

/// The key `gap_image`.
fn gap_image(frame: ImageFrame, unit: f64) -> String {
    let ImageFrame { plane, lower_left, upper_right, black, white } = frame;
    let plane: String = plane.iter().map(|&axis| ['x', 'y', 'z'][axis]).collect();
    let [lower_left, upper_right] = [lower_left, upper_right].map(|corner| list(&corner.map(|x| x / unit)));
    let [black, white] = [black, white].map(|gap| number(gap / unit));
    format!(
        "{{ plane = \"{plane}\", lower_left = {lower_left}, upper_right = {upper_right}, black = {black}, white = {white} }}"
    )
}

/// The key `friction` of a coefficient that depends on other things, its friction value given.
fn friction_curve(curve: &FrictionCurve, friction: f64) -> String {
    let scaled = |ratio: f64| number(ratio * friction);
    match curve {
        FrictionCurve::Decay(SpeedDecay { kinetic_ratio, decay }) => {
            let [at_rest, kinetic] = [1.0, *kinetic_ratio].map(scaled);
            format!("{{ static = {at_rest}, kinetic = {kinetic}, decay = {} }}", number(*decay))
        }
        FrictionCurve::Stribeck(Stribeck { kinetic_ratio, speed, exponent, viscous }) => {
            let [at_rest, kinetic, viscous] = [1.0, *kinetic_ratio, *viscous].map(scaled);
            let [speed, exponent] = [*speed, *exponent].map(number);
            let falling = format!("static = {at_rest}, kinetic = {kinetic}, stribeck_speed = {speed}");
            format!("{{ {falling}, exponent = {exponent}, viscous = {viscous} }}")
        }
        FrictionCurve::Table(FrictionTable { speeds, pressures, values }) => {
            let grid = speeds.iter().flat_map(|v| pressures.iter().map(move |q| [*v, *q]));
            let row = |([v, q], phi): ([f64; 2], &f64)| format!("[{}, {}, {}]", scaled(*phi), number(v), number(q));
            let rows: Vec<String> = grid.zip(values).map(row).collect();
            format!("{{ by = [\"speed\", \"pressure\"], table = [{}] }}", rows.join(", "))
        }
    }
}

fn analysis(out: &mut Text, model: &Model) {
    out.table("[stability]");
    out.line("band", list(&model.band));
    out.line("friction_damping", model.friction_damping);
    model.prestress.into_iter().for_each(|prestress| out.line("prestress", prestress));
    let (key, limit) = model.criterion.entry();
    out.line("unstable", format_args!("{{ {key} = {} }}", number(limit)));
    if !model.frictions.is_empty() {
        let mut contacts = String::new();
        if !model.swept.is_empty() {
            let names: Vec<String> = model.swept.iter().map(|name| quoted(name)).collect();
            write!(contacts, "contacts = [{}], ", names.join(", ")).expect("a string takes all");
        }
        out.table("[sweep]");
        out.line("friction", format_args!("{{ {contacts}values = {} }}", list(&model.frictions)));
    }
    if let Some(reduction) = &model.reduction {
        out.table("[reduction]");
        out.line("contacts", reduction.contacts);
        out.line("band", list(&reduction.band));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{EXAMPLE, parse};
    use std::path::Path;

    #[test]
    fn the_documented_example_is_written_and_read_back() {
        let model = parse(EXAMPLE, Path::new("brake.toml")).unwrap();
        let text = write(&model, "brake.msh");
        let back = parse(&text, Path::new("brake.toml")).unwrap();
        // All but the places is the same, to rounding of lengths and of isotropic elasticities.
        assert_eq!(write(&back, "brake.msh"), text);
        assert_eq!((back.fixes.len(), back.contacts.len(), back.loads.len()), (1, 3, 4));
        assert_eq!((back.connectors.len(), back.ties.len(), back.rigid_sets.len()), (2, 1, 1));
        assert_eq!(
            (&back.masses[0].inertia, &back.equations[0].terms),
            (&model.masses[0].inertia, &model.equations[0].terms)
        );
        for (one, two) in model.parts.iter().zip(&back.parts) {
            let (a, b) = (one.material.elasticity.as_flattened(), two.material.elasticity.as_flattened());
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * a.abs().max(1e9)), "{}", one.name);
            assert_eq!((one.rayleigh, one.material.density), (two.rayleigh, two.material.density));
            assert_eq!(one.material.loss_factor, two.material.loss_factor);
        }
        assert!(back.has_structural_damping() && back.connectors[0].loss_factor == 0.1);
        assert_eq!(back.contacts[1].law, model.contacts[1].law);
        assert_eq!((back.frictions, back.swept, back.reduction.is_some()), (model.frictions, model.swept, true));
        assert!(text.contains("young = 1.1e11"), "{text}");
    }

    #[test]
    fn friction_curves_are_written_and_read_back() {
        for curve in [
            "{ static = 0.5, kinetic = 0.4, decay = 2 }",
            "{ static = 0.5, kinetic = 0.4, stribeck_speed = 0.1, exponent = 2, viscous = 0.01 }",
            "{ by = [\"pressure\"], table = [[0.5, 1e6], [0.4, 2e6]] }",
        ] {
            let model =
                parse(&EXAMPLE.replace("friction = 0.5", &format!("friction = {curve}")), Path::new("brake.toml"));
            let contact = &model.as_ref().unwrap().contacts[0];
            let back = parse(&write(model.as_ref().unwrap(), "brake.msh"), Path::new("brake.toml")).unwrap();
            assert!(contact.friction_curve.is_some(), "{curve}");
            assert_eq!(back.contacts[0].friction_curve, contact.friction_curve);
        }
    }

    #[test]
    fn viscoelastic_laws_are_written_and_read_back() {
        for key in [
            "young = 110e9\nviscoelastic = { maxwell = [[5e6, 1e-4], [2e7, 1e-5]] }",
            "young = 110e9\nviscoelastic = { unrelaxed = 3e11, relaxation_time = 1e-7, order = 0.6 }",
            "viscoelastic = { by = [\"frequency\"], table = [[2e6, 0.3, 100], [9e6, 0.9, 3000]] }",
        ] {
            let text = EXAMPLE.replacen("young = 110e9                  # Pa", key, 1);
            let model = parse(&text, Path::new("brake.toml")).unwrap();
            let back = parse(&write(&model, "brake.msh"), Path::new("brake.toml")).unwrap();
            let of = |model: &Model| model.viscoelastic_part().unwrap().material.clone();
            let (own, back) = (of(&model), of(&back));
            assert_eq!(own.viscoelastic, back.viscoelastic);
            assert!((own.elasticity[0][0] / back.elasticity[0][0] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_are_short_and_exact() {
        assert_eq!(
            [0.5, 2e13, 0.1 + 0.2, -0.0, 7100.0, 1e-9].map(number),
            ["0.5", "2e13", "0.30000000000000004", "-0.0", "7100.0", "1e-9"]
        );
    }
}
