//! The hat function.

use super::{Shape, Weights};
use crate::math::v4::Wide;

/// Linear hat: N = 1 - |r|.
///
/// A particle on a node belongs to the cell above it, on the last node to the cell below, so that
/// the gradients always sum to zero. A fraction below [`EDGE`] counts as [`EDGE`]: a particle
/// exactly on a node then still gives its upper neighbours the mass that their gradient weight
/// needs, so that no force is lost to an empty node and free flight makes no strain.
///
/// # Source  language.md 9.7
#[derive(Clone, Copy, Debug)]
pub struct Linear;

/// Smallest weight of a node whose gradient weight is not zero.
pub const EDGE: f64 = 1e-12;

impl Shape<2> for Linear {
    #[inline(always)]
    fn weights<V: Wide>(r: V, last: V) -> Weights<2> {
        let one = V::splat(1.0);
        let cell = r.floor().smaller(last - one);
        let fraction = (r - cell).larger(V::splat(EDGE)).smaller(V::splat(1.0 - EDGE));
        Weights {
            first: cell.array(),
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

    #[test]
    fn the_partition_of_unity_is_exact_and_places_are_reproduced() {
        for step in 0..=4000 {
            let r = step as f64 / 1000.0;
            let (first, value, _) = at(r);
            assert_eq!(value[0] + value[1], 1.0);
            let place = value[0] * first + value[1] * (first + 1.0);
            assert!((place - r).abs() <= 2.0 * EDGE, "{r}: {place}");
        }
    }
}
