//! Wear by Archard's law: `dh/dt = k p v` at each point of a sliding pair, h added to its gap.
//!
//! A step of time dt is implicit: pressure and wear at its end belong together, `d_new = d - k v dt P(d_new)`. That is
//! an equilibrium with a softer normal law at each point ([`PointLaw::wear`](crate::contact::PointLaw::wear)), so that
//! steps of any length are stable; each step begins at the equilibrium of the one before. The limit of long steps is
//! that of long sliding: the wear rate is a rigid motion of the parts, and uniform where they do not tilt.
//!
//! Source: Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953).

use std::time::Instant;

use crate::assembly::System;
use crate::contact::{Interface, Response, Tangential};
use crate::native::{Comm, Vector};
use crate::output::fields::write_contact_state;
use crate::output::folder::Folder;
use crate::results::{PairWear, Wear, WearEnd, WearStep, WornPoint};
use crate::structure::FullModel;
use crate::{Error, Result};

use super::observer::{Event, Observer, stop_signal, warn};
use super::sweep::Sweep;

/// What [`wear`] is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct WearOptions {
    /// Friction coefficient of the swept pairs; their own where there is none.
    pub friction: Option<f64>,
    /// Where wear ends.
    pub goal: WearGoal,
}

/// Where wear ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WearGoal {
    /// At a sliding distance, in steps of one length.
    Distance {
        /// Mean over the points that wear, m.
        distance: f64,
        /// Number of steps.
        n_steps: usize,
    },
    /// Where the standard deviation of `p v` over its mean falls below this on every pair, in steps that double.
    Uniform {
        /// Such as 0.01.
        tolerance: f64,
    },
}

/// Steps to a uniform wear rate double at most so often.
const MAX_DOUBLINGS: usize = 60;
/// `p v` is steady where a step changes it by less than this fraction of the tolerance of its uniformity.
const STEADY: f64 = 0.01;

/// Wears the sliding pairs of a brake that have a wear coefficient. The brake has the worn gaps afterwards. The
/// pressure before and after goes into the folder, which the root has. Collective.
///
/// ```no_run
/// use squeal::analysis::{WearGoal, WearOptions, wear};
/// use squeal::structure::FullModel;
///
/// let comm = squeal::Session::start(&[])?;
/// let mut brake = FullModel::read(&comm, "brake.toml".as_ref())?;
/// let options = WearOptions { friction: None, goal: WearGoal::Uniform { tolerance: 0.01 } };
/// let worn = wear(&comm, &mut brake, &options, None, &mut ())?;
/// println!("bedded in after {} m", worn.steps.last().map_or(0.0, |step| step.distance));
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] where no pair wears; [`Error::NotConverged`]; [`Error::Interrupted`]; PETSc's, MUMPS's and the
/// system's.
pub fn wear(
    comm: &Comm,
    full: &mut FullModel,
    options: &WearOptions,
    folder: Option<&Folder>,
    observer: &mut dyn Observer,
) -> Result<Wear> {
    let (start, coefficients) = (Instant::now(), coefficients(full)?);
    warn(comm, full, observer);
    observer.event(Event::Stage("assembling"));
    let system = full.assemble(comm, &full.families()?)?;
    let friction = options.friction.map_or_else(|| full.own_friction(), Ok)?;
    let mut state = State::new(full, &system, coefficients, friction, observer)?;
    write_contact_state(folder, full, &system, (&state.u, &state.responses), "contact_before")?;
    let before = state.responses.clone();
    let mut steps = vec![state.measured()];
    let end = match options.goal {
        WearGoal::Distance { distance, n_steps } => {
            for _ in 0..n_steps {
                state.step(distance / n_steps as f64, observer)?;
                steps.push(state.measured());
            }
            WearEnd::Distance
        }
        WearGoal::Uniform { tolerance } => state.until_uniform(tolerance, &mut steps, observer)?,
    };
    write_contact_state(folder, full, &system, (&state.u, &state.responses), "contact_worn")?;
    let points = state.points(&before);
    let interface = state.interface;
    full.interface = interface;
    let (title, seconds) = (full.model.title.clone(), start.elapsed().as_secs_f64());
    Ok(Wear { title, friction, steps, end, points, seconds, n_ranks: comm.size() })
}

