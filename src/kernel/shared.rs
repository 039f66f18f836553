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
// `part` and `rows`; sending or sharing it moves nothing that `T: Send` does not allow.
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

    /// The rows of a stencil, to write.
    ///
    /// # Safety
    /// As for [`Shared::part`], for the nodes of the stencil.
    ///
    /// # Panics
    /// If a row lies beyond the memory.
    #[inline(always)]
    pub unsafe fn rows<const D: usize, const W: usize>(
        &self,
        base: usize,
        stride: [usize; 2],
    ) -> RowsMut<'a, T, D, W> {
        assert!(holds::<D, W>(self.len, base, stride));
        // SAFETY: `base` is in bounds.
        RowsMut { start: unsafe { self.start.add(base) }, stride, lent: PhantomData }
    }
}

/// Do `len` elements hold all rows that begin at `base`?
#[inline(always)]
fn holds<const D: usize, const W: usize>(len: usize, base: usize, stride: [usize; 2]) -> bool {
    // Strides are sizes of arrays: products with W do not overflow.
    let last = match D {
        1 => W,
        2 => (W - 1) * stride[0] + W,
        _ => (W - 1) * (stride[0] + stride[1]) + W,
    };
    base < len && last <= len - base
}

/// Distance of a row from the first one.
#[inline(always)]
fn offset<const D: usize, const W: usize>(i: usize, j: usize, stride: [usize; 2]) -> usize {
    assert!(i < if D == 3 { W } else { 1 } && j < if D == 1 { 1 } else { W });
    match D {
        1 => 0,
        2 => j * stride[0],
        _ => i * stride[0] + j * stride[1],
    }
}

/// The rows of `W` nodes that a stencil sees, to read: their bounds are checked once.
#[derive(Clone, Copy)]
pub struct Rows<'a, T, const D: usize, const W: usize> {
    start: *const T,
    stride: [usize; 2],
    lent: PhantomData<&'a [T]>,
}

impl<'a, T, const D: usize, const W: usize> Rows<'a, T, D, W> {
    /// The rows that begin at `base`, with strides along the outer axes.
    ///
    /// # Panics
    /// If a row lies beyond the slice.
    #[inline(always)]
    pub fn new(nodes: &'a [T], base: usize, stride: [usize; 2]) -> Self {
        assert!(holds::<D, W>(nodes.len(), base, stride));
        Self { start: nodes[base..].as_ptr(), stride, lent: PhantomData }
    }

    /// Row `j` of plane `i`.
    #[inline(always)]
    pub fn row(&self, i: usize, j: usize) -> &'a [T; W] {
        // SAFETY: `new` has checked the last row, the others lie before it.
        unsafe { &*self.start.add(offset::<D, W>(i, j, self.stride)).cast::<[T; W]>() }
    }
}

/// The rows of `W` nodes that a stencil sees, to write: their bounds are checked once.
pub struct RowsMut<'a, T, const D: usize, const W: usize> {
    start: *mut T,
    stride: [usize; 2],
    lent: PhantomData<&'a mut [T]>,
}

impl<T, const D: usize, const W: usize> RowsMut<'_, T, D, W> {
    /// Row `j` of plane `i`.
    #[inline(always)]
    pub fn row(&mut self, i: usize, j: usize) -> &mut [T; W] {
        // SAFETY: `Shared::rows` has checked the last row, the others lie before it, and its caller
        // promises that nobody else uses them.
        unsafe { &mut *self.start.add(offset::<D, W>(i, j, self.stride)).cast::<[T; W]>() }
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
        let (low, mut high) = unsafe { (shared.part(0..4), shared.rows::<1, 2>(4, [0; 2])) };
        low.fill(1);
        high.row(0, 0).fill(2);
        assert_eq!(numbers, [1, 1, 1, 1, 2, 2, 0, 0, 0, 0]);
    }

    #[test]
    fn rows_are_found_and_rows_past_the_end_are_refused() {
        // Three planes of 4 x 5 nodes.
        let numbers: Vec<usize> = (0..60).collect();
        let rows = Rows::<_, 3, 2>::new(&numbers, 33, [20, 5]);
        assert_eq!(
            [rows.row(0, 0), rows.row(0, 1), rows.row(1, 0), rows.row(1, 1)].map(|row| row[1]),
            [34, 39, 54, 59]
        );
        for base in [34, 60, usize::MAX] {
            let refused =
                std::panic::catch_unwind(|| Rows::<_, 3, 2>::new(&numbers, base, [20, 5]));
            assert!(refused.is_err(), "{base}");
        }
        assert!(
            std::panic::catch_unwind(|| Rows::<_, 3, 2>::new(&numbers, 0, [20, 5]).row(0, 2))
                .is_err()
        );
    }
}
