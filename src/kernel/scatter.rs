//! P2G: mass, momentum and force of the particles go to the nodes.

use super::by_dimension;
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use super::tiles::Tiles;
use crate::math::v4::{Plain, Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::model::grid::{Grid, Node};
use crate::model::particles::Particles;
use crate::shape::Shape;
use std::marker::PhantomData;

/// The columns that the force needs: entry 3 i + j is sigma_ij; absent ones are empty.
pub const STRESS: [Column; 9] = {
    use Column::*;
    [S11, S12, S13, S12, S22, S23, S13, S23, S33]
};

/// What one particle gives to the nodes.
#[derive(Clone, Copy)]
pub struct Parcel<V, const D: usize> {
    /// m v and m.
    pub motion: V,
    /// -V sigma_{.j} / h of each axis j: the force is the sum over j of this times dN/dr_j.
    pub force: [V; D],
}

/// motion += N (m v, m), force -= V sigma grad N, for one particle (line 5).
#[inline(always)]
pub fn scatter_one<V: Wide, const D: usize, const W: usize>(
    stencil: &Stencil<D, W>,
    parcel: &Parcel<V, D>,
    nodes: Shared<'_, Node>,
) {
    for number in 0..Stencil::<D, W>::ROWS {
        let row = stencil.row(number);
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let nodes = unsafe { nodes.row::<W>(row.first) };
        let motion = V::splat(row.value) * parcel.motion;
        let steep = V::splat(row.value) * parcel.force[D - 1];
        let mut flat = V::splat(0.0);
        for axis in 0..D - 1 {
            flat = V::splat(row.slope[axis]).mul_add(parcel.force[axis], flat);
        }
        for k in 0..W {
            let (value, slope) = (V::splat(stencil.value(k)), V::splat(stencil.slope(k)));
            let node = &mut nodes[k];
            value.mul_add(motion, V::load(&node.motion)).store(&mut node.motion);
            let force = slope.mul_add(steep, V::load(&node.change));
            let force = if D > 1 { value.mul_add(flat, force) } else { force };
            force.store(&mut node.change);
        }
    }
}

/// -V sigma_{.j}/h, V = J V0; `stress` has the nine entries of [`STRESS`] at this particle.
#[inline(always)]
pub fn force<V: Wide, const D: usize>(volume: f64, stress: impl Fn(usize) -> f64) -> [V; D] {
    let factor = V::splat(-volume);
    std::array::from_fn(|j| {
        let mut column = [0.0; 4];
        for (i, entry) in column.iter_mut().enumerate().take(D) {
            *entry = stress(3 * i + j);
        }
        factor * V::load(&column)
    })
}

/// Line 5 for every particle, at the start of a run and in steps whose fixes act before it.
pub fn sweep(
    tiles: &mut Tiles,
    particles: &Particles,
    grid: &mut Grid,
    dimension: usize,
    frame: &Frame,
) {
    by_dimension!(dimension, sweep_of, tiles, particles, grid, frame);
}

fn sweep_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    particles: &Particles,
    grid: &mut Grid,
    frame: &Frame,
) {
    let nodes = Shared::new(&mut grid.nodes);
    tiles.sweep(|range, _| {
        dispatch(Tile::<'_, D, W, S> {
            position: &particles.position[range.clone()],
            velocity: &particles.velocity[range.clone()],
            jacobian: &particles.column(Column::J)[range.clone()],
            stress: STRESS.map(|column| particles.column(column).get(range.clone()).unwrap_or(&[])),
            nodes,
            frame: *frame,
            shape: PhantomData,
        });
    });
}

struct Tile<'a, const D: usize, const W: usize, S> {
    position: &'a [[f64; 4]],
    velocity: &'a [[f64; 4]],
    jacobian: &'a [f64],
    stress: [&'a [f64]; 9],
    nodes: Shared<'a, Node>,
    frame: Frame,
    shape: PhantomData<S>,
}

impl<const D: usize, const W: usize, S: Shape<W>> Sweep for Tile<'_, D, W, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let inverse_cell = self.frame.inverse_cell;
        for (p, (position, velocity)) in self.position.iter().zip(self.velocity).enumerate() {
            let stencil = self.frame.stencil::<V, D, W, S>(V::load(position));
            let volume = self.jacobian[p] * velocity[3] * inverse_cell;
            let parcel = Parcel {
                motion: V::splat(position[3]) * V::load(velocity).with_last(V::splat(1.0)),
                force: force::<V, D>(volume, |entry| self.stress[entry][p]),
            };
            scatter_one(&stencil, &parcel, self.nodes);
        }
    }
}

/// force += N mbp: the external forces that fixes gave to particles (H1).
pub fn external(
    tiles: &mut Tiles,
    particles: &Particles,
    grid: &mut Grid,
    dimension: usize,
    frame: &Frame,
) {
    by_dimension!(dimension, external_of, tiles, particles, grid, frame);
}

fn external_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    particles: &Particles,
    grid: &mut Grid,
    frame: &Frame,
) {
    let nodes = Shared::new(&mut grid.nodes);
    let external = Shared::new(&mut grid.external);
    let force = [Column::Bx, Column::By, Column::Bz].map(|column| particles.column(column));
    tiles.sweep(|range, _| {
        for p in range {
            let force: [f64; 3] = force.map(|column| column.get(p).copied().unwrap_or(0.0));
            let stencil = frame.stencil::<Plain, D, W, S>(Plain::load(&particles.position[p]));
            for number in 0..Stencil::<D, W>::ROWS {
                let row = stencil.row(number);
                // SAFETY: tiles of one colour share no node (see `tiles`).
                let nodes = unsafe { nodes.part(row.first..row.first + W) };
                for (k, node) in nodes.iter_mut().enumerate() {
                    for axis in 0..D {
                        node.change[axis] += row.value * stencil.value(k) * force[axis];
                    }
                }
                if !external.is_empty() {
                    // SAFETY: as above.
                    let nodes = unsafe { external.part(row.first..row.first + W) };
                    for (k, node) in nodes.iter_mut().enumerate() {
                        for axis in 0..D {
                            node[axis] += row.value * stencil.value(k) * force[axis];
                        }
                    }
                }
            }
        }
    });
}
