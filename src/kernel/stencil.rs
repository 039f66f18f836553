//! Which nodes see a particle, with which weights.

use super::shared::{Rows, RowsMut, Shared};
use crate::math::v4::Wide;
use crate::model::domain::Domain;
use crate::model::lattice::Lattice;
use crate::shape::{Shape, Weights};

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
    /// Last node per axis of the whole lattice; 1 beyond the dimension.
    last: [f64; 4],
    /// Place in memory that node 0 of the whole lattice would have.
    origin: usize,
    /// Step in memory from one node to the next along the outer axes.
    stride: [usize; 2],
}

impl Frame {
    /// The frame of a lattice; `walls`: the box that particles must not leave, if any.
    pub fn new(lattice: &Lattice, walls: Option<&Domain>) -> Self {
        let wide = |c: [f64; 3]| [c[0], c[1], c[2], 0.0];
        let window = &lattice.window;
        let [_, ny, nz] = window.size;
        let first = (window.lower[0] * ny + window.lower[1]) * nz + window.lower[2];
        Self {
            lower: wide(lattice.cells.lower),
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

    /// The nodes of a particle. Nodes outside the window give places beyond its memory.
    #[inline(always)]
    pub fn stencil<V: Wide, const D: usize, const W: usize, S: Shape<W>>(
        &self,
        position: V,
    ) -> Stencil<D, W> {
        let r = (position - V::load(&self.lower)) * V::splat(self.inverse_spacing);
        let axes = S::weights(r, V::load(&self.last));
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

/// The W^D nodes of a particle: rows of W along the last axis.
#[derive(Clone, Copy)]
pub struct Stencil<const D: usize, const W: usize> {
    base: usize,
    stride: [usize; 2],
    axes: Weights<W>,
}

/// One row of nodes: the part of the weights that its nodes share.
#[derive(Clone, Copy)]
pub struct Row {
    /// Product of N over the outer axes.
    pub value: f64,
    /// The same with dN/dr on one outer axis.
    pub slope: [f64; 2],
    /// Place of the row along the outer axes, counted from the first row.
    pub outer: [f64; 2],
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

    /// Number of rows.
    pub const ROWS: usize = W.pow(D as u32 - 1);

    /// A row, counted with the first axis outermost. (An index and no closure: a closure would
    /// keep the compiler from using wide registers inside.)
    #[inline(always)]
    pub fn row(&self, number: usize) -> Row {
        let Weights { value, slope, .. } = &self.axes;
        match D {
            1 => Row { value: 1.0, slope: [0.0; 2], outer: [0.0; 2] },
            2 => Row {
                value: value[number][0],
                slope: [slope[number][0], 0.0],
                outer: [number as f64, 0.0],
            },
            _ => {
                let (i, j) = (number / W, number % W);
                Row {
                    value: value[i][0] * value[j][1],
                    slope: [slope[i][0] * value[j][1], value[i][0] * slope[j][1]],
                    outer: [i as f64, j as f64],
                }
            }
        }
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
        let frame = Frame::new(&lattice, Some(&cells));
        let stencil =
            frame.stencil::<_, 3, W, S>(Plain::load(&[place[0], place[1], place[2], 0.0]));
        for stencil in [stencil, stencil.affine::<Plain, S>()] {
            let (mut value, mut gradient) = (0.0, [0.0; 3]);
            let nodes: Vec<[f64; 3]> =
                (0..window.places().end).map(|p| at(p.max(window.start))).collect();
            let places = stencil.of(&nodes);
            for number in 0..Stencil::<3, W>::ROWS {
                let row = stencil.row(number);
                for k in 0..W {
                    let at_node = field(places.row(number)[k]);
                    value += row.value * stencil.value(k) * at_node;
                    gradient[0] += row.slope[0] * stencil.value(k) * at_node / cells.cell;
                    gradient[1] += row.slope[1] * stencil.value(k) * at_node / cells.cell;
                    gradient[2] += row.value * stencil.slope(k) * at_node / cells.cell;
                }
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
