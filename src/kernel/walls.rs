//! Particles about to leave the box: removed, or reflected (`boundary`).
//!
//! Reads places and displacements; only where a particle is about to leave are its displacement
//! and velocity changed, after all of its momentum has gone to the nodes of the step. Particles are
//! removed when they have left.

use crate::model::domain::Domain;
use crate::model::particles::Particles;
use crate::world::World;
use rayon::prelude::*;

/// Particles per task of the search.
const TASK: usize = 16_384;

/// Does a place lie outside the box?
fn outside(domain: &Domain, x: &[f64; 4], dx: &[f64; 4]) -> bool {
    (0..domain.dimension).any(|axis| {
        let place = x[axis] + dx[axis];
        !(place >= domain.lower[axis] && place <= domain.upper[axis])
    })
}

/// Is any particle about to leave the box?
pub fn any_outside(world: &World, parallel: bool) -> bool {
    let (domain, particles) = (&world.domain, &world.particles);
    let (position, displacement) = (&particles.position, &particles.displacement);
    let mut pairs = position.iter().zip(displacement);
    match parallel {
        false => pairs.any(|(x, dx)| outside(domain, x, dx)),
        true => position
            .par_chunks(TASK)
            .zip(displacement.par_chunks(TASK))
            .any(|(x, dx)| x.iter().zip(dx).any(|(x, dx)| outside(domain, x, dx))),
    }
}

/// Removes the particles that have left the box; gives their number. `keep` is memory to use.
pub fn remove(world: &mut World, keep: &mut Vec<bool>) -> u64 {
    let World { domain, particles, .. } = world;
    keep.clear();
    keep.extend(particles.position.iter().map(|x| !outside(domain, x, &[0.0; 4])));
    particles.retain(keep);
    keep.iter().filter(|keep| !**keep).count() as u64
}

/// Reflects the particles about to leave the box; gives their number.
///
/// On each axis where x + dx passes a wall w: x + dx <- 2 w - (x + dx), v <- -v.
pub fn bounce(world: &mut World) -> u64 {
    let World { domain, particles, .. } = world;
    let Particles { position, velocity, displacement, .. } = particles;
    let mut count = 0;
    for ((x, v), dx) in position.iter().zip(velocity).zip(displacement) {
        if !outside(domain, x, dx) {
            continue;
        }
        count += 1;
        for axis in 0..domain.dimension {
            let [low, high] = [domain.lower[axis], domain.upper[axis]];
            let place = x[axis] + dx[axis];
            let wall = place.clamp(low, high);
            if wall != place {
                // Farther than the box is wide no step goes that keeps a body whole.
                let mirrored = (2.0 * wall - place).clamp(low, high);
                dx[axis] = displacement_to(x[axis], mirrored, low, high);
                v[axis] = -v[axis];
            }
        }
    }
    count
}

/// dx with low <= x + dx <= high after rounding, as near to `place` as that allows.
fn displacement_to(x: f64, place: f64, low: f64, high: f64) -> f64 {
    let mut dx = place - x;
    while x + dx > high {
        dx = dx.next_down();
    }
    while x + dx < low {
        dx = dx.next_up();
    }
    dx
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_displacement_never_ends_outside() {
        for n in 1..2000 {
            let x = 0.1 / f64::from(n);
            let [low, high]: [f64; 2] = [0.0, 1.0 / 3.0];
            for place in [low, low.next_up(), 0.2, high.next_down(), high] {
                let end = x + displacement_to(x, place, low, high);
                assert!((low..=high).contains(&end) && (end - place).abs() < 1e-16);
            }
        }
    }
}
