//! The 3^d nodes around particles with small domains, with weights that are no products over the axes.
//!
//! Where all corners of a domain lie in two neighbouring cells along each axis, every node that they
//! see lies in one patch of three nodes per axis: weights and gradients are then summed over the
//! corners first, four particles side by side, and every node is visited once.

use super::scatter::Parcel;
use super::shared::{Rows, RowsMut, Shared};
use super::support::{Gathered, Support};
use crate::math::v4::Wide;
use crate::model::grid::Node;

/// The weights of four particles on `N` = 3^`D` nodes each; the lanes are the particles.
pub struct Patches<const D: usize, const N: usize> {
    /// Place in memory of the first node, see [`super::stencil::Frame::nodes_at`].
    pub base: [usize; 4],
    /// Step in memory from one node to the next along the outer axes.
    pub stride: [usize; 2],
    /// From the first node to the particle along each axis, in node spacings.
    pub offset: [[f64; 4]; D],
    /// N of each node, the last axis fastest.
    pub value: [[f64; 4]; N],
    /// grad N of each node per node spacing.
    pub slope: [[[f64; 4]; D]; N],
}

impl<const D: usize, const N: usize> Default for Patches<D, N> {
    fn default() -> Self {
        Self {
            base: [0; 4],
            stride: [0; 2],
            offset: [[0.0; 4]; D],
            value: [[0.0; 4]; N],
            slope: [[[0.0; 4]; D]; N],
        }
    }
}

/// The patch of one particle.
#[derive(Clone, Copy)]
pub struct Patch<'a, const D: usize, const N: usize> {
    /// Those of four.
    pub four: &'a Patches<D, N>,
    /// Which of them.
    pub lane: usize,
}

impl<const D: usize, const N: usize> Patch<'_, D, N> {
    /// Number of planes.
    const PLANES: usize = if D == 3 { 3 } else { 1 };

    /// Rows in a plane.
    const ROWS: usize = if D == 1 { 1 } else { 3 };

    /// Number of node `k` of row `j` of plane `i`.
    #[inline(always)]
    fn number(i: usize, j: usize, k: usize) -> usize {
        (i * Self::ROWS + j) * 3 + k
    }

    /// Along the axes from the first node to node `k` of row `j` of plane `i`.
    #[inline(always)]
    fn way(i: usize, j: usize, k: usize) -> [usize; 3] {
        match D {
            1 => [k, 0, 0],
            2 => [j, k, 0],
            _ => [i, j, k],
        }
    }

    #[inline(always)]
    fn value(&self, number: usize) -> f64 {
        self.four.value[number][self.lane & 3]
    }

    #[inline(always)]
    fn slope(&self, number: usize, axis: usize) -> f64 {
        self.four.slope[number][axis][self.lane & 3]
    }

    #[inline(always)]
    fn offset(&self, axis: usize) -> f64 {
        self.four.offset[axis][self.lane & 3]
    }

    #[inline(always)]
    fn base(&self) -> usize {
        self.four.base[self.lane & 3]
    }

    #[inline(always)]
    fn of<'b, T>(&self, nodes: &'b [T]) -> Rows<'b, T, D, 3> {
        Rows::new(nodes, self.base(), self.four.stride)
    }

    /// # Safety
    /// As for [`Shared::rows`].
    #[inline(always)]
    unsafe fn of_shared<'b, T>(&self, nodes: &Shared<'b, T>) -> RowsMut<'b, T, D, 3> {
        // SAFETY: the caller's promise.
        unsafe { nodes.rows(self.base(), self.four.stride) }
    }

    /// m v at the first node, of the affine field with m v at the particle.
    #[inline(always)]
    fn at_first<V: Wide, const AFFINE: bool>(&self, motion: V, spread: &[V; D]) -> V {
        let mut first = motion;
        if AFFINE {
            for axis in 0..D {
                first = V::splat(-self.offset(axis)).mul_add(spread[axis], first);
            }
        }
        first
    }

    /// m v at node `k` of row `j` of plane `i`.
    #[inline(always)]
    fn at_node<V: Wide, const AFFINE: bool>(first: V, spread: &[V; D], [i, j, k]: [usize; 3]) -> V {
        let mut motion = first;
        if AFFINE {
            let way = Self::way(i, j, k);
            for axis in 0..D {
                motion = V::splat(way[axis] as f64).mul_add(spread[axis], motion);
            }
        }
        motion
    }
}

