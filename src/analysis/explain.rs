//! What explains a mode of a brake, by part, joint and contact pair.

use num_complex::Complex64;

use crate::Result;
use crate::assembly::{JointKind, System, TurningSolids};
use crate::equilibrium::Equilibrium;
use crate::model::Rayleigh;
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::native::lapack;
use crate::reduction::parts::PartMatrices;
use crate::reduction::super_element::SuperElement;
use crate::results::{Kind, Source};
use crate::stability::{Complex, Forms, Mode, Sources, of_contacts, of_elements, self_product, sensitivity, shares};
use crate::structure::{FullModel, Structure, coordinates};

use super::sweep::Sweep;

/// The forms of sources with two vectors. Collective.
type FormsOf<'a> = &'a dyn Fn(&System, [Complex; 2]) -> Result<Vec<Forms>>;

/// The sources of M, C, K and G, and the forms that they have with two vectors. Collective.
pub struct SourceForms<'a> {
    /// What they are.
    pub named: &'a [(Kind, String)],
    /// Their forms, in the same order.
    pub forms: FormsOf<'a>,
    /// What the derivative of each one's stiffness with lambda is, relative to the real part of that; 0 of those
    /// beyond.
    pub slopes: &'a [Complex64],
}

impl Sweep<'_> {
    /// Explains a mode about an equilibrium by the sources of the system's matrices and by the contact pairs. With its
    /// left vector sensitivities come along. Shares add up to 1, what is fed in and taken out to the growth rate.
    /// Sensitivities are at the equilibrium's contact status. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn explain(
        &mut self,
        sources_of: &SourceForms,
        turning: Option<&TurningSolids>,
        equilibrium: &Equilibrium,
        mode: &Mode,
        left: Option<Complex>,
    ) -> Result<Vec<Source>> {
        let (lambda, right) = (mode.lambda, Complex { re: &mode.re, im: &mode.im });
        let pairs = &self.path.contacts().interface().pairs;
        let names = sources_of.named.iter().cloned().chain(pairs.iter().map(|pair| (Kind::Contact, pair.name.clone())));
        let mut own = self.forms(sources_of, equilibrium, [right, right])?;
        own.extend(self.gyroscopic_form(turning, [right, right])?);
        let mut sources: Vec<Source> = names
            .zip(shares(lambda, &own))
            .map(|((kind, name), share)| Source { kind, name, share, sensitivity: None, friction: None })
            .collect();
        let Some(left) = left else { return Ok(sources) };
        let mut forms = self.forms(sources_of, equilibrium, [left, right])?;
        forms.extend(self.gyroscopic_form(turning, [left, right])?);
        let viscoelastic = forms.iter().zip(sources_of.slopes).map(|(form, slope)| slope * form.k).sum::<Complex64>();
        let product = self_product(lambda, &forms) + viscoelastic;
        for (source, form) in sources.iter_mut().zip(&forms) {
            source.sensitivity = Some(sensitivity(lambda, form, product));
        }
        let friction = self.friction_forms(equilibrium, [left, right])?;
        let contacts = sources.iter_mut().filter(|source| source.kind == Kind::Contact);
        contacts.zip(friction).for_each(|(source, form)| source.friction = Some(-(form.k + lambda * form.c) / product));
        Ok(sources)
    }

    /// Sources of the system's matrices, then contact pairs.
    fn forms(&mut self, sources: &SourceForms, equilibrium: &Equilibrium, vectors: [Complex; 2]) -> Result<Vec<Forms>> {
        let mut forms = (sources.forms)(self.system, vectors)?;
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
            let element = &reduced.element;
            let parts = element.parts.iter().map(|part| (Kind::Part, part.name.clone()));
            let named: Vec<_> = parts.chain(element.rest.iter().map(|rest| (Kind::Rest, rest.clone()))).collect();
            let forms = |system: &System, vectors: [Complex; 2]| part_forms(element, system, mode.lambda, vectors);
            let laws: Vec<_> = element.parts.iter().map(|part| part.law.as_ref()).collect();
            let sources = SourceForms { named: &named, forms: &forms, slopes: &slopes(&laws, mode.lambda) };
            sweep.explain(&sources, None, equilibrium, mode, left)
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
    let laws: Vec<Option<&ViscoelasticLaw>> =
        families.solids.parts().iter().map(|part| part.material.viscoelastic.as_ref()).collect();
    let forms = |system: &System, vectors: [Complex; 2]| {
        let mut forms = of_elements(system, &sources, named.len(), vectors)?;
        for (form, law) in forms.iter_mut().zip(&laws).filter_map(|(form, law)| Some((form, (*law)?))) {
            *form = viscoelastic(form, law.factor(mode.lambda));
        }
        Ok(forms)
    };
    let sources = SourceForms { named: &named, forms: &forms, slopes: &slopes(&laws, mode.lambda) };
    sweep.explain(&sources, Some(&families.turning), equilibrium, mode, left)
}

