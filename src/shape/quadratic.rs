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
Source: Steffen, Kirby, Berzins 2008.";

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
        let value = [half * a * a, V::splat(0.75) - b * b, half * c * c];
        let slope = [zero - a, zero - (b + b), c];
        let mut weights = Weights {
            first: first.array(),
            offset: d.array(),
            value: [value[0].array(), value[1].array(), value[2].array()],
            slope: [slope[0].array(), slope[1].array(), slope[2].array()],
        };
        if !d.inside(half, V::splat(1.5)) {
            // Some axis is in the half cell at a border: d < 1/2 or d > 3/2.
            let minus = V::splat(-1.0);
            let (low, high) = ([one - d, d, zero], [zero, two - d, d - one]);
            let (low_slope, high_slope) = ([minus, one, zero], [zero, minus, one]);
            for k in 0..3 {
                let upper = d.below(V::splat(1.5), value[k], high[k]);
                d.below(half, low[k], upper).store(&mut weights.value[k]);
                let upper = d.below(V::splat(1.5), slope[k], high_slope[k]);
                d.below(half, low_slope[k], upper).store(&mut weights.slope[k]);
            }
        }
        weights
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