/// Refuses a brake without a pair that wears.
///
/// # Errors
/// [`Error::Input`]; see [`wear`].
pub(super) fn require_wear(full: &FullModel) -> Result<()> {
    coefficients(full).map(|_| ())
}

/// Archard's coefficient of each pair, m2/N; 0 of pairs that do not wear.
fn coefficients(full: &FullModel) -> Result<Vec<f64>> {
    let contacts = full.model.contacts.iter().zip(&full.interface.pairs);
    for (contact, pair) in contacts.clone().filter(|(contact, _)| contact.wear.is_some()) {
        if !pair.is_sliding() {
            let what = "it has wear and does not slide. Leave wear out, or give its master a [[rotation]]";
            return Err(full.model.error(contact.place, format_args!("contact {:?}: {what}", contact.name)));
        }
    }
    let all: Vec<f64> = contacts.map(|(contact, _)| contact.wear.unwrap_or(0.0)).collect();
    match all.iter().any(|coefficient| *coefficient > 0.0) {
        true => Ok(all),
        false => {
            let what = "no sliding contact has a wear coefficient";
            let advice = "Give wear = 1e-14 (m2/N) to the [[contact]] of each pad";
            Err(Error::input(format!("{}: {what}. {advice}", full.model.file.display())))
        }
    }
}

/// A brake while it wears.
struct State<'a> {
    full: &'a FullModel,
    system: &'a System,
    friction: f64,
    coefficients: Vec<f64>,
    /// Sliding speed of each point, m/s.
    speeds: Vec<f64>,
    /// Mean of them over the area that wears.
    mean_speed: f64,
    /// With the gaps of now.
    interface: Interface,
    u: Vector,
    responses: Vec<Response>,
    distance: f64,
    /// `k sum p v dt` by pair, m3.
    archard: Vec<f64>,
}

