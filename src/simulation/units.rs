//! Do the numbers of a scene fit together in some usual system of units?
//!
//! A script has no units. A density, a wave speed and gravity that are possible in no usual system
//! come from two of them; nothing is said as long as one system explains all numbers.

use super::Simulation;
use crate::output::number::{brief, text};

/// A system of units.
#[derive(Clone, Copy, Debug)]
struct System {
    /// Length, mass, time; then stress.
    name: &'static str,
    /// Its units in m, kg, s.
    length: f64,
    mass: f64,
    time: f64,
}

const fn system(name: &'static str, length: f64, mass: f64, time: f64) -> System {
    System { name, length, mass, time }
}

/// Systems that are used, the most usual ones first.
const SYSTEMS: [System; 12] = [
    system("m, kg, s (Pa)", 1.0, 1.0, 1.0),
    system("mm, t, s (MPa)", 1e-3, 1e3, 1.0),
    system("mm, kg, ms (GPa)", 1e-3, 1.0, 1e-3),
    system("mm, g, ms (MPa)", 1e-3, 1e-3, 1e-3),
    system("cm, g, us (Mbar)", 1e-2, 1e-3, 1e-6),
    system("cm, g, s", 1e-2, 1e-3, 1.0),
    system("mm, kg, s (kPa)", 1e-3, 1.0, 1.0),
    system("mm, mg, us (GPa)", 1e-3, 1e-6, 1e-6),
    system("m, t, s (kPa)", 1.0, 1e3, 1.0),
    system("m, kg, ms (MPa)", 1.0, 1.0, 1e-3),
    system("um, 1e-15 kg, ns (GPa)", 1e-6, 1e-15, 1e-9),
    system("in, lbf s^2/in, s (psi)", 0.0254, 175.126835, 1.0),
];

/// Gravity \[m/s^2\].
const GRAVITY: f64 = 9.80665;

/// What is known of a body, in units of the script.
#[derive(Clone, Debug)]
struct Body {
    name: String,
    density: f64,
    wave_speed: f64,
}

impl System {
    fn density(&self, value: f64) -> f64 {
        value * self.mass / self.length.powi(3)
    }

    fn speed(&self, value: f64) -> f64 {
        value * self.length / self.time
    }

    fn stress(&self, value: f64) -> f64 {
        value * self.mass / (self.length * self.time * self.time)
    }

    fn gravity(&self) -> f64 {
        GRAVITY * self.time * self.time / self.length
    }

    /// Between a thin gas and the heaviest metal, and waves slower than in diamond.
    fn explains(&self, body: &Body) -> bool {
        (0.01..3e4).contains(&self.density(body.density)) && self.speed(body.wave_speed) < 2.5e4
    }

    /// Is the density that of solids and liquids?
    fn is_condensed(&self, body: &Body) -> bool {
        (10.0..2.5e4).contains(&self.density(body.density))
    }

    fn has_gravity(&self, gravity: f64) -> bool {
        (gravity / self.gravity() - 1.0).abs() < 0.003
    }
}

/// Is the number that of the earth's gravity in some system? Others may be anything.
fn is_earths(gravity: f64) -> bool {
    SYSTEMS.iter().any(|system| system.has_gravity(gravity))
}

