//! The cubic B-spline with its variants at borders.

use super::{EDGE, Shape, Weights};
use crate::math::v4::{Wide, splats};

/// One sentence for the table.
pub const SUMMARY: &str = "cubic B-splines: four nodes per axis, the smoothest";

/// The manual entry.
pub const MANUAL: &str = "\
Interior node r^2 (|r|/2 - 1) + 2/3 (|r| < 1), (2 - |r|)^3/6 (< 2), r in cells. Node next to a
border -r^3/3 - r^2 + 2/3 on -1 <= r < 0, border node r^3/6 - r + 1 on 0 <= r < 1 (mirrored at the
upper border): weights sum to one and places are reproduced up to the walls. Needs four nodes per
axis. Source: Steffen, Kirby, Berzins 2008; language.md 9.7.";

/// Cubic B-spline: r^2 (|r|/2 - 1) + 2/3 inside |r| < 1, (2 - |r|)^3/6 up to 2.
///
/// In the first cell, d from the border: d^3/6 - d + 1, d - d^3/3, d^3/6, 0; mirrored in the last.
///
/// # Source  Steffen, Kirby, Berzins 2008; language.md 9.7
#[derive(Clone, Copy, Debug)]
pub struct Cubic;

/// Values and slopes of the three nodes that see a particle at distance d from a border.
#[inline(always)]
fn at_border<V: Wide>(d: V) -> ([V; 3], [V; 3]) {
    let (one, half) = (V::splat(1.0), V::splat(0.5));
    let square = d * d;
    let sixth = V::splat(1.0 / 6.0) * square * d;
    let slope = half * square;
    ([sixth - d + one, d - (sixth + sixth), sixth], [slope - one, one - square, slope])
}

impl Shape<4> for Cubic {
    const MOMENTS: bool = true;

    #[inline(always)]
    fn weights<V: Wide>(r: V, last: V) -> Weights<4> {
        let [zero, half, one, two, three]: [V; 5] = splats([0.0, 0.5, 1.0, 2.0, 3.0]);
        let sixth = V::splat(1.0 / 6.0);
        let first = (r.floor() - one).larger(zero).smaller(last - three);
        let d = (r - first).larger(V::splat(EDGE)).smaller(V::splat(3.0 - EDGE));
        let (f, g) = (d - one, two - d);
        let (ff, gg) = (f * f, g * g);
        let middle = |square: V, r: V| square * (half * r - one) + V::splat(2.0 / 3.0);
        // d < 1 and d >= 2 happen only in the cells at the borders.
        let pick = |lower: V, inside: V, upper: V| {
            d.below(one, lower, d.below(two, inside, upper)).array()
        };
        let (low, low_slope) = at_border(d);
        let (high, high_slope) = at_border(three - d);
        let three_halves = V::splat(1.5);
        Weights {
            first: first.array(),
            offset: d.array(),
            value: [
                pick(low[0], sixth * gg * g, zero),
                pick(low[1], middle(ff, f), high[2]),
                pick(low[2], middle(gg, g), high[1]),
                pick(zero, sixth * ff * f, high[0]),
            ],
            slope: [
                pick(low_slope[0], zero - half * gg, zero),
                pick(low_slope[1], f * (three_halves * f - two), zero - high_slope[2]),
                pick(low_slope[2], g * (two - three_halves * g), zero - high_slope[1]),
                pick(zero, half * ff, zero - high_slope[0]),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;

    fn at(r: f64) -> (f64, [f64; 4], [f64; 4]) {
        let weights = Cubic::weights(Plain::splat(r), Plain::splat(6.0));
        (weights.first[0], weights.value.map(|v| v[0]), weights.slope.map(|v| v[0]))
    }

    fn near(found: [f64; 4], expected: [f64; 4]) {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-12, "{found} for {expected}");
        }
    }

    #[test]
    fn weights_at_special_points() {
        let (first, value, slope) = at(2.5);
        assert_eq!(first, 1.0);
        near(value, [1.0 / 48.0, 23.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0]);
        near(slope, [-0.125, -0.625, 0.625, 0.125]);
        let (first, value, slope) = at(3.0);
        assert_eq!(first, 2.0);
        near(value, [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0]);
        near(slope, [-0.5, 0.0, 0.5, 0.0]);
    }

    #[test]
    fn weights_at_the_borders() {
        near(at(0.0).1, [1.0, 0.0, 0.0, 0.0]);
        near(at(0.5).1, [25.0 / 48.0, 11.0 / 24.0, 1.0 / 48.0, 0.0]);
        near(at(0.5).2, [-0.875, 0.75, 0.125, 0.0]);
        let (first, value, slope) = at(5.5);
        assert_eq!(first, 3.0);
        near(value, [0.0, 1.0 / 48.0, 11.0 / 24.0, 25.0 / 48.0]);
        near(slope, [0.0, -0.125, -0.75, 0.875]);
        near(at(6.0).1, [0.0, 0.0, 0.0, 1.0]);
    }
}
