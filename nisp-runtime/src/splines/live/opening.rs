//! The first rows of a record: they are all there when the first answer is given, and are answered as a whole record's are.
//!
//! A whole record's answer counts with sources that set in with the record, or are rougher in one part of it than in another. A
//! window knows neither: its priors are alike all along.

use super::super::heads::Heads;
use super::super::kept::KeptSplines;
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

impl Opening {
    /// Of the first rows; nothing where they have no answer with deviations.
    pub(super) fn solve(bound: &Bound) -> Option<Self> {
        let mut monitor = |_: super::super::Progress<'_>| Flow::Continue;
        let noise = noise::estimate(bound);
        let found = super::super::solve(bound, &noise, &[], Limits::default(), None, &mut monitor).ok()?;
        let is_told = found.status == Status::Converged && found.kept.deviations(0, &[]).is_some();
        is_told.then_some(Self { kept: found.kept, until: f64::INFINITY, misfits: found.misfits })
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
