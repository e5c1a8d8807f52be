//! Systems of units of decks, which name none: found from densities and moduli, or named.

use super::names;

/// A consistent system of units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitSystem {
    /// What it is called: length, mass, time.
    pub name: &'static str,
    /// Metres.
    pub length: f64,
    /// Kilograms.
    pub mass: f64,
    /// Seconds.
    pub time: f64,
}

/// Young's moduli of solids, from rubber to above diamond, Pa.
const YOUNG: [f64; 2] = [1e6, 1e12];
/// Densities of what brakes are made of, kg/m3.
const DENSITY: [f64; 2] = [500.0, 2.5e4];

/// lbf s2/in in kg.
const LBF_S2_PER_INCH: f64 = 175.126_835_246_476_6;

impl UnitSystem {
    /// The systems in use, the most common ones first.
    pub const ALL: [UnitSystem; 7] = [
        UnitSystem { name: "mm-t-s", length: 1e-3, mass: 1e3, time: 1.0 },
        UnitSystem { name: "m-kg-s", length: 1.0, mass: 1.0, time: 1.0 },
        UnitSystem { name: "mm-kg-ms", length: 1e-3, mass: 1.0, time: 1e-3 },
        UnitSystem { name: "mm-g-ms", length: 1e-3, mass: 1e-3, time: 1e-3 },
        UnitSystem { name: "mm-kg-s", length: 1e-3, mass: 1.0, time: 1.0 },
        UnitSystem { name: "cm-g-s", length: 1e-2, mass: 1e-3, time: 1.0 },
        UnitSystem { name: "in-lbf-s", length: 0.0254, mass: LBF_S2_PER_INCH, time: 1.0 },
    ];

    /// The system with a name, or what to give instead.
    ///
    /// # Errors
    /// Advice for a name that is none of them.
    pub fn named(name: &str) -> Result<UnitSystem, String> {
        let found = UnitSystem::ALL.into_iter().find(|system| system.name == name);
        found.ok_or_else(|| names::advice(name, UnitSystem::ALL.map(|system| system.name)))
    }

    /// The systems in which all materials, given by their stiffness and, where they have one, density, are solids that
    /// brakes are made of, `1e6 <= E <= 1e12 Pa` and `500 <= rho <= 2.5e4 kg/m3`; lengths are as in `length` (m) where
    /// that is known.
    pub fn fitting(materials: &[(f64, Option<f64>)], length: Option<f64>) -> Vec<UnitSystem> {
        let is_inside = |x: f64, [low, high]: [f64; 2]| (low..=high).contains(&x);
        let fits = |system: &UnitSystem| {
            let all = materials.iter().all(|(young, density)| {
                is_inside(young * system.stress(), YOUNG)
                    && density.is_none_or(|density| is_inside(density * system.density(), DENSITY))
            });
            all && length.is_none_or(|length| length == system.length)
        };
        UnitSystem::ALL.into_iter().filter(fits).collect()
    }

    /// kg/m3
    pub fn density(&self) -> f64 {
        self.mass / self.length.powi(3)
    }

    /// m/s2
    pub fn acceleration(&self) -> f64 {
        self.length / self.time.powi(2)
    }

    /// N
    pub fn force(&self) -> f64 {
        self.mass * self.length / self.time.powi(2)
    }

    /// Pa
    pub fn stress(&self) -> f64 {
        self.mass / (self.length * self.time.powi(2))
    }

    /// Stiffness of a contact, N/m3.
    pub fn foundation(&self) -> f64 {
        self.stress() / self.length
    }

    /// Stiffness of a spring, N/m.
    pub fn stiffness(&self) -> f64 {
        self.mass / self.time.powi(2)
    }

    /// Stiffness against rotation, N m/rad.
    pub fn rotational_stiffness(&self) -> f64 {
        self.stiffness() * self.length.powi(2)
    }

    /// Constant of a dashpot, N s/m.
    pub fn damping(&self) -> f64 {
        self.mass / self.time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steel, grey cast iron and a lining, Pa and kg/m3.
    const BRAKE: [[f64; 2]; 3] = [[210e9, 7850.0], [110e9, 7100.0], [1.5e9, 2600.0]];

    #[test]
    fn a_brake_in_any_system_fits_that_system_alone() {
        for system in UnitSystem::ALL {
            let materials = BRAKE.map(|[young, density]| (young / system.stress(), Some(density / system.density())));
            let names: Vec<&str> = UnitSystem::fitting(&materials, None).iter().map(|system| system.name).collect();
            assert_eq!(names, [system.name]);
            assert_eq!(UnitSystem::named(system.name).unwrap(), system);
            let other = if system.length == 1.0 { 1e-3 } else { 1.0 };
            assert!(UnitSystem::fitting(&materials, Some(other)).is_empty());
            let without_density = materials.map(|(young, _)| (young, None));
            assert!(UnitSystem::fitting(&without_density, None).contains(&system));
        }
    }

    #[test]
    fn derived_units_are_known_ones() {
        let [millimetres, _, milliseconds, .., inches] = UnitSystem::ALL;
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        close(millimetres.force(), 1.0);
        close(millimetres.stress(), 1e6);
        close(millimetres.density(), 1e12);
        close(millimetres.foundation(), 1e9);
        close(millimetres.rotational_stiffness(), 1e-3);
        close(milliseconds.stress(), 1e9);
        close(milliseconds.force(), 1e3);
        close(milliseconds.damping(), 1e3);
        close(inches.force(), 4.448_221_615_260_5);
        assert!(UnitSystem::named("mm").unwrap_err().contains("mm-t-s"));
    }
}
