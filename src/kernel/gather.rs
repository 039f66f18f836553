//! G2P: particles take their new velocity from the grid, and give it back for the second mapping.

use super::by_kind;
use super::ghosts::NodeArray;
use super::shared::Shared;
use super::stencil::Frame;
use super::support::{Footprint, Records, Support};
use super::tiles::{Report, Tiles};
use crate::math::v4::{Sweep, Wide, dispatch, splats};
use crate::model::grid::Node;
use crate::model::particles::DOMAIN_RECORDS;
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
/// mapped += N m (v + C (x_I - x)). Free corners of domains: carried <- dt sum N(x_c) v*.
pub fn sweep(tiles: &mut Tiles, world: &mut World, numbers: Gather) -> Report {
    by_kind!(world.domain.dimension, world.method.shape, sweep_of, tiles, world, numbers)
}

fn sweep_of<const D: usize, F: Footprint<D>>(
    tiles: &mut Tiles,
    world: &mut World,
    numbers: Gather,
) -> Report {
    let World { particles, grid, method, .. } = world;
    let places = if method.total { &particles.reference } else { &particles.position };
    let velocity = Shared::new(&mut particles.velocity);
    let displacement = Shared::new(&mut particles.displacement);
    let carried = particles.carried.each_mut().map(|record| Shared::new(record));
    let mut columns = particles.matrix.iter_mut();
    let matrix: [Shared<'_, [f64; 4]>; 3] =
        std::array::from_fn(|_| Shared::new(columns.next().map_or(&mut [], |c| c)));
    let mapped = Shared::new(&mut grid.mapped);
    let nodes = &grid.nodes;
    let arrays: &[&dyn NodeArray] = if numbers.scatter { &[&mapped] } else { &[] };
    tiles.sweep_into(arrays, |tile, report| {
        let (range, start) = (tile.range.clone(), tile.range.start);
        // SAFETY: the ranges of the tiles do not overlap, so each particle has one writer.
        let (velocity, displacement, matrix) = unsafe {
            let columns =
                matrix.each_ref().map(|column| match numbers.affine && !column.is_empty() {
                    true => column.part(range.clone()),
                    false => &mut [],
                });
            (velocity.part(range.clone()), displacement.part(range.clone()), columns)
        };
        dispatch(Part::<'_, D, F> {
            records: F::part(&particles.domain, range.clone()),
            places: &places[range],
            velocity,
            displacement,
            carried: &carried,
            start,
            matrix,
            nodes,
            mapped,
            frame: *tile.frame,
            numbers,
            report,
            footprint: PhantomData,
        });
    })
}

struct Part<'a, const D: usize, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    velocity: &'a mut [[f64; 4]],
    displacement: &'a mut [[f64; 4]],
    /// How far free corners of all particles move, if they do.
    carried: &'a [Shared<'a, [f64; 4]>; DOMAIN_RECORDS],
    /// First of the particles.
    start: usize,
    matrix: [&'a mut [[f64; 4]]; 3],
    nodes: &'a [Node],
    mapped: Shared<'a, [f64; 4]>,
    frame: Frame,
    numbers: Gather,
    report: &'a mut Report,
    footprint: PhantomData<F>,
}

impl<const D: usize, F: Footprint<D>> Sweep for Part<'_, D, F> {
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

