//! Which nodes see a particle, with which weights.

use super::shared::{Rows, RowsMut, Shared};
use crate::math::v4::Wide;
use crate::model::domain::Domain;
use crate::model::lattice::Lattice;
use crate::shape::{EDGE, Shape, Weights, gimp};

/// What a kernel must know of a lattice to find the nodes of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Lower corner of the lattice \[L\].
    lower: [f64; 4],
    /// 1/(distance between nodes).
    pub inverse_spacing: f64,
    /// Distance between nodes \[L\].
    pub spacing: f64,
    /// Corners of the box that particles must not leave \[L\].
    pub walls: [[f64; 4]; 2],
    /// Upper corner of the lattice \[L\].
    upper: [f64; 4],
    /// How far the corners of a particle's domain may lie from it \[L\].
    pub reach: f64,
    /// Last node per axis of the whole lattice; 1 beyond the dimension.
    last: [f64; 4],
    /// Place in memory that node 0 of the whole lattice would have.
    origin: usize,
    /// Step in memory from one node to the next along the outer axes.
    stride: [usize; 2],
}

impl Frame {
    /// The frame of a lattice; `walls`: the box that particles must not leave, if any; `reach`: how
    /// many cells the domain of a particle may reach.
    pub fn new(lattice: &Lattice, walls: Option<&Domain>, reach: usize) -> Self {
        let wide = |c: [f64; 3]| [c[0], c[1], c[2], 0.0];
        let window = &lattice.window;
        let [_, ny, nz] = window.size;
        let first = (window.lower[0] * ny + window.lower[1]) * nz + window.lower[2];
        Self {
            // On unused axes a place of 0 lies amid the lattice, where no border is near.
            lower: std::array::from_fn(|axis| match axis < lattice.cells.dimension {
                true => lattice.cells.lower[axis],
                false => -1.5 * lattice.spacing,
            }),
            upper: std::array::from_fn(|axis| match axis < lattice.cells.dimension {
                true => lattice.place(lattice.nodes.map(|count| count - 1))[axis],
                false => 1.5 * lattice.spacing,
            }),
            reach: reach as f64 * lattice.cells.cell,
            inverse_spacing: 1.0 / lattice.spacing,
            spacing: lattice.spacing,
            walls: match walls {
                Some(walls) => [wide(walls.lower), wide(walls.upper)],
                None => [[f64::NEG_INFINITY; 4], [f64::INFINITY; 4]],
            },
            last: std::array::from_fn(|axis| match lattice.nodes.get(axis) {
                Some(count) if *count > 1 => (count - 1) as f64,
                _ => (S_LEAST - 1) as f64,
            }),
            origin: window.start.wrapping_sub(first),
            stride: [ny * nz, nz],
        }
    }

    /// The inverse of a radius; beside the axis weights, and with them velocities, fall as fast as
    /// r does, down to [`EDGE`].
    #[inline(always)]
    pub fn inverse_radius(&self, r: f64) -> f64 {
        1.0 / r.max(EDGE * self.spacing)
    }

    /// Rate of the hoop strain, v_r/r \[1/T\].
    #[inline(always)]
    pub fn hoop_rate(&self, radial_velocity: f64, r: f64) -> f64 {
        radial_velocity * self.inverse_radius(r)
    }

    /// The nodes of a particle. Nodes outside the window give places beyond its memory.
    #[inline(always)]
    pub fn stencil<V: Wide, const D: usize, const W: usize, S: Shape<W>>(
        &self,
        position: V,
    ) -> Stencil<D, W> {
        self.stencil_of::<V, D, W>(S::weights(self.in_spacings(position), V::load(&self.last)))
    }

    /// The nodes around a particle whose box has the half sizes `half` \[L\] (GIMP).
    #[inline(always)]
    pub fn boxed<V: Wide, const D: usize>(&self, position: V, half: V) -> Stencil<D, 3> {
        let half = half * V::splat(self.inverse_spacing);
        let r = self.in_spacings(position);
        self.stencil_of::<V, D, 3>(gimp::weights(r, half, V::load(&self.last)))
    }

