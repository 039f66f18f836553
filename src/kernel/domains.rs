//! Geometry of the domains of particles: means of the finite element functions of their corners
//! and of the gradients of these (language.md 9.7).

use crate::geometry::element::SIGNS;
use crate::material::Lane;
use crate::math::tensor::{Tensor, rotation};
use crate::shape::{DomainKind, ShapeKind};

/// Means over a domain with `C` corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means<const C: usize> {
    /// w_c = (1/V) int M_c.
    pub weight: [f64; C],
    /// g_c = (1/V) int grad M_c \[1/unit of the corners\].
    pub slope: [[f64; 4]; C],
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

/// dt L r with the velocity gradient of particle `p` of a chunk.
#[inline(always)]
pub fn stretch<const D: usize>(
    edge: &[f64; 4],
    gradient: &[Lane; 9],
    dt: f64,
    p: usize,
) -> [f64; 4] {
    let mut change = [0.0; 4];
    for i in 0..D {
        for j in 0..D {
            change[i] += dt * gradient[3 * i + j][p / 4][p % 4] * edge[j];
        }
    }
    change
}

/// (l U_11, l U_22, l U_33, l), at most `most`, with U = R^T F.
pub fn half_sizes(half: f64, deformation: &Tensor, most: f64) -> [f64; 4] {
    let stretch = rotation(deformation).transpose() * deformation;
    let size = |axis: usize| (half * stretch[(axis, axis)]).min(most);
    [size(0), size(1), size(2), half]
}

/// Means of a parallelogram, box or line in units of `unit`: w = 1/2^d, g_c = R^-T s_c/2^d with the
/// half edges r_i as the columns of R and the signs s_c of the corner.
#[inline(always)]
pub fn means_of_parallel<const D: usize, const C: usize>(
    edges: &[[f64; 4]; D],
    unit: f64,
    count: usize,
) -> Means<C> {
    let mean = 1.0 / C as f64;
    let mut r = [[0.0; 3]; 3];
    for axis in 0..3 {
        r[axis][axis] = 1.0;
        if axis < D {
            r[axis].copy_from_slice(&edges[axis][..3]);
        }
    }
    // Rows of R^-1: cross products of the other columns over the volume.
    let rows = [cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1])];
    let scale = unit * mean / dot(r[0], rows[0]);
    let mut means = Means { weight: [mean; C], slope: [[0.0; 4]; C] };
    for c in 0..count.min(C) {
        for axis in 0..D {
            for k in 0..D {
                means.slope[c][k] += scale * SIGNS[c][axis] * rows[axis][k];
            }
        }
    }
    means
}

/// Means over a quadrangle, tetrahedron or hexahedron from its `count` = `C` corners.
#[inline(always)]
pub fn means<const D: usize, const C: usize>(corners: &[[f64; 4]; C], count: usize) -> Means<C> {
    match (D, C) {
        (2, _) => quadrangle(corners),
        (_, 4) => tetrahedron(corners),
        _ => hexahedron(corners, count),
    }
}

/// Tetrahedron: w = 1/4 and the constant gradients.
#[inline(always)]
fn tetrahedron<const C: usize>(corners: &[[f64; 4]; C]) -> Means<C> {
    let mut edges = [[0.0; 3]; 3];
    for axis in 0..3 {
        for k in 0..3 {
            edges[axis][k] = corners[axis + 1][k] - corners[0][k];
        }
    }
    let rows = [cross(edges[1], edges[2]), cross(edges[2], edges[0]), cross(edges[0], edges[1])];
    let inverse = 1.0 / dot(edges[0], rows[0]);
    let mut means = Means { weight: [0.25; C], slope: [[0.0; 4]; C] };
    for axis in 0..3 {
        for k in 0..3 {
            let slope = inverse * rows[axis][k];
            means.slope[axis + 1][k] = slope;
            means.slope[0][k] -= slope;
        }
    }
    means
}

/// Quadrangle, corners in order round it. Either sense: signs of area and moments then agree.
#[inline(always)]
fn quadrangle<const C: usize>(x: &[[f64; 4]; C]) -> Means<C> {
    let mut means = Means { weight: [0.0; C], slope: [[0.0; 4]; C] };
    let side = |i: usize, j: usize| [x[i][0] - x[j][0], x[i][1] - x[j][1]];
    let turn = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    // Twice the area from the diagonals; a and b measure how far it is from a parallelogram.
    let volume = 0.5 * turn(side(2, 0), side(3, 1));
    let a = turn(side(3, 0), side(1, 2));
    let b = turn(side(2, 3), side(0, 1));
    let scale = 1.0 / (24.0 * volume);
    let signs = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    for c in 0..4 {
        means.weight[c] = scale * (6.0 * volume + signs[c][0] * a + signs[c][1] * b);
        let across = side((c + 1) % 4, (c + 3) % 4);
        means.slope[c] = [0.5 * across[1] / volume, -0.5 * across[0] / volume, 0.0, 0.0];
    }
    means
}

