//! Linear relations between displacements of nodes: `*EQUATION`, `*MPC`, and supports along local axes.
//!
//! A displacement along a local axis e of `*TRANSFORM` is `e . u`, three terms in global axes.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector3;

use super::Conversion;
use crate::Result;
use crate::deck::sets::Kind;
use crate::deck::types::{ConstraintKind, Entry, EquationDefinition, PointConstraint, Transform};
use crate::model::{Equation, EquationTerm, Place};

/// Coefficients below this, relative to the largest, are none.
const NOTHING: f64 = 1e-12;
/// The axes by their letters, for names.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Local axes, one a row.
pub(super) type Axes = [[f64; 3]; 3];

impl Conversion<'_> {
    /// The equations of the deck, in the order of its keywords.
    pub(super) fn equations(&mut self) -> Result<Vec<Equation>> {
        let (deck, mut equations) = (self.deck, Vec::new());
        for definition in &deck.equations {
            self.equation(definition, &mut equations)?;
        }
        for constraint in &deck.point_constraints {
            self.point_constraint(constraint, &mut equations)?;
        }
        Ok(equations)
    }

    /// An equation for each node of its sets; a single node is in all of them.
    fn equation(&mut self, definition: &EquationDefinition, equations: &mut Vec<Equation>) -> Result<()> {
        let place = definition.place;
        let mut members = Vec::new();
        for term in &definition.terms {
            if term.axis > 3 {
                let what = "a rotation in an equation is not supported: nodes of solids do not rotate. \
                            Take displacements 1 to 3";
                return Err(self.assembly.error(place, what));
            }
            members.push(self.by_number(&term.of, place)?);
        }
        let n = members.iter().map(Vec::len).max().unwrap_or(0);
        if members.iter().any(|own| own.len() != n && own.len() != 1) {
            return Err(self.assembly.error(
                place,
                "the sets of the equation have different numbers of nodes. Give sets of one length, or one node",
            ));
        }
        for k in 0..n {
            let mut sum = BTreeMap::new();
            for (term, own) in definition.terms.iter().zip(&members) {
                let node = own[k.min(own.len() - 1)];
                self.add_term(&mut sum, node, usize::from(term.axis) - 1, term.coefficient);
            }
            self.push_equation(sum, place, equations)?;
        }
        Ok(())
    }

    /// Nodes of a set by their numbers, as both programs pair them.
    fn by_number(&self, of: &Entry, place: Place) -> Result<Vec<u32>> {
        let mut nodes = self.assembly.set(Kind::Node, 0, of, place)?;
        nodes.sort_by_key(|&node| self.assembly.numbers[node as usize]);
        match nodes.iter().find(|&&node| !self.is_used(node)) {
            None => Ok(nodes),
            Some(&node) => {
                let number = self.assembly.numbers[node as usize];
                let what = format_args!(
                    "node {number} belongs to no solid: equations are between nodes of solids. Couple a reference node"
                );
                Err(self.assembly.error(place, what))
            }
        }
    }

    /// Adds a displacement along a local axis of a node.
    fn add_term(&self, sum: &mut BTreeMap<(u32, usize), f64>, node: u32, axis: usize, coefficient: f64) {
        let node = self.bodies.node_of[node as usize];
        let direction = self.axes.get(&node).map_or_else(|| unit(axis), |axes| axes[axis]);
        (0..3).for_each(|i| *sum.entry((node, i)).or_default() += coefficient * direction[i]);
    }

    /// Adds an equation in displacements of mesh nodes; one term alone is a support.
    fn push_equation(
        &mut self,
        sum: BTreeMap<(u32, usize), f64>,
        place: Place,
        equations: &mut Vec<Equation>,
    ) -> Result<()> {
        let largest = sum.values().fold(0.0_f64, |most, value| most.max(value.abs()));
        let terms = sum.into_iter().filter(|(_, coefficient)| coefficient.abs() > NOTHING * largest);
        let terms: Vec<EquationTerm> = terms
            .map(|((node, axis), coefficient)| EquationTerm { node: self.mesh_node_name(node), axis, coefficient })
            .collect();
        if terms.len() < 2 {
            let what = "the equation relates fewer than two displacements. Take *BOUNDARY";
            return Err(self.assembly.error(place, what));
        }
        let all: Vec<String> = terms.iter().map(|term| format!("{} {}", term.node, AXES[term.axis])).collect();
        let name = match all.len() {
            0..=4 => all.join(", "),
            n => format!("{} and {} more", all[0], n - 1),
        };
        let name = super::regions::unlike(&name, |name| equations.iter().any(|own| own.name == name), "equation");
        equations.push(Equation { name, terms, place });
        Ok(())
    }

    /// Nodes that move as one, or, of a BEAM between nodes of solids, keep their distance.
    fn point_constraint(&mut self, constraint: &PointConstraint, equations: &mut Vec<Equation>) -> Result<()> {
        let place = constraint.place;
        if constraint.kind == ConstraintKind::Beam {
            let second = self.one_node(&constraint.nodes[1], place, "the second node of a BEAM")?;
            if !self.is_used(second) {
                return Ok(());
            }
        }
        let [first, second] =
            [self.by_number(&constraint.nodes[0], place)?, self.by_number(&constraint.nodes[1], place)?];
        if second.len() != first.len() && second.len() != 1 {
            return Err(self.assembly.error(
                place,
                "the two sets have different numbers of nodes (*MPC). Give sets of one length, or one node",
            ));
        }
        for (k, &node) in first.iter().enumerate() {
            let other = second[k.min(second.len() - 1)];
            for direction in self.constrained_directions(constraint.kind, node, other, place)? {
                let mut sum = BTreeMap::new();
                for (node, sign) in [(node, 1.0), (other, -1.0)] {
                    let node = self.bodies.node_of[node as usize];
                    (0..3).for_each(|i| *sum.entry((node, i)).or_default() += sign * direction[i]);
                }
                self.push_equation(sum, place, equations)?;
            }
        }
        Ok(())
    }

    /// Directions along which two nodes have the same displacement.
    fn constrained_directions(&self, kind: ConstraintKind, a: u32, b: u32, place: Place) -> Result<Vec<[f64; 3]>> {
        if kind == ConstraintKind::Same {
            return Ok(vec![unit(0), unit(1), unit(2)]);
        }
        let line = Vector3::from(self.point(b)) - Vector3::from(self.point(a));
        let along = line
            .try_normalize(0.0)
            .ok_or_else(|| self.assembly.error(place, "the two nodes of a BEAM are one point (*MPC). Take TIE"))?;
        Ok(vec![along.into()])
    }

    /// The name of the set of one node of the assembly.
    pub(super) fn node_name(&mut self, node: u32) -> String {
        self.mesh_node_name(self.bodies.node_of[node as usize])
    }

    fn mesh_node_name(&mut self, node: u32) -> String {
        let number = self.numbers[node as usize];
        self.regions.add_node_set(&format!("node {number}"), vec![node])
    }

    /// Local axes by mesh nodes.
    pub(super) fn transforms(&self) -> Result<HashMap<u32, Axes>> {
        let mut all = HashMap::new();
        for transform in &self.deck.transforms {
            let entry = crate::deck::parse::entry(&transform.set);
            for node in
                self.assembly.set(Kind::Node, 0, &entry, transform.place)?.into_iter().filter(|&n| self.is_used(n))
            {
                let axes = local_axes(transform, self.assembly.coordinates[node as usize]).ok_or_else(|| {
                    let what =
                        "the axes are not determined: their points, or a node and the axis, lie on a line (*TRANSFORM)";
                    self.assembly.error(transform.place, what)
                })?;
                all.insert(self.bodies.node_of[node as usize], axes);
            }
        }
        Ok(all)
    }

    /// Supports of a node along local axes: held global axes, and equations for oblique ones.
    pub(super) fn local_support(
        &mut self,
        node: u32,
        held: [bool; 3],
        place: Place,
        equations: &mut Vec<Equation>,
    ) -> Result<[bool; 3]> {
        let (axes, mut global) = (self.axes[&node], [false; 3]);
        if held == [true; 3] {
            return Ok(held);
        }
        for i in (0..3).filter(|&i| held[i]) {
            match global_axis(&axes[i]) {
                Some(j) => global[j] = true,
                None => {
                    let sum = (0..3).map(|j| ((node, j), axes[i][j])).collect();
                    self.push_equation(sum, place, equations)?;
                }
            }
        }
        Ok(global)
    }
}

