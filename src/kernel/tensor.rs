//! Sums over a stencil whose weights are products over the axes.
//!
//! Loops go over planes (along the first of three axes), rows (along the last but one axis) and
//! nodes, and multiply the weight of an axis in where its loop ends.

use super::scatter::Parcel;
use super::shared::Shared;
use super::stencil::Stencil;
use super::support::{Gathered, Support};
use crate::math::v4::Wide;
use crate::model::grid::Node;

impl<const D: usize, const W: usize> Support<D> for Stencil<D, W> {
    #[inline(always)]
    fn gather<V: Wide, const AFFINE: bool>(&self, steep: &Self, nodes: &[Node]) -> Gathered<V, D> {
        let zero = V::splat(0.0);
        let rows = self.of(nodes);
        let (last, across) = (D - 1, Stencil::<D, W>::ACROSS);
        let mut sum = Gathered { w: zero, a: zero, matrix: [zero; D] };
        for i in 0..Stencil::<D, W>::PLANES {
            let mut plane = Gathered { w: zero, a: zero, matrix: [zero; D] };
            for j in 0..Stencil::<D, W>::ROWS {
                let nodes = rows.row(i, j);
                let (value, motion) = (self.value::<V>(last, 0), V::load(&nodes[0].motion));
                let (mut w, mut a) = (value * motion, value * V::load(&nodes[0].change));
                let mut slope = steep.slope::<V>(last, 0) * motion;
                for k in 1..W {
                    let (value, motion) = (self.value::<V>(last, k), V::load(&nodes[k].motion));
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
                let value = self.value::<V>(across, j);
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
            let value = self.value::<V>(0, i);
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

    #[inline(always)]
    fn scatter_momentum<V: Wide, const AFFINE: bool>(
        &self,
        momentum: V,
        spread: &[V; D],
        mapped: Shared<'_, [f64; 4]>,
    ) {
        let (last, across) = (D - 1, Stencil::<D, W>::ACROSS);
        let mut first = momentum;
        if AFFINE {
            for axis in 0..D {
                first = V::splat(-self.offset(axis)).mul_add(spread[axis], first);
            }
        }
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&mapped) };
        for i in 0..Stencil::<D, W>::PLANES {
            let along = if D == 3 { self.value::<V>(0, i) } else { V::splat(1.0) };
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
                    2 => self.value::<V>(across, j),
                    _ => along * self.value::<V>(across, j),
                };
                let (mut momentum, step) = (value * momentum, value * spread[last]);
                let nodes = rows.row(i, j);
                for k in 0..W {
                    let node = &mut nodes[k];
                    self.value::<V>(last, k).mul_add(momentum, V::load(node)).store(node);
                    if AFFINE {
                        momentum = momentum + step;
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn scatter<
        V: Wide,
        const ROUND: bool,
        const MOTION: bool,
        const FORCE: bool,
        const AFFINE: bool,
    >(
        &self,
        mut parcel: Parcel<V, D>,
        nodes: Shared<'_, Node>,
    ) {
        if AFFINE {
            for axis in 0..D {
                let offset = V::splat(-self.offset(axis));
                parcel.motion = offset.mul_add(parcel.spread[axis], parcel.motion);
            }
        }
        let (last, across) = (D - 1, Stencil::<D, W>::ACROSS);
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&nodes) };
        for i in 0..Stencil::<D, W>::PLANES {
            let plane = self.along_plane::<V, FORCE, AFFINE>(&parcel, i);
            for j in 0..Stencil::<D, W>::ROWS {
                let Parcel { mut motion, spread, force, hoop } = plane;
                let (mut step, mut steep, mut flat) = (spread[last], force[last], V::splat(0.0));
                if D > 1 {
                    if AFFINE {
                        motion = V::splat(j as f64).mul_add(spread[across], motion);
                    }
                    let (value, slope) = (self.value::<V>(across, j), self.slope::<V>(across, j));
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
                    let (value, slope) = (self.value::<V>(last, k), self.slope::<V>(last, k));
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

    #[inline(always)]
    fn gradient_and_value<V: Wide>(&self, mapped: &[[f64; 4]]) -> ([V; D], V) {
        let (last, across, zero) = (D - 1, Stencil::<D, W>::ACROSS, V::splat(0.0));
        let rows = self.of(mapped);
        let mut sum = [zero; D];
        for i in 0..Stencil::<D, W>::PLANES {
            let mut plane = [zero; D];
            let mut plane_flat = zero;
            for j in 0..Stencil::<D, W>::ROWS {
                let nodes = rows.row(i, j);
                let (mut flat, mut steep) = (zero, zero);
                for k in 0..W {
                    let node = V::load(&nodes[k]);
                    flat = self.value::<V>(last, k).mul_add(node, flat);
                    steep = self.slope::<V>(last, k).mul_add(node, steep);
                }
                if D == 1 {
                    return ([steep; D], flat);
                }
                let (value, slope) = (self.value::<V>(across, j), self.slope::<V>(across, j));
                plane[last] = value.mul_add(steep, plane[last]);
                plane[across] = slope.mul_add(flat, plane[across]);
                plane_flat = value.mul_add(flat, plane_flat);
            }
            if D < 3 {
                return (plane, plane_flat);
            }
            let value = self.value::<V>(0, i);
            sum[0] = self.slope::<V>(0, i).mul_add(plane_flat, sum[0]);
            for axis in 1..D {
                sum[axis] = value.mul_add(plane[axis], sum[axis]);
            }
        }
        (sum, zero)
    }

    #[inline(always)]
    fn sum<V: Wide>(&self, nodes: &[[f64; 4]]) -> V {
        let (rows, mut sum) = (self.of(nodes), V::splat(0.0));
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..W {
                    let weight = V::splat(self.weight(i, j, k));
                    sum = weight.mul_add(V::load(&nodes[k]), sum);
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn add<V: Wide>(&self, amount: V, nodes: Shared<'_, [f64; 4]>) {
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&nodes) };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..W {
                    let weight = V::splat(self.weight(i, j, k));
                    weight.mul_add(amount, V::load(&nodes[k])).store(&mut nodes[k]);
                }
            }
        }
    }

    #[inline(always)]
    fn sum_of_numbers(&self, nodes: &[f64]) -> f64 {
        let (rows, mut sum) = (self.of(nodes), 0.0);
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                for k in 0..W {
                    sum += self.weight(i, j, k) * rows.row(i, j)[k];
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn add_number(&self, amount: f64, nodes: Shared<'_, f64>) {
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&nodes) };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..W {
                    nodes[k] += self.weight(i, j, k) * amount;
                }
            }
        }
    }

    #[inline(always)]
    fn add_divergence(&self, flux: [f64; 4], nodes: Shared<'_, f64>) {
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut nodes = unsafe { self.of_shared(&nodes) };
        let (last, across) = (D - 1, Self::ACROSS);
        let (value, slope) = (self.all_values(), self.all_slopes());
        for i in 0..Self::PLANES {
            let (along, steep_along) = match D {
                3 => (value[i][0], slope[i][0]),
                _ => (1.0, 0.0),
            };
            for j in 0..Self::ROWS {
                let (mut steep, mut flat) = (flux[last] * along, flux[0] * steep_along);
                if D > 1 {
                    steep *= value[j][across];
                    flat = flat * value[j][across] + flux[across] * along * slope[j][across];
                }
                let row = nodes.row(i, j);
                for k in 0..W {
                    row[k] += steep * slope[k][last] + flat * value[k][last];
                }
            }
        }
    }

    fn each_slope(&self, mut visit: impl FnMut(usize, f64, [f64; 3], [f64; 3])) {
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                for k in 0..W {
                    let (slopes, away) = (self.slopes(i, j, k), self.away(i, j, k));
                    visit(self.place(i, j, k), self.weight(i, j, k), slopes, away);
                }
            }
        }
    }

    fn each(&self, mut visit: impl FnMut(usize, f64)) {
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                for k in 0..W {
                    visit(self.place(i, j, k), self.weight(i, j, k));
                }
            }
        }
    }
}