    /// Lower end of the lattice along an axis \[L\].
    #[inline(always)]
    pub fn lower(&self, axis: usize) -> f64 {
        self.lower[axis]
    }

    /// Number of the last node along an axis.
    #[inline(always)]
    pub fn last(&self, axis: usize) -> f64 {
        self.last[axis]
    }

    /// How far the corners of a particle's domain may lie from it, in node spacings.
    #[inline(always)]
    pub fn reach_in_spacings(&self) -> f64 {
        self.reach * self.inverse_spacing
    }

    /// Step in memory from one node to the next along the outer axes.
    #[inline(always)]
    pub fn stride(&self) -> [usize; 2] {
        self.stride
    }

    /// Places in memory of four nodes with such numbers along each axis; nodes outside the window
    /// give places beyond its memory.
    #[inline(always)]
    pub fn nodes_at<V: Wide, const D: usize>(&self, numbers: &[V; D]) -> [usize; 4] {
        let mut sum = numbers[D - 1] + V::splat(SHIFT);
        for axis in 0..D - 1 {
            sum = numbers[axis].mul_add(V::splat(self.stride[axis] as f64), sum);
        }
        let mut places = [self.origin; 4];
        for (place, sum) in places.iter_mut().zip(sum.array()) {
            *place = place.wrapping_add(low_bits(sum));
        }
        places
    }

    /// Can corners of a particle's domain lie beyond the lattice or its tile, being so far away from
    /// it along each axis?
    pub fn cuts(&self, place: &[f64; 4], extent: [f64; 3], axes: usize) -> bool {
        (0..axes).any(|axis| {
            let (low, high) = (place[axis] - extent[axis], place[axis] + extent[axis]);
            low < self.lower[axis] || high > self.upper[axis] || extent[axis] > self.reach
        })
    }

    /// Do domains with these least and largest places of corners, whose farthest lie `widest` away from
    /// their particles, all keep within the lattice and their tile?
    #[inline(always)]
    pub fn holds<V: Wide>(&self, least: V, largest: V, widest: V) -> bool {
        let (lower, upper) = (V::load(&self.lower), V::load(&self.upper));
        let reach = V::splat(self.reach);
        least.inside(lower, upper)
            && largest.inside(lower, upper)
            && widest.inside(V::splat(0.0), reach)
    }

    /// Distance from node 0 in node spacings.
    #[inline(always)]
    fn in_spacings<V: Wide>(&self, position: V) -> V {
        (position - V::load(&self.lower)) * V::splat(self.inverse_spacing)
    }

    /// The nodes of weights; those outside the window give places beyond its memory.
    #[inline(always)]
    fn stencil_of<V: Wide, const D: usize, const W: usize>(
        &self,
        axes: Weights<W>,
    ) -> Stencil<D, W> {
        let first = (V::load(&axes.first) + V::splat(SHIFT)).array();
        let mut base = self.origin.wrapping_add(low_bits(first[D - 1]));
        for axis in 0..D - 1 {
            base = base.wrapping_add(low_bits(first[axis]).wrapping_mul(self.stride[axis]));
        }
        Stencil { base, stride: self.stride, axes }
    }
}

/// Nodes of the unused axes, enough for the widest shape.
const S_LEAST: usize = 5;

/// A whole number 0 <= value < 2^32 without the checks of a saturating conversion: added to 2^52,
/// its bits are the low bits of the sum. Other numbers give some place beyond the memory.
const SHIFT: f64 = 4_503_599_627_370_496.0;

#[inline(always)]
fn low_bits(shifted: f64) -> usize {
    shifted.to_bits() as u32 as usize
}

