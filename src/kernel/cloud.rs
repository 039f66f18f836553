//! Nodes seen through the corners of a particle's domain (CPDI): N_I = sum_c w_c N(x_c) and
//! grad N_I = sum_c g_c N(x_c) with the hats N, w_c and g_c the means of the finite element functions
//! of the corners and of their gradients over the domain (language.md 9.7).
//!
//! Weights are found for four particles side by side. A small domain sees a patch of nodes
//! ([`super::patch`]), every other one the hats around its corners, one corner after the other. Which
//! of both depends on the particle alone.
//!
//! # Source  Sadeghirad, Brannon, Burghardt 2011; Sadeghirad, Brannon, Guilkey 2013

use super::domains::{self, Means, Vectors};
use super::patch::{Patch, Patches};
use super::scatter::Parcel;
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use super::support::{Footprint, Gathered, Records, Support};
use crate::math::v4::{Sweep, Wide, dispatch, splats};
use crate::model::grid::Node;
use crate::shape::EDGE;

/// Domains with `C` corners. Those that stay parallelograms or boxes (`R4`, `R8`; in one dimension two
/// ends) have half edges r_i as records, the corners are x -+ r_1 -+ r_2 -+ r_3. Corners that are `FREE`
/// (`T3`, `Q4`, `Tet4`, `H8`) move with the grid each for itself, the records are the corners seen
/// from the particle. `N`: nodes of the patch of a small domain, 1 if all are seen through corners.
pub struct Corners<const C: usize, const N: usize, const FREE: bool>;

/// What the particles of a group of four see; the lanes are the particles.
pub struct Clouds<const D: usize, const C: usize, const N: usize> {
    /// First particle of the group.
    first: usize,
    /// Above 0 for particles that do not fit into their patch, in node spacings.
    excess: [f64; 4],
    patches: Patches<D, N>,
    hats: Hats<D, C>,
}

/// The hats around the corners of four domains.
struct Hats<const D: usize, const C: usize> {
    /// Number of corners: `C`. Loops go up to it, since a compiler that knows their number writes
    /// each corner out, which takes minutes and gains nothing.
    count: usize,
    /// Place in memory of the first node around each corner.
    base: [[usize; 4]; C],
    stride: [usize; 2],
    /// Distance of the corner from that node along each axis, in node spacings.
    fraction: [[[f64; 4]; D]; C],
    /// Distance of the particle from that node.
    offset: [[[f64; 4]; D]; C],
    /// w_c.
    weight: [[f64; 4]; C],
    /// g_c per node spacing.
    slope: [[[f64; 4]; D]; C],
}

impl<const D: usize, const C: usize, const N: usize> Default for Clouds<D, C, N> {
    fn default() -> Self {
        let hats = Hats {
            count: C,
            base: [[0; 4]; C],
            stride: [0; 2],
            fraction: [[[0.0; 4]; D]; C],
            offset: [[[0.0; 4]; D]; C],
            weight: [[0.0; 4]; C],
            slope: [[[0.0; 4]; D]; C],
        };
        Self { first: usize::MAX, excess: [0.0; 4], patches: Patches::default(), hats }
    }
}

impl<const D: usize, const C: usize, const N: usize, const FREE: bool> Footprint<D>
    for Corners<C, N, FREE>
{
    const RECORDS: usize = if FREE { C } else { D };

    const FREE: bool = FREE;

    type Memory = Clouds<D, C, N>;

    type Support<'a> = Cloud<'a, D, C, N>;

    #[inline(always)]
    fn at<'a, V: Wide, const SLOPES: bool, const CORNERS: bool>(
        memory: &'a mut Self::Memory,
        frame: &Frame,
        places: &[[f64; 4]],
        records: &Records<'_>,
        p: usize,
    ) -> Self::Support<'a> {
        let first = p & !3;
        if memory.first != first {
            memory.first = first;
            find(Find::<'_, D, C, N, FREE, SLOPES, CORNERS> {
                clouds: memory,
                frame,
                places,
                records,
            });
        }
        let lane = p & 3;
        let at_corners = AtCorners { four: &memory.hats, lane };
        match N > 1 && memory.excess[lane] <= 0.0 {
            true => Cloud::Near(Patch { four: &memory.patches, lane }, at_corners),
            false => Cloud::Far(at_corners),
        }
    }
}

