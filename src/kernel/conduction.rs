//! Conduction of heat on the nodes, for all solids together (language.md 7.6).
//!
//! Three sweeps of their own, in `thermo-mechanical` runs only, around the fixes that prescribe
//! temperatures: [`collect`] before H2, [`conduct`] with the update of the nodes (line 7),
//! [`gather`] with G2P (line 9).

use super::by_kind;
use super::chunk::{SCRATCH, Scratch};
use super::points::of_one_solid;
use super::shared::Shared;
use super::stencil::Frame;
use super::support::{Footprint, Records, Support};
use super::tiles::Tiles;
use crate::material::{Description, LANES, Thermal};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::math::wide::{Four, cofactors};
use crate::model::column::{Column, ColumnSet};
use crate::model::grid::Grid;
use crate::world::World;
use std::marker::PhantomData;
use std::ops::Range;

/// Nodal temperatures T_I = sum N m cp T/C_I, C_I = sum N m cp, at the places that the step begins
/// with.
pub fn collect(tiles: &mut Tiles, world: &mut World) {
    let grid = &mut world.grid;
    for node in grid.runs.iter().cloned().flatten() {
        grid.temperature[node] = [0.0; 4];
        grid.heating[node] = 0.0;
    }
    by_kind!(world.domain.dimension, world.method.shape, collect_of, tiles, world);
    let grid = &mut world.grid;
    for node in grid.runs.iter().cloned().flatten() {
        let [heat, _, _, capacity] = &mut grid.temperature[node];
        *heat = if *capacity > 0.0 { *heat / *capacity } else { 0.0 };
    }
    equalize(grid, 0);
}

/// T*_I = T_I + dt (sum V q_p . grad N)/C_I with q_p = -kappa sum T_I grad N.
pub fn conduct(tiles: &mut Tiles, world: &mut World, dt: f64) {
    by_kind!(world.domain.dimension, world.method.shape, conduct_of, tiles, world);
    let grid = &mut world.grid;
    for node in grid.runs.iter().cloned().flatten() {
        let [_, change, _, capacity] = &mut grid.temperature[node];
        *change = if *capacity > 0.0 { dt * grid.heating[node] / *capacity } else { 0.0 };
    }
    equalize(grid, 1);
    for node in grid.runs.iter().cloned().flatten() {
        let [temperature, change, ..] = &mut grid.temperature[node];
        *temperature += *change;
    }
}

/// A gap is open from this part of a cell on.
const OPEN: f64 = 0.05;

/// Bodies with lattices of their own conduct where they share nodes: the means weighted with C, of
/// T_I (entry 0) or T*_I - T_I (entry 1). Heat is kept; none passes an open gap.
fn equalize(grid: &mut Grid, entry: usize) {
    let Grid { couples, temperature, lattices, .. } = grid;
    let Some(spacing) = lattices.first().map(|lattice| lattice.spacing) else { return };
    for couple in couples.iter().filter(|couple| couple.gap < OPEN * spacing) {
        let nodes = couple.nodes.map(|node| node as usize);
        let [a, b] = nodes.map(|node| temperature[node]);
        let capacity = a[3] + b[3];
        if a[3] > 0.0 && b[3] > 0.0 {
            let mean = (a[3] * a[entry] + b[3] * b[entry]) / capacity;
            nodes.iter().for_each(|node| temperature[*node][entry] = mean);
        }
    }
}

/// T_p = a (T_p + sum N (T*_I - T_I)) + (1 - a) sum N T*_I; false if one is not finite.
pub fn gather(tiles: &mut Tiles, world: &mut World) -> bool {
    by_kind!(world.domain.dimension, world.method.shape, gather_of, tiles, world)
}

/// The chunks of a tile whose material has a heat capacity.
fn each_chunk(world: &World, tile: Range<usize>, mut visit: impl FnMut(Range<usize>, Thermal)) {
    for range in of_one_solid(tile, &world.particles.solid) {
        let thermal = world.solids[world.particles.solid[range.start] as usize].law.thermal();
        if thermal.capacity > 0.0 {
            visit(range, thermal);
        }
    }
}

fn collect_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) {
    let mut nodes = std::mem::take(&mut world.grid.temperature);
    let shared = Shared::new(&mut nodes);
    let (places, temperature) =
        (world.particles.places(world.method.total), world.particles.column(Column::Temperature));
    tiles.sweep_into(&[&shared], |tile, _| {
        each_chunk(world, tile.range, |range, thermal| {
            dispatch(Collect::<'_, D, F> {
                places: &places[range.clone()],
                records: F::part(&world.particles.domain, range.clone()),
                temperature: &temperature[range],
                capacity: thermal.capacity,
                frame: tile.frame,
                nodes: shared,
                footprint: PhantomData,
            });
        });
    });
    world.grid.temperature = nodes;
}

/// (sum N m cp T, 0, 0, sum N m cp) of a chunk.
struct Collect<'a, const D: usize, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    temperature: &'a [f64],
    capacity: f64,
    frame: &'a Frame,
    nodes: Shared<'a, [f64; 4]>,
    footprint: PhantomData<F>,
}

impl<const D: usize, F: Footprint<D>> Sweep for Collect<'_, D, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let mut memory = F::Memory::default();
        let (places, records) = (self.places, &self.records);
        for (p, (place, temperature)) in places.iter().zip(self.temperature).enumerate() {
            let support = F::at::<V, false, false>(&mut memory, self.frame, places, records, p);
            let capacity = place[3] * self.capacity;
            let heat = V::load(&[capacity * temperature, 0.0, 0.0, capacity]);
            support.add(heat, self.nodes);
        }
    }
}

