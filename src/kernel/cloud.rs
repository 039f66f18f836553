//! Nodes seen through the corners of a particle's domain (CPDI): N_I = sum_c w_c N(x_c) and
//! grad N_I = sum_c g_c N(x_c) with the hats N, w_c and g_c the means of the finite element functions
//! of the corners and of their gradients over the domain (language.md 9.7).
//!
//! # Source  Sadeghirad, Brannon, Burghardt 2011; Sadeghirad, Brannon, Guilkey 2013

use super::domains::{self, Means};
use super::scatter::Parcel;
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use super::support::{Footprint, Gathered, Records, Support};
use crate::math::v4::Wide;
use crate::model::grid::Node;
use crate::shape::corners::corner_of_parallel;

/// The hats around at most `C` corners.
#[derive(Clone, Copy)]
pub struct Cloud<const D: usize, const C: usize> {
    /// Number of corners: `C`. Loops go up to it, since a compiler that knows their number writes
    /// each corner out, which takes minutes and gains nothing.
    count: usize,
    corners: [Stencil<D, 2>; C],
    /// w_c, and g_c per node spacing.
    means: Means<C>,
    /// Corners seen from the particle, in node spacings.
    arms: [[f64; 4]; C],
}

/// Domains that stay parallelograms or boxes (`R4`, `R8`; in one dimension two ends): the records are
/// half edges r_i, the corners x -+ r_1 -+ r_2 -+ r_3.
pub struct Parallel<const C: usize>;

/// Domains with corners that the grid carries along (`T3`, `Q4`, `Tet4`, `H8`): the records are the
/// corners seen from the particle.
pub struct Corners<const C: usize>;

impl<const D: usize, const C: usize> Footprint<D> for Parallel<C> {
    const RECORDS: usize = D;

    type Support = Cloud<D, C>;

    #[inline(always)]
    fn at<V: Wide>(
        frame: &Frame,
        place: &[f64; 4],
        records: &Records<'_>,
        p: usize,
    ) -> Self::Support {
        let mut edges = [[0.0; 4]; D];
        for axis in 0..D {
            edges[axis] = records[axis][p];
        }
        let mut offsets = [[0.0; 4]; C];
        for c in 0..frame.count.min(C) {
            offsets[c] = corner_of_parallel(&edges, c);
        }
        let means = domains::means_of_parallel::<D, C>(&edges, frame.spacing, frame.count);
        Cloud::new::<V>(frame, place, &offsets, |_| means)
    }
}

impl<const D: usize, const C: usize> Footprint<D> for Corners<C> {
    const RECORDS: usize = C;

    type Support = Cloud<D, C>;

    #[inline(always)]
    fn at<V: Wide>(
        frame: &Frame,
        place: &[f64; 4],
        records: &Records<'_>,
        p: usize,
    ) -> Self::Support {
        let mut offsets = [[0.0; 4]; C];
        for c in 0..frame.count.min(C) {
            offsets[c] = records[c][p];
        }
        let means = |arms: &[[f64; 4]; C]| domains::means::<D, C>(arms, frame.count);
        Cloud::new::<V>(frame, place, &offsets, means)
    }
}

impl<const D: usize, const C: usize> Cloud<D, C> {
    /// The cloud of a particle; `means` are found from the arms.
    #[inline(always)]
    fn new<V: Wide>(
        frame: &Frame,
        place: &[f64; 4],
        offsets: &[[f64; 4]; C],
        means: impl Fn(&[[f64; 4]; C]) -> Means<C>,
    ) -> Self {
        let place = V::load(place).with_last(V::splat(0.0));
        let inverse = V::splat(frame.inverse_spacing);
        let mut arms = [[0.0; 4]; C];
        let first = frame.corner(place, V::load(&offsets[0]));
        let mut corners = [frame.around::<V, D>(first); C];
        ((first - place) * inverse).store(&mut arms[0]);
        for c in 1..frame.count.min(C) {
            let corner = frame.corner(place, V::load(&offsets[c]));
            corners[c] = frame.around::<V, D>(corner);
            ((corner - place) * inverse).store(&mut arms[c]);
        }
        Self { count: frame.count.min(C), corners, means: means(&arms), arms }
    }

    /// m (v + C (x_c - x)) of a corner.
    #[inline(always)]
    fn at_corner<V: Wide, const AFFINE: bool>(&self, c: usize, motion: V, spread: &[V; D]) -> V {
        let mut motion = motion;
        if AFFINE {
            for axis in 0..D {
                motion = V::splat(self.arms[c][axis]).mul_add(spread[axis], motion);
            }
        }
        motion
    }
}

