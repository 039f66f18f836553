//! Geometry of the domains of particles: means of the finite element functions of their corners
//! and of the gradients of these (language.md 9.7), of four particles side by side.

use crate::geometry::element::SIGNS;
use crate::math::v4::{Wide, splats};
use crate::shape::{DomainKind, ShapeKind};

/// A vector of each of four particles.
pub type Vectors<V> = [V; 3];

/// Means over domains with `C` corners, of four particles.
#[derive(Clone, Copy)]
pub struct Means<V, const C: usize> {
    /// w_c = (1/V) int M_c.
    pub weight: [V; C],
    /// g_c = (1/V) int grad M_c \[1/unit of the corners\].
    pub slope: [Vectors<V>; C],
}

impl<V: Wide, const C: usize> Means<V, C> {
    #[inline(always)]
    fn of_equal_weights() -> Self {
        let zero = V::splat(0.0);
        Self { weight: [V::splat(1.0 / C as f64); C], slope: [[zero; 3]; C] }
    }
}

/// How far the corners of a domain lie from their particle at most, by axis \[L\].
pub fn extent<R: AsRef<[[f64; 4]]>>(records: &[R], shape: ShapeKind, p: usize) -> [f64; 3] {
    let present = records.iter().filter_map(|record| record.as_ref().get(p));
    let mut extent = [0.0f64; 3];
    for record in present {
        for axis in 0..3 {
            let size = record[axis].abs();
            extent[axis] = match shape {
                ShapeKind::Corners(DomainKind::Parallel) => extent[axis] + size,
                _ => extent[axis].max(size),
            };
        }
    }
    extent
}

/// Corners of parallelograms, boxes or lines with these half edges, seen from their centres.
#[inline(always)]
pub fn corners_of_parallel<V: Wide, const D: usize, const C: usize>(
    edges: &[Vectors<V>; D],
) -> [Vectors<V>; C] {
    let mut corners = [[V::splat(0.0); 3]; C];
    for k in 0..D {
        for c in 0..C {
            for axis in 0..D {
                let sum = corners[c][k];
                corners[c][k] = match (axis, SIGNS[c][axis] > 0.0) {
                    (0, true) => edges[0][k],
                    (0, false) => sum - edges[0][k],
                    (_, true) => sum + edges[axis][k],
                    (_, false) => sum - edges[axis][k],
                };
            }
        }
    }
    corners
}

/// Means of parallelograms, boxes or lines: w = 1/2^d, g_c = R^-T s_c/2^d with the half edges r_i as
/// the columns of R and the signs s_c of the corner.
#[inline(always)]
pub fn means_of_parallel<V: Wide, const D: usize, const C: usize>(
    edges: &[Vectors<V>; D],
) -> Means<V, C> {
    let [zero, one, mean]: [V; 3] = splats([0.0, 1.0, 1.0 / C as f64]);
    let mut means = Means::<V, C>::of_equal_weights();
    // Rows of R^-1: cross products of the other columns over the volume.
    let mut rows = [[zero; 3]; D];
    match D {
        1 => rows[0][0] = mean / edges[0][0],
        2 => {
            let [[a, b, _], [c, d, _]] = [edges[0], edges[1]];
            let scale = mean / (a * d - b * c);
            (rows[0][0], rows[0][1]) = (scale * d, (zero - scale) * c);
            (rows[1][0], rows[1][1]) = ((zero - scale) * b, scale * a);
        }
        _ => {
            let [a, b, c] = [edges[0], edges[1], edges[2]];
            let crosses = [cross(b, c), cross(c, a), cross(a, b)];
            let scale = mean * (one / dot(a, crosses[0]));
            for axis in 0..3 {
                rows[axis] = scaled(scale, crosses[axis]);
            }
        }
    }
    means.slope = corners_of_parallel::<V, D, C>(&rows);
    means
}