/// What a group sees, compiled once for all sweeps.
struct Find<
    'a,
    const D: usize,
    const C: usize,
    const N: usize,
    const FREE: bool,
    const SLOPES: bool,
    const CORNERS: bool,
> {
    clouds: &'a mut Clouds<D, C, N>,
    frame: &'a Frame,
    places: &'a [[f64; 4]],
    records: &'a Records<'a>,
}

#[inline(never)]
fn find<S: Sweep<Output = ()>>(work: S) {
    dispatch(work);
}

impl<
    const D: usize,
    const C: usize,
    const N: usize,
    const FREE: bool,
    const SLOPES: bool,
    const CORNERS: bool,
> Sweep for Find<'_, D, C, N, FREE, SLOPES, CORNERS>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        self.clouds.find::<V, FREE, SLOPES, CORNERS>(self.frame, self.places, self.records);
    }
}

/// Records `first` to `first + 3` with the axes in place of the particles; the last one stands for
/// those that are missing.
#[inline(always)]
fn four<V: Wide>(records: &[[f64; 4]], first: usize) -> [V; 4] {
    let mut rows = [V::splat(0.0); 4];
    if let Some(four) = records.get(first..first + 4) {
        for lane in 0..4 {
            rows[lane] = V::load(&four[lane]);
        }
    } else {
        for lane in 0..4 {
            rows[lane] = V::load(&records[(first + lane).min(records.len() - 1)]);
        }
    }
    V::transpose(rows)
}

/// Four domains in node spacings.
struct Shapes<V, const D: usize, const C: usize> {
    /// Particles seen from node 0.
    place: Vectors<V>,
    /// Half edges, of parallel domains.
    edges: [Vectors<V>; D],
    /// Corners seen from the particles.
    arms: [Vectors<V>; C],
}

impl<const D: usize, const C: usize, const N: usize> Clouds<D, C, N> {
    /// Finds what the group that begins at `self.first` sees: gradients only if `SLOPES`, the hats
    /// around corners if `CORNERS` or where a particle needs them.
    #[inline(always)]
    fn find<V: Wide, const FREE: bool, const SLOPES: bool, const CORNERS: bool>(
        &mut self,
        frame: &Frame,
        places: &[[f64; 4]],
        records: &Records<'_>,
    ) {
        let inverse = V::splat(frame.inverse_spacing);
        let zero = V::splat(0.0);
        let mut shapes = Shapes { place: [zero; 3], edges: [[zero; 3]; D], arms: [[zero; 3]; C] };
        let place = four::<V>(places, self.first);
        for k in 0..D {
            shapes.place[k] = (place[k] - V::splat(frame.lower(k))) * inverse;
        }
        if FREE {
            for c in 0..C {
                let arm = four::<V>(records[c], self.first);
                for k in 0..D {
                    shapes.arms[c][k] = inverse * arm[k];
                }
            }
        } else {
            for axis in 0..D {
                let edge = four::<V>(records[axis], self.first);
                for k in 0..D {
                    shapes.edges[axis][k] = inverse * edge[k];
                }
            }
            shapes.arms = domains::corners_of_parallel::<V, D, C>(&shapes.edges);
        }
        self.excess = [1.0; 4];
        let first = if N > 1 { self.first_nodes::<V, FREE>(frame, &shapes) } else { [zero; D] };
        // What is not a number does not fit either.
        let fit = self.excess.iter().all(|excess| *excess <= 0.0);
        if (FREE && CORNERS) || !fit {
            self.find_hats(frame, &mut shapes);
        }
        let means = match FREE {
            true => domains::means::<V, D, C>(&shapes.arms),
            false => domains::means_of_parallel::<V, D, C>(&shapes.edges),
        };
        if N > 1 {
            self.weigh::<V, FREE, SLOPES>(&shapes, &first, &means);
        }
        if (FREE && CORNERS) || !fit {
            for c in 0..C {
                means.weight[c].store(&mut self.hats.weight[c]);
                for k in 0..D {
                    means.slope[c][k].store(&mut self.hats.slope[c][k]);
                }
            }
        }
    }

