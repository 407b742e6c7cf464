//! Memory that one factorisation leaves to the next: asking the system for it anew can take longer than filling it.

use std::sync::{Mutex, PoisonError};

use crate::aligned::AlignedVec;

/// Buffers that nobody uses at present.
#[derive(Default)]
pub(super) struct Spare(Mutex<Vec<AlignedVec<f64>>>);

/// A buffer is taken if it has at most this many times the memory that is asked for.
const ROOM: usize = 4;

impl Spare {
    /// A buffer of at least so many numbers, whichever they are; nothing where memory is too small.
    pub(super) fn any(&self, len: usize) -> Option<AlignedVec<f64>> {
        self.taken(len).or_else(|| AlignedVec::try_zeros(len))
    }

    /// A buffer that begins with so many zeros; nothing where memory is too small.
    pub(super) fn zeros(&self, len: usize) -> Option<AlignedVec<f64>> {
        let mut buffer = self.any(len)?;
        // Fresh memory, too: pages that are read before they are written are mapped twice.
        buffer[..len].fill(0.0);
        Some(buffer)
    }

    /// The smallest of the buffers that have the room. Where none has, the largest of those that nearly have goes back to the system: a
    /// larger one takes its place.
    fn taken(&self, len: usize) -> Option<AlignedVec<f64>> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fits = |at: &usize| (len..=ROOM * len).contains(&all[*at].len());
        if let Some(at) = (0..all.len()).filter(fits).min_by_key(|&at| all[at].len()) {
            return Some(all.swap_remove(at));
        }
        let near = |at: &usize| (len / ROOM..len).contains(&all[*at].len());
        if let Some(at) = (0..all.len()).filter(near).max_by_key(|&at| all[at].len()) {
            all.swap_remove(at);
        }
        None
    }

    /// Leaves a buffer to others.
    pub(super) fn give_back(&self, buffer: AlignedVec<f64>) {
        if !buffer.is_empty() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(buffer);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_that_fits_is_taken_again() {
        let spare = Spare::default();
        let mut first = spare.zeros(100).unwrap();
        first.fill(1.0);
        let place = first.as_ptr();
        spare.give_back(first);
        let other = spare.zeros(10).unwrap();
        assert_ne!(other.as_ptr(), place);
        let again = spare.any(50).unwrap();
        assert_eq!((again.as_ptr(), again[..50].to_vec()), (place, vec![1.0; 50]));
        spare.give_back(again);
        let again = spare.zeros(50).unwrap();
        assert_eq!((again.as_ptr(), again[..50].to_vec()), (place, vec![0.0; 50]));
        assert!(spare.0.lock().unwrap().is_empty());
        // What is too small is no longer kept beside what takes its place.
        spare.give_back(again);
        assert_eq!(spare.zeros(150).unwrap().to_vec(), vec![0.0; 150]);
        assert!(spare.0.lock().unwrap().is_empty());
    }
}
