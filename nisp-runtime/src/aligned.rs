//! Buffers whose first element starts a cache line.

use crate::real::Real;
use std::alloc::{Layout, alloc_zeroed, dealloc, handle_alloc_error};
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;

/// Alignment of every [`AlignedVec`] in bytes: a cache line, and the widest vector.
pub const ALIGNMENT: usize = 64;

/// A buffer of fixed length, aligned to [`ALIGNMENT`] bytes. A vector load at a multiple of the vector's length never
/// crosses a cache line.
pub struct AlignedVec<E> {
    start: NonNull<E>,
    len: usize,
}

// SAFETY: the buffer owns its elements, as a Vec does.
unsafe impl<E: Send> Send for AlignedVec<E> {}
// SAFETY: as above.
unsafe impl<E: Sync> Sync for AlignedVec<E> {}

impl<E: Real> AlignedVec<E> {
    /// A buffer of `len` zeros.
    pub fn zeros(len: usize) -> Self {
        Self::try_zeros(len).unwrap_or_else(|| handle_alloc_error(layout::<E>(len)))
    }

    /// The same; nothing where memory is too small.
    pub fn try_zeros(len: usize) -> Option<Self> {
        if len == 0 {
            return Some(Self { start: NonNull::dangling(), len });
        }
        // SAFETY: the layout has a size. All bits zero is the number zero in both element types.
        let start = unsafe { alloc_zeroed(layout::<E>(len)) };
        Some(Self { start: NonNull::new(start.cast::<E>())?, len })
    }
}

fn layout<E>(len: usize) -> Layout {
    let bytes = len.checked_mul(size_of::<E>()).expect("the size of a buffer fits the address space");
    Layout::from_size_align(bytes, ALIGNMENT).expect("the size of a buffer fits the address space")
}

impl<E> Drop for AlignedVec<E> {
    fn drop(&mut self) {
        if self.len > 0 {
            // SAFETY: allocated with this layout; the elements are plain numbers.
            unsafe { dealloc(self.start.as_ptr().cast(), layout::<E>(self.len)) };
        }
    }
}

impl<E> Deref for AlignedVec<E> {
    type Target = [E];
    #[inline(always)]
    fn deref(&self) -> &[E] {
        // SAFETY: `len` initialised elements live at `start` as long as the buffer.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<E> DerefMut for AlignedVec<E> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [E] {
        // SAFETY: as for `deref`, and borrowed exclusively.
        unsafe { std::slice::from_raw_parts_mut(self.start.as_ptr(), self.len) }
    }
}

impl<E: Real> From<&[E]> for AlignedVec<E> {
    fn from(elements: &[E]) -> Self {
        let mut copy = Self::zeros(elements.len());
        copy.copy_from_slice(elements);
        copy
    }
}

impl<E: Real> Clone for AlignedVec<E> {
    fn clone(&self) -> Self {
        Self::from(&**self)
    }
}

impl<E: Real> Default for AlignedVec<E> {
    fn default() -> Self {
        Self::zeros(0)
    }
}

impl<E: Real> std::fmt::Debug for AlignedVec<E> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_aligned_zeroed_and_cloned_by_value() {
        for len in [0, 1, 5, 64, 1000] {
            let mut buffer = AlignedVec::<f32>::zeros(len);
            assert_eq!(buffer.len(), len);
            assert!(buffer.iter().all(|&x| x == 0.0));
            if len > 0 {
                assert_eq!(buffer.as_ptr().addr() % ALIGNMENT, 0);
            }
            let copy = buffer.clone();
            buffer.fill(1.0);
            assert!(copy.iter().all(|&x| x == 0.0));
        }
    }
}
