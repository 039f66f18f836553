//! F-bar: the volumetric part of L, averaged over the grid (language.md 9.1).

use super::by_space;
use super::chunk::{SCRATCH, Scratch};
use super::points::of_one_solid;
use super::shared::Shared;
use super::stencil::Frame;
use super::support::{Footprint, Records, Support};
use super::tiles::Tiles;
use crate::material::state::load_tensor;
use crate::material::{Description, LANES};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::math::wide::{Four, cofactors, in_space};
use crate::model::column::ColumnSet;
use crate::world::World;
use std::marker::PhantomData;

/// dilation += N m tr L for every particle.
pub fn sweep(tiles: &mut Tiles, world: &mut World) {
    let (method, dimension) = (world.method, world.domain.dimension);
    by_space!(method.axisymmetric, dimension, method.shape, sweep_of, tiles, world);
}

fn sweep_of<const D: usize, const ROUND: bool, F: Footprint<D>>(
    tiles: &mut Tiles,
    world: &mut World,
) {
    let description = world.description();
    let total = world.method.total;
    let dimension = world.tensor_dimension();
    let mut deformation = ColumnSet::default();
    deformation.extend(world.deformation_columns());
    let World { particles, grid, solids, .. } = world;
    let places = particles.places(total);
    let mapped = &grid.mapped;
    let dilation = Shared::new(&mut grid.dilation);
    tiles.sweep_into(&[&dilation], |tile, _| {
        SCRATCH.with_borrow_mut(|scratch| {
            for range in of_one_solid(tile.range, &particles.solid) {
                if solids[particles.solid[range.start] as usize].rigid {
                    continue;
                }
                scratch.load(particles, dimension, deformation, range.clone());
                let records = F::part(&particles.domain, range.clone());
                let places = &places[range];
                let (frame, footprint) = (tile.frame, PhantomData);
                dispatch(Part::<'_, D, ROUND, F> {
                    places,
                    records,
                    scratch,
                    frame,
                    mapped,
                    dilation,
                    description,
                    footprint,
                });
            }
        });
    });
}

/// One chunk.
struct Part<'a, const D: usize, const ROUND: bool, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    scratch: &'a mut Scratch,
    frame: &'a Frame,
    mapped: &'a [[f64; 4]],
    dilation: Shared<'a, f64>,
    description: Description,
    footprint: PhantomData<F>,
}

impl<const D: usize, const ROUND: bool, F: Footprint<D>> Sweep for Part<'_, D, ROUND, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { places, records, scratch, frame, mapped, dilation, description, .. } = self;
        let len = places.len().min(LANES);
        let mut memory = F::Memory::default();
        for p in 0..len {
            let support = F::at::<V, true, false>(&mut memory, frame, places, &records, p);
            let (columns, value) = support.gradient_and_value::<V>(mapped);
            for j in 0..D {
                columns[j].store(&mut scratch.records[j][p]);
            }
            if ROUND {
                scratch.numbers[p / 4][p % 4] = frame.hoop_rate(value.array()[0], places[p][0]);
            }
        }
        let groups = scratch.state.groups().end;
        scratch.spread::<V, D>(frame.inverse_spacing, groups);
        if ROUND {
            scratch.spread_hoop(len);
        }
        for group in 0..groups {
            let trace = match ROUND {
                true => trace_of::<V, 3>(scratch, description, group),
                false => trace_of::<V, D>(scratch, description, group),
            };
            trace.store(&mut scratch.numbers[group]);
        }
        for p in 0..len {
            let support = F::at::<V, true, false>(&mut memory, frame, places, &records, p);
            let amount = places[p][3] * scratch.numbers[p / 4][p % 4];
            support.add_number(amount, dilation);
        }
    }
}

/// tr L; total Lagrangian: dF/dt : F^-T.
#[inline(always)]
fn trace_of<V: Wide, const D: usize>(
    scratch: &Scratch,
    description: Description,
    group: usize,
) -> V {
    let rate: Four<V> = load_tensor(&scratch.gradient, group);
    if description != Description::Total {
        let mut trace = rate[0];
        for axis in 1..D {
            trace = trace + rate[4 * axis];
        }
        return trace;
    }
    let f: Four<V> = scratch.state.deformation_of_four(group);
    let (cofactor, j) = cofactors::<V, D>(&f);
    let mut trace = V::splat(0.0);
    for entry in 0..9 {
        if in_space::<D>(entry) {
            trace = rate[entry].mul_add(cofactor[entry], trace);
        }
    }
    trace / j
}

/// L <- L + (theta - tr L)/d I with theta in `numbers`; total Lagrangian:
/// dF/dt <- dF/dt + (theta - tr L)/d F. Where x is a radius, d = 3.
#[inline(always)]
pub fn replace<V: Wide, const D: usize>(scratch: &mut Scratch, description: Description) {
    for group in scratch.state.groups() {
        let theta = V::load(&scratch.numbers[group]);
        let trace = trace_of::<V, D>(scratch, description, group);
        let shift = (theta - trace) / V::splat(D as f64);
        let total = description == Description::Total;
        let f: Four<V> = scratch.state.deformation_of_four(group);
        for entry in 0..9 {
            if !in_space::<D>(entry) || !(total || entry % 4 == 0) {
                continue;
            }
            let rate = V::load(&scratch.gradient[entry][group]);
            let factor = if total { f[entry] } else { V::splat(1.0) };
            shift.mul_add(factor, rate).store(&mut scratch.gradient[entry][group]);
        }
    }
}