impl<'a> State<'a> {
    /// The equilibrium before any wear. Collective.
    fn new(
        full: &'a FullModel,
        system: &'a System,
        coefficients: Vec<f64>,
        friction: f64,
        observer: &mut dyn Observer,
    ) -> Result<State<'a>> {
        let interface = full.interface.clone();
        let equilibrium = Sweep::new(system, &interface, false)?.equilibrium(friction, observer)?;
        let speed = |tangential: Tangential| match tangential {
            Tangential::Sliding { speed, .. } => speed,
            _ => 0.0,
        };
        let points = interface.points.iter().filter(|point| coefficients[point.pair] > 0.0);
        let area: f64 = points.clone().map(|point| point.law.weight).sum();
        let moved: f64 = points.map(|point| point.law.weight * speed(point.law.tangential)).sum();
        Ok(State {
            full,
            system,
            friction,
            speeds: interface.points.iter().map(|point| speed(point.law.tangential)).collect(),
            mean_speed: moved / area,
            archard: vec![0.0; coefficients.len()],
            coefficients,
            interface,
            u: equilibrium.u,
            responses: equilibrium.responses,
            distance: 0.0,
        })
    }

    /// `k v`: depth that point `a` loses by pressure and time, m/(Pa s).
    fn rate(&self, a: usize) -> f64 {
        self.coefficients[self.interface.points[a].pair] * self.speeds[a]
    }

    /// Points that wear.
    fn wearing(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.speeds.len()).filter(|&a| self.rate(a) > 0.0)
    }

    /// One implicit step over a sliding distance (m): `h += k p v dt` with the pressure at its end. Collective.
    fn step(&mut self, distance: f64, observer: &mut dyn Observer) -> Result<()> {
        observer.event(Event::Stage(&format!("wear to {:.3e} m", self.distance + distance)));
        let time = distance / self.mean_speed;
        let mut wearing = self.interface.clone();
        for a in self.wearing() {
            wearing.points[a].law.wear = self.rate(a) * time;
        }
        let mut sweep = Sweep::new(self.system, &wearing, false)?;
        let equilibrium = sweep.equilibrium_near(self.u.duplicate()?, self.friction, observer)?;
        drop(sweep);
        for (a, response) in equilibrium.responses.iter().enumerate() {
            let point = &mut self.interface.points[a];
            let force = response.normal_force.max(0.0);
            point.law.gap += wearing.points[a].law.wear * force / point.law.weight;
            self.archard[point.pair] += wearing.points[a].law.wear * force;
        }
        self.u = equilibrium.u;
        self.responses = equilibrium.responses;
        self.distance += distance;
        self.stop_if_asked(observer)
    }

    /// Steps that double until `p v` is uniform, or changes no more. Collective.
    fn until_uniform(
        &mut self,
        tolerance: f64,
        steps: &mut Vec<WearStep>,
        observer: &mut dyn Observer,
    ) -> Result<WearEnd> {
        let mut distance = self.first_distance();
        for _ in 0..MAX_DOUBLINGS {
            if steps.last().is_some_and(|step| step.spread() <= tolerance) {
                return Ok(WearEnd::Uniform);
            }
            let before = self.heating();
            self.step(distance, observer)?;
            steps.push(self.measured());
            if change(&before, &self.heating()) <= STEADY * tolerance {
                break;
            }
            distance *= 2.0;
        }
        let is_uniform = steps.last().is_some_and(|step| step.spread() <= tolerance);
        Ok(if is_uniform { WearEnd::Uniform } else { WearEnd::Steady })
    }

    /// The distance over which the wear is like the penetration, on average: `k v dt P' = 1`.
    fn first_distance(&self) -> f64 {
        let weight = |a: usize| self.interface.points[a].law.weight;
        let ratio = |a: usize| weight(a) * self.rate(a) * self.interface.points[a].law.normal_law.initial_stiffness();
        let area: f64 = self.wearing().map(weight).sum();
        self.mean_speed * area / self.wearing().map(ratio).sum::<f64>()
    }

    /// Pressure of a point, Pa.
    fn pressure(&self, a: usize, responses: &[Response]) -> f64 {
        responses[a].normal_force.max(0.0) / self.interface.points[a].law.weight
    }

    /// `sqrt(w) p v` of the points that wear.
    fn heating(&self) -> Vec<f64> {
        let of =
            |a: usize| self.interface.points[a].law.weight.sqrt() * self.pressure(a, &self.responses) * self.speeds[a];
        self.wearing().map(of).collect()
    }

    /// What has been worn off, and how the pairs wear now.
    fn measured(&self) -> WearStep {
        let pairs = (0..self.coefficients.len()).filter(|&i| self.coefficients[i] > 0.0);
        WearStep { distance: self.distance, pairs: pairs.map(|i| self.pair(i)).collect() }
    }

    fn pair(&self, i: usize) -> PairWear {
        let pair = &self.interface.pairs[i];
        let points = || pair.points.clone();
        let weight = |a: usize| self.interface.points[a].law.weight;
        let heating = |a: usize| self.pressure(a, &self.responses) * self.speeds[a];
        let depth = |a: usize| self.interface.points[a].law.gap - self.full.interface.points[a].law.gap;
        let area: f64 = points().map(weight).sum();
        let mean = points().map(|a| weight(a) * heating(a)).sum::<f64>() / area;
        let variance = points().map(|a| weight(a) * (heating(a) - mean).powi(2)).sum::<f64>() / area;
        let volume = points().map(|a| weight(a) * depth(a)).sum::<f64>();
        PairWear {
            pair: pair.name.clone(),
            mean,
            spread: if mean > 0.0 { variance.sqrt() / mean } else { 0.0 },
            smallest: points().map(heating).fold(f64::INFINITY, f64::min),
            largest: points().map(heating).fold(0.0, f64::max),
            pressure: points().map(|a| self.pressure(a, &self.responses)).fold(0.0, f64::max),
            depth: points().map(depth).fold(0.0, f64::max),
            volume,
            archard_volume: self.archard[i],
            mass: self.density(&pair.slave) * volume,
        }
    }

    /// Density of the part behind a surface, kg/m3; 0 where it lies on several.
    fn density(&self, surface: &str) -> f64 {
        let (model, mesh) = (&self.full.model, &self.full.mesh);
        let part = mesh.part_of_surface(surface).map(|part| &mesh.parts[part as usize]);
        let own = model.parts.iter().find(|own| Some(&own.name) == part);
        own.map_or(0.0, |own| own.material.density)
    }

    /// The points of the pairs that wear, by place, which is the same on any number of ranks.
    fn points(&self, before: &[Response]) -> Vec<WornPoint> {
        let pairs = (0..self.coefficients.len()).filter(|&i| self.coefficients[i] > 0.0);
        pairs.flat_map(|i| self.points_of(i, before)).collect()
    }

    fn points_of(&self, pair: usize, before: &[Response]) -> Vec<WornPoint> {
        let own = &self.interface.pairs[pair];
        let positions: Vec<[f64; 3]> = own.points.clone().map(|a| self.interface.points[a].position).collect();
        let field = self.full.model.contacts[pair].gap_field.as_ref();
        let given = field.and_then(|field| field.at(&positions).ok()).unwrap_or_else(|| vec![0.0; positions.len()]);
        let point = |((a, [x_m, y_m, z_m]), given): ((usize, [f64; 3]), f64)| {
            let wear_m = self.interface.points[a].law.gap - self.full.interface.points[a].law.gap;
            WornPoint {
                contact: own.name.clone(),
                x_m,
                y_m,
                z_m,
                gap_m: given + wear_m,
                wear_m,
                area_m2: self.interface.points[a].law.weight,
                speed_m_per_s: self.speeds[a],
                pressure_before_pa: self.pressure(a, before),
                pressure_pa: self.pressure(a, &self.responses),
            }
        };
        let mut points: Vec<WornPoint> = own.points.clone().zip(positions).zip(given).map(point).collect();
        let place = |point: &WornPoint| [point.x_m, point.y_m, point.z_m];
        points.sort_by(|a, b| place(a).partial_cmp(&place(b)).expect("coordinates are numbers"));
        points
    }

    /// Ends the work where a signal has asked any rank for it. Collective.
    fn stop_if_asked(&self, observer: &mut dyn Observer) -> Result<()> {
        let Some(signal) = stop_signal(self.system.k.comm(), observer) else { return Ok(()) };
        let text = format!("stopped after {:.3e} m of sliding. Nothing is kept", self.distance);
        Err(Error::Interrupted { signal, text })
    }
}

/// `|b - a| / |b|`.
fn change(a: &[f64], b: &[f64]) -> f64 {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| b - a)) / norm(&mut b.iter().copied()).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_relative_to_what_it_leads_to() {
        assert_eq!(change(&[3.0, 4.0], &[3.0, 4.0]), 0.0);
        assert!((change(&[3.0, 4.0], &[6.0, 8.0]) - 0.5).abs() < 1e-15);
        assert_eq!(change(&[], &[]), 0.0);
    }

    #[test]
    fn only_sliding_pairs_with_a_coefficient_wear() {
        let comm = crate::native::Session::start(&[]).unwrap();
        let mut brake = FullModel::read(&comm, "tests/data/pads_on_disc.toml".as_ref()).unwrap();
        let message = |brake: &FullModel| require_wear(brake).unwrap_err().to_string();
        assert!(message(&brake).contains("no sliding contact has a wear coefficient. Give wear = 1e-14"));
        brake.model.contacts[1].wear = Some(2e-14);
        assert_eq!(coefficients(&brake).unwrap(), [0.0, 2e-14]);
        brake.interface.pairs[1].kind = crate::contact::TangentialKind::StickSlip;
        assert!(message(&brake).contains("it has wear and does not slide"));
    }
}
