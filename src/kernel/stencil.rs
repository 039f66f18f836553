//! Which nodes see a particle, with which weights.

use crate::math::v4::Wide;
use crate::model::domain::Domain;
use crate::model::grid::Window;
use crate::shape::{Shape, Weights};

/// What a kernel must know of the grid to find the nodes of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Lower corner of the box \[L\].
    pub lower: [f64; 4],
    /// Upper corner of the box \[L\].
    pub upper: [f64; 4],
    /// 1/h.
    pub inverse_cell: f64,
    /// Last node per axis of the whole grid; 1 beyond the dimension.
    last: [f64; 4],
    /// Place in memory that node 0 of the whole grid would have.
    origin: usize,
    /// Step in memory from one node to the next along the outer axes.
    stride: [usize; 2],
}

impl Frame {
    /// The frame of a window of the grid.
    pub fn new(domain: &Domain, window: &Window) -> Self {
        let [lower, upper] = [domain.lower, domain.upper].map(|c| [c[0], c[1], c[2], 0.0]);
        let nodes = domain.nodes();
        let [_, ny, nz] = window.size;
        let first = (window.lower[0] * ny + window.lower[1]) * nz + window.lower[2];
        Self {
            lower,
            upper,
            inverse_cell: 1.0 / domain.cell,
            last: std::array::from_fn(|axis| match nodes.get(axis) {
                Some(count) if *count > 1 => (count - 1) as f64,
                _ => 1.0,
            }),
            origin: 0usize.wrapping_sub(first),
            stride: [ny * nz, nz],
        }
    }

    /// The nodes of a particle. Nodes outside the window give places beyond its memory.
    #[inline(always)]
    pub fn stencil<V: Wide, const D: usize, const W: usize, S: Shape<W>>(
        &self,
        position: V,
    ) -> Stencil<D, W> {
        let r = (position - V::load(&self.lower)) * V::splat(self.inverse_cell);
        let axes = S::weights(r, V::load(&self.last));
        let mut base = self.origin.wrapping_add(whole(axes.first[D - 1]));
        for axis in 0..D - 1 {
            base = base.wrapping_add(whole(axes.first[axis]).wrapping_mul(self.stride[axis]));
        }
        Stencil { base, stride: self.stride, axes }
    }
}

/// A whole number 0 <= value < 2^32 without the checks of a saturating conversion: added to 2^52,
/// its bits are the low bits of the sum. Other numbers give some place beyond the memory.
#[inline(always)]
fn whole(value: f64) -> usize {
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    (value + SHIFT).to_bits() as u32 as usize
}

/// The W^D nodes of a particle: rows of W along the last axis.
pub struct Stencil<const D: usize, const W: usize> {
    base: usize,
    stride: [usize; 2],
    axes: Weights<W>,
}

/// One row of nodes: its place in memory and the part of the weights that its nodes share.
#[derive(Clone, Copy)]
pub struct Row {
    /// Place of the first node.
    pub first: usize,
    /// Product of N over the outer axes.
    pub value: f64,
    /// The same with dN/dr on one outer axis.
    pub slope: [f64; 2],
}

impl<const D: usize, const W: usize> Stencil<D, W> {
    /// N of node `k` of a row, along the row.
    #[inline(always)]
    pub fn value(&self, k: usize) -> f64 {
        self.axes.value[k][D - 1]
    }

    /// dN/dr of node `k` of a row, along the row.
    #[inline(always)]
    pub fn slope(&self, k: usize) -> f64 {
        self.axes.slope[k][D - 1]
    }

    /// Number of rows.
    pub const ROWS: usize = W.pow(D as u32 - 1);

    /// A row, counted with the first axis outermost. (An index and no closure: a closure would
    /// keep the compiler from using wide registers inside.)
    #[inline(always)]
    pub fn row(&self, number: usize) -> Row {
        match D {
            1 => Row { first: self.base, value: 1.0, slope: [0.0; 2] },
            2 => {
                let first = self.base.wrapping_add(number * self.stride[0]);
                let Weights { value, slope, .. } = &self.axes;
                Row { first, value: value[number][0], slope: [slope[number][0], 0.0] }
            }
            _ => {
                let (i, j) = (number / W, number % W);
                let offset = i * self.stride[0] + j * self.stride[1];
                let Weights { value, slope, .. } = &self.axes;
                Row {
                    first: self.base.wrapping_add(offset),
                    value: value[i][0] * value[j][1],
                    slope: [slope[i][0] * value[j][1], value[i][0] * slope[j][1]],
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;
    use crate::shape::Linear;

    #[test]
    fn a_linear_field_and_its_gradient_are_reproduced_in_three_dimensions() {
        let domain = Domain { dimension: 3, lower: [-1.0; 3], upper: [1.0, 2.0, 3.0], cell: 0.5 };
        let window = Window { lower: [1, 0, 2], size: [4, 5, 6] };
        let field = |x: [f64; 3]| 2.0 * x[0] - 3.0 * x[1] + 0.5 * x[2] + 1.0;
        let frame = Frame::new(&domain, &window);
        let place = [-0.3, 0.61, 0.9];
        let stencil =
            frame.stencil::<_, 3, 2, Linear>(Plain::load(&[place[0], place[1], place[2], 0.0]));
        let (mut value, mut gradient) = (0.0, [0.0; 3]);
        for row in (0..Stencil::<3, 2>::ROWS).map(|number| stencil.row(number)) {
            for k in 0..2 {
                let at_node = field(domain.node(window.node(row.first + k)));
                value += row.value * stencil.value(k) * at_node;
                gradient[0] += row.slope[0] * stencil.value(k) * at_node / domain.cell;
                gradient[1] += row.slope[1] * stencil.value(k) * at_node / domain.cell;
                gradient[2] += row.value * stencil.slope(k) * at_node / domain.cell;
            }
        }
        assert!((value - field(place)).abs() < 1e-14);
        for (axis, expected) in [2.0, -3.0, 0.5].into_iter().enumerate() {
            assert!((gradient[axis] - expected).abs() < 1e-13, "axis {axis}: {gradient:?}");
        }
    }
}