impl<const D: usize, const C: usize> Support<D> for Cloud<D, C> {
    #[inline(always)]
    fn gather<V: Wide, const AFFINE: bool>(&self, _: &Self, nodes: &[Node]) -> Gathered<V, D> {
        let zero = V::splat(0.0);
        let mut sum = Gathered { w: zero, a: zero, matrix: [zero; D] };
        for c in 0..self.count.min(C) {
            let corner = &self.corners[c];
            let seen = corner.gather::<V, false>(corner, nodes);
            let weight = V::splat(self.means.weight[c]);
            sum.w = weight.mul_add(seen.w, sum.w);
            sum.a = weight.mul_add(seen.a, sum.a);
            if AFFINE {
                for axis in 0..D {
                    let slope = V::splat(self.means.slope[c][axis]);
                    sum.matrix[axis] = slope.mul_add(seen.w, sum.matrix[axis]);
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
        for c in 0..self.count.min(C) {
            let weight = V::splat(self.means.weight[c]);
            let momentum = weight * self.at_corner::<V, AFFINE>(c, momentum, spread);
            let mut part = *spread;
            for axis in 0..D {
                part[axis] = weight * part[axis];
            }
            self.corners[c].scatter_momentum::<V, AFFINE>(momentum, &part, mapped);
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
        for c in 0..self.count.min(C) {
            let weight = V::splat(self.means.weight[c]);
            let motion = weight * self.at_corner::<V, AFFINE>(c, parcel.motion, &parcel.spread);
            let (mut spread, mut force) = (parcel.spread, V::splat(0.0));
            for axis in 0..D {
                spread[axis] = weight * spread[axis];
                let slope = V::splat(self.means.slope[c][axis]);
                force = slope.mul_add(parcel.force[axis], force);
            }
            if ROUND {
                force = weight.mul_add(parcel.hoop, force);
            }
            self.corners[c]
                .scatter_values::<V, MOTION, FORCE, AFFINE>(motion, spread, force, nodes);
        }
    }

    #[inline(always)]
    fn gradient_and_value<V: Wide>(&self, mapped: &[[f64; 4]]) -> ([V; D], V) {
        let mut sum = ([V::splat(0.0); D], V::splat(0.0));
        for c in 0..self.count.min(C) {
            let value = self.corners[c].sum::<V>(mapped);
            for axis in 0..D {
                sum.0[axis] = V::splat(self.means.slope[c][axis]).mul_add(value, sum.0[axis]);
            }
            sum.1 = V::splat(self.means.weight[c]).mul_add(value, sum.1);
        }
        sum
    }

    #[inline(always)]
    fn sum<V: Wide>(&self, nodes: &[[f64; 4]]) -> V {
        let mut sum = V::splat(0.0);
        for c in 0..self.count.min(C) {
            sum = V::splat(self.means.weight[c]).mul_add(self.corners[c].sum::<V>(nodes), sum);
        }
        sum
    }

    #[inline(always)]
    fn add<V: Wide>(&self, amount: V, nodes: Shared<'_, [f64; 4]>) {
        for c in 0..self.count.min(C) {
            self.corners[c].add::<V>(V::splat(self.means.weight[c]) * amount, nodes);
        }
    }

    #[inline(always)]
    fn sum_of_numbers(&self, nodes: &[f64]) -> f64 {
        let mut sum = 0.0;
        for c in 0..self.count.min(C) {
            sum += self.means.weight[c] * self.corners[c].sum_of_numbers(nodes);
        }
        sum
    }

    #[inline(always)]
    fn add_number(&self, amount: f64, nodes: Shared<'_, f64>) {
        for c in 0..self.count.min(C) {
            self.corners[c].add_number(self.means.weight[c] * amount, nodes);
        }
    }

    #[inline(always)]
    fn add_divergence(&self, flux: [f64; 4], nodes: Shared<'_, f64>) {
        for c in 0..self.count.min(C) {
            let mut amount = 0.0;
            for axis in 0..D {
                amount += flux[axis] * self.means.slope[c][axis];
            }
            self.corners[c].add_number(amount, nodes);
        }
    }

    fn each_slope(&self, mut visit: impl FnMut(usize, f64, [f64; 3], [f64; 3])) {
        for c in 0..self.count.min(C) {
            let ([x, y, z, _], [u, v, w, _]) = (self.means.slope[c], self.arms[c]);
            self.corners[c].each_slope(|node, value, _, away| {
                let slopes = [x, y, z].map(|slope| value * slope);
                let away = [away[0] - u, away[1] - v, away[2] - w];
                visit(node, self.means.weight[c] * value, slopes, away);
            });
        }
    }

    fn each(&self, mut visit: impl FnMut(usize, f64)) {
        for c in 0..self.count.min(C) {
            self.corners[c].each(|node, weight| visit(node, self.means.weight[c] * weight));
        }
    }
}

/// The velocity of each corner, sum N(x_c) v*.
#[inline(always)]
pub fn corner_velocities<V: Wide, const D: usize, const C: usize>(
    cloud: &Cloud<D, C>,
    nodes: &[Node],
) -> [[f64; 4]; C] {
    let mut velocity = [[0.0; 4]; C];
    for c in 0..cloud.count.min(C) {
        let corner = &cloud.corners[c];
        corner.gather::<V, false>(corner, nodes).w.store(&mut velocity[c]);
    }
    velocity
}
