//! Four numbers at once, on whatever the processor offers.
//!
//! Kernels are generic over [`Wide`]; [`dispatch`] picks the back end once per call. On x86-64
//! with AVX2 and FMA and on 64-bit ARM, [`Wide::mul_add`] rounds once; elsewhere it rounds twice:
//! one numeric path per processor family, the same bits for any number of threads.

use std::ops::{Add, Div, Mul, Sub};

/// Four `f64` handled together.
pub trait Wide:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The same number four times.
    fn splat(value: f64) -> Self;
    /// Four numbers from memory.
    fn load(from: &[f64; 4]) -> Self;
    /// Four numbers to memory.
    fn store(self, to: &mut [f64; 4]);
    /// Square roots.
    fn sqrt(self) -> Self;
    /// self * factor + summand.
    fn mul_add(self, factor: Self, summand: Self) -> Self;
    /// The larger of self and other, lane by lane.
    fn larger(self, other: Self) -> Self;
    /// The smaller of self and other, lane by lane.
    fn smaller(self, other: Self) -> Self;
    /// Largest whole numbers not above self.
    fn floor(self) -> Self;
    /// Absolute values.
    fn absolute(self) -> Self;
    /// The first three lanes of self, the last one of `other`.
    fn with_last(self, other: Self) -> Self;
    /// Lane by lane: `then` where self < bound, `otherwise` elsewhere.
    fn below(self, bound: Self, then: Self, otherwise: Self) -> Self;
    /// Lane `k` of each of the four in place of the k-th.
    fn transpose(rows: [Self; 4]) -> [Self; 4];
    /// Are all four positive finite numbers?
    fn all_positive(self) -> bool;
    /// Do the first three lanes all lie in lower..=upper? False if one is not a number.
    fn inside(self, lower: Self, upper: Self) -> bool;
    /// Is self < bound in any lane?
    fn any_below(self, bound: Self) -> bool;
    /// m and e with self = m 2^e, 1 <= m < 2, for positive normal numbers.
    fn split(self) -> [Self; 2];
    /// 2^self for whole numbers from -1022 to 1023.
    fn power_of_two(self) -> Self;
    /// The four numbers.
    #[inline(always)]
    fn array(self) -> [f64; 4] {
        let mut array = [0.0; 4];
        self.store(&mut array);
        array
    }
}

/// Each number four times. (Loops, no closures: what the standard library maps or folds over wide
/// numbers is compiled without the features of the processor and called for every element.)
#[inline(always)]
pub fn splats<V: Wide, const N: usize>(values: [f64; N]) -> [V; N] {
    let mut wide = [V::splat(0.0); N];
    for n in 0..N {
        wide[n] = V::splat(values[n]);
    }
    wide
}

/// Work that is compiled once for each back end.
pub trait Sweep {
    /// What the work gives back.
    type Output;
    /// Does the work; implementations are `#[inline(always)]`.
    fn run<V: Wide>(self) -> Self::Output;
}

/// Does the work with the widest back end of this processor.
#[inline]
pub fn dispatch<S: Sweep>(sweep: S) -> S::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has just been found to have both features.
        return unsafe { avx2::run(sweep) };
    }
    #[cfg(target_arch = "aarch64")]
    return sweep.run::<neon::Neon>();
    #[cfg(not(target_arch = "aarch64"))]
    sweep.run::<Plain>()
}

/// Bits of the mantissa of an `f64`.
const MANTISSA: u64 = (1 << 52) - 1;

/// Bits of 1.0.
const ONE: u64 = 1023 << 52;

/// 2^52: the last bits of 2^52 + k are those of the whole number k.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// 2^52 and the offset of exponents.
const SHIFTER: f64 = WHOLE + 1023.0;

/// The four operators of a type, each from its expression.
macro_rules! operators {
    ($wide:ty, $a:ident, $b:ident, $add:expr, $sub:expr, $mul:expr, $div:expr) => {
        operators!(@ $wide, Add, add, $a, $b, $add);
        operators!(@ $wide, Sub, sub, $a, $b, $sub);
        operators!(@ $wide, Mul, mul, $a, $b, $mul);
        operators!(@ $wide, Div, div, $a, $b, $div);
    };
    (@ $wide:ty, $operator:ident, $method:ident, $a:ident, $b:ident, $value:expr) => {
        impl std::ops::$operator for $wide {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self, other);
                $value
            }
        }
    };
}

