//! Small tensors of four particles at once, in one, two or three dimensions.
//!
//! Entry 3 i + j of an array is component ij. In two dimensions only entries 0, 1, 3, 4 count (the
//! rest of the tensor is that of the identity), in one dimension only entry 0.

use super::v4::Wide;

/// A tensor of each of four particles.
pub type Four<V> = [V; 9];

/// Does entry 3 i + j lie in the `D` dimensions?
#[inline(always)]
pub const fn in_space<const D: usize>(entry: usize) -> bool {
    entry / 3 < D && entry % 3 < D
}

/// The cofactors cof F = J F^-T and J = det F.
#[inline(always)]
pub fn cofactors<V: Wide, const D: usize>(f: &Four<V>) -> (Four<V>, V) {
    let zero = V::splat(0.0);
    let mut c = [zero; 9];
    match D {
        1 => {
            c[0] = V::splat(1.0);
            (c, f[0])
        }
        2 => {
            (c[0], c[1], c[3], c[4]) = (f[4], zero - f[3], zero - f[1], f[0]);
            (c, f[0] * f[4] - f[1] * f[3])
        }
        _ => {
            let [f11, f12, f13, f21, f22, f23, f31, f32, f33] = *f;
            let c = [
                f22 * f33 - f23 * f32,
                f23 * f31 - f21 * f33,
                f21 * f32 - f22 * f31,
                f32 * f13 - f33 * f12,
                f33 * f11 - f31 * f13,
                f31 * f12 - f32 * f11,
                f12 * f23 - f13 * f22,
                f13 * f21 - f11 * f23,
                f11 * f22 - f12 * f21,
            ];
            (c, f[0].mul_add(c[0], f[1].mul_add(c[1], f[2] * c[2])))
        }
    }
}

/// a b.
#[inline(always)]
pub fn product<V: Wide, const D: usize>(a: &Four<V>, b: &Four<V>) -> Four<V> {
    contract::<V, D>(a, (3, 1), b, (3, 1))
}

/// a b^T.
#[inline(always)]
pub fn product_transposed<V: Wide, const D: usize>(a: &Four<V>, b: &Four<V>) -> Four<V> {
    contract::<V, D>(a, (3, 1), b, (1, 3))
}

/// a^T b.
#[inline(always)]
pub fn transposed_product<V: Wide, const D: usize>(a: &Four<V>, b: &Four<V>) -> Four<V> {
    contract::<V, D>(a, (1, 3), b, (3, 1))
}

/// sum_k a_ik b_kj, from the distances in memory of the indices i and k of a, k and j of b.
#[inline(always)]
fn contract<V: Wide, const D: usize>(
    a: &Four<V>,
    (ai, ak): (usize, usize),
    b: &Four<V>,
    (bk, bj): (usize, usize),
) -> Four<V> {
    let mut c = [V::splat(0.0); 9];
    for i in 0..D {
        for j in 0..D {
            let mut sum = a[ai * i] * b[bj * j];
            for k in 1..D {
                sum = a[ai * i + ak * k].mul_add(b[bk * k + bj * j], sum);
            }
            c[3 * i + j] = sum;
        }
    }
    c
}

/// Newton's iteration for the polar decomposition stops below this squared change: the next one
/// would be the square of it.
const SETTLED: f64 = 1e-18;

/// Most steps of that iteration: enough for stretches up to 1e6.
const MOST_STEPS: usize = 30;

/// Rotation R of F = R U, det F > 0: in three dimensions by R <- (R + R^-T)/2 until it settles,
/// each particle for itself, in two dimensions in closed form.
///
/// # Source  Higham 1986
#[inline(always)]
pub fn rotation<V: Wide, const D: usize>(f: &Four<V>) -> Four<V> {
    let (zero, half) = (V::splat(0.0), V::splat(0.5));
    let mut r = [zero; 9];
    match D {
        1 => r[0] = V::splat(1.0),
        2 => {
            let (c, s) = (f[0] + f[4], f[3] - f[1]);
            let inverse = V::splat(1.0) / c.mul_add(c, s * s).sqrt();
            let (c, s) = (c * inverse, s * inverse);
            (r[0], r[1], r[3], r[4]) = (c, zero - s, s, c);
        }
        _ => {
            r = *f;
            let mut change = V::splat(f64::INFINITY);
            for _ in 0..MOST_STEPS {
                let (cofactor, j) = cofactors::<V, D>(&r);
                let scale = half / j;
                let mut square = zero;
                for entry in 0..9 {
                    let new = half.mul_add(r[entry], scale * cofactor[entry]);
                    let step = new - r[entry];
                    square = step.mul_add(step, square);
                    // A particle that has settled stays, whatever its neighbours do.
                    r[entry] = change.below(V::splat(SETTLED), r[entry], new);
                }
                change = change.below(V::splat(SETTLED), change, square);
                let left = change.array();
                if left.iter().all(|square| *square < SETTLED || square.is_nan()) {
                    break;
                }
            }
        }
    }
    r
}

