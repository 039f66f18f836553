//! P2G of one particle: mass, momentum and force go to the nodes.

use super::by_kind;
use super::shared::Shared;
use super::stencil::{Stencil, rows_of};
use super::tiles::Tiles;
use crate::math::v4::{Plain, Wide};
use crate::model::column::Column;
use crate::model::grid::Node;
use crate::shape::Shape;
use crate::world::World;

/// What one particle gives to the nodes.
#[derive(Clone, Copy)]
pub struct Parcel<V, const D: usize> {
    /// m v and m; with an affine field m v is that at the first node.
    pub motion: V,
    /// Change of m v from node to node along each axis.
    pub spread: [V; D],
    /// -V0 J sigma_{.j} / h of each axis j: the force is the sum over j of this times dN/dr_j.
    pub force: [V; D],
    /// -V0 J sigma_tt/r along x: where x is a radius, the force is also N times this.
    pub hoop: V,
}

impl<V: Wide, const D: usize> Parcel<V, D> {
    /// motion += N (m v, m), force -= V sigma grad N (line 5 of language.md 7.1); where x is a
    /// radius (`ROUND`) also f_r -= V sigma_tt N/r.
    #[inline(always)]
    pub fn scatter<
        const W: usize,
        const ROUND: bool,
        const MOTION: bool,
        const FORCE: bool,
        const AFFINE: bool,
    >(
        &self,
        stencil: &Stencil<D, W>,
        nodes: Shared<'_, Node>,
    ) {
        let (last, across) = (D - 1, Stencil::<D, W>::ACROSS);
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { stencil.of_shared(&nodes) };
        for i in 0..Stencil::<D, W>::PLANES {
            let plane = self.along_plane::<W, FORCE, AFFINE>(stencil, i);
            for j in 0..Stencil::<D, W>::ROWS {
                let Parcel { mut motion, spread, force, hoop } = plane;
                let (mut step, mut steep, mut flat) = (spread[last], force[last], V::splat(0.0));
                if D > 1 {
                    if AFFINE {
                        motion = V::splat(j as f64).mul_add(spread[across], motion);
                    }
                    let (value, slope) =
                        (stencil.value::<V>(across, j), stencil.slope::<V>(across, j));
                    (motion, step, steep) = (value * motion, value * step, value * steep);
                    flat = slope * force[across];
                    if ROUND {
                        flat = value.mul_add(hoop, flat);
                    }
                    if D == 3 {
                        flat = value.mul_add(force[0], flat);
                    }
                }
                let nodes = rows.row(i, j);
                for k in 0..W {
                    let (value, slope) = (stencil.value::<V>(last, k), stencil.slope::<V>(last, k));
                    let node = &mut nodes[k];
                    if MOTION {
                        value.mul_add(motion, V::load(&node.motion)).store(&mut node.motion);
                        if AFFINE {
                            motion = motion + step;
                        }
                    }
                    if FORCE {
                        let force = slope.mul_add(steep, V::load(&node.change));
                        let force = if D > 1 { value.mul_add(flat, force) } else { force };
                        force.store(&mut node.change);
                    }
                }
            }
        }
    }

    /// What plane `i` of the stencil gets: all but the force along the first axis is weighted with
    /// N, that force with dN/dr.
    #[inline(always)]
    fn along_plane<const W: usize, const FORCE: bool, const AFFINE: bool>(
        &self,
        stencil: &Stencil<D, W>,
        i: usize,
    ) -> Self {
        let mut plane = *self;
        if D < 3 {
            return plane;
        }
        let value = stencil.value::<V>(0, i);
        if AFFINE {
            plane.motion = V::splat(i as f64).mul_add(self.spread[0], plane.motion);
            for axis in 1..D {
                plane.spread[axis] = value * self.spread[axis];
            }
        }
        plane.motion = value * plane.motion;
        if FORCE {
            plane.force[0] = stencil.slope::<V>(0, i) * self.force[0];
            for axis in 1..D {
                plane.force[axis] = value * self.force[axis];
            }
        }
        plane
    }
}

/// force += N mbp: the external forces that fixes gave to particles (H1).
pub fn external_forces(tiles: &mut Tiles, world: &mut World) {
    by_kind!(world.domain.dimension, world.method.shape, external_of, tiles, world);
}

fn external_of<const D: usize, const W: usize, S: Shape<W> + Sync>(
    tiles: &mut Tiles,
    world: &mut World,
) {
    let World { particles, grid, method, solids, .. } = world;
    let places = particles.places(method.total);
    let nodes = Shared::new(&mut grid.nodes);
    let external = Shared::new(&mut grid.external);
    let force = [Column::Bx, Column::By, Column::Bz].map(|column| particles.column(column));
    tiles.sweep(|tile, _| {
        for p in tile.range {
            if solids[particles.solid[p] as usize].rigid {
                continue;
            }
            let force: [f64; 3] = force.map(|column| column.get(p).copied().unwrap_or(0.0));
            let stencil = tile.frame.stencil::<Plain, D, W, S>(Plain::load(&places[p]));
            // SAFETY: tiles of one colour share no node (see `tiles`).
            let mut rows = unsafe { stencil.of_shared(&nodes) };
            // SAFETY: as above.
            let mut apart = (!external.is_empty()).then(|| unsafe { stencil.of_shared(&external) });
            for (i, j) in rows_of::<D, W>() {
                for k in 0..W {
                    for axis in 0..D {
                        let share = stencil.weight(i, j, k) * force[axis];
                        rows.row(i, j)[k].change[axis] += share;
                        if let Some(external) = &mut apart {
                            external.row(i, j)[k][axis] += share;
                        }
                    }
                }
            }
        }
    });
}