/// Four numbers in an array: any processor.
#[derive(Clone, Copy, Debug)]
pub struct Plain([f64; 4]);

impl Plain {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }
}

operators!(
    Plain,
    a,
    b,
    a.zip(b, |a, b| a + b),
    a.zip(b, |a, b| a - b),
    a.zip(b, |a, b| a * b),
    a.zip(b, |a, b| a / b)
);

impl Wide for Plain {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }
    #[inline(always)]
    fn load(from: &[f64; 4]) -> Self {
        Self(*from)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        *to = self.0;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.map(f64::floor))
    }
    #[inline(always)]
    fn absolute(self) -> Self {
        Self(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn with_last(self, other: Self) -> Self {
        Self([self.0[0], self.0[1], self.0[2], other.0[3]])
    }
    #[inline(always)]
    fn below(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let pick = |lane| match self.0[lane] < bound.0[lane] {
            true => then.0[lane],
            false => otherwise.0[lane],
        };
        Self(std::array::from_fn(pick))
    }
    #[inline(always)]
    fn transpose(rows: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|k| Self(rows.map(|row| row.0[k])))
    }
    #[inline(always)]
    fn all_positive(self) -> bool {
        self.0.iter().all(|value| *value > 0.0 && *value < f64::INFINITY)
    }
    #[inline(always)]
    fn inside(self, lower: Self, upper: Self) -> bool {
        (0..3).all(|lane| self.0[lane] >= lower.0[lane] && self.0[lane] <= upper.0[lane])
    }
    #[inline(always)]
    fn any_below(self, bound: Self) -> bool {
        (0..4).any(|lane| self.0[lane] < bound.0[lane])
    }
    #[inline(always)]
    fn split(self) -> [Self; 2] {
        let bits = self.0.map(f64::to_bits);
        [
            Self(bits.map(|bits| f64::from_bits(bits & MANTISSA | ONE))),
            Self(bits.map(|bits| (bits >> 52) as f64 - 1023.0)),
        ]
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self(self.0.map(|exponent| f64::from_bits((exponent + SHIFTER).to_bits() << 52)))
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{MANTISSA, ONE, SHIFTER, Sweep, WHOLE, Wide};
    use std::arch::x86_64::*;

    /// Four numbers in one AVX register; made only inside [`run`].
    #[derive(Clone, Copy)]
    pub struct Avx2(__m256d);

    /// Runs a sweep compiled for AVX2 and FMA.
    ///
    /// # Safety
    /// The processor must have both features.
    #[target_feature(enable = "avx2,fma")]
    pub unsafe fn run<S: Sweep>(sweep: S) -> S::Output {
        sweep.run::<Avx2>()
    }

    operators!(
        Avx2,
        a,
        b,
        unsafe { Self(_mm256_add_pd(a.0, b.0)) },
        unsafe { Self(_mm256_sub_pd(a.0, b.0)) },
        unsafe { Self(_mm256_mul_pd(a.0, b.0)) },
        unsafe { Self(_mm256_div_pd(a.0, b.0)) }
    );

    // SAFETY of every block here: `Avx2` is named only by `run`, whose caller has checked the
    // processor; loads and stores are unaligned and go through references to four numbers.
    impl Wide for Avx2 {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            unsafe { Self(_mm256_set1_pd(value)) }
        }
        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            unsafe { Self(_mm256_loadu_pd(from.as_ptr())) }
        }
        #[inline(always)]
        fn store(self, to: &mut [f64; 4]) {
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            unsafe { Self(_mm256_sqrt_pd(self.0)) }
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, summand: Self) -> Self {
            unsafe { Self(_mm256_fmadd_pd(self.0, factor.0, summand.0)) }
        }
        #[inline(always)]
        fn larger(self, other: Self) -> Self {
            unsafe { Self(_mm256_max_pd(self.0, other.0)) }
        }
        #[inline(always)]
        fn smaller(self, other: Self) -> Self {
            unsafe { Self(_mm256_min_pd(self.0, other.0)) }
        }
        #[inline(always)]
        fn floor(self) -> Self {
            unsafe { Self(_mm256_floor_pd(self.0)) }
        }
        #[inline(always)]
        fn absolute(self) -> Self {
            unsafe { Self(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0)) }
        }
        #[inline(always)]
        fn with_last(self, other: Self) -> Self {
            unsafe { Self(_mm256_blend_pd::<0b1000>(self.0, other.0)) }
        }
        #[inline(always)]
        fn below(self, bound: Self, then: Self, otherwise: Self) -> Self {
            unsafe {
                let mask = _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, bound.0);
                Self(_mm256_blendv_pd(otherwise.0, then.0, mask))
            }
        }
        #[inline(always)]
        fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
            unsafe {
                let (even_ab, odd_ab) =
                    (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
                let (even_cd, odd_cd) =
                    (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(even_ab, even_cd)),
                    Self(_mm256_permute2f128_pd::<0x20>(odd_ab, odd_cd)),
                    Self(_mm256_permute2f128_pd::<0x31>(even_ab, even_cd)),
                    Self(_mm256_permute2f128_pd::<0x31>(odd_ab, odd_cd)),
                ]
            }
        }
        #[inline(always)]
        fn all_positive(self) -> bool {
            unsafe {
                let above = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, _mm256_setzero_pd());
                let below = _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(f64::INFINITY));
                _mm256_movemask_pd(_mm256_and_pd(above, below)) == 0b1111
            }
        }
        #[inline(always)]
        fn inside(self, lower: Self, upper: Self) -> bool {
            unsafe {
                let above = _mm256_cmp_pd::<_CMP_GE_OQ>(self.0, lower.0);
                let below = _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, upper.0);
                _mm256_movemask_pd(_mm256_and_pd(above, below)) & 0b111 == 0b111
            }
        }
        #[inline(always)]
        fn any_below(self, bound: Self) -> bool {
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, bound.0)) != 0 }
        }
        #[inline(always)]
        fn split(self) -> [Self; 2] {
            unsafe {
                let mantissa = _mm256_castsi256_pd(_mm256_set1_epi64x(MANTISSA as i64));
                let one = _mm256_castsi256_pd(_mm256_set1_epi64x(ONE as i64));
                let whole = _mm256_castpd_si256(_mm256_set1_pd(WHOLE));
                let exponent = _mm256_srli_epi64::<52>(_mm256_castpd_si256(self.0));
                let exponent = _mm256_castsi256_pd(_mm256_or_si256(exponent, whole));
                [
                    Self(_mm256_or_pd(_mm256_and_pd(self.0, mantissa), one)),
                    Self(_mm256_sub_pd(exponent, _mm256_set1_pd(SHIFTER))),
                ]
            }
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            unsafe {
                let shifted = _mm256_add_pd(self.0, _mm256_set1_pd(SHIFTER));
                let bits = _mm256_slli_epi64::<52>(_mm256_castpd_si256(shifted));
                Self(_mm256_castsi256_pd(bits))
            }
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod neon {
    use super::{MANTISSA, ONE, SHIFTER, Wide};
    use std::arch::aarch64::*;

    /// Four numbers in two NEON registers, which every 64-bit ARM processor has.
    #[derive(Clone, Copy)]
    pub struct Neon(float64x2_t, float64x2_t);

    operators!(
        Neon,
        a,
        b,
        unsafe { Self(vaddq_f64(a.0, b.0), vaddq_f64(a.1, b.1)) },
        unsafe { Self(vsubq_f64(a.0, b.0), vsubq_f64(a.1, b.1)) },
        unsafe { Self(vmulq_f64(a.0, b.0), vmulq_f64(a.1, b.1)) },
        unsafe { Self(vdivq_f64(a.0, b.0), vdivq_f64(a.1, b.1)) }
    );

    // SAFETY of every block here: NEON is part of the aarch64 target; loads and stores go
    // through references to four numbers.
    impl Wide for Neon {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            unsafe { Self(vdupq_n_f64(value), vdupq_n_f64(value)) }
        }
        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            unsafe { Self(vld1q_f64(from.as_ptr()), vld1q_f64(from.as_ptr().add(2))) }
        }
        #[inline(always)]
        fn store(self, to: &mut [f64; 4]) {
            unsafe {
                vst1q_f64(to.as_mut_ptr(), self.0);
                vst1q_f64(to.as_mut_ptr().add(2), self.1);
            }
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            unsafe { Self(vsqrtq_f64(self.0), vsqrtq_f64(self.1)) }
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, summand: Self) -> Self {
            unsafe {
                Self(vfmaq_f64(summand.0, self.0, factor.0), vfmaq_f64(summand.1, self.1, factor.1))
            }
        }
        #[inline(always)]
        fn larger(self, other: Self) -> Self {
            unsafe { Self(vmaxq_f64(self.0, other.0), vmaxq_f64(self.1, other.1)) }
        }
        #[inline(always)]
        fn smaller(self, other: Self) -> Self {
            unsafe { Self(vminq_f64(self.0, other.0), vminq_f64(self.1, other.1)) }
        }
        #[inline(always)]
        fn floor(self) -> Self {
            unsafe { Self(vrndmq_f64(self.0), vrndmq_f64(self.1)) }
        }
        #[inline(always)]
        fn absolute(self) -> Self {
            unsafe { Self(vabsq_f64(self.0), vabsq_f64(self.1)) }
        }
        #[inline(always)]
        fn with_last(self, other: Self) -> Self {
            unsafe { Self(self.0, vcopyq_laneq_f64::<1, 1>(self.1, other.1)) }
        }
        #[inline(always)]
        fn below(self, bound: Self, then: Self, otherwise: Self) -> Self {
            unsafe {
                Self(
                    vbslq_f64(vcltq_f64(self.0, bound.0), then.0, otherwise.0),
                    vbslq_f64(vcltq_f64(self.1, bound.1), then.1, otherwise.1),
                )
            }
        }
        #[inline(always)]
        fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
            unsafe {
                [
                    Self(vzip1q_f64(a.0, b.0), vzip1q_f64(c.0, d.0)),
                    Self(vzip2q_f64(a.0, b.0), vzip2q_f64(c.0, d.0)),
                    Self(vzip1q_f64(a.1, b.1), vzip1q_f64(c.1, d.1)),
                    Self(vzip2q_f64(a.1, b.1), vzip2q_f64(c.1, d.1)),
                ]
            }
        }
        #[inline(always)]
        fn all_positive(self) -> bool {
            self.array().iter().all(|value| *value > 0.0 && *value < f64::INFINITY)
        }
        #[inline(always)]
        fn inside(self, lower: Self, upper: Self) -> bool {
            let (x, low, high) = (self.array(), lower.array(), upper.array());
            (0..3).all(|lane| x[lane] >= low[lane] && x[lane] <= high[lane])
        }
        #[inline(always)]
        fn any_below(self, bound: Self) -> bool {
            let (x, bound) = (self.array(), bound.array());
            (0..4).any(|lane| x[lane] < bound[lane])
        }
        #[inline(always)]
        fn split(self) -> [Self; 2] {
            unsafe {
                let halves = [self.0, self.1].map(|half| vreinterpretq_u64_f64(half));
                let (mask, one) = (vdupq_n_u64(MANTISSA), vdupq_n_u64(ONE));
                let mantissa =
                    halves.map(|bits| vreinterpretq_f64_u64(vorrq_u64(vandq_u64(bits, mask), one)));
                let offset = vdupq_n_f64(1023.0);
                let exponent =
                    halves.map(|bits| vsubq_f64(vcvtq_f64_u64(vshrq_n_u64::<52>(bits)), offset));
                [Self(mantissa[0], mantissa[1]), Self(exponent[0], exponent[1])]
            }
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            unsafe {
                let shifter = vdupq_n_f64(SHIFTER);
                let [low, high] = [self.0, self.1].map(|half| {
                    let bits = vreinterpretq_u64_f64(vaddq_f64(half, shifter));
                    vreinterpretq_f64_u64(vshlq_n_u64::<52>(bits))
                });
                Self(low, high)
            }
        }
    }
}

#[cfg(test)]
mod tests;
