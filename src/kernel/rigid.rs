//! Rigid bodies: the nodes they carry along, and what the material does to them.
//!
//! Sweeps of their own over the rigid particles, run by scenes that have some: the other kernels
//! see nothing of them but a node whose velocity is set.

use super::by_kind;
use super::points::of_one_solid;
use super::shared::Shared;
use super::stencil::Frame;
use super::support::{Footprint, Support};
use super::tiles::{SMALLEST_PARALLEL, Tiles};
use crate::math::v4::Plain;
use crate::math::v4::Wide;
use crate::model::grid::Grid;
use crate::model::particles::Particles;
use crate::world::World;
use rayon::prelude::*;

/// rigid <- (sum N V v_p/sum N V, sum N V) over rigid particles, zero elsewhere (language.md 7.3).
pub fn flag(tiles: &mut Tiles, world: &mut World) {
    let Grid { rigid, runs, .. } = &mut world.grid;
    for run in runs.iter() {
        rigid[run.clone()].fill([0.0; 4]);
    }
    by_kind!(world.domain.dimension, world.method.shape, flag_of, tiles, world);
    let Grid { rigid, runs, .. } = &mut world.grid;
    for node in runs.iter().cloned().flatten() {
        let weight = rigid[node][3];
        if weight > 0.0 {
            for velocity in &mut rigid[node][..3] {
                *velocity /= weight;
            }
        }
    }
    world.rigid.flagged = true;
}

fn flag_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) {
    let World { particles, grid, solids, .. } = world;
    let nodes = Shared::new(&mut grid.rigid);
    let records = F::part(&particles.domain, 0..particles.len());
    tiles.sweep_into(&[&nodes], |tile, _| {
        let (frame, places, mut memory) = (tile.frame, &particles.position, F::Memory::default());
        for range in of_one_solid(tile.range, &particles.solid) {
            if !solids[particles.solid[range.start] as usize].rigid {
                continue;
            }
            for p in range {
                let support = F::at::<Plain, false, false>(&mut memory, frame, places, &records, p);
                let [x, y, z, volume] = particles.velocity[p];
                let amount = [x, y, z, 1.0].map(|part| volume * part);
                support.add(Plain::load(&amount), nodes);
            }
        }
    });
}

/// v = v* = the rigid velocity on the flagged nodes, before any force is known (`usf`).
pub fn set_first(grid: &mut Grid) {
    each_flagged(grid, |grid, node| {
        let [x, y, z, _] = grid.rigid[node];
        grid.nodes[node].motion[..3].copy_from_slice(&[x, y, z]);
    });
}

/// v = v* = the rigid velocity v_r on the flagged nodes. Each rigid particle gets its share N V/sum N V
/// of the force of the material, f + mb - (1 - alpha) m (v_r - v)/dt: the forces that move no particle
/// because v* - v is 0, less what particles take of the new velocity. So the momentum they gain is
/// the impulse of the body, whatever their own velocities differ from v_r by.
/// The shares are handed out by [`react`].
pub fn set(grid: &mut Grid, axes: usize, dt: f64, alpha: f64) {
    each_flagged(grid, |grid, node| {
        let [x, y, z, weight] = grid.rigid[node];
        let (set, free) = ([x, y, z], &mut grid.nodes[node]);
        let share = free.motion[3] / (dt * weight);
        for axis in 0..3 {
            let jump = free.motion[axis] - set[axis];
            // Until the gathering the second mapping has no other use.
            grid.mapped[node][axis] = share * (alpha * free.change[axis] + (1.0 - alpha) * jump);
            free.motion[axis] = set[axis];
            free.change[axis] = 0.0;
        }
        if !grid.filtered.is_empty() {
            grid.held.extend((0..axes).map(|axis| (node, axis)));
        }
    });
}

/// Each rigid particle gets its share N V/sum N V of the forces on the flagged nodes.
pub fn react(tiles: &Tiles, world: &mut World) {
    by_kind!(world.domain.dimension, world.method.shape, react_of, &tiles.frames, world);
    each_flagged(&mut world.grid, |grid, node| grid.mapped[node] = [0.0; 4]);
}

/// The same velocity after the second mapping.
pub fn set_mapped(grid: &mut Grid) {
    each_flagged(grid, |grid, node| {
        let [x, y, z, _] = grid.rigid[node];
        grid.mapped[node] = [x, y, z, 0.0];
    });
}

fn each_flagged(grid: &mut Grid, visit: impl Fn(&mut Grid, usize)) {
    for run in 0..grid.runs.len() {
        for node in grid.runs[run].clone() {
            if grid.rigid[node][3] > 0.0 {
                visit(grid, node);
            }
        }
    }
}

fn react_of<const D: usize, F: Footprint<D>>(frames: &[Frame], world: &mut World) {
    let World { particles, solids, grid, rigid, .. } = world;
    let Particles { position, velocity, solid, domain, .. } = &*particles;
    let records = F::part(domain, 0..position.len());
    let mapped = &grid.mapped;
    let gather = |(reaction, p): (&mut [f64; 4], &u32)| {
        let p = *p as usize;
        let frame = &frames[solids[solid[p] as usize].lattice];
        let mut memory = F::Memory::default();
        let support = F::at::<Plain, false, false>(&mut memory, frame, position, &records, p);
        *reaction = support.sum::<Plain>(mapped).array().map(|sum| velocity[p][3] * sum);
    };
    if rigid.particles.len() >= SMALLEST_PARALLEL {
        rigid.reaction.par_iter_mut().zip(&rigid.particles).for_each(gather);
    } else {
        rigid.reaction.iter_mut().zip(&rigid.particles).for_each(gather);
    }
}

/// Puts the velocities of rigid particles aside, before the gathering.
pub fn keep(world: &mut World) {
    let World { particles, rigid, .. } = world;
    for (kept, p) in rigid.velocity.iter_mut().zip(&rigid.particles) {
        *kept = particles.velocity[*p as usize];
    }
}

/// Gives them back; dx = dt v_p. Returns the largest component of dx \[L\].
pub fn restore(world: &mut World, dt: f64) -> f64 {
    let World { particles, rigid, .. } = world;
    let mut farthest = 0.0f64;
    for (kept, p) in rigid.velocity.iter().zip(&rigid.particles) {
        particles.velocity[*p as usize] = *kept;
        let dx = &mut particles.displacement[*p as usize];
        for (dx, velocity) in dx[..3].iter_mut().zip(kept) {
            *dx = dt * velocity;
            farthest = farthest.max(dx.abs());
        }
    }
    farthest
}