impl<const D: usize, const W: usize> Stencil<D, W> {
    /// motion += N (m v, m), force += N force; with an affine field m v is that at the particle.
    #[inline(always)]
    pub fn scatter_values<V: Wide, const MOTION: bool, const FORCE: bool, const AFFINE: bool>(
        &self,
        mut motion: V,
        spread: [V; D],
        force: V,
        nodes: Shared<'_, Node>,
    ) {
        let (last, across) = (D - 1, Self::ACROSS);
        if AFFINE {
            for axis in 0..D {
                motion = V::splat(-self.offset(axis)).mul_add(spread[axis], motion);
            }
        }
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&nodes) };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let mut motion = motion;
                if AFFINE && D > 1 {
                    motion = V::splat(j as f64).mul_add(spread[across], motion);
                }
                if AFFINE && D == 3 {
                    motion = V::splat(i as f64).mul_add(spread[0], motion);
                }
                let nodes = rows.row(i, j);
                for k in 0..W {
                    let weight = V::splat(self.weight(i, j, k));
                    let node = &mut nodes[k];
                    if MOTION {
                        weight.mul_add(motion, V::load(&node.motion)).store(&mut node.motion);
                    }
                    if FORCE {
                        weight.mul_add(force, V::load(&node.change)).store(&mut node.change);
                    }
                    if AFFINE {
                        motion = motion + spread[last];
                    }
                }
            }
        }
    }

    /// What plane `i` gets: all but the force along the first axis is weighted with N, that force
    /// with dN/dr.
    #[inline(always)]
    fn along_plane<V: Wide, const FORCE: bool, const AFFINE: bool>(
        &self,
        parcel: &Parcel<V, D>,
        i: usize,
    ) -> Parcel<V, D> {
        let mut plane = *parcel;
        if D < 3 {
            return plane;
        }
        let value = self.value::<V>(0, i);
        if AFFINE {
            plane.motion = V::splat(i as f64).mul_add(parcel.spread[0], plane.motion);
            for axis in 1..D {
                plane.spread[axis] = value * parcel.spread[axis];
            }
        }
        plane.motion = value * plane.motion;
        if FORCE {
            plane.force[0] = self.slope::<V>(0, i) * parcel.force[0];
            for axis in 1..D {
                plane.force[axis] = value * parcel.force[axis];
            }
        }
        plane
    }
}
