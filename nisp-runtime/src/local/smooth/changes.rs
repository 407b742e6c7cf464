//! How far cells hold back an answer: lattices, each finer than the one before, tell.

/// What a finer lattice is taken to leave of a change where only one change is known.
const FALL: f64 = 0.5;
/// The least and the most that it is taken to leave: changes fall slowly at corners and in layers, and once by chance to nearly nothing.
const LEAST_FALL: f64 = 0.25;
const MOST_FALL: f64 = 0.8;

/// How much lattices changed an answer, from one to the next.
#[derive(Default)]
pub(super) struct Changes {
    /// Between lattices on which the steps came to their end.
    taken: Vec<f64>,
    /// The last one, whether the steps came to their end or not.
    last: Option<f64>,
    /// How far the parameters of learned scalars are off by the lattice that has the answer; nothing of the only one.
    learned: Vec<f64>,
}

impl Changes {
    /// Adds the change of the answer by a finer lattice, which has the answer from now on if its steps have come to their end.
    pub(super) fn add(&mut self, change: f64, is_taken: bool) {
        self.last = Some(change);
        self.taken.extend(is_taken.then_some(change));
    }

    /// How far a finer lattice moves the parameters of learned scalars: so far they are off if it does not have the answer, and by a share of it
    /// if it does.
    pub(super) fn move_learned(&mut self, moved: Vec<f64>, is_taken: bool) {
        let left = if is_taken { FALL } else { 1.0 };
        self.learned = moved.into_iter().map(|moved| left * moved).collect();
    }

    /// How far the parameters of learned scalars are off by the lattice that has the answer; nothing of the only one.
    pub(super) fn learned(&self) -> &[f64] {
        &self.learned
    }

    /// The last change; infinite where there is none.
    pub(super) fn last(&self) -> f64 {
        self.last.unwrap_or(f64::INFINITY)
    }

    /// The least change by a finer lattice that is known of the answer: steps that did not come to their end may have agreed with it, and
    /// say nothing where they did not. Infinite where there is none.
    pub(super) fn least(&self) -> f64 {
        self.taken().unwrap_or(f64::INFINITY).min(self.last())
    }

    /// The change by the lattice that has the answer; nothing if it is the first.
    pub(super) fn taken(&self) -> Option<f64> {
        self.taken.last().copied()
    }

    /// How far the answer is off: the sum of all changes that lattices yet finer would make, each a share of the one before. Of an
    /// answer of the first lattice what the next one has begun to change; infinite where there was no next one.
    pub(super) fn off(&self) -> f64 {
        let Some(taken) = self.taken() else { return self.last() };
        let before = self.taken.iter().rev().nth(1);
        let fall = before.map_or(FALL, |before| (taken / before).clamp(LEAST_FALL, MOST_FALL));
        taken * fall / (1.0 - fall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum whose terms fall to three quarters: what is left of it is three times the last term.
    #[test]
    fn changes_that_fall_by_a_share_say_what_is_left() {
        let mut changes = Changes::default();
        assert!(changes.off().is_infinite());
        changes.add(0.4, true);
        assert!((changes.off() - 0.4).abs() < 1e-12);
        changes.add(0.3, true);
        assert!((changes.off() - 0.9).abs() < 1e-12);
        // Steps that did not come to their end say nothing of the answer that stands.
        changes.add(5.0, false);
        assert!((changes.off() - 0.9).abs() < 1e-12 && changes.taken() == Some(0.3) && changes.least() == 0.3);
    }

    /// Changes that do not fall leave much.
    #[test]
    fn changes_that_stay_say_that_the_answer_is_far_off() {
        let mut changes = Changes::default();
        changes.add(0.01, true);
        changes.add(0.02, true);
        assert!((changes.off() - 0.08).abs() < 1e-12);
    }
}
