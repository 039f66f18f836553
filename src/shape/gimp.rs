//! Hats averaged over the box of a particle: the generalized interpolation material point method.

use super::Weights;
use crate::math::v4::{Wide, splats};

/// One sentence for the table.
pub const SUMMARY: &str = "hats averaged over the box of a particle, which keeps its size (uGIMP)";

/// The manual entry.
pub const MANUAL: &str = "\
With q = |x_p - x_I| and the half size l of the particle's box: 1 - (q^2 + l^2)/(2 h l) for q < l,
1 - q/h for q < h - l, (h + l - q)^2/(4 h l) for q < h + l. l = h/(2 ppc) on every axis and stays; for a
particle of a mesh or list it is half an edge of a square or cube of its volume, at most h/2. The
slope is continuous: no noise of cell crossing. The lattice has one more layer of nodes around the
box, since boxes of particles at a wall reach beyond it: nodes held there must lie in the region too
(`INF` reaches them). Stretched material leaves gaps between the boxes: see `cpgimp`.
Source: Bardenhagen and Kober 2004.";

/// One sentence for the table.
pub const STRETCHED_SUMMARY: &str = "as gimp, but the boxes stretch with the material (cpGIMP)";

/// The manual entry.
pub const STRETCHED_MANUAL: &str = "\
As `gimp` with the half sizes l_i = l U_ii, at most h/2, U the right stretch tensor: F = R U. Boxes stay
parallel to the axes, so that a body which turns by large angles opens gaps between them: CPDI
follows such turns (`ulcpdi`). In `tlmpm` it would be the same as `gimp`.
Source: Bardenhagen and Kober 2004.";

/// Weights at `r`, in node spacings from node 0 on axes whose last node is `last`, of particles with
/// the half sizes `half`, 0 < half <= 1/2 of a spacing.
///
/// Three nodes see a particle, since its box lies within one spacing of the nearest one. Seen from
/// that node, a box from t - l to t + l has the part from a to b above it: the node above it gets
/// the mean of x over the box, (b^2 - a^2)/(4 l), and its slope is the share (b - a)/(2 l) of the box.
/// It is the same below, and the node in the middle gets what is left.
///
/// # Source  Bardenhagen and Kober 2004; language.md 9.7
#[inline(always)]
pub fn weights<V: Wide>(r: V, half: V, last: V) -> Weights<3> {
    let [zero, one, two, a_half]: [V; 4] = splats([0.0, 1.0, 2.0, 0.5]);
    let first = (r - a_half).floor().larger(zero).smaller(last - two);
    let d = r - first;
    let middle = d - one;
    let (from, to) = (middle - half, middle + half);
    let share = a_half / half;
    let (a, b) = (from.larger(zero), to.larger(zero));
    let above = share * (b - a);
    let value_above = a_half * above * (a + b);
    let (a, b) = (from.smaller(zero), to.smaller(zero));
    let below = share * (a - b);
    let value_below = a_half * below * (a + b);
    Weights {
        first: first.array(),
        offset: d.array(),
        value: [
            value_below.array(),
            (one - value_below - value_above).array(),
            value_above.array(),
        ],
        slope: [below.array(), (zero - below - above).array(), above.array()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;
    use crate::shape::{Quadratic, Shape};

    fn at(r: f64, half: f64) -> Weights<3> {
        weights(Plain::splat(r), Plain::splat(half), Plain::splat(8.0))
    }

    #[test]
    fn weights_at_special_points() {
        let here = at(3.0, 0.25);
        assert_eq!(here.first[0], 2.0);
        assert_eq!(here.value.map(|v| v[1]), [0.0625, 0.875, 0.0625]);
        assert_eq!(here.slope.map(|v| v[1]), [-0.5 * 0.25 / 0.25, 0.0, 0.5]);
        // Amid a cell a small box sees the hats.
        let here = at(3.5, 0.25);
        assert_eq!((here.first[0], here.value.map(|v| v[0])), (3.0, [0.5, 0.5, 0.0]));
        assert_eq!(here.slope.map(|v| v[0]), [-1.0, 1.0, 0.0]);
    }

    #[test]
    fn weights_sum_to_one_and_reproduce_places_for_every_size() {
        for half in [0.5, 0.25, 0.125, 0.01] {
            for n in 0..600 {
                let r = 1.0 + n as f64 / 100.0;
                let here = at(r, half);
                let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(f).sum::<f64>();
                let place = |k: usize| here.first[0] + k as f64;
                assert!((sum(&|k| here.value[k][0]) - 1.0).abs() < 1e-14);
                assert!(sum(&|k| here.slope[k][0]).abs() < 1e-13);
                assert!((sum(&|k| here.value[k][0] * place(k)) - r).abs() < 1e-14);
                assert!((sum(&|k| here.slope[k][0] * place(k)) - 1.0).abs() < 1e-12);
                let offset = (here.first[0] + here.offset[0] - r).abs();
                assert!(offset < 1e-14);
            }
        }
    }

    #[test]
    fn boxes_of_a_whole_cell_see_the_quadratic_spline() {
        for n in 0..300 {
            let r = 2.0 + n as f64 / 100.0;
            let spline = Quadratic::weights(Plain::splat(r), Plain::splat(8.0));
            let here = at(r, 0.5);
            assert_eq!(here.first, spline.first);
            for k in 0..3 {
                assert!((here.value[k][0] - spline.value[k][0]).abs() < 1e-14);
                assert!((here.slope[k][0] - spline.slope[k][0]).abs() < 1e-14);
            }
        }
    }
}
