//! G2P: particles take their new velocity from the grid, and give it back for the second mapping.

use super::by_kind;
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use super::tiles::{Report, Tiles};
use crate::math::v4::{Sweep, Wide, dispatch, splats};
use crate::model::grid::Node;
use crate::shape::Shape;
use crate::transfer::{Transfer, TransferKind};
use crate::world::World;
use std::marker::PhantomData;

/// How much of w = sum N v*, of the old velocity and of a dt = sum N (v* - v) makes a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mix {
    grid: f64,
    old: f64,
    change: f64,
}

/// Numbers of the sweep.
#[derive(Clone, Copy, Debug)]
pub struct Gather {
    dt: f64,
    velocity: Mix,
    /// x += dt v(new) in place of dt w.
    own_path: bool,
    /// C_p <- sum v* (x) (moment or gradient weights).
    affine: bool,
    /// Also scatter m v for the second mapping.
    scatter: bool,
}

impl Gather {
    /// The sweep of a transfer in a step of size dt.
    pub fn new(transfer: &Transfer, dt: f64, scatter: bool) -> Self {
        let alpha = transfer.blend(dt);
        let velocity = match transfer.kind {
            // The nodes hold v* and the filtered velocity less v: see `filter`.
            TransferKind::Xpic(_) => Mix { grid: 1.0, old: 0.0, change: 1.0 },
            _ => Mix { grid: 1.0 - alpha, old: alpha, change: alpha },
        };
        let own_path = transfer.kind == TransferKind::Asflip;
        Self { dt, velocity, own_path, affine: transfer.is_affine(), scatter }
    }
}

/// Lines 9, 11 and, if asked to, 13 of language.md 7.1, for every particle:
/// w = sum N v*, a dt = sum N (v* - v), dx = dt w, v <- (1 - alpha) w + alpha (v + a dt), C;
/// mapped += N m (v + C (x_I - x)).
pub fn sweep(tiles: &mut Tiles, world: &mut World, numbers: Gather) -> Report {
    by_kind!(world.domain.dimension, world.method.shape, sweep_of, tiles, world, numbers)
}

fn sweep_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    world: &mut World,
    numbers: Gather,
) -> Report {
    let World { particles, grid, method, .. } = world;
    let places = if method.total { &particles.reference } else { &particles.position };
    let velocity = Shared::new(&mut particles.velocity);
    let displacement = Shared::new(&mut particles.displacement);
    let mut columns = particles.matrix.iter_mut();
    let matrix: [Shared<'_, [f64; 4]>; 3] =
        std::array::from_fn(|_| Shared::new(columns.next().map_or(&mut [], |c| c)));
    let mapped = Shared::new(&mut grid.mapped);
    let nodes = &grid.nodes;
    tiles.sweep(|tile, report| {
        let range = tile.range;
        // SAFETY: the ranges of the tiles do not overlap, so each particle has one writer.
        let (velocity, displacement, matrix) = unsafe {
            let columns =
                matrix.each_ref().map(|column| match numbers.affine && !column.is_empty() {
                    true => column.part(range.clone()),
                    false => &mut [],
                });
            (velocity.part(range.clone()), displacement.part(range.clone()), columns)
        };
        dispatch(Part::<'_, D, W, S> {
            places: &places[range],
            velocity,
            displacement,
            matrix,
            nodes,
            mapped,
            frame: *tile.frame,
            numbers,
            report,
            shape: PhantomData,
        });
    })
}

struct Part<'a, const D: usize, const W: usize, S> {
    places: &'a [[f64; 4]],
    velocity: &'a mut [[f64; 4]],
    displacement: &'a mut [[f64; 4]],
    matrix: [&'a mut [[f64; 4]]; 3],
    nodes: &'a [Node],
    mapped: Shared<'a, [f64; 4]>,
    frame: Frame,
    numbers: Gather,
    report: &'a mut Report,
    shape: PhantomData<S>,
}

impl<const D: usize, const W: usize, S: Shape<W>> Sweep for Part<'_, D, W, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        match (self.numbers.scatter, self.numbers.affine) {
            (true, false) => self.particles::<V, true, false>(),
            (false, false) => self.particles::<V, false, false>(),
            (true, true) => self.particles::<V, true, true>(),
            (false, true) => self.particles::<V, false, true>(),
        }
    }
}

/// What a particle sees on the grid.
struct Gathered<V, const D: usize> {
    w: V,
    a: V,
    /// Columns of sum v* (x) weights, per node spacing.
    matrix: [V; D],
}