/// What the derivative of the stiffness of parts with some laws is at an eigenvalue, relative to its real part.
fn slopes(laws: &[Option<&ViscoelasticLaw>], lambda: Complex64) -> Vec<Complex64> {
    let slope = |law: &ViscoelasticLaw| law.slope(lambda) / law.factor(lambda).re;
    laws.iter().map(|law| law.map_or(Complex64::ZERO, slope)).collect()
}

/// The forms of a part whose stiffness at rest is multiplied by r: the imaginary part of that is structural damping.
fn viscoelastic(at_rest: &Forms, r: Complex64) -> Forms {
    Forms { k: r.re * at_rest.k, g: Some(at_rest.g.unwrap_or_default() + r.im * at_rest.k), ..*at_rest }
}

/// The forms of the parts of a super-element at an eigenvalue, and of its rest where it has one.
fn part_forms(element: &SuperElement, system: &System, lambda: Complex64, [y, x]: [Complex; 2]) -> Result<Vec<Forms>> {
    let n = element.n_coordinates();
    let columns = |v: Complex| -> Result<Vec<f64>> {
        Ok(coordinates(system, &[v.re, v.im])?.iter().flat_map(|column| &column[..n]).copied().collect())
    };
    let (y, x) = (columns(y)?, columns(x)?);
    let form = |a: &[f64]| hermitian(a, &y, &x);
    let structural = |g: &dyn Fn() -> Complex64| element.structural_damping.is_some().then(g);
    let of_part = |part: &PartMatrices| {
        let (m, k, Rayleigh { alpha, beta }) = (form(&part.mass), form(&part.stiffness), part.rayleigh);
        Forms { m, c: alpha * m + beta * k, k, g: structural(&|| part.loss_factor * k) }
    };
    let mut forms: Vec<Forms> = element.parts.iter().map(of_part).collect();
    if element.rest.is_some() {
        let [m, c, k] = [&element.mass, &element.damping, &element.stiffness].map(|a| form(a));
        let total = Forms { m, c, k, g: element.structural_damping.as_ref().map(|g| form(g)) };
        let less = |rest: Forms, own: &Forms| {
            let g = rest.g.zip(own.g).map(|(rest, own)| rest - own);
            Forms { m: rest.m - own.m, c: rest.c - own.c, k: rest.k - own.k, g }
        };
        forms.push(forms.iter().fold(total, less));
    }
    for (form, part) in forms.iter_mut().zip(&element.parts) {
        if let Some(law) = &part.law {
            *form = viscoelastic(form, law.factor(lambda));
        }
    }
    Ok(forms)
}

/// `y^H A x` of a matrix by rows; real parts, then imaginary parts of the vectors.
fn hermitian(a: &[f64], y: &[f64], x: &[f64]) -> Complex64 {
    let n = x.len() / 2;
    let mut image = vec![0.0; 2 * n];
    lapack::multiply(true, [n, n, 2], a, x, &mut image);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let ([y_re, y_im], [a_re, a_im]) = ([&y[..n], &y[n..]], [&image[..n], &image[n..]]);
    Complex64::new(dot(y_re, a_re) + dot(y_im, a_im), dot(y_re, a_im) - dot(y_im, a_re))
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
