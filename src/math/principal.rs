//! Principal values and directions of four symmetric tensors at once.

use super::v4::{Wide, splats};

/// Principal values and directions: entry 3 i + k of the directions is component i of direction k.
pub struct Principal<V> {
    /// In no order.
    pub values: [V; 3],
    /// Orthonormal.
    pub directions: [V; 9],
}

/// Planes of the rotations of a sweep: axes p and q, the third axis, and the places of pq, pr, qr
/// among the components 11, 22, 33, 12, 13, 23.
const PLANES: [[usize; 6]; 3] = [[0, 1, 2, 3, 4, 5], [0, 2, 1, 4, 3, 5], [1, 2, 0, 5, 3, 4]];

/// A component off the diagonal is nothing below this part of the tensor, both squared: half a unit
/// in the last place of the largest principal value.
const NOTHING: f64 = 1e-32;

/// More sweeps than any 3 x 3 tensor needs: each squares what is left off the diagonal.
const MOST_SWEEPS: usize = 8;

/// Principal values and directions of the tensor 11, 22, 33, 12, 13, 23, whose directions beyond
/// the `D` dimensions are axes: Jacobi's rotations, one in a plane, sweeps over three planes in
/// space until nothing is left off the diagonal. Equal values are no special case, and each
/// tensor is solved for itself.
///
/// # Source  Golub and Van Loan 2013, section 8.5
#[inline(always)]
pub fn principal<V: Wide, const D: usize>(tensor: [V; 6]) -> Principal<V> {
    let mut a = tensor;
    let mut n: [V; 9] = splats([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    if D == 2 {
        rotate::<V, 2>(&mut a, &mut n, PLANES[0], V::splat(0.0));
    }
    if D == 3 {
        let diagonal = a[0].mul_add(a[0], a[1].mul_add(a[1], a[2] * a[2]));
        let off = a[3].mul_add(a[3], a[4].mul_add(a[4], a[5] * a[5]));
        let bound = V::splat(NOTHING) * (diagonal + off + off);
        for _ in 0..MOST_SWEEPS {
            let off = (a[3] * a[3]).larger(a[4] * a[4]).larger(a[5] * a[5]);
            if !bound.any_below(off) {
                break;
            }
            for plane in 0..3 {
                rotate::<V, 3>(&mut a, &mut n, PLANES[plane], bound);
            }
        }
    }
    Principal { values: [a[0], a[1], a[2]], directions: n }
}

/// Turns in the plane of axes p and q so that component pq vanishes; not where its square is below
/// the bound.
#[inline(always)]
fn rotate<V: Wide, const D: usize>(
    a: &mut [V; 6],
    n: &mut [V; 9],
    [p, q, _, pq, pr, qr]: [usize; 6],
    bound: V,
) {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let off = bound.below(a[pq] * a[pq], a[pq], zero);
    let (gap, twice) = (a[q] - a[p], off + off);
    let length = gap.absolute() + gap.mul_add(gap, twice * twice).sqrt();
    let tangent = twice / length.larger(V::splat(f64::MIN_POSITIVE));
    let tangent = gap.below(zero, zero - tangent, tangent);
    let cosine = one / tangent.mul_add(tangent, one).sqrt();
    let sine = tangent * cosine;
    let shift = tangent * off;
    (a[p], a[q], a[pq]) = (a[p] - shift, a[q] + shift, a[pq] - off);
    if D == 3 {
        (a[pr], a[qr]) = (cosine * a[pr] - sine * a[qr], sine * a[pr] + cosine * a[qr]);
    }
    for i in 0..D {
        let (x, y) = (n[3 * i + p], n[3 * i + q]);
        (n[3 * i + p], n[3 * i + q]) = (cosine * x - sine * y, sine * x + cosine * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::tensor::Tensor;
    use crate::math::v4::Plain;
    use nalgebra::{Rotation3, Vector3};

    fn turn() -> Tensor {
        Rotation3::new(Vector3::new(1.0, -2.0, 0.5)).into_inner()
    }

    fn six(tensors: [&Tensor; 4]) -> [Plain; 6] {
        [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
            .map(|place| Plain::load(&tensors.map(|tensor| tensor[place])))
    }

    /// Values and directions of one of the four tensors.
    fn lane(found: &Principal<Plain>, lane: usize) -> (Vector3<f64>, Tensor) {
        let values = found.values.map(|value| value.array()[lane]);
        (values.into(), Tensor::from_fn(|i, k| found.directions[3 * i + k].array()[lane]))
    }

    fn examples() -> Vec<Tensor> {
        let of = |a, b, c| turn() * Tensor::from_diagonal(&Vector3::new(a, b, c));
        [
            of(3.0, -1.0, 2.0),
            of(2.0, 2.0, 5.0),
            of(7.0, 7.0 + 1e-9, 7.0 - 1e-12),
            of(1e6, 1.0, -1e-6),
            of(4.0, 4.0, 4.0),
            of(0.0, 0.0, 0.0),
            Tensor::from_diagonal(&Vector3::new(1.0, 2.0, 1.0)),
        ]
        .into_iter()
        .map(|half| half * turn().transpose())
        .map(|a| (a + a.transpose()) * 0.5)
        .collect()
    }

    #[test]
    fn equal_and_nearly_equal_values_are_as_good_as_others() {
        for a in examples() {
            let (values, n) = lane(&principal::<Plain, 3>(six([&a; 4])), 2);
            let scale = a.norm();
            assert!((n * n.transpose() - Tensor::identity()).norm() < 4e-15);
            let again = n * Tensor::from_diagonal(&values) * n.transpose();
            assert!((again - a).norm() <= 4e-15 * scale, "{a} {again}");
            let mut exact: Vec<f64> = a.symmetric_eigenvalues().iter().copied().collect();
            let mut found: Vec<f64> = values.iter().copied().collect();
            exact.sort_by(f64::total_cmp);
            found.sort_by(f64::total_cmp);
            for (found, exact) in found.iter().zip(&exact) {
                assert!((found - exact).abs() <= 4e-15 * scale, "{found} for {exact}");
            }
        }
    }

    #[test]
    fn neighbours_change_nothing() {
        let all = examples();
        let mixed = principal::<Plain, 3>(six([&all[0], &all[3], &all[6], &all[5]]));
        for (place, a) in [&all[0], &all[3], &all[6], &all[5]].into_iter().enumerate() {
            assert_eq!(lane(&mixed, place), lane(&principal::<Plain, 3>(six([a; 4])), 0));
        }
    }

    #[test]
    fn a_plane_takes_one_rotation_and_a_line_none() {
        let a = Tensor::new(1.0, 0.7, 0.0, 0.7, -2.0, 0.0, 0.0, 0.0, 5.0);
        let (values, n) = lane(&principal::<Plain, 2>(six([&a; 4])), 0);
        assert!((n * Tensor::from_diagonal(&values) * n.transpose() - a).norm() < 1e-15);
        assert_eq!((values[2], n[(2, 2)], n[(0, 2)]), (5.0, 1.0, 0.0));
        let line = Tensor::from_diagonal(&Vector3::new(1.0, 2.0, 3.0));
        let (values, n) = lane(&principal::<Plain, 1>(six([&line; 4])), 0);
        assert_eq!((values, n), (Vector3::new(1.0, 2.0, 3.0), Tensor::identity()));
    }
}