    /// The first node of each patch; `excess` tells how far corners lie outside it, outside the
    /// lattice, or farther from the particle than they may; it is no number where an arm is none.
    #[inline(always)]
    fn first_nodes<V: Wide, const FREE: bool>(
        &mut self,
        frame: &Frame,
        shapes: &Shapes<V, D, C>,
    ) -> [V; D] {
        let [zero, two, reach]: [V; 3] = splats([0.0, 2.0, frame.reach_in_spacings()]);
        let mut firsts = [zero; D];
        let (mut excess, mut sum) = (zero - two, zero);
        for k in 0..D {
            let (mut low, mut high) = (shapes.arms[0][k], shapes.arms[0][k]);
            if FREE {
                sum = sum + low;
                for c in 1..C {
                    let arm = shapes.arms[c][k];
                    (low, high, sum) = (low.smaller(arm), high.larger(arm), sum + arm);
                }
                excess = ((zero - low).larger(high) - reach).larger(excess);
            } else {
                // Domains of two spacings at most: no corner lies farther than one from its centre.
                high = shapes.edges[0][k].absolute();
                for axis in 1..D {
                    high = high + shapes.edges[axis][k].absolute();
                }
                (low, sum) = (zero - high, sum + high);
            }
            (low, high) = (shapes.place[k] + low, shapes.place[k] + high);
            let first = low.floor().smaller(V::splat(frame.last(k)) - two).larger(zero);
            excess = (first - low).larger(high - first - two).larger(excess);
            (shapes.place[k] - first).store(&mut self.patches.offset[k]);
            firsts[k] = first;
        }
        // Nothing is added, but what is not a number stays none.
        zero.mul_add(sum, excess).store(&mut self.excess);
        self.patches.stride = frame.stride();
        self.patches.base = frame.nodes_at(&firsts);
        firsts
    }

    /// Weights and gradients on the patches: sums over the corners.
    #[inline(always)]
    fn weigh<V: Wide, const FREE: bool, const SLOPES: bool>(
        &mut self,
        shapes: &Shapes<V, D, C>,
        first: &[V; D],
        means: &Means<V, C>,
    ) {
        let [zero, one]: [V; 2] = splats([0.0, 1.0]);
        // The hats of three nodes per axis at each corner, that lie from 0 to 2 on patches that count.
        let mut hats = [[[one; 3]; D]; C];
        for k in 0..D {
            let middle = shapes.place[k] - first[k] - one;
            for c in 0..C {
                let d = middle + shapes.arms[c][k];
                hats[c][k] = [(zero - d).larger(zero), one - d.absolute(), d.larger(zero)];
            }
        }
        // Of parallel domains g_c/w_c is what is needed: the hats carry w_c.
        let mut steep = means.slope;
        if !FREE {
            for c in 0..C / 2 {
                for axis in 0..D {
                    steep[c][axis] = V::splat(C as f64) * steep[c][axis];
                }
            }
        }
        let (planes, rows) = (if D == 3 { 3 } else { 1 }, if D == 1 { 1 } else { 3 });
        let weighted = !(FREE && SLOPES);
        for i in 0..planes {
            for j in 0..rows {
                let mut row = if weighted { means.weight } else { [one; C] };
                for c in 0..C {
                    if D > 1 {
                        row[c] = row[c] * hats[c][D - 2][j];
                    }
                    if D == 3 {
                        row[c] = row[c] * hats[c][0][i];
                    }
                }
                for k in 0..3 {
                    let (mut value, mut slope) = (zero, [zero; D]);
                    if !SLOPES {
                        value = row[0] * hats[0][D - 1][k];
                        for c in 1..C {
                            value = row[c].mul_add(hats[c][D - 1][k], value);
                        }
                    } else if FREE {
                        for c in 0..C {
                            let hat = row[c] * hats[c][D - 1][k];
                            value = means.weight[c].mul_add(hat, value);
                            for axis in 0..D {
                                slope[axis] = means.slope[c][axis].mul_add(hat, slope[axis]);
                            }
                        }
                    } else {
                        // Gradients of opposite corners differ in sign, weights are equal.
                        for c in 0..C / 2 {
                            let other = opposite(C, c);
                            let here = row[c] * hats[c][D - 1][k];
                            let there = row[other] * hats[other][D - 1][k];
                            value = value + (here + there);
                            for axis in 0..D {
                                let steep = steep[c][axis];
                                slope[axis] = steep.mul_add(here - there, slope[axis]);
                            }
                        }
                    }
                    let number = (i * rows + j) * 3 + k;
                    value.store(&mut self.patches.value[number]);
                    if SLOPES {
                        for axis in 0..D {
                            slope[axis].store(&mut self.patches.slope[number][axis]);
                        }
                    }
                }
            }
        }
    }

