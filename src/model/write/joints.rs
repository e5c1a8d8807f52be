//! The connectors, ties, rigid sets, masses and equations of a model file.

use super::{Text, list, number, quoted};
use crate::model::{Connector, Equation, EquationTerm, Model, PointMass, RigidSet, Tie};

/// Writes all of them.
pub fn write(out: &mut Text, model: &Model) {
    let unit = model.mesh_unit;
    model.connectors.iter().for_each(|own| connector(out, own, unit));
    model.ties.iter().for_each(|own| tie(out, own, unit));
    model.rigid_sets.iter().for_each(|own| rigid_set(out, own));
    model.masses.iter().for_each(|own| mass(out, own, unit));
    model.equations.iter().for_each(|own| equation(out, own));
}

fn connector(out: &mut Text, connector: &Connector, unit: f64) {
    let [a, b] = connector.between.each_ref().map(|name| quoted(name));
    out.table("[[connector]]");
    out.line("name", quoted(&connector.name));
    out.line("between", format_args!("[{a}, {b}]"));
    out.point("at", connector.at, unit);
    if let Some([x, y, _]) = &connector.axes {
        out.line("x_axis", list(x));
        out.line("y_axis", list(y));
    }
    out.line("stiffness", list(&connector.stiffness));
    out.line("rotational_stiffness", list(&connector.rotational_stiffness));
    out.line("damping", list(&connector.damping));
    if connector.loss_factor != 0.0 {
        out.line("loss_factor", number(connector.loss_factor));
    }
}

fn tie(out: &mut Text, tie: &Tie, unit: f64) {
    out.table("[[tie]]");
    out.line("name", quoted(&tie.name));
    out.line("slave", quoted(&tie.slave));
    out.line("master", quoted(&tie.master));
    out.optional("search", tie.search_distance.map(|distance| distance / unit));
    out.optional("stiffness", tie.stiffness);
}

fn rigid_set(out: &mut Text, set: &RigidSet) {
    out.table("[[rigid]]");
    out.line("name", quoted(&set.name));
    out.line("nodes", quoted(&set.nodes));
}

fn mass(out: &mut Text, mass: &PointMass, unit: f64) {
    out.table("[[mass]]");
    out.line("name", quoted(&mass.name));
    out.line("nodes", quoted(&mass.nodes));
    out.line("mass", number(mass.mass));
    out.point("at", mass.at, unit);
    if mass.inertia != [0.0; 6] {
        out.line("inertia", list(&mass.inertia));
    }
}

fn equation(out: &mut Text, equation: &Equation) {
    let term = |EquationTerm { node, axis, coefficient }: &EquationTerm| {
        let (node, axis) = (quoted(node), quoted(["x", "y", "z"][*axis]));
        format!("    {{ node = {node}, axis = {axis}, coefficient = {} }},\n", number(*coefficient))
    };
    out.table("[[equation]]");
    out.line("name", quoted(&equation.name));
    out.line("terms", format_args!("[\n{}]", equation.terms.iter().map(term).collect::<String>()));
}
