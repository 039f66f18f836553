//! Velocity gradients, stress and movement of the particles, and P2G of the next step.

use super::by_dimension;
use super::scatter::{Parcel, STRESS, force, scatter_one};
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use super::tiles::{Report, Tiles};
use crate::material::{Chunk, LANES, Lane, Law, StressRate, View};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::{COLUMNS, Column};
use crate::model::grid::Node;
use crate::shape::Shape;
use crate::world::{Solid, World};
use std::cell::RefCell;
use std::marker::PhantomData;
use std::ops::Range;

/// Options of the sweep.
#[derive(Clone, Copy, Debug)]
pub struct Stress {
    /// Size of the step \[T\].
    pub dt: f64,
    /// The adaptive dt needs wave speeds and rates.
    pub time_step: bool,
    /// Also scatter mass, momentum and force of the next step.
    pub scatter: bool,
}

/// Line 15 of language.md 7.1 and x += dx for every particle, in chunks of one law:
/// L = sum v (x) grad N at the old place; F, J, stress; then, if asked to, P2G at the new place.
pub fn sweep(tiles: &mut Tiles, world: &mut World, frame: &Frame, options: Stress) -> Report {
    by_dimension!(world.domain.dimension, sweep_of, tiles, world, frame, options)
}

/// Memory that the tiles write, each its part.
struct Lent<'a> {
    position: Shared<'a, [f64; 4]>,
    columns: [Shared<'a, f64>; COLUMNS],
    nodes: Shared<'a, Node>,
}

fn sweep_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    world: &mut World,
    frame: &Frame,
    options: Stress,
) -> Report {
    let World { particles, grid, solids, rate, .. } = world;
    let (velocity, displacement, solid) =
        (&particles.velocity, &particles.displacement, &particles.solid);
    let mut columns = particles.columns.iter_mut();
    let lent = Lent {
        position: Shared::new(&mut particles.position),
        columns: std::array::from_fn(|_| Shared::new(columns.next().map_or(&mut [], |c| c))),
        nodes: Shared::new(&mut grid.nodes),
    };
    let mapped = &grid.mapped;
    tiles.sweep(|range, report| {
        GRADIENT.with_borrow_mut(|gradient| {
            for range in of_one_solid(range, solid) {
                // SAFETY: the ranges of the tiles do not overlap, so each particle has one writer.
                let (position, columns) = unsafe {
                    let columns = lent.columns.each_ref().map(|column| match column.is_empty() {
                        true => &mut [][..],
                        false => column.part(range.clone()),
                    });
                    (lent.position.part(range.clone()), columns)
                };
                dispatch(Part::<'_, D, W, S> {
                    first: range.start,
                    law: &*solids[solid[range.start] as usize].law,
                    rate: *rate,
                    position,
                    velocity: &velocity[range.clone()],
                    displacement: &displacement[range],
                    columns,
                    gradient,
                    mapped,
                    nodes: lent.nodes,
                    frame: *frame,
                    options,
                    report,
                    shape: PhantomData,
                });
            }
        })
    })
}

thread_local! {
    /// The velocity gradients of the chunk a thread is at.
    static GRADIENT: RefCell<[Lane; 9]> = const { RefCell::new([[0.0; LANES]; 9]) };
}

static ZERO: Lane = [0.0; LANES];

/// The entries of L in D dimensions; the others are 0.
#[inline(always)]
fn plane<const D: usize>(gradient: &[Lane; 9]) -> [&Lane; 9] {
    std::array::from_fn(|entry| if in_space::<D>(entry) { &gradient[entry] } else { &ZERO })
}

/// The larger of two numbers, in one instruction; a number that is not one never wins.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Does entry 3 i + j of a tensor lie in the D dimensions?
#[inline(always)]
const fn in_space<const D: usize>(entry: usize) -> bool {
    entry / 3 < D && entry % 3 < D
}

/// Cuts a range into chunks of at most [`LANES`] particles of one solid.
fn of_one_solid(range: Range<usize>, solid: &[u16]) -> impl Iterator<Item = Range<usize>> {
    let mut start = range.start;
    std::iter::from_fn(move || {
        if start == range.end {
            return None;
        }
        let limit = range.end.min(start + LANES);
        // Within a tile the particles are sorted by solid.
        let first = solid[start];
        let end = start + solid[start..limit].partition_point(|other| *other == first);
        let chunk = start..end;
        start = end;
        Some(chunk)
    })
}

/// One chunk.
struct Part<'a, const D: usize, const W: usize, S> {
    first: usize,
    law: &'a dyn Law,
    rate: StressRate,
    position: &'a mut [[f64; 4]],
    velocity: &'a [[f64; 4]],
    displacement: &'a [[f64; 4]],
    columns: [&'a mut [f64]; COLUMNS],
    gradient: &'a mut [Lane; 9],
    mapped: &'a [[f64; 4]],
    nodes: Shared<'a, Node>,
    frame: Frame,
    options: Stress,
    report: &'a mut Report,
    shape: PhantomData<S>,
}

impl<const D: usize, const W: usize, S: Shape<W>> Sweep for Part<'_, D, W, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(mut self) {
        self.gradients::<V>();
        self.stress();
        self.advance::<V>();
    }
}