/// Smallest and largest squared stretch: eigenvalues of F^T F within the dimensions.
#[inline(always)]
pub fn squared_stretches<V: Wide, const D: usize>(f: &Four<V>) -> [V; 2] {
    let c = transposed_product::<V, D>(f, f);
    match D {
        1 => [c[0], c[0]],
        2 => {
            let (mean, half) = (V::splat(0.5) * (c[0] + c[4]), V::splat(0.5) * (c[0] - c[4]));
            let radius = half.mul_add(half, c[1] * c[1]).sqrt();
            [mean - radius, mean + radius]
        }
        _ => {
            let mean = V::splat(1.0 / 3.0) * (c[0] + c[4] + c[8]);
            let (a, b, d) = (c[0] - mean, c[4] - mean, c[8] - mean);
            let (e, g, h) = (c[1], c[2], c[5]);
            let off = e.mul_add(e, g.mul_add(g, h * h));
            let diagonal = a.mul_add(a, b.mul_add(b, d * d));
            let square = V::splat(1.0 / 6.0) * (diagonal + off + off);
            let p = square.sqrt().larger(V::splat(1e-100));
            let determinant = a * (b * d - h * h) - e * (e * d - h * g) + g * (e * h - b * g);
            let one = V::splat(1.0);
            let q = (V::splat(0.5) * determinant / (p * p * p)).smaller(one).larger(V::splat(-1.0));
            let twice = p + p;
            [mean - twice * third_of_angle(V::splat(0.0) - q), mean + twice * third_of_angle(q)]
        }
    }
}

/// cos(acos(q)/3) for -1 <= q <= 1: a polynomial in cos(acos(q)/2), good to 2e-7, and a step of
/// Newton's for 4 t^3 - 3 t = q.
#[inline(always)]
fn third_of_angle<V: Wide>(q: V) -> V {
    const FIT: [f64; 7] = [
        0.5000001632013076,
        0.5773334600450495,
        -0.1108230402375623,
        0.05154791013547763,
        -0.026538217925966587,
        0.010623049587632601,
        -0.002143448158326336,
    ];
    let half = V::splat(0.5);
    let u = half.mul_add(q, half).sqrt();
    let mut t = V::splat(FIT[6]);
    for k in (0..6).rev() {
        t = t.mul_add(u, V::splat(FIT[k]));
    }
    let square = t * t;
    let value = t * (V::splat(4.0) * square - V::splat(3.0)) - q;
    let slope = (V::splat(12.0) * square - V::splat(3.0)).larger(V::splat(1e-3));
    t - value / slope
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::tensor::{self, Tensor};
    use crate::math::v4::Plain;
    use nalgebra::{Rotation3, Vector3};

    fn four(f: &Tensor) -> Four<Plain> {
        std::array::from_fn(|entry| Plain::splat(f[(entry / 3, entry % 3)]))
    }

    fn first(f: &Four<Plain>) -> Tensor {
        Tensor::from_fn(|i, j| f[3 * i + j].array()[0])
    }

    fn examples() -> Vec<Tensor> {
        let turn = Rotation3::new(Vector3::new(1.0, -2.0, 0.5)).into_inner();
        let shear = Tensor::new(1.0, 3.0, 0.2, 0.0, 1.1, -0.4, 0.1, 0.0, 0.7);
        let flat = Tensor::from_diagonal(&Vector3::new(0.05, 2.0, 9.0));
        vec![Tensor::identity(), turn, shear, turn * flat, Tensor::identity() * 1.5]
    }

    /// The part of a tensor that counts in two dimensions.
    fn plane(f: &Tensor) -> Tensor {
        let mut plane = Tensor::identity();
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            plane[(i, j)] = f[(i, j)];
        }
        plane
    }

    #[test]
    fn cofactors_are_the_transposed_inverse_times_the_determinant() {
        for f in examples() {
            let (cofactor, j) = cofactors::<Plain, 3>(&four(&f));
            let exact = f.try_inverse().unwrap().transpose() * f.determinant();
            assert!((first(&cofactor) - exact).norm() < 1e-14 * exact.norm());
            assert!((j.array()[0] - f.determinant()).abs() < 1e-14 * f.norm().powi(3));
            let f = plane(&f);
            let (cofactor, j) = cofactors::<Plain, 2>(&four(&f));
            let exact = f.try_inverse().unwrap().transpose() * f.determinant();
            assert!((cofactor[1].array()[0] - exact[(0, 1)]).abs() < 1e-14);
            assert!((j.array()[0] - f.determinant()).abs() < 1e-14);
        }
    }

    #[test]
    fn rotations_are_those_of_the_polar_decomposition_each_for_itself() {
        for f in examples() {
            let exact = tensor::rotation(&f);
            let mut mixed = four(&f);
            let alone = first(&rotation::<Plain, 3>(&mixed));
            assert!((alone - exact).norm() < 1e-14, "{f}");
            for (entry, other) in four(&examples()[2]).into_iter().enumerate() {
                mixed[entry] =
                    mixed[entry].below(Plain::load(&[9e9, -9e9, 9e9, -9e9]), mixed[entry], other);
            }
            assert_eq!(first(&rotation::<Plain, 3>(&mixed)), alone, "neighbours change nothing");
            let f = plane(&f);
            if f.determinant() > 0.0 {
                let exact = tensor::rotation(&f);
                let found = rotation::<Plain, 2>(&four(&f));
                assert!((found[3].array()[0] - exact[(1, 0)]).abs() < 1e-14, "{f}");
            }
        }
    }

    #[test]
    fn stretches_are_singular_values() {
        for f in examples() {
            let exact = (f.transpose() * f).symmetric_eigenvalues();
            let [low, high] = squared_stretches::<Plain, 3>(&four(&f)).map(|v| v.array()[0]);
            assert!((high - exact.max()).abs() < 1e-12 * exact.max(), "{high} {exact}");
            assert!((low - exact.min()).abs() < 1e-9 * exact.max(), "{low} {exact}");
        }
        let stretches = squared_stretches::<Plain, 2>(&four(&examples()[2]));
        let [low, high]: [f64; 2] = stretches.map(|v| v.array()[0]);
        let part = nalgebra::Matrix2::<f64>::new(1.0, 3.0, 0.0, 1.1);
        let exact = (part.transpose() * part).symmetric_eigenvalues();
        assert!((low - exact.min()).abs() < 1e-14);
        assert!((high - exact.max()).abs() < 1e-14);
    }
}