fn conduct_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) {
    let mut heating = std::mem::take(&mut world.grid.heating);
    let shared = Shared::new(&mut heating);
    let places = world.particles.places(world.method.total);
    let total = world.description() == Description::Total;
    // F where the weights belong to reference places.
    let mut columns = ColumnSet::default();
    columns.insert(Column::J);
    if total {
        columns.extend(Column::deformation(D));
    }
    tiles.sweep_into(&[&shared], |tile, _| {
        SCRATCH.with_borrow_mut(|scratch| {
            each_chunk(world, tile.range, |range, thermal| {
                scratch.load(&world.particles, D, columns, range.clone());
                dispatch(Conduct::<'_, D, F> {
                    places: &places[range.clone()],
                    records: F::part(&world.particles.domain, range.clone()),
                    velocity: &world.particles.velocity[range],
                    conductivity: thermal.conductivity,
                    total,
                    scratch,
                    frame: tile.frame,
                    nodes: &world.grid.temperature,
                    heating: shared,
                    footprint: PhantomData,
                });
            });
        });
    });
    world.grid.heating = heating;
}

/// heating += V q . grad N of a chunk.
struct Conduct<'a, const D: usize, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    velocity: &'a [[f64; 4]],
    conductivity: f64,
    total: bool,
    scratch: &'a mut Scratch,
    frame: &'a Frame,
    nodes: &'a [[f64; 4]],
    heating: Shared<'a, f64>,
    footprint: PhantomData<F>,
}

impl<const D: usize, F: Footprint<D>> Sweep for Conduct<'_, D, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(mut self) {
        let len = self.places.len().min(LANES);
        let mut memory = F::Memory::default();
        let (frame, places, records) = (self.frame, self.places, self.records);
        for p in 0..len {
            let support = F::at::<V, true, false>(&mut memory, frame, places, &records, p);
            let (columns, _) = support.gradient_and_value::<V>(self.nodes);
            for j in 0..D {
                self.scratch.records[0][p][j] = columns[j].array()[0];
            }
        }
        if self.total {
            self.pull_back::<V>();
        }
        let factor = -self.conductivity * self.frame.inverse_spacing.powi(2);
        for p in 0..len {
            let support = F::at::<V, true, false>(&mut memory, frame, places, &records, p);
            let volume = self.scratch.state.value(Column::J, p) * self.velocity[p][3];
            let flux = self.scratch.records[0][p].map(|slope| factor * volume * slope);
            support.add_divergence(flux, self.heating);
        }
    }
}

impl<const D: usize, F: Footprint<D>> Conduct<'_, D, F> {
    /// F^-1 F^-T grad0 T in place of grad0 T: q . grad N = -kappa (F^-T grad0 T) . (F^-T grad0 N).
    #[inline(always)]
    fn pull_back<V: Wide>(&mut self) {
        let Scratch { state, records, .. } = &mut *self.scratch;
        for group in state.groups() {
            let mut four = [V::splat(0.0); 4];
            for lane in 0..4 {
                four[lane] = V::load(&records[0][4 * group + lane]);
            }
            let slopes = V::transpose(four);
            let f: Four<V> = state.deformation_of_four(group);
            let (cofactor, j) = cofactors::<V, D>(&f);
            let scale = V::splat(1.0) / (j * j);
            let mut back = [V::splat(0.0); 4];
            for i in 0..D {
                let mut spatial = V::splat(0.0);
                for axis in 0..D {
                    spatial = cofactor[3 * i + axis].mul_add(slopes[axis], spatial);
                }
                let spatial = scale * spatial;
                for axis in 0..D {
                    back[axis] = cofactor[3 * i + axis].mul_add(spatial, back[axis]);
                }
            }
            let four = V::transpose(back);
            for lane in 0..4 {
                four[lane].store(&mut records[0][4 * group + lane]);
            }
        }
    }
}

fn gather_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) -> bool {
    let column = Column::Temperature as usize;
    let mut temperature = std::mem::take(&mut world.particles.columns[column]);
    let shared = Shared::new(&mut temperature);
    let places = world.particles.places(world.method.total);
    let report = tiles.sweep(|tile, report| {
        each_chunk(world, tile.range, |range, _| {
            dispatch(Gather::<'_, D, F> {
                places: &places[range.clone()],
                records: F::part(&world.particles.domain, range.clone()),
                // SAFETY: the ranges of the tiles do not overlap: each particle has one writer.
                temperature: unsafe { shared.part(range) },
                blend: world.thermal_blend,
                frame: tile.frame,
                nodes: &world.grid.temperature,
                watch: &mut report.watch,
                footprint: PhantomData,
            });
        });
    });
    world.particles.columns[column] = temperature;
    report.watch.is_finite()
}

/// New temperatures of a chunk.
struct Gather<'a, const D: usize, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    temperature: &'a mut [f64],
    blend: f64,
    frame: &'a Frame,
    nodes: &'a [[f64; 4]],
    watch: &'a mut f64,
    footprint: PhantomData<F>,
}

impl<const D: usize, F: Footprint<D>> Sweep for Gather<'_, D, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let mut memory = F::Memory::default();
        let (places, records) = (self.places, &self.records);
        for (p, temperature) in self.temperature.iter_mut().enumerate() {
            let support = F::at::<V, false, false>(&mut memory, self.frame, places, records, p);
            let [updated, change, ..] = support.sum::<V>(self.nodes).array();
            *temperature = self.blend * (*temperature + change) + (1.0 - self.blend) * updated;
            *self.watch += *temperature;
        }
    }
}