/// Means over quadrangles, tetrahedra or hexahedra from their corners.
#[inline(always)]
pub fn means<V: Wide, const D: usize, const C: usize>(corners: &[Vectors<V>; C]) -> Means<V, C> {
    match (D, C) {
        (2, _) => quadrangle(corners),
        (_, 4) => tetrahedron(corners),
        _ => hexahedron(corners),
    }
}

/// Tetrahedra: w = 1/4 and the constant gradients.
#[inline(always)]
fn tetrahedron<V: Wide, const C: usize>(x: &[Vectors<V>; C]) -> Means<V, C> {
    let [a, b, c] = [minus(x[1], x[0]), minus(x[2], x[0]), minus(x[3], x[0])];
    let crosses = [cross(b, c), cross(c, a), cross(a, b)];
    let inverse = V::splat(1.0) / dot(a, crosses[0]);
    let mut means = Means::<V, C>::of_equal_weights();
    for axis in 0..3 {
        means.slope[axis + 1] = scaled(inverse, crosses[axis]);
        means.slope[0] = minus(means.slope[0], means.slope[axis + 1]);
    }
    means
}

/// Quadrangles, corners in order round them. Either sense: signs of area and moments then agree.
#[inline(always)]
fn quadrangle<V: Wide, const C: usize>(x: &[Vectors<V>; C]) -> Means<V, C> {
    let [zero, quarter, half, share]: [V; 4] = splats([0.0, 0.25, 0.5, 1.0 / 24.0]);
    let mut means = Means::<V, C>::of_equal_weights();
    // Twice the area from the diagonals; a and b measure how far it is from a parallelogram.
    let inverse = V::splat(1.0) / (half * turn(minus(x[2], x[0]), minus(x[3], x[1])));
    let a = share * inverse * turn(minus(x[3], x[0]), minus(x[1], x[2]));
    let b = share * inverse * turn(minus(x[2], x[3]), minus(x[0], x[1]));
    means.weight[0] = quarter - a - b;
    means.weight[1] = quarter - a + b;
    means.weight[2] = quarter + a + b;
    means.weight[3] = quarter + a - b;
    let inverse = half * inverse;
    for c in 0..4 {
        let across = minus(x[(c + 1) % 4], x[(c + 3) % 4]);
        means.slope[c] = [inverse * across[1], (zero - inverse) * across[0], zero];
    }
    means
}

/// Hexahedra with x = sum_m a_m f_m, m over the products f_m of the local coordinates u, v, w:
/// V = 8 a_u . (a_v x a_w) + 8/3 (a_u . (a_uv x a_uw) + a_v . (a_vw x a_uv) + a_w . (a_uw x a_vw)),
/// V g_c = dV/dx_c = sum_m f_m(c) d_m with d_m = (1/8) dV/da_m, and
/// V w_c = (1/8) sum_m f_m(c) int f_m det J, the integrals worked out term by term.
///
/// # Source  the product det J = x_u . (x_v x x_w) of the eight modes; g_c: Flanagan, Belytschko 1981
#[inline(always)]
fn hexahedron<V: Wide, const C: usize>(x: &[Vectors<V>; C]) -> Means<V, C> {
    let [zero, eighth, third, one]: [V; 4] = splats([0.0, 0.125, 1.0 / 3.0, 1.0]);
    let mut modes = [[zero; 3]; 8];
    for k in 0..3 {
        let mut values = [zero; 8];
        for c in 0..8 {
            values[BITS[c]] = eighth * x[c][k];
        }
        let sums = to_modes(values);
        for m in 0..8 {
            modes[m][k] = sums[m];
        }
    }
    let [_, u, v, uv, w, uw, vw, uvw] = modes;
    let [of_vw, of_wu, of_uv] = [cross(v, w), cross(w, u), cross(u, v)];
    let [e, f, h] = [cross(vw, uv), cross(uv, uw), cross(uw, vw)];
    let change = [
        [zero; 3],
        along(third, f, of_vw),
        along(third, e, of_wu),
        scaled(third, plus(cross(uw, u), cross(v, vw))),
        along(third, h, of_uv),
        scaled(third, plus(cross(u, uv), cross(vw, w))),
        scaled(third, plus(cross(uv, v), cross(w, uw))),
        [zero; 3],
    ];
    let volume = third.mul_add(dot(u, f) + dot(v, e) + dot(w, h), dot(u, of_vw));
    let inverse = one / volume;
    // Integrals of f_m det J over the volume of the local cube, 8.
    let ninth = third * third;
    let integral = [
        volume,
        third * (dot(uv, of_wu) + dot(uw, of_uv) + dot(uvw, change[6])),
        third * (dot(vw, of_uv) + dot(uv, of_vw) + dot(uvw, change[5])),
        ninth * (dot(uvw, along(zero - third, h, of_uv)) - dot(u, e) - dot(v, f)),
        third * (dot(vw, of_wu) + dot(uw, of_vw) + dot(uvw, change[3])),
        ninth * (dot(uvw, along(zero - third, e, of_wu)) - dot(w, f) - dot(u, h)),
        ninth * (dot(uvw, along(zero - third, f, of_vw)) - dot(w, e) - dot(v, h)),
        (zero - third) * ninth * (dot(uv, h) + dot(uv, h)),
    ];
    let mut means = Means::<V, C>::of_equal_weights();
    let (scale, weights) = (eighth * inverse, of_modes(integral));
    for c in 0..8 {
        means.weight[c] = scale * weights[BITS[c]];
    }
    for k in 0..3 {
        let mut parts = [zero; 8];
        for m in 0..8 {
            parts[m] = change[m][k];
        }
        let slopes = of_modes(parts);
        for c in 0..8 {
            means.slope[c][k] = scale * slopes[BITS[c]];
        }
    }
    means
}

