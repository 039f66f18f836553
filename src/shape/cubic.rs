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
axis. Source: Steffen, Kirby, Berzins 2008.";

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
        let [zero, one, two, three]: [V; 4] = splats([0.0, 1.0, 2.0, 3.0]);
        let first = (r.floor() - one).larger(zero).smaller(last - three);
        let d = (r - first).larger(V::splat(EDGE)).smaller(V::splat(3.0 - EDGE));
        let (value, slope) = inside(d);
        let mut weights = Weights {
            first: first.array(),
            offset: d.array(),
            value: [value[0].array(), value[1].array(), value[2].array(), value[3].array()],
            slope: [slope[0].array(), slope[1].array(), slope[2].array(), slope[3].array()],
        };
        if !d.inside(one, two) {
            // Some axis is in a cell at a border: d < 1 or d >= 2.
            let (low, low_slope) = at_border(d);
            let (high, high_slope) = at_border(three - d);
            let low = [low[0], low[1], low[2], zero];
            let high = [zero, high[2], high[1], high[0]];
            let low_slope = [low_slope[0], low_slope[1], low_slope[2], zero];
            let high_slope = [zero, high_slope[2], high_slope[1], high_slope[0]];
            for k in 0..4 {
                let upper = d.below(two, value[k], high[k]);
                d.below(one, low[k], upper).store(&mut weights.value[k]);
                let upper = d.below(two, slope[k], zero - high_slope[k]);
                d.below(one, low_slope[k], upper).store(&mut weights.slope[k]);
            }
        }
        weights
    }
}

/// Values and slopes of the four nodes away from borders, 1 <= d < 2 from the first of them.
#[inline(always)]
fn inside<V: Wide>(d: V) -> ([V; 4], [V; 4]) {
    let [zero, half, one, two]: [V; 4] = splats([0.0, 0.5, 1.0, 2.0]);
    let [sixth, two_thirds, three_halves]: [V; 3] = splats([1.0 / 6.0, 2.0 / 3.0, 1.5]);
    let (f, g) = (d - one, two - d);
    let (ff, gg) = (f * f, g * g);
    let value = [
        sixth * gg * g,
        ff.mul_add(half * f - one, two_thirds),
        gg.mul_add(half * g - one, two_thirds),
        sixth * ff * f,
    ];
    let slope =
        [zero - half * gg, f * (three_halves * f - two), g * (two - three_halves * g), half * ff];
    (value, slope)
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