    /// The hats around the corners. Corners end where the tile of the particle and the lattice end on
    /// the way to them.
    #[inline(always)]
    fn find_hats<V: Wide>(&mut self, frame: &Frame, shapes: &mut Shapes<V, D, C>) {
        let [zero, one, reach]: [V; 3] = splats([0.0, 1.0, frame.reach_in_spacings()]);
        let [edge, other_edge]: [V; 2] = splats([EDGE, 1.0 - EDGE]);
        let (excess, hats) = (V::load(&self.excess), &mut self.hats);
        hats.stride = frame.stride();
        for c in 0..hats.count.min(C) {
            let mut cells = [zero; D];
            for k in 0..D {
                let (place, last) = (shapes.place[k], V::splat(frame.last(k)));
                let arm = shapes.arms[c][k].smaller(reach).larger(zero - reach);
                let corner = (place + arm).larger(zero).smaller(last);
                cells[k] = corner.floor().smaller(last - one);
                let fraction = (corner - cells[k]).larger(edge).smaller(other_edge);
                fraction.store(&mut hats.fraction[c][k]);
                (place - cells[k]).store(&mut hats.offset[c][k]);
                // Particles that fit into their patches keep theirs to the bit.
                shapes.arms[c][k] = zero.below(excess, corner - place, shapes.arms[c][k]);
            }
            hats.base[c] = frame.nodes_at(&cells);
        }
    }
}

/// The corner of a parallel domain with `corners` corners that lies opposite to the `c`-th.
const fn opposite(corners: usize, c: usize) -> usize {
    match corners {
        8 => [6, 7, 4, 5][c],
        4 => c + 2,
        _ => 1,
    }
}

/// What one particle sees.
#[derive(Clone, Copy)]
pub enum Cloud<'a, const D: usize, const C: usize, const N: usize> {
    /// A patch; the hats around the corners are there if they were asked for.
    Near(Patch<'a, D, N>, AtCorners<'a, D, C>),
    /// The hats around its corners.
    Far(AtCorners<'a, D, C>),
}

/// Calls a method of whichever of both it is.
macro_rules! whichever {
    ($cloud:expr, $support:ident => $call:expr) => {
        match $cloud {
            Cloud::Near($support, _) => $call,
            Cloud::Far($support) => $call,
        }
    };
}

