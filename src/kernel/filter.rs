//! The filter of XPIC(m): nodal velocities without the smoothing of one mapping to and fro.
//!
//! v' = sum_{k=1..m} (-1)^(k+1) C(m, k) (S+ S)^(k-1) S+ V with S: grid to particles and S+: particles
//! to grid by mass. Prescribed velocities hold in each S+, as if the body went on behind the wall.
//! `Grid::filtered` is v' - v; particles then take sum N (v* + v' - v).
//!
//! # Source  Hammerquist and Nairn 2017

use super::by_kind;
use super::grid::{for_each_run, inverse_mass};
use super::shared::Shared;
use super::support::{Footprint, Records, Support};
use super::tiles::Tiles;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::grid::{Grid, Node};
use crate::world::World;
use std::marker::PhantomData;

/// change <- v' - v, what particles gather beside v* in place of v* - v. `spare` is memory.
pub fn apply(tiles: &mut Tiles, world: &mut World, spare: &mut Vec<[f64; 4]>, terms: u32) {
    start(&mut world.grid, tiles.parallel, f64::from(terms));
    let mut factor = f64::from(terms);
    for k in 2..=terms {
        // (-1)^(k+1) C(m, k), one from the other.
        factor *= -f64::from(terms + 1 - k) / f64::from(k);
        spare.clear();
        spare.resize(world.grid.len(), [0.0; 4]);
        project(tiles, world, spare);
        add(&mut world.grid, spare, factor);
    }
    finish(&mut world.grid);
}

/// v of a node after the update and H3.
fn velocity(node: &Node, axis: usize) -> f64 {
    node.motion[axis] - node.change[axis]
}

/// mapped <- v, filtered <- (m - 1) v.
fn start(grid: &mut Grid, parallel: bool, terms: f64) {
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter().zip(mapped) {
            *mapped = [velocity(node, 0), velocity(node, 1), velocity(node, 2), 0.0];
        }
    });
    for (filtered, v) in grid.filtered.iter_mut().zip(&grid.mapped) {
        *filtered = v.map(|v| (terms - 1.0) * v);
    }
}

/// spare += N m sum N v, for every particle.
fn project(tiles: &mut Tiles, world: &World, spare: &mut [[f64; 4]]) {
    by_kind!(world.domain.dimension, world.method.shape, project_of, tiles, world, spare);
}

fn project_of<const D: usize, F: Footprint<D>>(
    tiles: &mut Tiles,
    world: &World,
    spare: &mut [[f64; 4]],
) {
    let World { particles, grid, method, .. } = world;
    let places = particles.places(method.total);
    let spare = Shared::new(spare);
    tiles.sweep_into(&[&spare], |tile, _| {
        dispatch(Part::<'_, D, F> {
            records: F::part(&particles.domain, tile.range.clone()),
            places: &places[tile.range],
            from: &grid.mapped,
            to: spare,
            frame: tile.frame,
            footprint: PhantomData,
        });
    });
}

struct Part<'a, const D: usize, F> {
    places: &'a [[f64; 4]],
    records: Records<'a>,
    from: &'a [[f64; 4]],
    to: Shared<'a, [f64; 4]>,
    frame: &'a super::stencil::Frame,
    footprint: PhantomData<F>,
}

impl<const D: usize, F: Footprint<D>> Sweep for Part<'_, D, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let mut memory = F::Memory::default();
        let (places, records) = (self.places, &self.records);
        for (p, place) in places.iter().enumerate() {
            let support = F::at::<V, false, false>(&mut memory, self.frame, places, records, p);
            let momentum = V::splat(place[3]) * support.sum::<V>(self.from);
            support.add(momentum, self.to);
        }
    }
}

/// mapped <- spare/m, or v where it is prescribed; filtered += factor mapped.
fn add(grid: &mut Grid, spare: &[[f64; 4]], factor: f64) {
    let Grid { nodes, mapped, filtered, held, runs, mass_cutoff, .. } = grid;
    for node in runs.iter().cloned().flatten() {
        let inverse = inverse_mass(&nodes[node], *mass_cutoff);
        mapped[node] = spare[node].map(|momentum| inverse * momentum);
    }
    for (node, axis) in held.iter().copied() {
        mapped[node][axis] = velocity(&nodes[node], axis);
    }
    for node in runs.iter().cloned().flatten() {
        for (filtered, v) in filtered[node].iter_mut().zip(mapped[node]) {
            *filtered += factor * v;
        }
    }
}

/// change <- v' - v; the second mapping is cleared again.
fn finish(grid: &mut Grid) {
    let Grid { nodes, mapped, filtered, runs, .. } = grid;
    for node in runs.iter().cloned().flatten() {
        nodes[node].change[..3].copy_from_slice(&filtered[node][..3]);
        mapped[node] = [0.0; 4];
    }
}
