//! Logarithm, exponential and power of four numbers at once.
//!
//! Every lane is computed for itself, so a number gives the same bits wherever it stands. Errors
//! relative to the correct value: below 1e-15 for ln and exp, for powers growing with |n ln x|.

use super::v4::Wide;

/// ln 2 in two parts: the first has zeros in its last bits, so that its product with an exponent is
/// exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Coefficients of (ln((1 + s)/(1 - s)) - 2 s)/s in powers of s^2.
const LN: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// Coefficients of r (e^r + 1)/(e^r - 1) - 2 in powers of r^2.
const EXP: [f64; 5] = [
    1.666_666_666_666_660_2e-1,
    -2.777_777_777_701_559_3e-3,
    6.613_756_321_437_934e-5,
    -1.653_390_220_546_525_2e-6,
    4.138_136_797_057_238_5e-8,
];

/// Exponents beyond these give 0 (or nearly so) and numbers near the largest.
const EXPONENTS: [f64; 2] = [-708.0, 709.0];

/// c0 + c1 x + c2 x^2 + ..., N odd: even and odd powers apart, so that two chains of operations
/// run side by side.
#[inline(always)]
fn polynomial<V: Wide, const N: usize>(coefficients: &[f64; N], x: V) -> V {
    let square = x * x;
    let (mut even, mut odd) = (V::splat(coefficients[N - 1]), V::splat(coefficients[N - 2]));
    for k in (0..N / 2).rev() {
        even = even.mul_add(square, V::splat(coefficients[2 * k]));
        if k > 0 {
            odd = odd.mul_add(square, V::splat(coefficients[2 * k - 1]));
        }
    }
    odd.mul_add(x, even)
}

/// ln x of positive normal numbers; -709 at 0.
///
/// x = 2^k (1 + f), s = f/(2 + f): ln(1 + f) = f - f^2/2 + s (f^2/2 + R(s^2)).
///
/// # Source  fdlibm, e_log.c
#[inline(always)]
pub fn ln<V: Wide>(x: V) -> V {
    let (one, half) = (V::splat(1.0), V::splat(0.5));
    let [mantissa, exponent] = x.split();
    let small = V::splat(std::f64::consts::SQRT_2);
    let exponent = mantissa.below(small, exponent, exponent + one);
    let f = mantissa.below(small, mantissa, half * mantissa) - one;
    let s = f / (V::splat(2.0) + f);
    let z = s * s;
    let rest = z * polynomial(&LN, z);
    let square = half * f * f;
    let low = s.mul_add(square + rest, exponent * V::splat(LN_2[1]));
    exponent.mul_add(V::splat(LN_2[0]), f - (square - low))
}

/// e^x; 0 < e^-708 below -708, e^709 above 709.
///
/// x = k ln 2 + r, c = r - r^2 P(r^2): e^r = 1 + r + r c/(2 - c).
///
/// # Source  fdlibm, e_exp.c
#[inline(always)]
pub fn exp<V: Wide>(x: V) -> V {
    let (zero, one, two) = (V::splat(0.0), V::splat(1.0), V::splat(2.0));
    let x = x.larger(V::splat(EXPONENTS[0])).smaller(V::splat(EXPONENTS[1]));
    let k = x.mul_add(V::splat(std::f64::consts::LOG2_E), V::splat(0.5)).floor();
    let high = (zero - k).mul_add(V::splat(LN_2[0]), x);
    let low = k * V::splat(LN_2[1]);
    let r = high - low;
    let square = r * r;
    let c = r - square * polynomial(&EXP, square);
    let value = one + ((r * c / (two - c) - low) + high);
    value * k.power_of_two()
}

/// x^n for x >= 0: 0^n = 0 for n > 0, and 0^0 = 1.
#[inline(always)]
pub fn power<V: Wide>(x: V, n: f64) -> V {
    let at_zero = V::splat(if n == 0.0 { 1.0 } else { 0.0 });
    V::splat(0.0).below(x, exp(V::splat(n) * ln(x)), at_zero)
}

/// (1 + u)^n for small u, by the binomial series: a quarter of the work of a [`power`].
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// Binomial coefficients of n over 0, 1, 2 ...
    coefficients: [f64; 13],
    /// The series holds for 0 <= u below this number.
    limit: f64,
}

impl Growth {
    /// The first term left out, binomial(n, 13) u^13, is below 1e-17 for n <= 2 and u <= 1/16;
    /// for larger n the series is never used.
    pub fn new(n: f64) -> Self {
        let mut coefficients = [1.0; 13];
        for k in 1..13 {
            let above = k as f64 - 1.0;
            coefficients[k] = coefficients[k - 1] * (n - above) / (above + 1.0);
        }
        Self { coefficients, limit: if n <= 2.0 { 1.0 / 16.0 } else { 0.0 } }
    }