impl<const D: usize, const C: usize, const N: usize> Support<D> for Cloud<'_, D, C, N> {
    #[inline(always)]
    fn gather<V: Wide, const AFFINE: bool>(&self, _: &Self, nodes: &[Node]) -> Gathered<V, D> {
        whichever!(self, support => support.gather::<V, AFFINE>(support, nodes))
    }

    #[inline(always)]
    fn carry<V: Wide>(&self, nodes: &[Node], velocities: &mut [[f64; 4]]) {
        let (Cloud::Near(_, at_corners) | Cloud::Far(at_corners)) = self;
        at_corners.carry::<V>(nodes, velocities);
    }

    #[inline(always)]
    fn scatter_momentum<V: Wide, const AFFINE: bool>(
        &self,
        momentum: V,
        spread: &[V; D],
        mapped: Shared<'_, [f64; 4]>,
    ) {
        whichever!(self, support => support.scatter_momentum::<V, AFFINE>(momentum, spread, mapped));
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
        whichever!(self, support =>
            support.scatter::<V, ROUND, MOTION, FORCE, AFFINE>(parcel, nodes));
    }

    #[inline(always)]
    fn gradient_and_value<V: Wide>(&self, mapped: &[[f64; 4]]) -> ([V; D], V) {
        whichever!(self, support => support.gradient_and_value::<V>(mapped))
    }

    #[inline(always)]
    fn sum<V: Wide>(&self, nodes: &[[f64; 4]]) -> V {
        whichever!(self, support => support.sum::<V>(nodes))
    }

    #[inline(always)]
    fn add<V: Wide>(&self, amount: V, nodes: Shared<'_, [f64; 4]>) {
        whichever!(self, support => support.add::<V>(amount, nodes));
    }

    #[inline(always)]
    fn sum_of_numbers(&self, nodes: &[f64]) -> f64 {
        whichever!(self, support => support.sum_of_numbers(nodes))
    }

    #[inline(always)]
    fn add_number(&self, amount: f64, nodes: Shared<'_, f64>) {
        whichever!(self, support => support.add_number(amount, nodes));
    }

    #[inline(always)]
    fn add_divergence(&self, flux: [f64; 4], nodes: Shared<'_, f64>) {
        whichever!(self, support => support.add_divergence(flux, nodes));
    }

    fn each(&self, visit: impl FnMut(usize, f64)) {
        whichever!(self, support => support.each(visit));
    }

    fn each_slope(&self, visit: impl FnMut(usize, f64, [f64; 3], [f64; 3])) {
        whichever!(self, support => support.each_slope(visit));
    }
}

/// The hats around the corners of one domain.
#[derive(Clone, Copy)]
pub struct AtCorners<'a, const D: usize, const C: usize> {
    four: &'a Hats<D, C>,
    lane: usize,
}

impl<const D: usize, const C: usize> AtCorners<'_, D, C> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.four.count.min(C)
    }

    /// w_c.
    #[inline(always)]
    fn weight(&self, c: usize) -> f64 {
        self.four.weight[c][self.lane & 3]
    }

    /// g_c along an axis.
    #[inline(always)]
    fn slope(&self, c: usize, axis: usize) -> f64 {
        self.four.slope[c][axis][self.lane & 3]
    }

    /// The hats around a corner; they lie at their distance from the particle.
    #[inline(always)]
    fn hats(&self, c: usize) -> Stencil<D, 2> {
        let (mut fraction, mut offset) = ([0.0; D], [0.0; D]);
        for axis in 0..D {
            fraction[axis] = self.four.fraction[c][axis][self.lane & 3];
            offset[axis] = self.four.offset[c][axis][self.lane & 3];
        }
        Stencil::of_hats(self.four.base[c][self.lane & 3], self.four.stride, fraction, offset)
    }
}

