//! What joins parts and adds to them without a mesh: connectors, ties, rigid sets, point masses and equations.

use super::contacts::search_distance;
use super::item::{Item, Vector, named};
use super::keys;
use super::materials::axes;
use super::source::ModelText;
use super::{Connector, Equation, EquationTerm, PointMass, RigidSet, Tie};
use crate::Result;
use toml::Spanned;

/// A penalty over the stiffness of the elements beside it: errors of 1e-4, and four digits fewer in a factor.
pub const PENALTY: f64 = 1e4;

/// The axes by their letters.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The connectors; `unit` is metres per unit of the mesh.
pub fn connectors(source: ModelText, raw: &[Spanned<keys::ConnectorTable>], unit: f64) -> Result<Vec<Connector>> {
    let called = |raw: &keys::ConnectorTable| raw.name.clone().unwrap_or_else(|| raw.between.get_ref().join(" / "));
    named(source, "connector", raw, called, |item, name, raw| connector(item, name, raw, unit))
}

fn connector(item: &Item, name: String, raw: &keys::ConnectorTable, unit: f64) -> Result<Connector> {
    let [a, b] = raw.between.get_ref();
    let what = format_args!("both ends are {a:?}");
    item.require_at(&raw.between.span(), a != b, what, "Name two different node sets")?;
    let constants =
        |values: &Vector, key: &str, advice: &str| item.each(values, |x| x >= 0.0, key, "must be 0 or above", advice);
    let optional = |values: &Option<Vector>, key, advice| {
        values.as_ref().map_or(Ok([0.0; 3]), |values| constants(values, key, advice))
    };
    let rotational = "Give [x, y, z] in N m/rad";
    let connector = Connector {
        name,
        between: raw.between.get_ref().clone(),
        at: item.point(&raw.at, "at", unit)?,
        axes: axes(item, &raw.x_axis, &raw.y_axis)?.map(|axes| [0, 1, 2].map(|i| axes.column(i).into_owned().into())),
        stiffness: constants(&raw.stiffness, "stiffness", "Give [x, y, z] in N/m")?,
        rotational_stiffness: optional(&raw.rotational_stiffness, "rotational_stiffness", rotational)?,
        damping: optional(&raw.damping, "damping", "Give [x, y, z] in N s/m")?,
        loss_factor: item.loss_factor(&raw.loss_factor)?,
        place: item.place(),
    };
    let all = [connector.stiffness, connector.rotational_stiffness, connector.damping];
    let acts = all.as_flattened().iter().any(|&x| x != 0.0);
    item.require(acts, "all its constants are 0", "Give it a stiffness, or leave it out")?;
    Ok(connector)
}

/// The ties; `unit` is metres per unit of the mesh.
pub fn ties(source: ModelText, raw: &[Spanned<keys::TieTable>], unit: f64) -> Result<Vec<Tie>> {
    let called = |raw: &keys::TieTable| raw.name.clone().unwrap_or_else(|| format!("{} / {}", raw.slave, raw.master));
    named(source, "tie", raw, called, |item, name, raw| {
        let what = format_args!("slave and master are both {:?}", raw.slave);
        item.require(raw.slave != raw.master, what, "Name the two surfaces that move as one")?;
        let advice = "Give N/m3, or leave it out: it then follows from the elements beside the surfaces";
        Ok(Tie {
            name,
            slave: raw.slave.clone(),
            master: raw.master.clone(),
            search_distance: search_distance(item, &raw.search, unit)?,
            stiffness: item.positive_if_given(&raw.stiffness, "stiffness", advice)?,
            place: item.place(),
        })
    })
}

/// The rigid sets.
pub fn rigid_sets(source: ModelText, raw: &[Spanned<keys::RigidTable>]) -> Result<Vec<RigidSet>> {
    let called = |raw: &keys::RigidTable| raw.name.clone().unwrap_or_else(|| raw.nodes.clone());
    let read =
        |item: &Item, name, raw: &keys::RigidTable| RigidSet { name, nodes: raw.nodes.clone(), place: item.place() };
    named(source, "rigid", raw, called, |item, name, raw| Ok(read(item, name, raw)))
}

