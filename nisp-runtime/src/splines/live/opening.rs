//! The first rows of a record: they are all there when the first answer is given, and are answered as a whole record's are.
//!
//! A whole record's answer counts with sources that set in with the record, or are rougher in one part of it than in another. A
//! window knows neither: its priors are alike all along.

use super::super::SplineSolution;
use super::super::heads::Heads;
use super::super::kept::KeptSplines;
use crate::facts::{Answer, Score};
use crate::noise;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::solve::driver::{Flow, Limits, Status};
use crate::verdict::{Verdict, judge, jumps};

/// Checks of a whole record that rows behind the first ones cannot mend: what they are about holds all along.
const LASTING: [&str; 4] = ["determined", "filtered", "polled", "jolt"];
/// Checks that say nothing of the beginning of a record: a source may be at rest there.
const LATER: [&str; 1] = ["told"];

/// What to do where splines may be too coarse: a stream has no other carrier.
const BY_A_SOLVE: &str = "a solve of the whole record may take another one";

/// Steps at most, several times as many as most records take: later rows wait meanwhile.
const STEPS: u64 = 400;

/// What the first rows say as a whole, and up to where that is the answer.
pub(super) struct Opening {
    kept: KeptSplines,
    until: f64,
    /// By group and term: how far rows are off, and the noise.
    misfits: Vec<Vec<(Vec<f64>, Option<f64>)>>,
    /// What speaks against it, as against a whole record's answer.
    against: Option<String>,
}

/// What the first rows say of given numbers, and of the record as a whole.
#[derive(Default)]
pub(super) struct Doubt {
    pub(super) scores: Vec<Score>,
    /// What speaks against every answer.
    pub(super) lasting: Option<String>,
    /// Whether a window may say it of further rows: it takes each row's noise for its own.
    pub(super) goes_on: bool,
}

impl Opening {
    /// Of the first rows, and what they say of given numbers; no opening where they have no answer with deviations.
    pub(super) fn solve(bound: &Bound) -> (Option<Self>, Doubt) {
        let mut monitor = |_: super::super::Progress<'_>| Flow::Continue;
        let noise = noise::estimate(bound);
        let limits = Limits { iterations: STEPS, ..Limits::default() };
        let Ok(found) = super::super::solve(bound, &noise, &[], limits, None, &mut monitor) else {
            return (None, Doubt::default());
        };
        let is_told = found.status == Status::Converged && found.kept.deviations(0, &[]).is_some();
        let verdict = judged(bound, &found, &noise);
        let against = failed(&verdict, |check| !LATER.contains(&check));
        let lasting = failed(&verdict, |check| LASTING.contains(&check));
        let own = || Self { kept: found.kept, until: f64::INFINITY, misfits: found.misfits, against };
        let (scores, shared) = (found.answer.scores, found.answer.shared);
        let goes_on = !scores.is_empty() && shared.iter().flatten().all(Option::is_none);
        (is_told.then(own), Doubt { scores, lasting, goes_on })
    }

    /// What speaks against it.
    pub(super) fn against(&self) -> Option<&String> {
        self.against.as_ref()
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

/// The verdict on the first rows, as on a whole record.
fn judged(bound: &Bound, found: &SplineSolution, noise: &Noise) -> Verdict {
    let points = bound.coordinates.concat();
    let heads = 0..bound.problem.scene().schema.heads.len();
    let values: Vec<Vec<f64>> = heads.map(|head| found.kept.evaluate(head, &points)).collect();
    let mut verdict = judge(bound, &Answer { finer: BY_A_SOLVE, ..found.answer.clone() }, &values, noise);
    verdict.checks.extend(jumps::checks(bound, noise, &|head, places| found.kept.evaluate(head, places)));
    verdict
}

/// What the first failed check of some says.
fn failed(verdict: &Verdict, is_asked: impl Fn(&str) -> bool) -> Option<String> {
    verdict.failed().find(|check| is_asked(check.check)).map(|check| check.message.clone())
}
