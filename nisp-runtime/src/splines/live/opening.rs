//! The first rows of a record: they are all there when the first answer is given, and are answered as a whole record's are.
//!
//! A whole record's answer counts with sources that set in with the record, or are rougher in one part of it than in another. A
//! window knows neither: its priors are alike all along.

use super::super::heads::Heads;
use super::super::kept::KeptSplines;
use crate::facts::Score;
use crate::noise;
use crate::problem::Bound;
use crate::solve::driver::{Flow, Limits, Status};

/// What the first rows say as a whole, and up to where that is the answer.
pub(super) struct Opening {
    kept: KeptSplines,
    until: f64,
    /// By group and term: how far rows are off, and the noise.
    misfits: Vec<Vec<(Vec<f64>, Option<f64>)>>,
}

/// What the first rows say of given numbers.
#[derive(Default)]
pub(super) struct Doubt {
    pub(super) scores: Vec<Score>,
    /// Whether a window may say it of further rows: it takes each row's noise for its own.
    pub(super) goes_on: bool,
}

impl Opening {
    /// Of the first rows, and what they say of given numbers; no opening where they have no answer with deviations.
    pub(super) fn solve(bound: &Bound) -> (Option<Self>, Doubt) {
        let mut monitor = |_: super::super::Progress<'_>| Flow::Continue;
        let noise = noise::estimate(bound);
        let Ok(found) = super::super::solve(bound, &noise, &[], Limits::default(), None, &mut monitor) else {
            return (None, Doubt::default());
        };
        let is_told = found.status == Status::Converged && found.kept.deviations(0, &[]).is_some();
        let own = || Self { kept: found.kept, until: f64::INFINITY, misfits: found.misfits };
        let (scores, shared) = (found.answer.scores, found.answer.shared);
        let goes_on = !scores.is_empty() && shared.iter().flatten().all(Option::is_none);
        (is_told.then(own), Doubt { scores, goes_on })
    }

    /// As the answer up to a place.
    pub(super) fn until(self, until: f64) -> Self {
        Self { until, ..self }
    }

    /// Whether it is the answer at a place in the engine's units.
    pub(super) fn answers(&self, at: f64) -> bool {
        at <= self.until
    }

    /// A head at a place, and its standard deviation.
    pub(super) fn read(&self, head: usize, at: f64) -> (f64, f64) {
        let deviation = self.kept.deviations(head, &[at]).map_or(f64::NAN, |found| found[0]);
        (self.kept.evaluate(head, &[at])[0], deviation)
    }

    /// By group and term: how far rows are off, and the noise.
    pub(super) fn misfits(&self) -> &[Vec<(Vec<f64>, Option<f64>)>] {
        &self.misfits
    }

    /// The splines, and their coefficients.
    pub(super) fn splines(&self) -> (&Heads, &[f64]) {
        (&self.kept.heads, &self.kept.theta)
    }
}