/// The W^D nodes of a particle: planes of rows of `W` nodes along the last axis.
///
/// Loops go over planes (along the first of three axes), rows (along the last but one axis) and
/// nodes, and multiply the weight of an axis in where its loop ends: a stencil of 64 nodes then
/// costs little more per node than one of 8.
#[derive(Clone, Copy)]
pub struct Stencil<const D: usize, const W: usize> {
    base: usize,
    stride: [usize; 2],
    axes: Weights<W>,
}

impl<const D: usize, const W: usize> Stencil<D, W> {
    /// Number of planes.
    pub const PLANES: usize = if D == 3 { W } else { 1 };

    /// Rows in a plane.
    pub const ROWS: usize = if D == 1 { 1 } else { W };

    /// The axis across the rows of a plane (without meaning in one dimension).
    pub const ACROSS: usize = if D == 3 { 1 } else { 0 };

    /// The hats of the nodes around a place that lies `fraction` after the first of them, which is at
    /// `base`; the particle lies `offset` after it, in node spacings.
    #[inline(always)]
    pub fn of_hats(base: usize, stride: [usize; 2], fraction: [f64; D], offset: [f64; D]) -> Self {
        let mut axes = Weights {
            first: [0.0; 4],
            offset: [0.0; 4],
            value: [[0.0; 4]; W],
            slope: [[0.0; 4]; W],
        };
        for axis in 0..D {
            axes.offset[axis] = offset[axis];
            (axes.value[0][axis], axes.value[1][axis]) = (1.0 - fraction[axis], fraction[axis]);
            (axes.slope[0][axis], axes.slope[1][axis]) = (-1.0, 1.0);
        }
        Self { base, stride, axes }
    }

    /// N of node `k` of an axis.
    #[inline(always)]
    pub fn value<V: Wide>(&self, axis: usize, k: usize) -> V {
        V::splat(self.axes.value[k][axis])
    }

    /// dN/dr of node `k` of an axis.
    #[inline(always)]
    pub fn slope<V: Wide>(&self, axis: usize, k: usize) -> V {
        V::splat(self.axes.slope[k][axis])
    }

    /// N of node `k` of row `j` of plane `i`.
    #[inline(always)]
    pub fn weight(&self, i: usize, j: usize, k: usize) -> f64 {
        let value = &self.axes.value;
        match D {
            1 => value[k][0],
            2 => value[j][0] * value[k][1],
            _ => value[i][0] * value[j][1] * value[k][2],
        }
    }

    /// dN/dr along each axis of node `k` of row `j` of plane `i`, in loops where speed does not matter.
    #[inline(always)]
    pub fn slopes(&self, i: usize, j: usize, k: usize) -> [f64; 3] {
        let Weights { value, slope, .. } = &self.axes;
        match D {
            1 => [slope[k][0], 0.0, 0.0],
            2 => [slope[j][0] * value[k][1], value[j][0] * slope[k][1], 0.0],
            _ => [
                slope[i][0] * value[j][1] * value[k][2],
                value[i][0] * slope[j][1] * value[k][2],
                value[i][0] * value[j][1] * slope[k][2],
            ],
        }
    }

    /// From node `k` of row `j` of plane `i` to the particle, in node spacings.
    #[inline(always)]
    pub fn away(&self, i: usize, j: usize, k: usize) -> [f64; 3] {
        let [x, y, z, _] = self.axes.offset;
        match D {
            1 => [x - k as f64, 0.0, 0.0],
            2 => [x - j as f64, y - k as f64, 0.0],
            _ => [x - i as f64, y - j as f64, z - k as f64],
        }
    }

    /// N of node `k` of each axis: `all_values()[k][axis]`.
    #[inline(always)]
    pub fn all_values(&self) -> &[[f64; 4]; W] {
        &self.axes.value
    }

    /// dN/dr of node `k` of each axis: `all_slopes()[k][axis]`.
    #[inline(always)]
    pub fn all_slopes(&self) -> &[[f64; 4]; W] {
        &self.axes.slope
    }

