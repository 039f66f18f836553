//! The quadratic B-spline with its variants at borders.

use super::{EDGE, Shape, Weights};
use crate::math::v4::{Wide, splats};

/// One sentence for the table.
pub const SUMMARY: &str = "quadratic B-splines: three nodes per axis, no noise of cell crossing";

/// The manual entry.
pub const MANUAL: &str = "\
Interior node 3/4 - r^2 (|r| < 1/2), (3/2 - |r|)^2/2 (< 3/2), r in cells; hats in the half cell at
a border, so that weights sum to one and places are reproduced up to the walls. Needs four nodes
per axis. The gradient is continuous: second order also where particles cross cells.
Source: Steffen, Kirby, Berzins 2008; language.md 9.7.";

/// Quadratic B-spline: 3/4 - r^2 inside |r| < 1/2, (3/2 - |r|)^2/2 up to 3/2.
///
/// Within half a cell of a border the two nodes next to it are hats and the third has no weight.
///
/// # Source  Steffen, Kirby, Berzins 2008; language.md 9.7
#[derive(Clone, Copy, Debug)]
pub struct Quadratic;

impl Shape<3> for Quadratic {
    const MOMENTS: bool = true;

    #[inline(always)]
    fn weights<V: Wide>(r: V, last: V) -> Weights<3> {
        let [zero, half, one, two]: [V; 4] = splats([0.0, 0.5, 1.0, 2.0]);
        let first = (r - half).floor().larger(zero).smaller(last - two);
        let d = (r - first).larger(V::splat(EDGE)).smaller(V::splat(2.0 - EDGE));
        let (a, b, c) = (V::splat(1.5) - d, d - one, d - half);
        // d < 1/2 and d > 3/2 happen only in the half cells at the borders.
        let pick = |lower: V, inside: V, upper: V| {
            d.below(half, lower, d.below(V::splat(1.5), inside, upper)).array()
        };
        let minus = V::splat(-1.0);
        Weights {
            first: first.array(),
            offset: d.array(),
            value: [
                pick(one - d, half * a * a, zero),
                pick(d, V::splat(0.75) - b * b, two - d),
                pick(zero, half * c * c, d - one),
            ],
            slope: [
                pick(minus, zero - a, zero),
                pick(one, zero - (b + b), minus),
                pick(zero, c, one),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;

    fn at(r: f64) -> (f64, [f64; 3], [f64; 3]) {
        let weights = Quadratic::weights(Plain::splat(r), Plain::splat(5.0));
        (weights.first[1], weights.value.map(|v| v[1]), weights.slope.map(|v| v[1]))
    }

    #[test]
    fn weights_at_special_points() {
        assert_eq!(at(2.0), (1.0, [0.125, 0.75, 0.125], [-0.5, 0.0, 0.5]));
        assert_eq!(at(2.5), (2.0, [0.5, 0.5, 0.0], [-1.0, 1.0, 0.0]));
        assert_eq!(at(0.25), (0.0, [0.75, 0.25, 0.0], [-1.0, 1.0, 0.0]));
        assert_eq!(at(4.75), (3.0, [0.0, 0.25, 0.75], [0.0, -1.0, 1.0]));
        assert_eq!(at(0.0), (0.0, [1.0 - EDGE, EDGE, 0.0], [-1.0, 1.0, 0.0]));
        assert!((at(5.0).1[2] - (1.0 - EDGE)).abs() < 1e-15);
    }
}