impl<const D: usize, const W: usize, S: Shape<W>> Part<'_, D, W, S> {
    #[inline(always)]
    fn particles<V: Wide, const SCATTER: bool, const AFFINE: bool>(self) {
        let Self { places, velocity, displacement, matrix, nodes, mapped, frame, .. } = self;
        let Gather { velocity: mix, own_path, .. } = self.numbers;
        // One check of a stencil's bounds then serves both arrays.
        assert_eq!(nodes.len(), mapped.len());
        let [grid, old, change] = splats::<V, 3>([mix.grid, mix.old, mix.change]);
        let [along_grid, own]: [V; 2] =
            splats(if own_path { [0.0, self.numbers.dt] } else { [self.numbers.dt, 0.0] });
        let (mut farthest, mut watch) = (V::splat(0.0), V::splat(0.0));
        let particles = places.iter().zip(velocity).zip(displacement).enumerate();
        for (p, ((place, velocity), displacement)) in particles {
            let stencil = frame.stencil::<V, D, W, S>(V::load(place));
            let steep = if AFFINE { stencil.affine::<V, S>() } else { stencil };
            let seen = gather_one::<V, D, W, AFFINE>(&stencil, &steep, nodes);
            let before = V::load(velocity);
            let new = old.mul_add(before, grid.mul_add(seen.w, change * seen.a));
            new.with_last(before).store(velocity);
            let dx = own.mul_add(new, along_grid * seen.w);
            dx.store(displacement);
            farthest = farthest.larger(dx.absolute());
            watch = watch + new;
            let mass = V::splat(place[3]);
            let mut spread = [V::splat(0.0); D];
            if AFFINE {
                let inverse = V::splat(frame.inverse_spacing);
                for axis in 0..D {
                    spread[axis] = mass * seen.matrix[axis];
                    let column = inverse * seen.matrix[axis];
                    column.with_last(V::splat(0.0)).store(&mut matrix[axis][p]);
                }
            }
            if SCATTER {
                scatter_one::<V, D, W, AFFINE>(&stencil, mass * new, &spread, mapped);
            }
        }
        let (far, sum) = (farthest.array(), watch.array());
        self.report.farthest = far[0].max(far[1]).max(far[2]);
        self.report.watch = sum[0] + sum[1] + sum[2];
    }
}

/// sum N v*, sum N (v* - v) and, if asked to, sum v* (x) weights.
#[inline(always)]
fn gather_one<V: Wide, const D: usize, const W: usize, const AFFINE: bool>(
    stencil: &Stencil<D, W>,
    steep: &Stencil<D, W>,
    nodes: &[Node],
) -> Gathered<V, D> {
    let zero = V::splat(0.0);
    let rows = stencil.of(nodes);
    let (last, across) = (D - 1, Stencil::<D, W>::ACROSS);
    let mut sum = Gathered { w: zero, a: zero, matrix: [zero; D] };
    for i in 0..Stencil::<D, W>::PLANES {
        let mut plane = Gathered { w: zero, a: zero, matrix: [zero; D] };
        for j in 0..Stencil::<D, W>::ROWS {
            let nodes = rows.row(i, j);
            let (value, motion) = (stencil.value::<V>(last, 0), V::load(&nodes[0].motion));
            let (mut w, mut a) = (value * motion, value * V::load(&nodes[0].change));
            let mut slope = steep.slope::<V>(last, 0) * motion;
            for k in 1..W {
                let (value, motion) = (stencil.value::<V>(last, k), V::load(&nodes[k].motion));
                w = value.mul_add(motion, w);
                a = value.mul_add(V::load(&nodes[k].change), a);
                if AFFINE {
                    slope = steep.slope::<V>(last, k).mul_add(motion, slope);
                }
            }
            if D == 1 {
                plane = Gathered { w, a, matrix: [slope; D] };
                continue;
            }
            let value = stencil.value::<V>(across, j);
            plane.w = value.mul_add(w, plane.w);
            plane.a = value.mul_add(a, plane.a);
            if AFFINE {
                let steep = steep.slope::<V>(across, j);
                plane.matrix[across] = steep.mul_add(w, plane.matrix[across]);
                plane.matrix[last] = value.mul_add(slope, plane.matrix[last]);
            }
        }
        if D < 3 {
            return plane;
        }
        let value = stencil.value::<V>(0, i);
        sum.w = value.mul_add(plane.w, sum.w);
        sum.a = value.mul_add(plane.a, sum.a);
        if AFFINE {
            sum.matrix[0] = steep.slope::<V>(0, i).mul_add(plane.w, sum.matrix[0]);
            sum.matrix[across] = value.mul_add(plane.matrix[across], sum.matrix[across]);
            sum.matrix[last] = value.mul_add(plane.matrix[last], sum.matrix[last]);
        }
    }
    sum
}

