//! Sums without rounding: one result for every order of the terms, and so for every number of
//! threads and processes, and after a restart.

/// Whole numbers of 2^(32 k - 1074), k from 0: every finite f64 is a sum of three of them.
const LIMBS: usize = 68;

/// Additions after which limbs must be carried: each adds less than 2^32 to a limb.
const ROOM: u32 = 1 << 30;

/// 2^32.
const BASE: i64 = 1 << 32;

/// A sum of any number of f64, kept exactly and rounded once, when it is read.
///
/// # Source  Kulisch, Computer Arithmetic and Validity, 2008, ch. 8 (long accumulator)
#[derive(Clone, Debug, PartialEq)]
pub struct ExactSum {
    limbs: [i64; LIMBS],
    /// Terms that are NaN, infinite, minus infinite.
    special: [i64; 3],
    /// Additions since the last carry.
    additions: u32,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self { limbs: [0; LIMBS], special: [0; 3], additions: 0 }
    }
}

impl ExactSum {
    /// Words that hold a sum, for other processes: see [`ExactSum::words`].
    pub const WORDS: usize = LIMBS + 3;

    /// The sum of some terms.
    pub fn of(terms: impl IntoIterator<Item = f64>) -> Self {
        let mut sum = Self::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }

    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        if term == 0.0 {
            return;
        }
        let bits = term.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as usize;
        if exponent == 0x7ff {
            let kind = if term.is_nan() { 0 } else { 1 + usize::from(term < 0.0) };
            self.special[kind] += 1;
            return;
        }
        // A subnormal number has the exponent of the smallest normal one and no leading 1.
        let leading = u64::from(exponent != 0) << 52;
        let digits = bits & ((1 << 52) - 1) | leading;
        let place = exponent.max(1) - 1;
        let shifted = u128::from(digits) << (place % 32);
        let sign = if term < 0.0 { -1 } else { 1 };
        for (limb, part) in self.limbs[place / 32..].iter_mut().zip(0..3) {
            *limb += sign * (shifted >> (32 * part) & 0xffff_ffff) as i64;
        }
        self.additions += 1;
        if self.additions == ROOM {
            self.carry();
        }
    }

    /// Forgets all terms.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds the terms of another sum.
    pub fn merge(&mut self, other: &Self) {
        // What is left after a carry counts as one addition.
        if self.additions + other.additions + 1 >= ROOM {
            *self = Self::from_words(&self.words());
            return self.merge(&Self::from_words(&other.words()));
        }
        for (limb, more) in self.limbs.iter_mut().zip(&other.limbs) {
            *limb += more;
        }
        for (count, more) in self.special.iter_mut().zip(&other.special) {
            *count += more;
        }
        self.additions += other.additions + 1;
    }

    /// The sum as whole numbers: sums of processes add word by word.
    pub fn words(&self) -> [i64; Self::WORDS] {
        let mut carried = self.clone();
        carried.carry();
        let mut words = [0; Self::WORDS];
        words[..LIMBS].copy_from_slice(&carried.limbs);
        words[LIMBS..].copy_from_slice(&carried.special);
        words
    }

    /// The sum of these words: one [`ExactSum::words`], or up to 2^30 of them added.
    pub fn from_words(words: &[i64; Self::WORDS]) -> Self {
        let mut sum = Self::default();
        sum.limbs.copy_from_slice(&words[..LIMBS]);
        sum.special.copy_from_slice(&words[LIMBS..]);
        sum.carry();
        sum
    }

    /// Brings all limbs but the last into 0..2^32.
    fn carry(&mut self) {
        let mut carried = 0;
        for limb in &mut self.limbs[..LIMBS - 1] {
            let whole = *limb + carried;
            *limb = whole.rem_euclid(BASE);
            carried = whole.div_euclid(BASE);
        }
        self.limbs[LIMBS - 1] += carried;
        self.additions = 0;
    }

    /// The sum, rounded once to the nearest f64, ties to even.
    pub fn value(&self) -> f64 {
        match self.special {
            [0, 0, 0] => {}
            [0, _, 0] => return f64::INFINITY,
            [0, 0, _] => return f64::NEG_INFINITY,
            _ => return f64::NAN,
        }
        if self.limbs == [0; LIMBS] {
            return 0.0;
        }
        let mut sum = self.clone();
        sum.carry();
        let negative = sum.limbs[LIMBS - 1] < 0;
        if negative {
            sum.limbs.iter_mut().for_each(|limb| *limb = -*limb);
            sum.carry();
        }
        let Some(top) = sum.limbs.iter().rposition(|limb| *limb != 0) else { return 0.0 };
        // Four limbs hold at least 97 digits; whether any follow decides ties.
        let low = top.saturating_sub(3);
        let digits = sum.limbs[low..=top]
            .iter()
            .rev()
            .fold(0u128, |digits, limb| digits << 32 | *limb as u128);
        let rest = sum.limbs[..low].iter().any(|limb| *limb != 0);
        let size = libm::ldexp((digits | u128::from(rest)) as f64, 32 * low as i32 - 1074);
        if negative { -size } else { size }
    }
}

