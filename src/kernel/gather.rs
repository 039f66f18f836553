//! G2P: particles take their new velocity from the grid, and give it back for the second mapping.

use super::by_dimension;
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use super::tiles::{Report, Tiles};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::grid::{Grid, Node};
use crate::model::particles::Particles;
use crate::shape::Shape;
use std::marker::PhantomData;
use std::ops::Range;

/// Numbers of the sweep.
#[derive(Clone, Copy, Debug)]
pub struct Gather {
    /// Size of the step \[T\].
    pub dt: f64,
    /// 1 is FLIP, 0 is PIC.
    pub alpha: f64,
    /// Also scatter m v for the second mapping.
    pub scatter: bool,
}

/// Lines 9, 11 and, if asked to, 13 of language.md 7.1, for every particle:
/// w = sum N v*, a dt = sum N (v* - v), dx = dt w, v <- (1 - alpha) w + alpha (v + a dt);
/// mapped += N m v.
pub fn sweep(
    tiles: &mut Tiles,
    particles: &mut Particles,
    grid: &mut Grid,
    dimension: usize,
    frame: &Frame,
    numbers: Gather,
) -> Report {
    by_dimension!(dimension, sweep_of, tiles, particles, grid, frame, numbers)
}

fn sweep_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    particles: &mut Particles,
    grid: &mut Grid,
    frame: &Frame,
    numbers: Gather,
) -> Report {
    let position = &particles.position;
    let velocity = Shared::new(&mut particles.velocity);
    let displacement = Shared::new(&mut particles.displacement);
    let mapped = Shared::new(&mut grid.mapped);
    let nodes = &grid.nodes;
    tiles.sweep(|range, report| {
        // SAFETY: the ranges of the tiles do not overlap, so each particle has one writer.
        let (velocity, displacement) =
            unsafe { (velocity.part(range.clone()), displacement.part(range.clone())) };
        dispatch(Tile::<'_, D, W, S> {
            position: &position[range],
            velocity,
            displacement,
            nodes,
            mapped,
            frame: *frame,
            numbers,
            report,
            shape: PhantomData,
        });
    })
}

struct Tile<'a, const D: usize, const W: usize, S> {
    position: &'a [[f64; 4]],
    velocity: &'a mut [[f64; 4]],
    displacement: &'a mut [[f64; 4]],
    nodes: &'a [Node],
    mapped: Shared<'a, [f64; 4]>,
    frame: Frame,
    numbers: Gather,
    report: &'a mut Report,
    shape: PhantomData<S>,
}

impl<const D: usize, const W: usize, S: Shape<W>> Sweep for Tile<'_, D, W, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        if self.numbers.scatter {
            self.particles::<V, true>();
        } else {
            self.particles::<V, false>();
        }
    }
}

impl<const D: usize, const W: usize, S: Shape<W>> Tile<'_, D, W, S> {
    #[inline(always)]
    fn particles<V: Wide, const SCATTER: bool>(self) {
        let Gather { dt, alpha, .. } = self.numbers;
        let (dt, flip, pic) = (V::splat(dt), V::splat(alpha), V::splat(1.0 - alpha));
        let (frame, nodes, mapped) = (self.frame, self.nodes, self.mapped);
        let (mut farthest, mut watch) = (V::splat(0.0), V::splat(0.0));
        let particles = self.position.iter().zip(self.velocity).zip(self.displacement);
        for ((position, velocity), displacement) in particles {
            let stencil = frame.stencil::<V, D, W, S>(V::load(position));
            let (mut w, mut a) = (V::splat(0.0), V::splat(0.0));
            for number in 0..Stencil::<D, W>::ROWS {
                let row = stencil.row(number);
                let nodes = &nodes[row.first..row.first + W];
                let (mut row_w, mut row_a) = (V::splat(0.0), V::splat(0.0));
                for (k, node) in nodes.iter().enumerate() {
                    let weight = V::splat(stencil.value(k));
                    row_w = weight.mul_add(V::load(&node.motion), row_w);
                    row_a = weight.mul_add(V::load(&node.change), row_a);
                }
                let weight = V::splat(row.value);
                w = weight.mul_add(row_w, w);
                a = weight.mul_add(row_a, a);
            }
            let old = V::load(velocity);
            let new = pic.mul_add(w, flip * (old + a));
            new.with_last(old).store(velocity);
            let dx = dt * w;
            dx.store(displacement);
            farthest = farthest.larger(dx.absolute());
            watch = watch + new;
            if SCATTER {
                scatter_one(&stencil, V::splat(position[3]) * new, mapped);
            }
        }
        let (far, sum) = (farthest.array(), watch.array());
        self.report.farthest = far[0].max(far[1]).max(far[2]);
        self.report.watch = sum[0] + sum[1] + sum[2];
    }
}

/// mapped += N m v for one particle.
#[inline(always)]
fn scatter_one<V: Wide, const D: usize, const W: usize>(
    stencil: &Stencil<D, W>,
    momentum: V,
    mapped: Shared<'_, [f64; 4]>,
) {
    for number in 0..Stencil::<D, W>::ROWS {
        let row = stencil.row(number);
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let nodes = unsafe { mapped.row::<W>(row.first) };
        let momentum = V::splat(row.value) * momentum;
        for (k, node) in nodes.iter_mut().enumerate() {
            V::splat(stencil.value(k)).mul_add(momentum, V::load(node)).store(node);
        }
    }
}

/// Line 13 alone: mapped += N m v, for steps whose fixes change particles after the gathering.
pub fn scatter_momentum(
    tiles: &mut Tiles,
    particles: &Particles,
    grid: &mut Grid,
    dimension: usize,
    frame: &Frame,
) {
    by_dimension!(dimension, scatter_of, tiles, particles, grid, frame);
}

fn scatter_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    particles: &Particles,
    grid: &mut Grid,
    frame: &Frame,
) {
    let mapped = Shared::new(&mut grid.mapped);
    tiles.sweep(|range: Range<usize>, _| {
        dispatch(Second::<'_, D, W, S> {
            position: &particles.position[range.clone()],
            velocity: &particles.velocity[range],
            mapped,
            frame: *frame,
            shape: PhantomData,
        });
    });
}

struct Second<'a, const D: usize, const W: usize, S> {
    position: &'a [[f64; 4]],
    velocity: &'a [[f64; 4]],
    mapped: Shared<'a, [f64; 4]>,
    frame: Frame,
    shape: PhantomData<S>,
}

impl<const D: usize, const W: usize, S: Shape<W>> Sweep for Second<'_, D, W, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        for (position, velocity) in self.position.iter().zip(self.velocity) {
            let stencil = self.frame.stencil::<V, D, W, S>(V::load(position));
            let momentum = V::splat(position[3]) * V::load(velocity);
            scatter_one(&stencil, momentum, self.mapped);
        }
    }
}
