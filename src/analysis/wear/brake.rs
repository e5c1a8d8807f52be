//! A brake while it wears: one implicit step after the other, and what has been worn off.

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::analysis::observer::{Event, Observer};
use crate::analysis::sweep::Sweep;
use crate::assembly::System;
use crate::contact::{Interface, Response, Tangential};
use crate::equilibrium::Equilibrium;
use crate::native::Vector;
use crate::results::{PairWear, WearStep, WornPoint};
use crate::structure::Structure;

/// A state of wear, an equilibrium.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// This rank's displacements, m.
    pub u: Vec<f64>,
    /// Gaps of all points, m.
    pub gaps: Vec<f64>,
    /// What all points answer.
    pub responses: Vec<Response>,
    /// Sliding distance so far, m.
    pub distance: f64,
    /// `k sum p v dt` by pair, m3.
    archard: Vec<f64>,
}

/// What stays while a brake wears.
pub struct WearingBrake<'a> {
    structure: &'a Structure,
    /// Its dofs.
    pub system: &'a System,
    friction: f64,
    /// Sliding speed of each point, m/s.
    speeds: Vec<f64>,
    /// Mean of them over the area that wears.
    mean_speed: f64,
}

impl<'a> WearingBrake<'a> {
    /// At a friction coefficient of the swept pairs.
    pub fn new(structure: &'a Structure, system: &'a System, friction: f64) -> WearingBrake<'a> {
        let interface = structure.interface();
        let speed = |tangential: Tangential| match tangential {
            Tangential::Sliding { speed, .. } => speed,
            _ => 0.0,
        };
        let points = interface.points.iter().filter(|point| interface.pairs[point.pair].wear.is_some());
        let area: f64 = points.clone().map(|point| point.law.weight).sum();
        let moved: f64 = points.map(|point| point.law.weight * speed(point.law.tangential)).sum();
        let speeds = interface.points.iter().map(|point| speed(point.law.tangential)).collect();
        WearingBrake { structure, system, friction, speeds, mean_speed: moved / area }
    }

    /// Before any wear.
    fn interface(&self) -> &'a Interface {
        self.structure.interface()
    }

    /// `k v`: depth that point `a` loses by pressure and time, m/(Pa s).
    fn rate(&self, a: usize) -> f64 {
        let pair = &self.interface().pairs[self.interface().points[a].pair];
        pair.wear.map_or(0.0, |wear| wear.coefficient) * self.speeds[a]
    }

    fn weight(&self, a: usize) -> f64 {
        self.interface().points[a].law.weight
    }

    /// Points that wear.
    fn wearing(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.speeds.len()).filter(|&a| self.rate(a) > 0.0)
    }

    /// The equilibrium before any wear. Collective.
    ///
    /// # Errors
    /// See [`Sweep::equilibrium`].
    pub fn unworn(&self, observer: &mut dyn Observer) -> Result<State> {
        let interface = self.interface();
        let equilibrium = Sweep::new(self.system, interface, false)?.equilibrium(self.friction, observer)?;
        let gaps = interface.points.iter().map(|point| point.law.gap).collect();
        let Equilibrium { u, responses, .. } = equilibrium;
        Ok(State { u: u.to_vec()?, gaps, responses, distance: 0.0, archard: vec![0.0; interface.pairs.len()] })
    }

    /// One implicit step over a sliding distance (m): `h += k p v dt` with the pressure at its end. Collective.
    ///
    /// # Errors
    /// See [`Sweep::equilibrium_near`].
    pub fn step(&self, state: &State, distance: f64, observer: &mut dyn Observer) -> Result<State> {
        observer.event(Event::Stage(&format!("wear to {:.3e} m", state.distance + distance)));
        let time = distance / self.mean_speed;
        let mut wearing = self.interface().clone();
        wearing.points.iter_mut().zip(&state.gaps).for_each(|(point, gap)| point.law.gap = *gap);
        for a in self.wearing() {
            wearing.points[a].law.wear = self.rate(a) * time;
        }
        let u = Vector::from_local(self.system.k.comm(), &state.u)?;
        let equilibrium = Sweep::new(self.system, &wearing, false)?.equilibrium_near(u, self.friction, observer)?;
        let mut next = State { distance: state.distance + distance, ..state.clone() };
        for (a, response) in equilibrium.responses.iter().enumerate() {
            let point = &wearing.points[a];
            let force = response.normal_force.max(0.0);
            next.gaps[a] += point.law.wear * force / point.law.weight;
            next.archard[point.pair] += point.law.wear * force;
        }
        next.u = equilibrium.u.to_vec()?;
        next.responses = equilibrium.responses;
        Ok(next)
    }

    /// The distance over which the wear is like the penetration, on average: `k v dt P' = 1`.
    pub fn first_distance(&self) -> f64 {
        let law = |a: usize| &self.interface().points[a].law.normal_law;
        let ratio = |a: usize| self.weight(a) * self.rate(a) * law(a).initial_stiffness();
        let area: f64 = self.wearing().map(|a| self.weight(a)).sum();
        self.mean_speed * area / self.wearing().map(ratio).sum::<f64>()
    }

    /// How much a step has changed `p v`: `|b - a| / |b|` over the area that wears.
    pub fn change(&self, before: &State, after: &State) -> f64 {
        relative_change(&self.heating(before), &self.heating(after))
    }

    /// Pressure of a point, Pa.
    fn pressure(&self, a: usize, state: &State) -> f64 {
        state.responses[a].normal_force.max(0.0) / self.weight(a)
    }

    /// `sqrt(w) p v` of the points that wear.
    fn heating(&self, state: &State) -> Vec<f64> {
        self.wearing().map(|a| self.weight(a).sqrt() * self.pressure(a, state) * self.speeds[a]).collect()
    }

    /// Depth that a point has lost, m.
    fn depth(&self, a: usize, state: &State) -> f64 {
        state.gaps[a] - self.interface().points[a].law.gap
    }

    /// Numbers of the pairs that wear.
    fn wearing_pairs(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.interface().pairs.len()).filter(|&i| self.interface().pairs[i].wear.is_some())
    }

    /// What has been worn off, and how the pairs wear now.
    pub fn measured(&self, state: &State) -> WearStep {
        WearStep { distance: state.distance, pairs: self.wearing_pairs().map(|i| self.pair(i, state)).collect() }
    }

    fn pair(&self, i: usize, state: &State) -> PairWear {
        let pair = &self.interface().pairs[i];
        let points = || pair.points.clone();
        let weight = |a: usize| self.weight(a);
        let heating = |a: usize| self.pressure(a, state) * self.speeds[a];
        let area: f64 = points().map(weight).sum();
        let mean = points().map(|a| weight(a) * heating(a)).sum::<f64>() / area;
        let variance = points().map(|a| weight(a) * (heating(a) - mean).powi(2)).sum::<f64>() / area;
        let volume = points().map(|a| weight(a) * self.depth(a, state)).sum::<f64>();
        PairWear {
            pair: pair.name.clone(),
            mean,
            spread: if mean > 0.0 { variance.sqrt() / mean } else { 0.0 },
            smallest: points().map(heating).fold(f64::INFINITY, f64::min),
            largest: points().map(heating).fold(0.0, f64::max),
            pressure: points().map(|a| self.pressure(a, state)).fold(0.0, f64::max),
            depth: points().map(|a| self.depth(a, state)).fold(0.0, f64::max),
            volume,
            archard_volume: state.archard[i],
            mass: pair.wear.map_or(0.0, |wear| wear.density) * volume,
        }
    }

    /// The points of the pairs that wear, by place, which is the same on any number of ranks.
    pub fn points(&self, before: &State, after: &State) -> Vec<WornPoint> {
        self.wearing_pairs().flat_map(|i| self.points_of(i, before, after)).collect()
    }

    fn points_of(&self, pair: usize, before: &State, after: &State) -> Vec<WornPoint> {
        let own = &self.interface().pairs[pair];
        let point = |a: usize| {
            let point = &self.interface().points[a];
            let ([x_m, y_m, z_m], wear_m) = (point.position, self.depth(a, after));
            WornPoint {
                contact: own.name.clone(),
                x_m,
                y_m,
                z_m,
                gap_m: point.field_gap + wear_m,
                wear_m,
                area_m2: self.weight(a),
                speed_m_per_s: self.speeds[a],
                pressure_before_pa: self.pressure(a, before),
                pressure_pa: self.pressure(a, after),
            }
        };
        let mut points: Vec<WornPoint> = own.points.clone().map(point).collect();
        let place = |point: &WornPoint| [point.x_m, point.y_m, point.z_m];
        points.sort_by(|a, b| place(a).partial_cmp(&place(b)).expect("coordinates are numbers"));
        points
    }
}

/// `|b - a| / |b|`.
fn relative_change(a: &[f64], b: &[f64]) -> f64 {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| b - a)) / norm(&mut b.iter().copied()).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_relative_to_what_it_leads_to() {
        assert_eq!(relative_change(&[3.0, 4.0], &[3.0, 4.0]), 0.0);
        assert!((relative_change(&[3.0, 4.0], &[6.0, 8.0]) - 0.5).abs() < 1e-15);
        assert_eq!(relative_change(&[], &[]), 0.0);
    }
}
