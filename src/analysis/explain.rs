//! What explains a mode of a brake, by part, joint and contact pair.

use crate::Result;
use crate::assembly::{JointKind, TurningSolids};
use crate::equilibrium::Equilibrium;
use crate::reduction::super_element::Member;
use crate::results::{Kind, Source};
use crate::stability::{Complex, Forms, Mode, Sources, of_contacts, of_elements, self_product, sensitivity, shares};
use crate::structure::{FullModel, Structure};

use super::sweep::Sweep;

impl Sweep<'_> {
    /// Explains a mode about an equilibrium by families of elements, the source of each member among `named`, and by
    /// the contact pairs. With its left vector sensitivities come along. Shares add up to 1, what is fed in and taken
    /// out to the growth rate. Sensitivities are at the equilibrium's contact status. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn explain(
        &mut self,
        (families, named): (&[Sources], &[(Kind, String)]),
        turning: Option<&TurningSolids>,
        equilibrium: &Equilibrium,
        mode: &Mode,
        left: Option<Complex>,
    ) -> Result<Vec<Source>> {
        let (lambda, right) = (mode.lambda, Complex { re: &mode.re, im: &mode.im });
        let pairs = &self.path.contacts().interface().pairs;
        let names = named.iter().cloned().chain(pairs.iter().map(|pair| (Kind::Contact, pair.name.clone())));
        let mut own = self.forms(families, named.len(), equilibrium, [right, right])?;
        own.extend(self.gyroscopic_form(turning, [right, right])?);
        let mut sources: Vec<Source> = names
            .zip(shares(lambda, &own))
            .map(|((kind, name), share)| Source { kind, name, share, sensitivity: None, friction: None })
            .collect();
        let Some(left) = left else { return Ok(sources) };
        let mut forms = self.forms(families, named.len(), equilibrium, [left, right])?;
        forms.extend(self.gyroscopic_form(turning, [left, right])?);
        let product = self_product(lambda, &forms);
        for (source, form) in sources.iter_mut().zip(&forms) {
            source.sensitivity = Some(sensitivity(lambda, form, product));
        }
        let friction = self.friction_forms(equilibrium, [left, right])?;
        let contacts = sources.iter_mut().filter(|source| source.kind == Kind::Contact);
        contacts.zip(friction).for_each(|(source, form)| source.friction = Some(-(form.k + lambda * form.c) / product));
        Ok(sources)
    }

    /// Sources of elements, then contact pairs.
    fn forms(
        &mut self,
        families: &[Sources],
        n_named: usize,
        equilibrium: &Equilibrium,
        vectors: [Complex; 2],
    ) -> Result<Vec<Forms>> {
        let mut forms = of_elements(self.system, families, n_named, vectors)?;
        let contacts = self.path.contacts();
        let frictions = contacts.interface().frictions_at(equilibrium.friction);
        forms.extend(of_contacts(contacts, equilibrium, &frictions, self.terms.friction_damping, vectors)?);
        Ok(forms)
    }

    /// What the inertia forces of rotations have in `y^H C x`; none where there are none. They do no work and belong to
    /// no source.
    fn gyroscopic_form(&self, turning: Option<&TurningSolids>, vectors: [Complex; 2]) -> Result<Option<Forms>> {
        let Some(turning) = turning.filter(|turning| !turning.is_none()) else { return Ok(None) };
        let all = of_elements(self.system, &[(turning, &|_| 0)], 1, vectors)?;
        Ok(Some(Forms { c: all[0].c, ..Forms::default() }))
    }

    /// The forms of `dP / d mu` of each contact pair: K and friction damping are linear in mu.
    fn friction_forms(&mut self, equilibrium: &Equilibrium, vectors: [Complex; 2]) -> Result<Vec<Forms>> {
        let at = |mu: f64| {
            let frictions = vec![mu; self.path.contacts().interface().pairs.len()];
            of_contacts(self.path.contacts(), equilibrium, &frictions, self.terms.friction_damping, vectors)
        };
        let (one, none) = (at(1.0)?, at(0.0)?);
        let difference = |(a, b): (&Forms, &Forms)| Forms { m: a.m - b.m, c: a.c - b.c, k: a.k - b.k, g: None };
        Ok(one.iter().zip(&none).map(difference).collect())
    }
}

/// Explains a mode of a structure by parts, joints and contact pairs: [`Sweep::explain`]. Collective.
///
/// # Errors
/// [`crate::Error::Input`] where a part has no material; PETSc's.
pub fn explain(
    structure: &Structure,
    sweep: &mut Sweep,
    equilibrium: &Equilibrium,
    mode: &Mode,
    left: Option<Complex>,
) -> Result<Vec<Source>> {
    match structure {
        Structure::Full(full) => explain_full(full, sweep, equilibrium, mode, left),
        Structure::Reduced(reduced) => {
            let named = [(Kind::Part, "super-element".to_owned())];
            let member = Member::new(&reduced.element);
            sweep.explain((&[(&member, &|_| 0)], &named), None, equilibrium, mode, left)
        }
    }
}

/// Explains a mode of a full model, as [`explain`] does. Collective.
///
/// # Errors
/// [`crate::Error::Input`] where a part has no material; PETSc's.
pub fn explain_full(
    full: &FullModel,
    sweep: &mut Sweep,
    equilibrium: &Equilibrium,
    mode: &Mode,
    left: Option<Complex>,
) -> Result<Vec<Source>> {
    let parts = full.mesh.parts.iter().map(|name| (Kind::Part, name.clone()));
    let joints = full.joints.names.iter().map(|(kind, name)| (kind_of(*kind), name.clone()));
    let named: Vec<_> = parts.chain(joints).collect();
    let part = |e: usize| full.mesh.elements.get(e).part as usize;
    let joint = |e: usize| full.mesh.parts.len() + full.joints.elements[e].joint;
    let families = full.families()?;
    let sources: [Sources; 2] = [(&families.solids, &part), (families.joints, &joint)];
    sweep.explain((&sources, &named), Some(&families.turning), equilibrium, mode, left)
}

/// A joint as results call it.
fn kind_of(joint: JointKind) -> Kind {
    match joint {
        JointKind::Connector => Kind::Connector,
        JointKind::Tie => Kind::Tie,
        JointKind::RigidSet => Kind::Rigid,
        JointKind::Equation => Kind::Equation,
        JointKind::Mass => Kind::Mass,
    }
}