/// The global axis that a local one is parallel to.
pub(super) fn global_axis(axis: &[f64; 3]) -> Option<usize> {
    (0..3).find(|&j| axis[j].abs() > 1.0 - NOTHING)
}

/// A global axis.
fn unit(axis: usize) -> [f64; 3] {
    let mut direction = [0.0; 3];
    direction[axis] = 1.0;
    direction
}

/// The axes at a point; none where they are not determined.
fn local_axes(transform: &Transform, x: [f64; 3]) -> Option<Axes> {
    let [a, b, x] = [transform.a, transform.b, x].map(Vector3::from);
    let rows = |first: Vector3<f64>, second: Vector3<f64>, third: Vector3<f64>| [first, second, third].map(Into::into);
    if transform.is_cylindrical {
        let axial = (b - a).try_normalize(0.0)?;
        let arm = x - a;
        let radial = (arm - axial * arm.dot(&axial)).try_normalize(NOTHING * arm.norm())?;
        return Some(rows(radial, axial.cross(&radial), axial));
    }
    let first = a.try_normalize(0.0)?;
    let third = first.cross(&b).try_normalize(NOTHING * b.norm())?;
    Some(rows(first, third.cross(&first), third))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform(is_cylindrical: bool, a: [f64; 3], b: [f64; 3]) -> Transform {
        Transform { set: String::new(), is_cylindrical, a, b, place: Place::default() }
    }

    #[test]
    fn axes_are_right_handed_and_cylindrical_ones_follow_the_point() {
        let axes = local_axes(&transform(false, [0.0, 2.0, 0.0], [-1.0, 5.0, 0.0]), [9.0; 3]).unwrap();
        assert_eq!(axes, [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let axis = transform(true, [0.0; 3], [0.0, 0.0, 3.0]);
        let axes = local_axes(&axis, [0.0, 2.0, 7.0]).unwrap();
        assert_eq!(axes, [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(local_axes(&axis, [0.0, 0.0, 7.0]), None);
        assert_eq!(local_axes(&transform(false, [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]), [0.0; 3]), None);
    }
}
