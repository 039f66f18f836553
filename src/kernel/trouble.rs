//! Particles in trouble, for `watch`: bounds on J, |v|, the strain of a step, and finite stresses.
//!
//! All of a chunk are looked at together and four at a time, with a bound on components of v that is at
//! least as strict; only if that fails are they looked at one by one.

use super::chunk::Scratch;
use crate::material::state::STRESS;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::plan::Trouble;

/// The first particle of a chunk in trouble; `wave`: wave speed of the undeformed material \[L/T\].
pub fn first(
    scratch: &Scratch,
    velocity: &[[f64; 4]],
    trouble: &Trouble,
    wave: f64,
    dt: f64,
) -> Option<usize> {
    let bounds = Bounds {
        volume: trouble.volume,
        speed: (trouble.speed * wave).powi(2),
        rate: (trouble.strain / dt).powi(2),
    };
    let alive = dispatch(Look { scratch, velocity, bounds });
    if alive { None } else { (0..scratch.state.len).find(|p| !bounds.hold(scratch, velocity, *p)) }
}

/// Bounds on J, |v|^2 and ||L||^2.
#[derive(Clone, Copy)]
struct Bounds {
    volume: f64,
    speed: f64,
    rate: f64,
}

impl Bounds {
    /// Do they hold for one particle?
    fn hold(&self, scratch: &Scratch, velocity: &[[f64; 4]], p: usize) -> bool {
        let Scratch { state, gradient, .. } = scratch;
        let j = state.value(Column::J, p);
        let [x, y, z, _] = velocity[p];
        let rate: f64 = gradient.iter().map(|lane| lane[p / 4][p % 4].powi(2)).sum();
        let stress: f64 = STRESS.iter().map(|column| state.value(*column, p)).sum();
        j * self.volume >= 1.0
            && j <= self.volume
            && x * x + y * y + z * z <= self.speed
            && rate <= self.rate
            && stress.is_finite()
    }
}

/// Is all well?
struct Look<'a> {
    scratch: &'a Scratch,
    velocity: &'a [[f64; 4]],
    bounds: Bounds,
}

impl Sweep for Look<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Wide>(self) -> bool {
        let Scratch { state, gradient, .. } = self.scratch;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let (mut least, mut largest, mut rate, mut odd) = (one, one, zero, zero);
        for group in state.groups() {
            let j = state.four::<V>(Column::J, group);
            let mut square = zero;
            for entry in gradient {
                let part = V::load(&entry[group]);
                square = part.mul_add(part, square);
            }
            let mut sum = j + square;
            let stress: [V; 6] = state.fours(STRESS, group);
            for entry in stress {
                sum = sum + entry;
            }
            // What is not finite stays so when it is multiplied by 0.
            odd = sum.mul_add(zero, odd);
            (least, largest) = (least.smaller(j), largest.larger(j));
            rate = rate.larger(square);
        }
        let mut fastest = zero;
        for v in self.velocity {
            let v = V::load(v);
            odd = v.mul_add(zero, odd);
            fastest = v.absolute().larger(fastest);
        }
        let ([x, y, z, _], odd) = (fastest.array(), odd.array());
        let [least, largest, rate] = [least.array(), largest.array(), rate.array()];
        let Bounds { volume, speed, rate: bound } = self.bounds;
        odd == [0.0; 4]
            && least.iter().all(|j| j * volume >= 1.0)
            && largest.iter().all(|j| *j <= volume)
            && rate.iter().all(|square| *square <= bound)
            && x * x + y * y + z * z <= speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::LANES;

    fn chunk() -> (Box<Scratch>, [[f64; 4]; LANES]) {
        let mut scratch = Box::<Scratch>::default();
        (scratch.state.dimension, scratch.state.len) = (2, 7);
        for p in 0..LANES {
            scratch.state.set_value(Column::J, p, 1.0);
        }
        (scratch, [[3.0, 4.0, 0.0, 1e9]; LANES])
    }

    fn found(scratch: &Scratch, velocity: &[[f64; 4]]) -> Option<usize> {
        let trouble = Trouble { volume: 10.0, speed: 2.0, strain: 0.5 };
        first(scratch, &velocity[..7], &trouble, 3.0, 0.1)
    }

    #[test]
    fn each_bound_names_the_particle_that_breaks_it() {
        let (scratch, velocity) = chunk();
        assert_eq!(found(&scratch, &velocity), None);
        for (j, seen) in [(9.9, None), (10.1, Some(5)), (0.11, None), (0.09, Some(5))] {
            let (mut scratch, velocity) = chunk();
            scratch.state.set_value(Column::J, 5, j);
            assert_eq!(found(&scratch, &velocity), seen, "J = {j}");
        }
        for (v, seen) in [(5.9, None), (6.1, Some(2)), (f64::NAN, Some(2))] {
            let (scratch, mut velocity) = chunk();
            velocity[2] = [0.0, v, 0.0, 0.0];
            assert_eq!(found(&scratch, &velocity), seen, "v = {v}");
        }
        for (rate, seen) in [(4.9, None), (-5.1, Some(6)), (f64::NAN, Some(6))] {
            let (mut scratch, velocity) = chunk();
            scratch.gradient[3][1][2] = rate;
            assert_eq!(found(&scratch, &velocity), seen, "L = {rate}");
        }
        let (mut scratch, velocity) = chunk();
        scratch.state.set_value(Column::S12, 4, f64::INFINITY);
        assert_eq!(found(&scratch, &velocity), Some(4));
    }

    #[test]
    fn what_lies_in_lanes_without_a_particle_does_not_count() {
        let (mut scratch, velocity) = chunk();
        scratch.state.set_value(Column::J, 7, f64::NAN);
        assert_eq!(found(&scratch, &velocity), None);
    }
}
