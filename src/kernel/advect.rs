//! Corners of domains that the grid carries along, each for itself (CPDI with `T3`, `Q4`, `Tet4`,
//! `H8`): x_c += dt sum N(x_c) v*.

use super::cloud::{Cloud, Corners, corner_velocities};
use super::shared::Shared;
use super::support::Footprint;
use super::tiles::Tiles;
use crate::math::v4::Plain;
use crate::model::particles::Particles;
use crate::shape::{DomainKind, ShapeKind};
use crate::world::World;

/// carried <- dt sum N(x_c) v* - dx of the particle, for every corner; rigid bodies keep their shape.
/// Nothing where corners do not move for themselves.
pub fn sweep(tiles: &mut Tiles, world: &mut World, dt: f64) {
    match (world.domain.dimension, world.method.shape) {
        (2, ShapeKind::Corners(DomainKind::Quadrangle)) => sweep_of::<2, 4>(tiles, world, dt),
        (3, ShapeKind::Corners(DomainKind::Tetrahedron)) => sweep_of::<3, 4>(tiles, world, dt),
        (3, ShapeKind::Corners(DomainKind::Hexahedron)) => sweep_of::<3, 8>(tiles, world, dt),
        _ => {}
    }
}

fn sweep_of<const D: usize, const C: usize>(tiles: &mut Tiles, world: &mut World, dt: f64)
where
    Corners<C>: Footprint<D, Support = Cloud<D, C>>,
{
    let World { particles, grid, solids, .. } = world;
    let Particles { position, displacement, domain, carried, solid, .. } = particles;
    let carried = carried.each_mut().map(|record| Shared::new(record));
    let nodes = &grid.nodes;
    tiles.sweep(|tile, _| {
        let range = tile.range;
        let records = <Corners<C> as Footprint<D>>::part(domain, range.clone());
        // SAFETY: the ranges of the tiles do not overlap, so each particle has one writer.
        let mut carried = carried.each_ref().map(|record| unsafe {
            record.part(if record.is_empty() { 0..0 } else { range.clone() })
        });
        for (p, index) in range.enumerate() {
            let rigid = solids[solid[index] as usize].rigid;
            let cloud = <Corners<C> as Footprint<D>>::at::<Plain>(
                tile.frame,
                &position[index],
                &records,
                p,
            );
            let velocity = corner_velocities::<Plain, D, C>(&cloud, nodes);
            for (carried, velocity) in carried.iter_mut().zip(velocity) {
                for axis in 0..D {
                    let change = dt * velocity[axis] - displacement[index][axis];
                    carried[p][axis] = if rigid { 0.0 } else { change };
                }
            }
        }
    });
}