    /// (1 + u)^n, and 1 where the series holds, 0 elsewhere (also where u is no number).
    #[inline(always)]
    pub fn factor<V: Wide>(&self, u: V) -> [V; 2] {
        let holds = u.below(V::splat(self.limit), V::splat(1.0), V::splat(0.0));
        [polynomial(&self.coefficients, u), holds]
    }
}

#[cfg(test)]
mod tests {
    use super::super::v4::{Plain, Sweep, dispatch};
    use super::*;

    /// ln, exp and power of each number, with every neighbour to its right.
    struct Everywhere(Vec<f64>);

    impl Sweep for Everywhere {
        type Output = Vec<[[f64; 4]; 3]>;

        #[inline(always)]
        fn run<V: Wide>(self) -> Self::Output {
            let mut found = Vec::new();
            for start in 0..self.0.len() {
                let mut four = [0.0; 4];
                for (lane, value) in four.iter_mut().enumerate() {
                    *value = self.0[(start + lane) % self.0.len()];
                }
                let x = V::load(&four);
                found.push([ln(x).array(), exp(x).array(), power(x, 0.31).array()]);
            }
            found
        }
    }

    fn numbers() -> Vec<f64> {
        let mut list: Vec<f64> = (0..4000).map(|k| 1e-12 * 1.0123f64.powi(k)).collect();
        list.extend((0..4000).map(|k| 0.5 + f64::from(k) * 5e-4));
        list.extend([1.0, 1.0 + f64::EPSILON, 1.0 - f64::EPSILON, 2f64.sqrt(), f64::MIN_POSITIVE]);
        list.retain(|x| *x < 700.0);
        list
    }

    fn check(found: &[[[f64; 4]; 3]], list: &[f64]) {
        for (start, values) in found.iter().enumerate() {
            let x = list[start];
            let exact = [x.ln(), x.exp(), x.powf(0.31)];
            // A logarithm, an exponential, and an exponential of up to 30 units of the logarithm.
            let bounds = [1e-15, 1e-15, 1e-15 + 2e-16 * (0.31 * x.ln()).abs()];
            for ((values, exact), bound) in values.iter().zip(exact).zip(bounds) {
                let error = (values[0] - exact).abs();
                assert!(error <= bound * exact.abs(), "{x:e}: {} for {exact}", values[0]);
            }
            for lane in 1..4 {
                let other = found[(start + lane) % list.len()];
                for quantity in 0..3 {
                    let [here, alone] = [values[quantity][lane], other[quantity][0]];
                    assert_eq!(here.to_bits(), alone.to_bits(), "lane {lane} of {x:e}");
                }
            }
        }
    }

    #[test]
    fn values_are_those_of_the_standard_library_in_every_lane() {
        let list = numbers();
        check(&dispatch(Everywhere(list.clone())), &list);
        check(&Everywhere(list.clone()).run::<Plain>(), &list);
    }

    #[test]
    fn the_series_of_a_power_is_as_good_as_the_power() {
        for n in [0.0, 0.31, 0.37, 1.0, 1.7, 2.0] {
            let growth = Growth::new(n);
            for k in 0..1000 {
                let u = f64::from(k) / 16_000.0;
                let [factor, holds] = growth.factor(Plain::splat(u)).map(|v| v.array()[0]);
                let exact = (1.0 + u).powf(n);
                assert_eq!(holds, 1.0);
                assert!((factor / exact - 1.0).abs() < 5e-16, "{n} {u}: {factor} for {exact}");
            }
            for u in [1.0 / 16.0, 0.5, f64::INFINITY, f64::NAN] {
                assert_eq!(growth.factor(Plain::splat(u))[1].array()[0], 0.0);
            }
        }
        assert_eq!(Growth::new(2.5).factor(Plain::splat(0.0))[1].array()[0], 0.0);
    }

    #[test]
    fn special_points() {
        let of = |x: f64| Plain::splat(x);
        assert_eq!(exp(of(0.0)).array()[0], 1.0);
        assert_eq!(ln(of(1.0)).array()[0], 0.0);
        assert_eq!(power(of(0.0), 0.31).array()[0], 0.0);
        assert_eq!(power(of(0.0), 0.0).array()[0], 1.0);
        assert_eq!(power(of(7.0), 0.0).array()[0], 1.0);
        assert_eq!(power(of(1.0), 1.09).array()[0], 1.0);
        assert!(exp(of(-1e9)).array()[0] < 1e-300);
        assert!(exp(of(1e9)).array()[0].is_finite());
        let exact = (-30.0f64).exp();
        assert!((exp(of(-30.0)).array()[0] - exact).abs() < 1e-15 * exact);
    }
}