/// Hexahedron: two Gauss points per axis integrate M_c det J and cof(J) grad M_c exactly, since both
/// are of degree 3 at most along each axis.
#[inline(always)]
fn hexahedron<const C: usize>(corners: &[[f64; 4]; C], count: usize) -> Means<C> {
    let gauss = (1.0f64 / 3.0).sqrt();
    let mut means = Means { weight: [0.0; C], slope: [[0.0; 4]; C] };
    let mut volume = 0.0;
    for point in SIGNS.into_iter().take(count) {
        let (mut value, mut local) = ([0.0; C], [[0.0; 3]; C]);
        let mut columns = [[0.0; 3]; 3];
        for c in 0..count.min(C) {
            let s = SIGNS[c];
            let factor = [0, 1, 2].map(|axis| 1.0 + s[axis] * point[axis] * gauss);
            value[c] = 0.125 * factor[0] * factor[1] * factor[2];
            local[c] = [
                0.125 * s[0] * factor[1] * factor[2],
                0.125 * s[1] * factor[2] * factor[0],
                0.125 * s[2] * factor[0] * factor[1],
            ];
            for axis in 0..3 {
                for k in 0..3 {
                    columns[axis][k] += local[c][axis] * corners[c][k];
                }
            }
        }
        let [x, y, z] = columns;
        let rows = [cross(y, z), cross(z, x), cross(x, y)];
        let jacobian = dot(x, rows[0]);
        volume += jacobian;
        for c in 0..count.min(C) {
            means.weight[c] += jacobian * value[c];
            for axis in 0..3 {
                for k in 0..3 {
                    means.slope[c][k] += local[c][axis] * rows[axis][k];
                }
            }
        }
    }
    for c in 0..count.min(C) {
        means.weight[c] /= volume;
        means.slope[c] = means.slope[c].map(|slope| slope / volume);
    }
    means
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::corners::corner_of_parallel;

    /// Weights sum to one, gradients to zero, and the gradient of x is the unit tensor.
    fn conforms<const D: usize, const C: usize>(corners: &[[f64; 4]; C], means: &Means<C>) {
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
            conforms::<2, 4>(&corners, &means::<2, 4>(&corners, 4));
            let turned = [corners[3], corners[2], corners[1], corners[0]];
            conforms::<2, 4>(&turned, &means::<2, 4>(&turned, 4));
            let triangle = [corners[0], corners[1], corners[2], corners[2]];
            conforms::<2, 4>(&triangle, &means::<2, 4>(&triangle, 4));
            let corners = distorted::<8>(3, by);
            conforms::<3, 8>(&corners, &means::<3, 8>(&corners, 8));
            let four = [corners[0], corners[1], corners[3], corners[4]];
            conforms::<3, 4>(&four, &means::<3, 4>(&four, 4));
        }
    }

    #[test]
    fn centroids_are_means_of_corners_with_the_weights() {
        // Parallel sides 4 and 2, height 3: the centroid is 3 (4 + 2*2)/(3 (4 + 2)) high.
        let corners = [[0.0; 4], [4.0, 0.0, 0.0, 0.0], [3.0, 3.0, 0.0, 0.0], [1.0, 3.0, 0.0, 0.0]];
        let found = means::<2, 4>(&corners, 4);
        let height: f64 = (0..4).map(|c| found.weight[c] * corners[c][1]).sum();
        assert!((height - 4.0 / 3.0).abs() < 1e-14, "{height}");
        // A triangle is a quadrangle with two corners in one place.
        let corners = [[0.0; 4], [2.0, 0.5, 0.0, 0.0], [0.7, 1.5, 0.0, 0.0]];
        let four = means::<2, 4>(&[corners[0], corners[1], corners[2], corners[2]], 4);
        assert!((four.weight[2] + four.weight[3] - 1.0 / 3.0).abs() < 1e-14, "{four:?}");
        assert!((four.weight[0] - 1.0 / 3.0).abs() < 1e-14);
    }

    #[test]
    fn parallel_domains_agree_with_the_general_formulas() {
        let edges = [[0.5, 0.1, 0.0, 0.0], [0.3, 0.4, 0.0, 0.0]];
        let corners: [[f64; 4]; 4] = std::array::from_fn(|c| corner_of_parallel(&edges, c));
        close(&means_of_parallel::<2, 4>(&edges, 1.0, 4), &means::<2, 4>(&corners, 4));
        // R4 of language.md: g1 = (r1y - r2y, r2x - r1x)/V, V = 4 |r1 x r2|.
        let (volume, half) = (4.0 * (0.5 * 0.4 - 0.1 * 0.3), means::<2, 4>(&corners, 4).slope[0]);
        assert!((half[0] - (0.1 - 0.4) / volume).abs() < 1e-14);
        assert!((half[1] - (0.3 - 0.5) / volume).abs() < 1e-14);
        let edges = [[0.5, 0.1, 0.0, 0.0], [0.3, 0.4, 0.2, 0.0], [-0.1, 0.2, 0.6, 0.0]];
        let corners: [[f64; 4]; 8] = std::array::from_fn(|c| corner_of_parallel(&edges, c));
        close(&means_of_parallel::<3, 8>(&edges, 1.0, 8), &means::<3, 8>(&corners, 8));
        let line = means_of_parallel::<1, 2>(&[[0.25, 0.0, 0.0, 0.0]], 0.5, 2);
        assert_eq!((line.weight, line.slope[1][0]), ([0.5; 2], 1.0));
    }

    fn close<const C: usize>(a: &Means<C>, b: &Means<C>) {
        for c in 0..C {
            assert!((a.weight[c] - b.weight[c]).abs() < 1e-14);
            for k in 0..4 {
                assert!((a.slope[c][k] - b.slope[c][k]).abs() < 1e-13, "{c} {k}");
            }
        }
    }
}