/// mapped += N m (v + C (x_I - x)) for one particle; `spread` is m C h, column by column.
#[inline(always)]
fn scatter_one<V: Wide, const D: usize, const W: usize, const AFFINE: bool>(
    stencil: &Stencil<D, W>,
    momentum: V,
    spread: &[V; D],
    mapped: Shared<'_, [f64; 4]>,
) {
    let (last, across) = (D - 1, Stencil::<D, W>::ACROSS);
    let mut first = momentum;
    if AFFINE {
        for axis in 0..D {
            first = V::splat(-stencil.offset(axis)).mul_add(spread[axis], first);
        }
    }
    // SAFETY: tiles of one colour share no node (see `tiles`).
    let mut rows = unsafe { stencil.of_shared(&mapped) };
    for i in 0..Stencil::<D, W>::PLANES {
        let along = if D == 3 { stencil.value::<V>(0, i) } else { V::splat(1.0) };
        let mut plane = first;
        if AFFINE && D == 3 {
            plane = V::splat(i as f64).mul_add(spread[0], plane);
        }
        for j in 0..Stencil::<D, W>::ROWS {
            let mut momentum = plane;
            if AFFINE && D > 1 {
                momentum = V::splat(j as f64).mul_add(spread[across], momentum);
            }
            let value = match D {
                1 => along,
                2 => stencil.value::<V>(across, j),
                _ => along * stencil.value::<V>(across, j),
            };
            let (mut momentum, step) = (value * momentum, value * spread[last]);
            let nodes = rows.row(i, j);
            for k in 0..W {
                let node = &mut nodes[k];
                stencil.value::<V>(last, k).mul_add(momentum, V::load(node)).store(node);
                if AFFINE {
                    momentum = momentum + step;
                }
            }
        }
    }
}

/// Line 13 alone: mapped += N m (v + C (x_I - x)), for steps whose fixes change particles after the
/// gathering.
pub fn scatter_momentum(tiles: &mut Tiles, world: &mut World, affine: bool) {
    by_kind!(world.domain.dimension, world.method.shape, scatter_of, tiles, world, affine);
}

fn scatter_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    world: &mut World,
    affine: bool,
) {
    let World { particles, grid, method, .. } = world;
    let places = particles.places(method.total);
    let mapped = Shared::new(&mut grid.mapped);
    tiles.sweep(|tile, _| {
        let matrix = particles.matrix.each_ref().map(|column| match affine {
            true => column.get(tile.range.clone()).unwrap_or(&[]),
            false => &[],
        });
        dispatch(Second::<'_, D, W, S> {
            places: &places[tile.range.clone()],
            velocity: &particles.velocity[tile.range],
            matrix,
            affine,
            mapped,
            frame: *tile.frame,
            shape: PhantomData,
        });
    });
}

struct Second<'a, const D: usize, const W: usize, S> {
    places: &'a [[f64; 4]],
    velocity: &'a [[f64; 4]],
    matrix: [&'a [[f64; 4]]; 3],
    affine: bool,
    mapped: Shared<'a, [f64; 4]>,
    frame: Frame,
    shape: PhantomData<S>,
}

impl<const D: usize, const W: usize, S: Shape<W>> Sweep for Second<'_, D, W, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        if self.affine { self.particles::<V, true>() } else { self.particles::<V, false>() }
    }
}

impl<const D: usize, const W: usize, S: Shape<W>> Second<'_, D, W, S> {
    #[inline(always)]
    fn particles<V: Wide, const AFFINE: bool>(self) {
        for (p, (place, velocity)) in self.places.iter().zip(self.velocity).enumerate() {
            let stencil = self.frame.stencil::<V, D, W, S>(V::load(place));
            let mass = V::splat(place[3]);
            let mut spread = [V::splat(0.0); D];
            if AFFINE {
                let scale = mass * V::splat(self.frame.spacing);
                for axis in 0..D {
                    spread[axis] = scale * V::load(&self.matrix[axis][p]);
                }
            }
            let momentum = mass * V::load(velocity);
            scatter_one::<V, D, W, AFFINE>(&stencil, momentum, &spread, self.mapped);
        }
    }
}
