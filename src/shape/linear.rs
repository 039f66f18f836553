//! The hat function.

use super::{EDGE, Shape, Weights};
use crate::math::v4::Wide;

/// One sentence for the table.
pub const SUMMARY: &str = "hats: two nodes per axis, the fastest";

/// The manual entry.
pub const MANUAL: &str = "\
N = 1 - |r|, r in cells. A particle on a node belongs to the cell above it, on the last node to
the cell below, so that the gradients always sum to zero. Second order where no particle crosses
a cell; particles that cross cells make noise that does not fall with h (updated Lagrangian).";

/// Linear hat: N = 1 - |r|.
///
/// A particle on a node belongs to the cell above it, on the last node to the cell below, so that
/// the gradients always sum to zero. A fraction below [`EDGE`] counts as [`EDGE`].
///
/// # Source  language.md 9.7
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Shape<2> for Linear {
    const MOMENTS: bool = false;

    #[inline(always)]
    fn weights<V: Wide>(r: V, last: V) -> Weights<2> {
        let one = V::splat(1.0);
        let cell = r.floor().smaller(last - one);
        let fraction = (r - cell).larger(V::splat(EDGE)).smaller(V::splat(1.0 - EDGE));
        Weights {
            first: cell.array(),
            offset: fraction.array(),
            value: [(one - fraction).array(), fraction.array()],
            slope: [[-1.0; 4], [1.0; 4]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;

    fn at(r: f64) -> (f64, [f64; 2], [f64; 2]) {
        let weights = Linear::weights(Plain::splat(r), Plain::splat(4.0));
        (weights.first[2], weights.value.map(|v| v[2]), weights.slope.map(|v| v[2]))
    }

    #[test]
    fn weights_at_special_points() {
        assert_eq!(at(2.25), (2.0, [0.75, 0.25], [-1.0, 1.0]));
        assert_eq!(at(2.0), (2.0, [1.0 - EDGE, EDGE], [-1.0, 1.0]));
        let (first, value, _) = at(4.0);
        assert_eq!((first, value[1]), (3.0, 1.0 - EDGE));
    }
}