impl<const D: usize, const N: usize> Support<D> for Patch<'_, D, N> {
    #[inline(always)]
    fn gather<V: Wide, const AFFINE: bool>(&self, _: &Self, nodes: &[Node]) -> Gathered<V, D> {
        let (rows, zero) = (self.of(nodes), V::splat(0.0));
        let mut sum = Gathered { w: zero, a: zero, matrix: [zero; D] };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..3 {
                    let number = Self::number(i, j, k);
                    let (value, motion) = (V::splat(self.value(number)), V::load(&nodes[k].motion));
                    sum.w = value.mul_add(motion, sum.w);
                    sum.a = value.mul_add(V::load(&nodes[k].change), sum.a);
                    if AFFINE {
                        for axis in 0..D {
                            let slope = V::splat(self.slope(number, axis));
                            sum.matrix[axis] = slope.mul_add(motion, sum.matrix[axis]);
                        }
                    }
                }
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
        let first = self.at_first::<V, AFFINE>(momentum, spread);
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&mapped) };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..3 {
                    let momentum = Self::at_node::<V, AFFINE>(first, spread, [i, j, k]);
                    let value = V::splat(self.value(Self::number(i, j, k)));
                    value.mul_add(momentum, V::load(&nodes[k])).store(&mut nodes[k]);
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
        parcel: Parcel<V, D>,
        nodes: Shared<'_, Node>,
    ) {
        let first = self.at_first::<V, AFFINE>(parcel.motion, &parcel.spread);
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&nodes) };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..3 {
                    let (number, node) = (Self::number(i, j, k), &mut nodes[k]);
                    let value = V::splat(self.value(number));
                    if MOTION {
                        let motion = Self::at_node::<V, AFFINE>(first, &parcel.spread, [i, j, k]);
                        value.mul_add(motion, V::load(&node.motion)).store(&mut node.motion);
                    }
                    if FORCE {
                        let mut force = V::load(&node.change);
                        for axis in 0..D {
                            let slope = V::splat(self.slope(number, axis));
                            force = slope.mul_add(parcel.force[axis], force);
                        }
                        if ROUND {
                            force = value.mul_add(parcel.hoop, force);
                        }
                        force.store(&mut node.change);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn gradient_and_value<V: Wide>(&self, mapped: &[[f64; 4]]) -> ([V; D], V) {
        let rows = self.of(mapped);
        let mut sum = ([V::splat(0.0); D], V::splat(0.0));
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..3 {
                    let (number, node) = (Self::number(i, j, k), V::load(&nodes[k]));
                    for axis in 0..D {
                        let slope = V::splat(self.slope(number, axis));
                        sum.0[axis] = slope.mul_add(node, sum.0[axis]);
                    }
                    sum.1 = V::splat(self.value(number)).mul_add(node, sum.1);
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn sum<V: Wide>(&self, nodes: &[[f64; 4]]) -> V {
        let (rows, mut sum) = (self.of(nodes), V::splat(0.0));
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..3 {
                    let value = V::splat(self.value(Self::number(i, j, k)));
                    sum = value.mul_add(V::load(&nodes[k]), sum);
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn add<V: Wide>(&self, amount: V, nodes: Shared<'_, [f64; 4]>) {
        self.scatter_momentum::<V, false>(amount, &[V::splat(0.0); D], nodes);
    }

    #[inline(always)]
    fn sum_of_numbers(&self, nodes: &[f64]) -> f64 {
        let (rows, mut sum) = (self.of(nodes), 0.0);
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                for k in 0..3 {
                    sum += self.value(Self::number(i, j, k)) * rows.row(i, j)[k];
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
                for k in 0..3 {
                    nodes[k] += self.value(Self::number(i, j, k)) * amount;
                }
            }
        }
    }

    #[inline(always)]
    fn add_divergence(&self, flux: [f64; 4], nodes: Shared<'_, f64>) {
        // SAFETY: tiles of one colour share no node (see `tiles`).
        let mut rows = unsafe { self.of_shared(&nodes) };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                let nodes = rows.row(i, j);
                for k in 0..3 {
                    for axis in 0..D {
                        nodes[k] += self.slope(Self::number(i, j, k), axis) * flux[axis];
                    }
                }
            }
        }
    }

    fn each(&self, mut visit: impl FnMut(usize, f64)) {
        self.each_slope(|node, value, _, _| visit(node, value));
    }

    fn each_slope(&self, mut visit: impl FnMut(usize, f64, [f64; 3], [f64; 3])) {
        let [plane, row] = if D == 3 { self.four.stride } else { [0, self.four.stride[0]] };
        for i in 0..Self::PLANES {
            for j in 0..Self::ROWS {
                for k in 0..3 {
                    let (number, way) = (Self::number(i, j, k), Self::way(i, j, k));
                    let (mut slopes, mut away) = ([0.0; 3], [0.0; 3]);
                    for axis in 0..D {
                        slopes[axis] = self.slope(number, axis);
                        away[axis] = self.offset(axis) - way[axis] as f64;
                    }
                    let (place, value) =
                        (self.base() + i * plane + j * row + k, self.value(number));
                    if value != 0.0 || slopes != [0.0; 3] {
                        visit(place, value, slopes, away);
                    }
                }
            }
        }
    }
}