/// What does not fit together; `None` as long as one system explains everything.
fn hint(bodies: &[Body], gravity: Option<f64>) -> Option<String> {
    let explains = |system: &&System| bodies.iter().all(|body| system.explains(body));
    let fitting: Vec<&System> = SYSTEMS.iter().filter(explains).collect();
    let gravity = gravity.filter(|value| is_earths(*value));
    if !fitting.is_empty() {
        let gravity = gravity.filter(|value| !fitting.iter().any(|s| s.has_gravity(*value)))?;
        let body = bodies.first()?;
        let condensed = |system: &&&System| system.is_condensed(body);
        let likely = fitting.iter().find(condensed).or(fitting.first())?;
        return Some(format!(
            "density {} and wave speed {:.3e} look like {}, where gravity is {}, not {gravity}",
            text(body.density),
            body.wave_speed,
            likely.name,
            brief(likely.gravity())
        ));
    }
    let lonely = |body: &&Body| !SYSTEMS.iter().any(|system| system.explains(body));
    let Some(body) = bodies.iter().find(lonely) else {
        let [first, .., last] = bodies else { return None };
        let own = |body: &Body| SYSTEMS.iter().find(|s| s.explains(body) && s.is_condensed(body));
        let name = |body: &Body| own(body).map_or("another system", |system| system.name);
        return Some(format!(
            "no usual system explains all solids: density {} of `{}` looks like {}, density {} of `{}` like {}",
            text(first.density),
            first.name,
            name(first),
            text(last.density),
            last.name,
            name(last)
        ));
    };
    let stiffness = body.density * body.wave_speed * body.wave_speed;
    let system = SYSTEMS.iter().find(|system| system.is_condensed(body));
    Some(match system {
        Some(system) => format!(
            "density {} of `{}` looks like {} ({:.0} kg/m^3), but its stiffness of {stiffness:.3e} would be \
             {:.1e} Pa then, with waves of {:.1e} m/s",
            text(body.density),
            body.name,
            system.name,
            system.density(body.density),
            system.stress(stiffness),
            system.speed(body.wave_speed)
        ),
        None => format!(
            "density {} and wave speed {:.3e} of `{}` are possible in no usual system of units",
            text(body.density),
            body.wave_speed,
            body.name
        ),
    })
}

impl Simulation {
    /// What does not fit together in the units of the scene, if anything.
    pub fn unit_hint(&self) -> Option<String> {
        let solids = self.world.solids.iter().filter(|solid| !solid.rigid);
        let body = |solid: &crate::world::Solid| Body {
            name: solid.name.clone(),
            density: solid.law.density(),
            wave_speed: solid.law.reference_wave_speed(),
        };
        let bodies: Vec<Body> = solids.map(body).filter(|body| body.density > 0.0).collect();
        let mut accelerations =
            self.fixes.iter().filter_map(|(_, fix)| fix.constant_acceleration());
        hint(&bodies, accelerations.next_back())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(density: f64, stiffness: f64) -> Body {
        Body { name: "bar".to_string(), density, wave_speed: (stiffness / density).sqrt() }
    }

    #[test]
    fn steel_water_and_air_are_silent_in_every_system_with_its_gravity() {
        for system in SYSTEMS {
            for (density, stiffness) in [(7850.0, 2.8e11), (1000.0, 2.2e9), (1.2, 1.4e5)] {
                let here = body(density / system.density(1.0), stiffness / system.stress(1.0));
                for gravity in [None, Some(system.gravity()), Some(3.0), Some(0.0)] {
                    assert_eq!(hint(std::slice::from_ref(&here), gravity), None, "{}", system.name);
                }
            }
        }
    }

    #[test]
    fn scenes_without_units_are_silent() {
        for (density, stiffness) in [(1.0, 1.0), (1.0, 1e4), (1.0, 100.0), (1000.0, 1.0)] {
            assert_eq!(hint(&[body(density, stiffness)], Some(1.0)), None);
        }
        assert_eq!(hint(&[], Some(9.81)), None);
    }

    #[test]
    fn steel_of_two_systems_is_told() {
        // Tonnes and millimetres, but pascals.
        let told = hint(&[body(7.85e-9, 2.8e11)], None).unwrap();
        assert!(told.contains("looks like mm, t, s (MPa) (7850 kg/m^3)"), "{told}");
        assert!(told.contains("2.8e17 Pa"), "{told}");
        let nonsense = hint(&[body(1e-30, 1.0)], None).unwrap();
        assert!(nonsense.contains("possible in no usual system"), "{nonsense}");
    }

    #[test]
    fn gravity_of_another_system_is_told() {
        let told = hint(&[body(7.85e-9, 2.8e5)], Some(9.81)).unwrap();
        assert!(told.contains("mm, t, s (MPa), where gravity is 9806.65, not 9.81"), "{told}");
        assert_eq!(hint(&[body(7.85e-9, 2.8e5)], Some(9810.0)), None);
    }

    #[test]
    fn solids_of_two_systems_are_told() {
        let told = hint(&[body(7.85e-9, 2.8e5), body(7850.0, 2.8e11)], None).unwrap();
        assert!(told.contains("no usual system explains all solids"), "{told}");
    }
}
