//! Shape functions: weights and gradients of the nodes around a particle.
//!
//! The weight of a node in 2-D and 3-D is the product over the axes, its gradient follows by the
//! product rule (language.md 9.7). All axes of a particle are computed together, one per lane.

pub mod linear;

use crate::math::v4::Wide;

pub use linear::Linear;

/// Weights of the `W` nodes that see a particle on each axis; the lanes are the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<const W: usize> {
    /// The first of the nodes, a whole number.
    pub first: [f64; 4],
    /// N of each node: `value[k][axis]`.
    pub value: [[f64; 4]; W],
    /// dN/dr of each node, r in cells: divide by h for dN/dx.
    pub slope: [[f64; 4]; W],
}

/// A shape function with `W` nodes per axis.
pub trait Shape<const W: usize> {
    /// Weights at `r`, the distance from node 0 in cells, on axes whose last node is `last`.
    fn weights<V: Wide>(r: V, last: V) -> Weights<W>;
}
