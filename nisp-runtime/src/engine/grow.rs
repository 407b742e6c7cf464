//! Equations whose sizes follow learned scalars (see `problem/powers.rs`): the sizes, and what they add to derivatives.

use super::group::BoundTerm;
use super::{Engine, Learned};
use crate::kernel::Precision;

impl<E: Precision> BoundTerm<E> {
    /// Takes over learned scalars' parameters.
    pub(super) fn grow(&mut self, learned: &[Learned], theta: &[E]) {
        let Self { powers, grown, growth, .. } = self;
        growth.resize(powers.len(), 0.0);
        *grown = 1.0;
        for (at, power) in powers.iter().enumerate() {
            let (factor, slope) = learned[at].map.grown(theta[at].to_f64(), *power);
            *grown *= factor;
            growth[at] = slope;
        }
    }

    /// Adds to the derivatives of a row by the learned scalars, `amount` times, that its size grows with them.
    pub(super) fn shrink(&self, amount: f64, by_learned: &mut [E]) {
        for (by, growth) in by_learned.iter_mut().zip(&self.growth) {
            *by -= E::from_f64(amount * growth);
        }
    }
}

impl<E: Precision> Engine<E> {
    /// The same of the whole loss, whose shares are known: half the squares of rows that all shrink.
    pub(super) fn shrink_shares(&mut self) {
        let by_learned = &mut self.chunks[0].gradient[self.layout.learned_at..];
        for (term, share) in self.groups.iter().flat_map(|group| &group.terms).zip(&self.shares) {
            term.shrink(2.0 * share, by_learned);
        }
    }
}
