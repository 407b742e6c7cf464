//! Memory that one factorisation leaves to the next: asking the system for it anew can take longer than filling it.

use std::sync::{Mutex, PoisonError};

/// Vectors that nobody uses at present.
#[derive(Default)]
pub(super) struct Spare(Mutex<Vec<Vec<f64>>>);

/// A vector is taken if it has at most this many times the memory that is asked for, and at least that part of it.
const ROOM: usize = 4;

impl Spare {
    /// So many zeros; nothing where memory is too small.
    pub(super) fn zeros(&self, len: usize) -> Option<Vec<f64>> {
        let mut zeros = self.taken(len).unwrap_or_default();
        zeros.clear();
        zeros.try_reserve_exact(len).ok()?;
        zeros.resize(len, 0.0);
        Some(zeros)
    }

    /// The smallest of the vectors that have the room, or else the largest of the others, which grows.
    fn taken(&self, len: usize) -> Option<Vec<f64>> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let near = (0..all.len()).filter(|&at| (len / ROOM..=ROOM * len).contains(&all[at].capacity()));
        let lacks = |at: usize| len.saturating_sub(all[at].capacity());
        let at = near.min_by_key(|&at| (lacks(at), all[at].capacity()))?;
        Some(all.swap_remove(at))
    }

    /// Leaves a vector to others.
    pub(super) fn give_back(&self, vector: Vec<f64>) {
        if vector.capacity() > 0 {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(vector);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_that_fits_is_taken_again_and_holds_zeros() {
        let spare = Spare::default();
        let mut first = spare.zeros(100).unwrap();
        first.fill(1.0);
        let place = first.as_ptr();
        spare.give_back(first);
        let other = spare.zeros(10).unwrap();
        assert_ne!(other.as_ptr(), place);
        let again = spare.zeros(50).unwrap();
        assert_eq!((again.as_ptr(), &again), (place, &vec![0.0; 50]));
        assert!(spare.0.lock().unwrap().is_empty());
        // What is too small grows, and is no longer kept beside what it has grown to.
        spare.give_back(again);
        assert_eq!(spare.zeros(150).unwrap(), vec![0.0; 150]);
        assert!(spare.0.lock().unwrap().is_empty());
    }
}