impl<const D: usize, F: Footprint<D>> Part<'_, D, F> {
    #[inline(always)]
    fn particles<V: Wide, const SCATTER: bool, const AFFINE: bool>(self) {
        let Self { places, records, velocity, displacement, matrix, nodes, mapped, .. } = self;
        let (frame, carried, start) = (self.frame, self.carried, self.start);
        let Gather { dt, velocity: mix, own_path, .. } = self.numbers;
        // One check of a stencil's bounds then serves both arrays.
        assert_eq!(nodes.len(), mapped.len());
        let [grid, old, change] = splats::<V, 3>([mix.grid, mix.old, mix.change]);
        let [along_grid, own]: [V; 2] =
            splats(if own_path { [0.0, self.numbers.dt] } else { [self.numbers.dt, 0.0] });
        let (mut farthest, mut energy) = (V::splat(0.0), V::splat(0.0));
        let mut memory = F::Memory::default();
        // Slices of one length: the loop needs no further checks.
        let len = places.len();
        let (velocity, displacement) = (&mut velocity[..len], &mut displacement[..len]);
        for p in 0..len {
            let (place, velocity, displacement) =
                (&places[p], &mut velocity[p], &mut displacement[p]);
            // Corners are asked for where they are free, and only there.
            let support = F::at::<V, AFFINE, true>(&mut memory, &frame, places, &records, p);
            let steep = if AFFINE { F::affine::<V>(support) } else { support };
            let seen = support.gather::<V, AFFINE>(&steep, nodes);
            if F::FREE && !carried[0].is_empty() {
                let mut velocities = [[0.0; 4]; DOMAIN_RECORDS];
                support.carry::<V>(nodes, &mut velocities);
                let here = start + p;
                for c in 0..F::RECORDS {
                    // SAFETY: the ranges of the tiles do not overlap.
                    let carried = unsafe { &mut carried[c].part(here..here + 1)[0] };
                    (V::splat(dt) * V::load(&velocities[c])).store(carried);
                }
            }
            let before = V::load(velocity);
            let new = old.mul_add(before, grid.mul_add(seen.w, change * seen.a));
            new.with_last(before).store(velocity);
            let dx = own.mul_add(new, along_grid * seen.w);
            dx.store(displacement);
            farthest = farthest.larger(dx.absolute());
            let mass = V::splat(place[3]);
            let momentum = mass * new;
            energy = momentum.mul_add(new, energy);
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
                support.scatter_momentum::<V, AFFINE>(momentum, &spread, mapped);
            }
        }
        let (far, sum) = (farthest.array(), energy.array());
        self.report.farthest = far[0].max(far[1]).max(far[2]);
        self.report.kinetic = 0.5 * (sum[0] + sum[1] + sum[2]);
    }
}

/// Line 13 alone: mapped += N m (v + C (x_I - x)), for steps whose fixes change particles after the
/// gathering.
pub fn scatter_momentum(tiles: &mut Tiles, world: &mut World, affine: bool) {
    by_kind!(world.domain.dimension, world.method.shape, scatter_of, tiles, world, affine);
}

fn scatter_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World, affine: bool) {
    let World { particles, grid, method, .. } = world;
    let places = particles.places(method.total);
    let mapped = Shared::new(&mut grid.mapped);
    tiles.sweep_into(&[&mapped], |tile, _| {
        let matrix = particles.matrix.each_ref().map(|column| match affine {
            true => column.get(tile.range.clone()).unwrap_or(&[]),
            false => &[],
        });
        dispatch(Second::<'_, D, F> {
            records: F::part(&particles.domain, tile.range.clone()),
            places: &places[tile.range.clone()],
            velocity: &particles.velocity[tile.range],
            matrix,
            affine,
            mapped,
            frame: *tile.frame,
            footprint: PhantomData,
        });
    });
}

struct Second<'a, const D: usize, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    velocity: &'a [[f64; 4]],
    matrix: [&'a [[f64; 4]]; 3],
    affine: bool,
    mapped: Shared<'a, [f64; 4]>,
    frame: Frame,
    footprint: PhantomData<F>,
}

impl<const D: usize, F: Footprint<D>> Sweep for Second<'_, D, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        if self.affine { self.particles::<V, true>() } else { self.particles::<V, false>() }
    }
}

impl<const D: usize, F: Footprint<D>> Second<'_, D, F> {
    #[inline(always)]
    fn particles<V: Wide, const AFFINE: bool>(self) {
        let mut memory = F::Memory::default();
        let (places, records) = (self.places, &self.records);
        for (p, (place, velocity)) in places.iter().zip(self.velocity).enumerate() {
            let support = F::at::<V, AFFINE, false>(&mut memory, &self.frame, places, records, p);
            let mass = V::splat(place[3]);
            let mut spread = [V::splat(0.0); D];
            if AFFINE {
                let scale = mass * V::splat(self.frame.spacing);
                for axis in 0..D {
                    spread[axis] = scale * V::load(&self.matrix[axis][p]);
                }
            }
            let momentum = mass * V::load(velocity);
            support.scatter_momentum::<V, AFFINE>(momentum, &spread, self.mapped);
        }
    }
}
