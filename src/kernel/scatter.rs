//! P2G of one particle: mass, momentum and force go to the nodes.

use super::by_kind;
use super::shared::Shared;
use super::support::{Footprint, Support};
use super::tiles::Tiles;
use crate::math::v4::Plain;
use crate::model::column::Column;
use crate::world::World;

/// What one particle gives to the nodes.
#[derive(Clone, Copy)]
pub struct Parcel<V, const D: usize> {
    /// m v and m.
    pub motion: V,
    /// Change of m v from node to node along each axis.
    pub spread: [V; D],
    /// -V0 J sigma_{.j} / h of each axis j: the force is the sum over j of this times dN/dr_j.
    pub force: [V; D],
    /// -V0 J sigma_tt/r along x: where x is a radius, the force is also N times this.
    pub hoop: V,
}

/// force += N mbp: the external forces that fixes gave to particles (H1).
pub fn external_forces(tiles: &mut Tiles, world: &mut World) {
    by_kind!(world.domain.dimension, world.method.shape, external_of, tiles, world);
}

fn external_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) {
    let World { particles, grid, method, solids, .. } = world;
    let places = particles.places(method.total);
    let nodes = Shared::new(&mut grid.nodes);
    let external = Shared::new(&mut grid.external);
    let force = [Column::Bx, Column::By, Column::Bz].map(|column| particles.column(column));
    let records = F::part(&particles.domain, 0..particles.len());
    tiles.sweep_into(&[&nodes, &external], |tile, _| {
        let mut memory = F::Memory::default();
        for p in tile.range {
            if solids[particles.solid[p] as usize].rigid {
                continue;
            }
            let force: [f64; 3] = force.map(|column| column.get(p).copied().unwrap_or(0.0));
            let support =
                F::at::<Plain, false, false>(&mut memory, tile.frame, places, &records, p);
            support.each(|node, weight| {
                let share: [f64; 3] = force.map(|force| weight * force);
                // SAFETY: tiles of one colour share no node (see `tiles`).
                let change = unsafe { &mut nodes.part(node..node + 1)[0].change };
                add(change, share);
                if !external.is_empty() {
                    // SAFETY: as above.
                    add(unsafe { &mut external.part(node..node + 1)[0] }, share);
                }
            });
        }
    });
}

fn add(sum: &mut [f64; 4], share: [f64; 3]) {
    for (sum, share) in sum.iter_mut().zip(share) {
        *sum += share;
    }
}