/// The point masses; `unit` is metres per unit of the mesh.
pub fn masses(source: ModelText, raw: &[Spanned<keys::MassTable>], unit: f64) -> Result<Vec<PointMass>> {
    let called = |raw: &keys::MassTable| raw.name.clone().unwrap_or_else(|| raw.nodes.clone());
    named(source, "mass", raw, called, |item, name, raw| mass(item, name, raw, unit))
}

fn mass(item: &Item, name: String, raw: &keys::MassTable, unit: f64) -> Result<PointMass> {
    let mass = item.not_negative(&raw.mass, "mass", "Give kg, such as 0.3")?;
    let inertia = raw.inertia.as_ref().map_or(Ok([0.0; 6]), |given| inertia(item, given))?;
    item.require(mass > 0.0 || inertia != [0.0; 6], "mass is 0, and there is no inertia", "Give kg, such as 0.3")?;
    Ok(PointMass {
        name,
        nodes: raw.nodes.clone(),
        at: item.point(&raw.at, "at", unit)?,
        mass,
        inertia,
        place: item.place(),
    })
}

/// An inertia tensor of which no rotation has a negative energy.
fn inertia(item: &Item, given: &Spanned<[f64; 6]>) -> Result<[f64; 6]> {
    let inertia = item.finite(given, "inertia")?;
    let advice = "Give [xx, yy, zz, xy, yz, zx] in kg m2; xy is minus the integral of x y dm";
    item.require_at(&given.span(), PointMass::is_possible(inertia), PointMass::NEGATIVE_MOMENT, advice)?;
    Ok(inertia)
}

/// The equations.
pub fn equations(source: ModelText, raw: &[Spanned<keys::EquationTable>]) -> Result<Vec<Equation>> {
    let term = |raw: &keys::EquationTermTable| format!("{} {}", raw.node, raw.axis.get_ref());
    let all = |raw: &keys::EquationTable| raw.terms.get_ref().iter().map(term).collect::<Vec<_>>().join(", ");
    let called = |raw: &keys::EquationTable| raw.name.clone().unwrap_or_else(|| all(raw));
    named(source, "equation", raw, called, equation)
}

fn equation(item: &Item, name: String, raw: &keys::EquationTable) -> Result<Equation> {
    let terms: Vec<EquationTerm> = raw.terms.get_ref().iter().map(|raw| term(item, raw)).collect::<Result<_>>()?;
    let span = raw.terms.span();
    item.require_at(&span, terms.len() > 1, "an equation has two terms at least", "Take [[fix]] for one of them")?;
    let same = |a: &EquationTerm, b: &EquationTerm| a.node == b.node && a.axis == b.axis;
    match (1..terms.len()).find(|&k| terms[..k].iter().any(|term| same(term, &terms[k]))) {
        None => Ok(Equation { name, terms, place: item.place() }),
        Some(twice) => {
            let EquationTerm { node, axis, .. } = &terms[twice];
            let what = format_args!("the displacement of {node:?} along {} is there twice", AXES[*axis]);
            Err(item.error(&span, what, "Add up their coefficients"))
        }
    }
}

fn term(item: &Item, raw: &keys::EquationTermTable) -> Result<EquationTerm> {
    let axis = item.find("axis", &raw.axis, &[0, 1, 2], |&i| AXES[i])?;
    let coefficient = *raw.coefficient.get_ref();
    let advice = "Give a number, or leave the term out";
    Ok(EquationTerm {
        node: raw.node.clone(),
        axis: *axis,
        coefficient: item.check(&raw.coefficient, coefficient != 0.0, "coefficient", "must not be 0", advice)?,
    })
}