impl<const D: usize, const C: usize> Support<D> for AtCorners<'_, D, C> {
    #[inline(always)]
    fn gather<V: Wide, const AFFINE: bool>(&self, _: &Self, nodes: &[Node]) -> Gathered<V, D> {
        let zero = V::splat(0.0);
        let mut sum = Gathered { w: zero, a: zero, matrix: [zero; D] };
        for c in 0..self.count() {
            let hats = self.hats(c);
            let seen = hats.gather::<V, false>(&hats, nodes);
            let weight = V::splat(self.weight(c));
            sum.w = weight.mul_add(seen.w, sum.w);
            sum.a = weight.mul_add(seen.a, sum.a);
            if AFFINE {
                for axis in 0..D {
                    let slope = V::splat(self.slope(c, axis));
                    sum.matrix[axis] = slope.mul_add(seen.w, sum.matrix[axis]);
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn carry<V: Wide>(&self, nodes: &[Node], velocities: &mut [[f64; 4]]) {
        for (c, velocity) in velocities.iter_mut().enumerate().take(self.count()) {
            let hats = self.hats(c);
            hats.gather::<V, false>(&hats, nodes).w.store(velocity);
        }
    }

    #[inline(always)]
    fn scatter_momentum<V: Wide, const AFFINE: bool>(
        &self,
        momentum: V,
        spread: &[V; D],
        mapped: Shared<'_, [f64; 4]>,
    ) {
        for c in 0..self.count() {
            let weight = V::splat(self.weight(c));
            let mut part = *spread;
            for axis in 0..D {
                part[axis] = weight * part[axis];
            }
            self.hats(c).scatter_momentum::<V, AFFINE>(weight * momentum, &part, mapped);
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
        for c in 0..self.count() {
            let weight = V::splat(self.weight(c));
            let (mut spread, mut force) = (parcel.spread, V::splat(0.0));
            for axis in 0..D {
                spread[axis] = weight * spread[axis];
                force = V::splat(self.slope(c, axis)).mul_add(parcel.force[axis], force);
            }
            if ROUND {
                force = weight.mul_add(parcel.hoop, force);
            }
            let motion = weight * parcel.motion;
            self.hats(c).scatter_values::<V, MOTION, FORCE, AFFINE>(motion, spread, force, nodes);
        }
    }

    #[inline(always)]
    fn gradient_and_value<V: Wide>(&self, mapped: &[[f64; 4]]) -> ([V; D], V) {
        let mut sum = ([V::splat(0.0); D], V::splat(0.0));
        for c in 0..self.count() {
            let value = self.hats(c).sum::<V>(mapped);
            for axis in 0..D {
                sum.0[axis] = V::splat(self.slope(c, axis)).mul_add(value, sum.0[axis]);
            }
            sum.1 = V::splat(self.weight(c)).mul_add(value, sum.1);
        }
        sum
    }

    #[inline(always)]
    fn sum<V: Wide>(&self, nodes: &[[f64; 4]]) -> V {
        let mut sum = V::splat(0.0);
        for c in 0..self.count() {
            sum = V::splat(self.weight(c)).mul_add(self.hats(c).sum::<V>(nodes), sum);
        }
        sum
    }

    #[inline(always)]
    fn add<V: Wide>(&self, amount: V, nodes: Shared<'_, [f64; 4]>) {
        for c in 0..self.count() {
            self.hats(c).add::<V>(V::splat(self.weight(c)) * amount, nodes);
        }
    }

    #[inline(always)]
    fn sum_of_numbers(&self, nodes: &[f64]) -> f64 {
        let mut sum = 0.0;
        for c in 0..self.count() {
            sum += self.weight(c) * self.hats(c).sum_of_numbers(nodes);
        }
        sum
    }

    #[inline(always)]
    fn add_number(&self, amount: f64, nodes: Shared<'_, f64>) {
        for c in 0..self.count() {
            self.hats(c).add_number(self.weight(c) * amount, nodes);
        }
    }

    #[inline(always)]
    fn add_divergence(&self, flux: [f64; 4], nodes: Shared<'_, f64>) {
        for c in 0..self.count() {
            let mut amount = 0.0;
            for axis in 0..D {
                amount += flux[axis] * self.slope(c, axis);
            }
            self.hats(c).add_number(amount, nodes);
        }
    }

    fn each_slope(&self, mut visit: impl FnMut(usize, f64, [f64; 3], [f64; 3])) {
        for c in 0..self.count() {
            let mut slopes = [0.0; 3];
            for axis in 0..D {
                slopes[axis] = self.slope(c, axis);
            }
            self.hats(c).each_slope(|node, value, _, away| {
                visit(node, self.weight(c) * value, slopes.map(|slope| value * slope), away);
            });
        }
    }

    fn each(&self, mut visit: impl FnMut(usize, f64)) {
        for c in 0..self.count() {
            self.hats(c).each(|node, value| visit(node, self.weight(c) * value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::element::SIGNS;
    use crate::math::v4::Plain;
    use crate::model::domain::Domain;
    use crate::model::lattice::{Lattice, Window};

    const CELLS: usize = 8;

    fn frame(dimension: usize) -> Frame {
        let within = |axis: usize| axis < dimension;
        let upper = std::array::from_fn(|axis| if within(axis) { CELLS as f64 } else { 0.0 });
        let cells = Domain { dimension, lower: [0.0; 3], upper, cell: 1.0 };
        let size = std::array::from_fn(|axis| if within(axis) { CELLS + 1 } else { 1 });
        let window = Window { lower: [0; 3], size, start: 0 };
        Frame::new(&Lattice { window, ..Lattice::new(cells, 1) }, None, 2)
    }

    /// Some places, all but the `far`-th with domains of less than two cells; records of `kind`.
    fn group<const D: usize, const C: usize, const FREE: bool>(
        far: usize,
    ) -> (Vec<[f64; 4]>, Vec<Vec<[f64; 4]>>) {
        let mut records = vec![Vec::new(); if FREE { C } else { D }];
        let noise = |n: usize| (1.7 * n as f64).sin();
        let places = (0..4).map(|p| {
            let mut place = [0.0, 0.0, 0.0, 1.0];
            for (axis, x) in place.iter_mut().enumerate().take(D) {
                *x = 4.0 + 1.3 * noise(5 * p + axis);
            }
            let size = if p == far { 1.4 } else { 0.35 };
            for (number, record) in records.iter_mut().enumerate() {
                let mut entry = [0.0; 4];
                for (axis, x) in entry.iter_mut().enumerate().take(D) {
                    let unit = match FREE {
                        true => SIGNS[number][axis],
                        false => f64::from(u8::from(axis == number)),
                    };
                    *x = size * (unit + 0.3 * noise(7 * p + 3 * number + axis));
                }
                record.push(entry);
            }
            place
        });
        let places = places.collect();
        (places, records)
    }

    /// Weight and gradient of every node.
    fn seen<const D: usize>(support: &impl Support<D>) -> Vec<[f64; 4]> {
        let mut nodes = vec![[0.0; 4]; (CELLS + 1).pow(D as u32)];
        support.each_slope(|node, value, slopes, _| {
            nodes[node][0] += value;
            for axis in 0..D {
                nodes[node][axis + 1] += slopes[axis];
            }
        });
        nodes
    }

    fn each_particle<const D: usize, const C: usize, const N: usize, const FREE: bool>(
        far: usize,
        mut visit: impl FnMut(usize, Cloud<'_, D, C, N>),
    ) {
        let (places, store) = group::<D, C, FREE>(far);
        let mut records: Records<'_> = Default::default();
        for (record, store) in records.iter_mut().zip(&store) {
            *record = store;
        }
        let mut memory = Clouds::default();
        for p in 0..places.len() {
            let (frame, records) = (&frame(D), &records);
            visit(
                p,
                Corners::<C, N, FREE>::at::<Plain, true, true>(
                    &mut memory,
                    frame,
                    &places,
                    records,
                    p,
                ),
            );
        }
    }

    fn patches_are_sums_of_hats<
        const D: usize,
        const C: usize,
        const N: usize,
        const FREE: bool,
    >() {
        let mut near = 0;
        each_particle::<D, C, N, FREE>(2, |p, cloud| {
            let Cloud::Near(patch, at_corners) = cloud else {
                assert_eq!(p, 2, "a large domain alone lies outside its patch");
                return;
            };
            near += 1;
            for (patch, hats) in seen(&patch).iter().zip(seen(&at_corners)) {
                for entry in 0..4 {
                    assert!((patch[entry] - hats[entry]).abs() < 20.0 * EDGE, "{patch:?} {hats:?}");
                }
            }
        });
        assert_eq!(near, 3);
    }

    #[test]
    fn patches_are_sums_of_the_hats_around_corners() {
        patches_are_sums_of_hats::<1, 2, 3, false>();
        patches_are_sums_of_hats::<2, 4, 9, false>();
        patches_are_sums_of_hats::<2, 4, 9, true>();
        patches_are_sums_of_hats::<3, 8, 27, false>();
        patches_are_sums_of_hats::<3, 8, 27, true>();
    }

    fn alone<const D: usize, const C: usize, const N: usize, const FREE: bool>() {
        let mut first = vec![Vec::new(); 4];
        each_particle::<D, C, N, FREE>(4, |p, cloud| first[p] = seen(&cloud));
        for far in 0..4 {
            each_particle::<D, C, N, FREE>(far, |p, cloud| {
                assert!(p == far || seen(&cloud) == first[p], "{p} beside {far}");
            });
        }
    }

    #[test]
    fn what_a_particle_sees_does_not_depend_on_its_neighbours() {
        alone::<2, 4, 9, false>();
        alone::<2, 4, 9, true>();
        alone::<3, 8, 27, false>();
        alone::<3, 8, 1, true>();
    }
}