    /// Place in memory of node `k` of row `j` of plane `i`.
    #[inline(always)]
    pub fn place(&self, i: usize, j: usize, k: usize) -> usize {
        let [plane, row] = if D == 3 { self.stride } else { [0, self.stride[0]] };
        self.base + i * plane + j * row + k
    }

    /// Distance of the particle from the first node along an axis, in node spacings.
    #[inline(always)]
    pub fn offset(&self, axis: usize) -> f64 {
        self.axes.offset[axis]
    }

    /// The stencil whose slopes fit affine fields: moments for splines, slopes for other shapes.
    #[inline(always)]
    pub fn affine<V: Wide, S: Shape<W>>(&self) -> Self {
        match S::MOMENTS {
            true => Self { axes: self.axes.moments::<V>(), ..*self },
            false => *self,
        }
    }

    /// The rows of nodes, to read.
    ///
    /// # Panics
    /// If one lies beyond the memory.
    #[inline(always)]
    pub fn of<'a, T>(&self, nodes: &'a [T]) -> Rows<'a, T, D, W> {
        Rows::new(nodes, self.base, self.stride)
    }

    /// The rows of nodes, to write.
    ///
    /// # Safety
    /// While they are in use nobody else may use any of these nodes.
    ///
    /// # Panics
    /// If one lies beyond the memory.
    #[inline(always)]
    pub unsafe fn of_shared<'a, T>(&self, nodes: &Shared<'a, T>) -> RowsMut<'a, T, D, W> {
        // SAFETY: the caller's promise.
        unsafe { nodes.rows(self.base, self.stride) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;
    use crate::model::lattice::Window;
    use crate::shape::{Cubic, Linear, Quadratic};

    fn reproduces<const W: usize, S: Shape<W>>(place: [f64; 3]) {
        let cells = Domain { dimension: 3, lower: [-1.0; 3], upper: [1.0, 2.0, 3.0], cell: 0.5 };
        let window = Window { lower: [0, 0, 1], size: [5, 7, 8], start: 7 };
        let lattice = Lattice { window, ..Lattice::new(cells, 1) };
        let at = |place: usize| lattice.place(window.node(place));
        let field = |x: [f64; 3]| 2.0 * x[0] - 3.0 * x[1] + 0.5 * x[2] + 1.0;
        let frame = Frame::new(&lattice, Some(&cells), 1);
        let stencil =
            frame.stencil::<_, 3, W, S>(Plain::load(&[place[0], place[1], place[2], 0.0]));
        let nodes: Vec<[f64; 3]> =
            (0..window.places().end).map(|p| at(p.max(window.start))).collect();
        let places = stencil.of(&nodes);
        for stencil in [stencil, stencil.affine::<Plain, S>()] {
            let (mut value, mut gradient) = (0.0, [0.0; 3]);
            let [n, s] = [&stencil.axes.value, &stencil.axes.slope];
            for (i, j, k) in (0..W * W * W).map(|c| (c / (W * W), c / W % W, c % W)) {
                let at_node = field(places.row(i, j)[k]);
                value += stencil.weight(i, j, k) * at_node;
                gradient[0] += s[i][0] * n[j][1] * n[k][2] * at_node / cells.cell;
                gradient[1] += n[i][0] * s[j][1] * n[k][2] * at_node / cells.cell;
                gradient[2] += n[i][0] * n[j][1] * s[k][2] * at_node / cells.cell;
            }
            assert!((value - field(place)).abs() < 1e-13);
            for (axis, expected) in [2.0, -3.0, 0.5].into_iter().enumerate() {
                assert!((gradient[axis] - expected).abs() < 1e-12, "axis {axis}: {gradient:?}");
            }
        }
    }

    #[test]
    fn a_linear_field_and_its_gradient_are_reproduced_in_three_dimensions() {
        for place in [[-0.3, 0.61, 0.9], [-0.9, 1.9, 0.1], [0.99, -0.95, 2.9]] {
            reproduces::<2, Linear>(place);
            reproduces::<3, Quadratic>(place);
            reproduces::<4, Cubic>(place);
        }
    }
}