/// Three exact sums: of vectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VectorSum(pub [ExactSum; 3]);

impl VectorSum {
    /// Adds a vector.
    #[inline]
    pub fn add(&mut self, vector: [f64; 3]) {
        for (sum, term) in self.0.iter_mut().zip(vector) {
            sum.add(term);
        }
    }

    /// Forgets all terms.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_cancels_leaves_nothing_and_nothing_is_lost() {
        let terms = [1e300, 1.0, -1e300, 1e-300, 5e-324, -1.0];
        assert_eq!(ExactSum::of(terms).value(), 1e-300 + 5e-324);
        assert_eq!(ExactSum::of([0.1; 10]).value(), 1.0);
        assert_eq!(ExactSum::of([-0.0, 0.0]).value(), 0.0);
        assert_eq!(ExactSum::of([f64::MAX, f64::MAX]).value(), f64::INFINITY);
        assert_eq!(ExactSum::of([f64::MAX, f64::MAX, -f64::MAX]).value(), f64::MAX);
        assert_eq!(ExactSum::of([-5e-324; 3]).value(), -1.5e-323);
    }

    #[test]
    fn ties_go_to_the_even_neighbour_unless_something_follows() {
        let half = 2f64.powi(-53);
        assert_eq!(ExactSum::of([1.0, half]).value(), 1.0);
        assert_eq!(ExactSum::of([1.0, half, 1e-300]).value(), 1.0 + 2.0 * half);
        assert_eq!(ExactSum::of([-1.0, -half, -1e-300]).value(), -1.0 - 2.0 * half);
    }

    #[test]
    fn terms_that_are_no_numbers_stay_visible() {
        assert!(ExactSum::of([1.0, f64::NAN]).value().is_nan());
        assert!(ExactSum::of([f64::INFINITY, f64::NEG_INFINITY]).value().is_nan());
        assert_eq!(ExactSum::of([f64::NEG_INFINITY, 1.0]).value(), f64::NEG_INFINITY);
    }

    proptest! {
        #[test]
        fn the_order_and_the_parts_do_not_matter(terms: Vec<f64>, cut: usize) {
            let whole = ExactSum::of(terms.iter().copied()).value();
            let backwards = ExactSum::of(terms.iter().rev().copied()).value();
            let (first, second) = terms.split_at(cut % (terms.len() + 1));
            let mut parts = ExactSum::of(first.iter().copied());
            parts.merge(&ExactSum::of(second.iter().copied()));
            prop_assert_eq!(whole.to_bits(), backwards.to_bits());
            prop_assert_eq!(whole.to_bits(), parts.value().to_bits());
        }

        #[test]
        fn two_terms_are_added_as_the_processor_adds_them(a: f64, b: f64) {
            let sum = ExactSum::of([a, b]).value();
            prop_assert!(sum == a + b || (sum.is_nan() && (a + b).is_nan()));
        }
    }
}