impl<const D: usize, const W: usize, S: Shape<W>> Part<'_, D, W, S> {
    /// L of every particle at its old place.
    #[inline(always)]
    fn gradients<V: Wide>(&mut self) {
        let (frame, mapped) = (self.frame, self.mapped);
        let inverse_cell = V::splat(frame.inverse_cell);
        for (p, position) in self.position.iter().enumerate() {
            let stencil = frame.stencil::<V, D, W, S>(V::load(position));
            let columns = gradient_of::<V, D, W>(&stencil, mapped);
            for (j, column) in columns.into_iter().enumerate() {
                let column = (column * inverse_cell).array();
                for i in 0..D {
                    self.gradient[3 * i + j][p] = column[i];
                }
            }
        }
    }

    /// The law's turn; then what the time step needs.
    #[inline(always)]
    fn stress(&mut self) {
        let len = self.position.len();
        let mut chunk = Chunk {
            dimension: D,
            dt: self.options.dt,
            rate: self.rate,
            gradient: plane::<D>(self.gradient),
            columns: self.columns.each_mut().map(|column| &mut **column),
            len,
            failed: None,
        };
        self.law.update(&mut chunk);
        if let Some(failed) = chunk.failed {
            self.report.failed.get_or_insert(self.first + failed);
        }
        if self.options.time_step {
            self.time_step(len);
        }
    }

    /// The fastest wave and the largest rate of the chunk.
    #[inline(always)]
    fn time_step(&mut self, len: usize) {
        let view = View { dimension: D, len, columns: self.columns.each_ref().map(|c| &**c) };
        let mut speed = [0.0; LANES];
        self.law.wave_speed(&view, &mut speed);
        let mut fastest = self.report.fastest;
        for (wave, v) in speed.iter().zip(self.velocity) {
            let particle = v[..D].iter().fold(0.0, |largest, v| larger(largest, v.abs()));
            fastest = larger(fastest, wave + particle);
        }
        self.report.fastest = fastest;
        let mut squares = [0.0; LANES];
        for entry in (0..9).filter(|entry| in_space::<D>(*entry)) {
            for (square, rate) in squares.iter_mut().zip(&self.gradient[entry]) {
                *square += rate * rate;
            }
        }
        self.report.rate = squares[..len].iter().fold(self.report.rate, |a, b| larger(a, *b));
    }

    /// x += dx, then P2G of the next step.
    #[inline(always)]
    fn advance<V: Wide>(self) {
        let (frame, nodes, scatter) = (self.frame, self.nodes, self.options.scatter);
        let (lower, upper) = (V::load(&frame.lower), V::load(&frame.upper));
        let len = self.position.len();
        // All of one length, so that the loop needs no further checks.
        let position = &mut self.position[..len];
        let (velocity, displacement) = (&self.velocity[..len], &self.displacement[..len]);
        let jacobian = &self.columns[Column::J as usize][..len];
        let stress: [&[f64]; 9] = std::array::from_fn(|entry| match in_space::<D>(entry) {
            true => &self.columns[STRESS[entry] as usize][..len],
            false => &[],
        });
        for p in 0..len {
            let place = V::load(&position[p]);
            let place = (place + V::load(&displacement[p])).with_last(place);
            place.store(&mut position[p]);
            if !place.inside(lower, upper) {
                self.report.escaped.get_or_insert(self.first + p);
                continue;
            }
            if !scatter {
                continue;
            }
            let stencil = frame.stencil::<V, D, W, S>(place);
            let volume = jacobian[p] * velocity[p][3] * frame.inverse_cell;
            let motion = V::load(&velocity[p]).with_last(V::splat(1.0));
            let parcel = Parcel {
                motion: V::splat(position[p][3]) * motion,
                force: force::<V, D>(volume, |entry| stress[entry][p]),
            };
            scatter_one(&stencil, &parcel, nodes);
        }
    }
}

/// sum v (x) dN/dr of one particle: column j is the derivative along axis j, in velocity per cell.
#[inline(always)]
fn gradient_of<V: Wide, const D: usize, const W: usize>(
    stencil: &Stencil<D, W>,
    mapped: &[[f64; 4]],
) -> [V; D] {
    let mut columns = [V::splat(0.0); D];
    for number in 0..Stencil::<D, W>::ROWS {
        let row = stencil.row(number);
        let nodes = &mapped[row.first..row.first + W];
        let (mut flat, mut steep) = (V::splat(0.0), V::splat(0.0));
        for (k, node) in nodes.iter().enumerate() {
            let node = V::load(node);
            flat = V::splat(stencil.value(k)).mul_add(node, flat);
            steep = V::splat(stencil.slope(k)).mul_add(node, steep);
        }
        for axis in 0..D - 1 {
            columns[axis] = V::splat(row.slope[axis]).mul_add(flat, columns[axis]);
        }
        columns[D - 1] = V::splat(row.value).mul_add(steep, columns[D - 1]);
    }
    columns
}

/// Wave speeds and rates are needed once more: before the first step of a run.
pub fn fastest(world: &World) -> f64 {
    let mut fastest: f64 = 0.0;
    let mut speed = [0.0; LANES];
    for (range, solid) in world.chunks() {
        let solid: &Solid = solid;
        solid.law.wave_speed(&world.view(range.clone()), &mut speed);
        for (speed, v) in speed.iter().zip(&world.particles.velocity[range]) {
            fastest = fastest.max(speed + v[0].abs().max(v[1].abs()).max(v[2].abs()));
        }
    }
    fastest
}