/// The corners of a hexahedron by the signs of their local coordinates, a bit for each.
const BITS: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// sum over corners of f_m times their values, by the bits of the coordinates in m.
#[inline(always)]
fn to_modes<V: Wide>(mut values: [V; 8]) -> [V; 8] {
    for stride in [1, 2, 4] {
        for c in 0..8 {
            if c & stride == 0 {
                let (low, high) = (values[c], values[c + stride]);
                (values[c], values[c + stride]) = (high + low, high - low);
            }
        }
    }
    values
}

/// sum over m of f_m(c) times the parts.
#[inline(always)]
fn of_modes<V: Wide>(mut parts: [V; 8]) -> [V; 8] {
    for stride in [1, 2, 4] {
        for c in 0..8 {
            if c & stride == 0 {
                let (mean, change) = (parts[c], parts[c + stride]);
                (parts[c], parts[c + stride]) = (mean - change, mean + change);
            }
        }
    }
    parts
}

#[inline(always)]
fn cross<V: Wide>(a: Vectors<V>, b: Vectors<V>) -> Vectors<V> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot<V: Wide>(a: Vectors<V>, b: Vectors<V>) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn turn<V: Wide>(a: Vectors<V>, b: Vectors<V>) -> V {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn plus<V: Wide>(a: Vectors<V>, b: Vectors<V>) -> Vectors<V> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn minus<V: Wide>(a: Vectors<V>, b: Vectors<V>) -> Vectors<V> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scaled<V: Wide>(factor: V, a: Vectors<V>) -> Vectors<V> {
    [factor * a[0], factor * a[1], factor * a[2]]
}

/// factor a + b.
#[inline(always)]
fn along<V: Wide>(factor: V, a: Vectors<V>, b: Vectors<V>) -> Vectors<V> {
    [factor.mul_add(a[0], b[0]), factor.mul_add(a[1], b[1]), factor.mul_add(a[2], b[2])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;
    use crate::shape::corners::corner_of_parallel;

    /// Means of one domain.
    #[derive(Debug)]
    struct Alone<const C: usize> {
        weight: [f64; C],
        slope: [[f64; 3]; C],
    }

    fn vector(place: &[f64; 4]) -> Vectors<Plain> {
        [0, 1, 2].map(|k| Plain::splat(place[k]))
    }

    /// The lane of a particle must not matter.
    fn alone<const C: usize>(means: &Means<Plain, C>) -> Alone<C> {
        let of = |lane: usize| Alone {
            weight: means.weight.map(|weight| weight.array()[lane]),
            slope: means.slope.map(|slope| slope.map(|entry| entry.array()[lane])),
        };
        assert_eq!(of(0).slope, of(3).slope);
        of(0)
    }

    fn free<const D: usize, const C: usize>(corners: &[[f64; 4]; C]) -> Alone<C> {
        alone(&means::<Plain, D, C>(&corners.each_ref().map(vector)))
    }

    fn parallel<const D: usize, const C: usize>(edges: &[[f64; 4]; D]) -> Alone<C> {
        alone(&means_of_parallel::<Plain, D, C>(&edges.each_ref().map(vector)))
    }

    /// Means over a hexahedron by two Gauss points per axis, which are exact.
    fn by_gauss_points(corners: &[[f64; 4]; 8]) -> Alone<8> {
        let gauss = (1.0f64 / 3.0).sqrt();
        let mut means = Alone { weight: [0.0; 8], slope: [[0.0; 3]; 8] };
        let mut volume = 0.0;
        for point in SIGNS {
            let mut columns = [[0.0; 3]; 3];
            let local = SIGNS.map(|s| {
                let [u, v, w] = [0, 1, 2].map(|axis| 1.0 + s[axis] * point[axis] * gauss);
                [0.125 * s[0] * v * w, 0.125 * s[1] * w * u, 0.125 * s[2] * u * v]
            });
            for (c, slope) in local.iter().enumerate() {
                for (axis, column) in columns.iter_mut().enumerate() {
                    for k in 0..3 {
                        column[k] += slope[axis] * corners[c][k];
                    }
                }
            }
            let [x, y, z] = columns.map(nalgebra::Vector3::from);
            let rows = [y.cross(&z), z.cross(&x), x.cross(&y)];
            let jacobian = x.dot(&rows[0]);
            volume += jacobian;
            for c in 0..8 {
                let factor = |axis: usize| 1.0 + SIGNS[c][axis] * point[axis] * gauss;
                means.weight[c] += jacobian * 0.125 * factor(0) * factor(1) * factor(2);
                for k in 0..3 {
                    means.slope[c][k] +=
                        (0..3).map(|axis| local[c][axis] * rows[axis][k]).sum::<f64>();
                }
            }
        }
        means.weight = means.weight.map(|weight| weight / volume);
        means.slope = means.slope.map(|slope| slope.map(|entry| entry / volume));
        means
    }

    #[test]
    fn means_of_hexahedra_are_integrals() {
        for by in [0.0, 0.2, 0.45, 0.6] {
            let corners = distorted::<8>(3, by);
            close(&free::<3, 8>(&corners), &by_gauss_points(&corners));
        }
        // A pyramid: four corners in one place.
        let mut corners = distorted::<8>(3, 0.2);
        for c in 5..8 {
            corners[c] = corners[4];
        }
        close(&free::<3, 8>(&corners), &by_gauss_points(&corners));
    }

    /// Weights sum to one, gradients to zero, and the gradient of x is the unit tensor.
    fn conforms<const D: usize, const C: usize>(corners: &[[f64; 4]; C], means: &Alone<C>) {
        let sum = means.weight.iter().sum::<f64>();
        assert!((sum - 1.0).abs() < 1e-14, "{sum}");
        for j in 0..D {
            let slopes: f64 = means.slope.iter().map(|slope| slope[j]).sum();
            assert!(slopes.abs() < 1e-12, "{slopes}");
            for i in 0..D {
                let entry: f64 = (0..C).map(|c| corners[c][i] * means.slope[c][j]).sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((entry - unit).abs() < 1e-12, "{i} {j}: {entry}");
            }
        }
    }

    /// Corners of a cube moved by some numbers.
    fn distorted<const C: usize>(dimension: usize, by: f64) -> [[f64; 4]; C] {
        std::array::from_fn(|c| {
            let mut corner = [0.0; 4];
            for axis in 0..dimension {
                let shift = ((3 * c + 5 * axis) as f64 * 1.7).sin();
                corner[axis] = SIGNS[c][axis] + by * shift;
            }
            corner
        })
    }

    #[test]
    fn means_of_distorted_domains_conform() {
        for by in [0.0, 0.2, 0.45] {
            let corners = distorted::<4>(2, by);
            conforms::<2, 4>(&corners, &free::<2, 4>(&corners));
            let turned = [corners[3], corners[2], corners[1], corners[0]];
            conforms::<2, 4>(&turned, &free::<2, 4>(&turned));
            let triangle = [corners[0], corners[1], corners[2], corners[2]];
            conforms::<2, 4>(&triangle, &free::<2, 4>(&triangle));
            let corners = distorted::<8>(3, by);
            conforms::<3, 8>(&corners, &free::<3, 8>(&corners));
            let four = [corners[0], corners[1], corners[3], corners[4]];
            conforms::<3, 4>(&four, &free::<3, 4>(&four));
        }
    }

    #[test]
    fn centroids_are_means_of_corners_with_the_weights() {
        // Parallel sides 4 and 2, height 3: the centroid is 3 (4 + 2*2)/(3 (4 + 2)) high.
        let corners = [[0.0; 4], [4.0, 0.0, 0.0, 0.0], [3.0, 3.0, 0.0, 0.0], [1.0, 3.0, 0.0, 0.0]];
        let found = free::<2, 4>(&corners);
        let height: f64 = (0..4).map(|c| found.weight[c] * corners[c][1]).sum();
        assert!((height - 4.0 / 3.0).abs() < 1e-14, "{height}");
        // A triangle is a quadrangle with two corners in one place.
        let corners = [[0.0; 4], [2.0, 0.5, 0.0, 0.0], [0.7, 1.5, 0.0, 0.0]];
        let four = free::<2, 4>(&[corners[0], corners[1], corners[2], corners[2]]);
        assert!((four.weight[2] + four.weight[3] - 1.0 / 3.0).abs() < 1e-14, "{four:?}");
        assert!((four.weight[0] - 1.0 / 3.0).abs() < 1e-14);
    }

    #[test]
    fn parallel_domains_agree_with_the_general_formulas() {
        let edges = [[0.5, 0.1, 0.0, 0.0], [0.3, 0.4, 0.0, 0.0]];
        let corners: [[f64; 4]; 4] = std::array::from_fn(|c| corner_of_parallel(&edges, c));
        close(&parallel::<2, 4>(&edges), &free::<2, 4>(&corners));
        // R4 of language.md: g1 = (r1y - r2y, r2x - r1x)/V, V = 4 |r1 x r2|.
        let (volume, half) = (4.0 * (0.5 * 0.4 - 0.1 * 0.3), free::<2, 4>(&corners).slope[0]);
        assert!((half[0] - (0.1 - 0.4) / volume).abs() < 1e-14);
        assert!((half[1] - (0.3 - 0.5) / volume).abs() < 1e-14);
        let edges = [[0.5, 0.1, 0.0, 0.0], [0.3, 0.4, 0.2, 0.0], [-0.1, 0.2, 0.6, 0.0]];
        let corners: [[f64; 4]; 8] = std::array::from_fn(|c| corner_of_parallel(&edges, c));
        close(&parallel::<3, 8>(&edges), &free::<3, 8>(&corners));
        let line = parallel::<1, 2>(&[[0.25, 0.0, 0.0, 0.0]]);
        assert_eq!((line.weight, line.slope[1][0]), ([0.5; 2], 2.0));
    }

    fn close<const C: usize>(a: &Alone<C>, b: &Alone<C>) {
        for c in 0..C {
            assert!((a.weight[c] - b.weight[c]).abs() < 1e-14);
            for k in 0..3 {
                assert!((a.slope[c][k] - b.slope[c][k]).abs() < 1e-13, "{c} {k}");
            }
        }
    }
}
