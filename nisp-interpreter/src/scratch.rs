//! Memory for a tile's intermediate numbers: what one kernel gives back, the next on the same thread takes again.

use std::cell::RefCell;

use nisp_runtime::aligned::AlignedVec;
use nisp_runtime::real::Real;

thread_local! {
    static SPARE: RefCell<Vec<AlignedVec<f64>>> = const { RefCell::new(Vec::new()) };
}

/// Zeros at first, and whatever was written there when it is taken again.
pub(crate) struct Scratch(Option<AlignedVec<f64>>);

impl Scratch {
    /// Memory for so many numbers of a type.
    pub(crate) fn of<E: Real>(count: usize) -> Self {
        let wanted = (count * size_of::<E>()).div_ceil(size_of::<f64>());
        // Spare memory that is too small is let go, so that what is left soon is large enough for all.
        let spare = SPARE.with_borrow_mut(Vec::pop).filter(|spare| spare.len() >= wanted);
        Self(Some(spare.unwrap_or_else(|| AlignedVec::zeros(wanted))))
    }

    /// Where it starts.
    pub(crate) fn start<E: Real>(&mut self) -> *mut E {
        self.0.as_mut().map_or(std::ptr::null_mut(), |memory| memory.as_mut_ptr().cast())
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if let Some(memory) = self.0.take() {
            // A thread that ends has no more use for it.
            let _ = SPARE.try_with(|spare| spare.borrow_mut().push(memory));
        }
    }
}
