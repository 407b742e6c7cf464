//! An answer beside one that another carrier has found before it.

use super::Solution;
use crate::solve::driver::Status;
use crate::solve::vector::farthest;
use crate::verdict::agreed;

impl Solution {
    /// Judged by another answer, too, where nothing is measured: if that one holds the equations firmly, and has failed all the same,
    /// small errors may grow along the equations, and what is left of them says little. It may be off by what finer cells would change.
    pub(super) fn compared(mut self, other: Option<&Self>) -> Self {
        let is_measured = !self.scene().observed().is_empty();
        let Some(other) = other.filter(|other| !is_measured && other.verdict.is_firm()) else { return self };
        let off = other.verdict.checks.iter().find(|check| check.check == "refined").map_or(0.0, |check| check.value);
        let answer = self.carried.answer(&self.bound);
        let [ours, theirs] = [&self, other].map(|found| self.where_read(&found.values_over_domain(), &answer));
        let natural = |head: usize| self.bound.head_scale(head);
        let apart = |head: usize| farthest(&ours[head], &theirs[head], natural(head));
        let apart = (0..ours.len()).map(apart).fold(0.0, f64::max);
        self.verdict.checks.push(agreed(apart, off));
        if self.status == Status::Converged && !self.is_sound() {
            self.status = Status::Inconsistent;
        }
        self
    }
}
