//! Memory that several tiles write at once, each its own part.

use std::marker::PhantomData;
use std::ops::Range;

/// A slice lent to all tiles of one colour.
///
/// The borrow checker cannot see that tiles are disjoint; the two functions below are therefore
/// unsafe, and their callers carry the argument. Bounds are always checked. Copies are handles to
/// the same memory.
#[derive(Debug)]
pub struct Shared<'a, T> {
    start: *mut T,
    len: usize,
    lent: PhantomData<&'a mut [T]>,
}

// SAFETY: a `Shared` is an exclusive borrow whose parts are handed out under the contract of
// `part` and `row`; sending or sharing it moves nothing that `T: Send` does not allow.
unsafe impl<T: Send> Send for Shared<'_, T> {}
unsafe impl<T: Send> Sync for Shared<'_, T> {}

impl<T> Clone for Shared<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Shared<'_, T> {}

impl<'a, T> Shared<'a, T> {
    /// Lends a slice.
    pub fn new(slice: &'a mut [T]) -> Self {
        Self { start: slice.as_mut_ptr(), len: slice.len(), lent: PhantomData }
    }

    /// Number of elements lent.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Is nothing lent?
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// A part to write.
    ///
    /// # Safety
    /// While the part is in use nobody else may use any of its elements.
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the caller promises that parts in use are disjoint")]
    pub unsafe fn part(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: in bounds; exclusive by the contract of this function.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }

    /// `W` consecutive elements to write.
    ///
    /// # Safety
    /// As for [`Shared::part`].
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the caller promises that parts in use are disjoint")]
    pub unsafe fn row<const W: usize>(&self, first: usize) -> &mut [T; W] {
        assert!(first < self.len && W <= self.len - first);
        // SAFETY: in bounds; exclusive by the contract of this function.
        unsafe { &mut *self.start.add(first).cast::<[T; W]>() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disjoint_parts_are_written_side_by_side() {
        let mut numbers = vec![0; 10];
        let shared = Shared::new(&mut numbers);
        // SAFETY: 0..4 and 4..6 do not overlap.
        let (low, high) = unsafe { (shared.part(0..4), shared.row::<2>(4)) };
        low.fill(1);
        high.fill(2);
        assert_eq!(numbers, [1, 1, 1, 1, 2, 2, 0, 0, 0, 0]);
    }

    #[test]
    #[should_panic(expected = "W <= self.len - first")]
    fn a_row_past_the_end_is_refused() {
        let mut numbers = vec![0; 3];
        // SAFETY: never reached.
        unsafe { Shared::new(&mut numbers).row::<2>(2) };
    }
}
