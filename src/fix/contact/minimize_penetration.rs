//! Contact that takes penetrations back within a step, with Coulomb friction.

use super::{Contact, ContactStyle};
use crate::fix::BuildFix;
use crate::kernel::pairs::{Pair, PairLaw, Response};
use crate::style::Style;
use crate::world::Solid;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "contact/minimize_penetration",
    usage: "s1, s2, mu",
    summary: "contact of the particles of two solids without overlap, with friction",
    manual: "\
H1, for particles of s1 and s2 that overlap: R = V^(1/d)/2, pen = R1 + R2 - r > 0. Force on 1 along
n from 2 to 1: F = m12 pen/dt^2, m12 = m1 m2/(m1 + m2), a rigid partner counts as infinite mass; dt is
the longest step since the solids met: springs that stiffen while dt falls would give energy.
Friction: min(mu F, m12 |v_t|/dt) against the relative tangential velocity v_t, mu >= 0. Its work
heats both solids, in shares of their conductivities (halves if both are 0), where a temperature is
stored.
Publishes the force on s1 in ID_x, ID_y, ID_z, the heat of friction so far in ID_s.
Source: Karamelo's rule; Coulomb's law.",
    build: Some(|args, target| {
        let friction = args.within("the coefficient of friction mu", 0.0, f64::INFINITY)?.value;
        Ok(Box::new(Contact::new(target, MinimizePenetration { friction })))
    }),
};

/// F = m12 pen/dt^2 and Coulomb friction.
///
/// The pairs are springs of stiffness m12/dt^2. An adaptive dt falls while bodies are squeezed
/// together and grows when they part; springs that follow it are stiffer on the way out than on the
/// way in and give energy to the bodies, half of it in some impacts. With the longest dt since the
/// bodies met they only soften. With a constant dt it is that dt.
#[derive(Clone, Copy, Debug)]
pub struct MinimizePenetration {
    /// mu.
    pub friction: f64,
}

impl ContactStyle for MinimizePenetration {
    type Law = Impulse;

    fn law(&self, _solids: [&Solid; 2], dt: f64, longest: f64) -> Impulse {
        Impulse { friction: self.friction, inverse_dt: 1.0 / dt, inverse_longest: 1.0 / longest }
    }
}

/// The law of a pair in a step.
#[derive(Clone, Copy, Debug)]
pub struct Impulse {
    /// mu.
    pub friction: f64,
    /// 1/dt \[1/T\].
    pub inverse_dt: f64,
    /// 1/(longest dt since the solids met) \[1/T\].
    pub inverse_longest: f64,
}

impl PairLaw for Impulse {
    fn respond(&self, pair: &Pair) -> Response {
        let Pair { normal: n, velocity: v, penetration, .. } = *pair;
        let push = pair.reduced_mass * penetration * self.inverse_longest.powi(2);
        let along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
        let slip: [f64; 3] = std::array::from_fn(|axis| v[axis] - along * n[axis]);
        let speed = (slip[0] * slip[0] + slip[1] * slip[1] + slip[2] * slip[2]).sqrt();
        let stop = pair.reduced_mass * speed * self.inverse_dt;
        let slides = self.friction * push < stop;
        let drag = if slides { self.friction * push } else { stop };
        let per_speed = if speed > 0.0 { drag / speed } else { 0.0 };
        Response {
            force: std::array::from_fn(|axis| push * n[axis] - per_speed * slip[axis]),
            // A pair that is stopped has slipped with half its velocity in the mean.
            friction: if slides { drag * speed } else { 0.5 * drag * speed },
            rate: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(velocity: [f64; 3]) -> Pair {
        Pair {
            normal: [0.0, 1.0, 0.0],
            penetration: 0.01,
            radii: [0.5; 2],
            reduced_mass: 2.0,
            smallest_mass: 4.0,
            velocity,
        }
    }

    const LAW: Impulse = Impulse { friction: 0.3, inverse_dt: 10.0, inverse_longest: 10.0 };

    #[test]
    fn the_push_takes_the_penetration_back_in_one_step() {
        let Response { force, friction, .. } = LAW.respond(&pair([0.0, -1.0, 0.0]));
        // F dt^2/m12 = pen.
        assert_eq!((force, friction), ([0.0, 2.0, 0.0], 0.0));
    }

    #[test]
    fn the_push_does_not_grow_when_the_step_shrinks() {
        let shorter = Impulse { inverse_dt: 20.0, ..LAW };
        let moving = pair([0.0, -1.0, 0.0]);
        assert_eq!(shorter.respond(&moving).force, LAW.respond(&moving).force);
        // What stops a slip within the step does.
        let slow = pair([1e-3, 0.0, 0.0]);
        assert_eq!(shorter.respond(&slow).force[0], 2.0 * LAW.respond(&slow).force[0]);
    }

    #[test]
    fn friction_is_coulombs_and_opposes_the_slip() {
        let Response { force, friction, .. } = LAW.respond(&pair([3.0, -1.0, 4.0]));
        let drag = 0.3 * 2.0;
        let exact = [-drag * 0.6, 2.0, -drag * 0.8];
        assert!((0..3).all(|a| (force[a] - exact[a]).abs() < 1e-15), "{force:?}");
        assert!((friction - 5.0 * drag).abs() < 1e-14);
    }

    #[test]
    fn friction_stops_a_slip_but_does_not_reverse_it() {
        let slip = 0.02;
        let Response { force, friction, .. } = LAW.respond(&pair([slip, 0.0, 0.0]));
        // dt F/m12 = -v_t, and the work is the energy m12 v_t^2/2 in the step of 0.1.
        assert!((force[0] * 0.1 / 2.0 + slip).abs() < 1e-16);
        assert!((friction * 0.1 - 0.5 * 2.0 * slip * slip).abs() < 1e-16);
    }
}
