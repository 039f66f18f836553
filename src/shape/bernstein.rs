//! Quadratic Bernstein polynomials.

use super::{EDGE, Shape, Weights};
use crate::math::v4::{Wide, splats};

/// One sentence for the table.
pub const SUMMARY: &str = "quadratic Bernstein polynomials, nodes every half cell (tlmpm)";

/// The manual entry.
pub const MANUAL: &str = "\
Nodes every h/2: at a cell's edge (1 - |r|)^2 (|r| < 1), in its middle 1/2 - 2 r^2 (|r| < 1/2), r in
cells. Positive weights of second degree with cells as wide as those of hats; the slope jumps
between cells, so that only methods whose particles never cross them use it.
Source: de Vaucorbeil, Nguyen, Nguyen-Thanh 2020.";

/// Bernstein polynomials of degree two: (1 - t)^2, 2 t (1 - t), t^2 with t the place in the cell.
///
/// # Source  language.md 9.7
#[derive(Clone, Copy, Debug)]
pub struct Bernstein;

impl Shape<3> for Bernstein {
    const MOMENTS: bool = false;

    #[inline(always)]
    fn weights<V: Wide>(r: V, last: V) -> Weights<3> {
        let [half, one, two]: [V; 3] = splats([0.5, 1.0, 2.0]);
        let cell = (half * r).floor().smaller(half * last - one);
        let first = two * cell;
        let t = (half * r - cell).larger(V::splat(EDGE)).smaller(V::splat(1.0 - EDGE));
        let s = one - t;
        Weights {
            first: first.array(),
            offset: (two * t).array(),
            value: [(s * s).array(), (two * t * s).array(), (t * t).array()],
            // dt/dr = 1/2: r counts half cells.
            slope: [(V::splat(0.0) - s).array(), (s - t).array(), t.array()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;

    #[test]
    fn weights_at_special_points() {
        // Three cells: nodes 0 to 6. Place 2.5 half cells: a quarter into the second cell.
        let weights = Bernstein::weights(Plain::splat(2.5), Plain::splat(6.0));
        assert_eq!(weights.first[0], 2.0);
        assert_eq!(weights.value.map(|v| v[0]), [0.5625, 0.375, 0.0625]);
        assert_eq!(weights.slope.map(|v| v[0]), [-0.75, 0.5, 0.25]);
        let end = Bernstein::weights(Plain::splat(6.0), Plain::splat(6.0));
        assert_eq!(end.first[0], 4.0);
        assert!((end.value[2][0] - 1.0).abs() < 1e-11);
    }
}
