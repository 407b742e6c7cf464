//! The answer, in the user's units, with its error bars.

mod judged;
mod kept;
mod noisy;
mod strays;

use std::time::Instant;

use super::carried::{Carried, Solved, Values};
use super::choice::Attempt;
use super::{Checkpoint, Optimizer, Settings, Width, noisiness};
use crate::carrier::Estimate;
use crate::problem::Bound;
use crate::saved::Extent;
use crate::schema::{self, TermKind};
use crate::simd::Isa;
use crate::solve::driver::{Status, Warning};
use crate::units::Number;
use crate::verdict::{Check, Verdict};

/// A solved problem.
pub struct Solution {
    /// Why the run ended.
    pub status: Status,
    /// The loss at the answer.
    pub loss: f64,
    /// Steps taken.
    pub iterations: u64,
    /// Seconds, from the call to the answer.
    pub wall_s: f64,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// The method that was used.
    pub optimizer: Optimizer,
    precision: Width,
    /// How it was run.
    pub settings: Settings,
    /// Where the method stopped, for [`resume`](super::resume).
    pub checkpoint: Checkpoint,
    /// What is left of the equations, conditions and data.
    pub verdict: Verdict,
    /// What carries the heads: `network`, `splines` or `local functions`.
    pub carrier: &'static str,
    /// Why it was chosen.
    pub carrier_reason: String,
    /// Whether data are met to the digits that they are written with.
    is_met_exactly: bool,
    pub(super) bound: Bound,
    method: &'static str,
    pub(super) carried: Box<dyn Carried>,
}

/// A learned scalar.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedValue {
    /// Its name.
    pub name: &'static str,
    /// Its declared unit.
    pub unit: schema::Unit,
    /// Its value in the declared unit.
    pub value: f64,
    /// Its standard deviation, where the method gives it, made as those of [`Solution::evaluate_with_errors`].
    pub deviation: Option<f64>,
}

/// How well a term is met.
#[derive(Clone, Debug, PartialEq)]
pub struct TermReport {
    /// `group.term`
    pub name: String,
    /// The condition.
    pub equation: &'static str,
    /// Its unit.
    pub unit: schema::Unit,
    /// Root mean square of its rows, in its unit; NaN where it has none, as where nothing was measured.
    pub rms: f64,
    /// The natural size of its rows, in its unit.
    pub size: f64,
    /// For observations, the noise that the solver ended with, in its unit.
    pub noise: Option<f64>,
    /// True if its rows compare with data.
    pub observation: bool,
}

impl Solution {
    /// What a carrier found, judged, under the fingerprint of problem and settings.
    pub(super) fn new(
        bound: Bound,
        found: Solved,
        (settings, start): (&Settings, Instant),
        attempt: &Attempt,
        fingerprint: u64,
    ) -> Self {
        let solution = Self {
            status: found.status,
            loss: found.loss,
            iterations: found.iterations,
            wall_s: start.elapsed().as_secs_f64(),
            warnings: found.warnings,
            optimizer: found.optimizer,
            precision: found.precision,
            settings: settings.clone(),
            checkpoint: Checkpoint { fingerprint, state: noisiness::save(&bound, found.state) },
            verdict: Verdict::default(),
            carrier: attempt.carrier.name(),
            carrier_reason: attempt.why.clone(),
            is_met_exactly: false,
            bound,
            method: found.method,
            carried: found.carried,
        };
        solution.judged()
    }

    /// True where error bars say something: the answer passed all checks, the run ended at a minimum, whose neighbourhood they
    /// describe, and data are noisy.
    fn has_bars(&self) -> bool {
        self.is_sound() && self.status == Status::Converged && !self.is_met_exactly
    }

    /// True where the answer may be relied on: it met all checks.
    pub fn is_sound(&self) -> bool {
        self.verdict.passed()
    }

    /// True where another carrier would say no more: all that is wrong is in the data themselves, or that they do not tell a
    /// source from none.
    pub(super) fn is_clear(&self) -> bool {
        let is_of_data = |check: &Check| matches!(check.check, "told" | "noise" | "held" | "outliers" | "outside");
        self.verdict.failed().all(is_of_data)
    }

    /// By point, flat and in declared units, whether the answer holds there: at points that it was found from and between them.
    pub fn holds_at(&self, points: &[f64]) -> Vec<bool> {
        let extent = Extent::of(&self.bound.frame(), &self.bound.coordinates);
        points.chunks_exact(self.scene().coordinates.len()).map(|point| extent.contains(point)).collect()
    }

    /// The scene that was solved.
    pub fn scene(&self) -> &'static schema::Scene {
        self.bound.problem.scene().schema
    }

    /// Name of the method that was used.
    pub fn method(&self) -> &'static str {
        self.method
    }

    /// The element types that the run went through.
    pub fn precision(&self) -> &'static str {
        match self.precision {
            Width::Auto => "f32, then f64",
            one => one.name(),
        }
    }

    /// Every head at points given in declared units, point by point, without error bars.
    pub fn evaluate(&self, points: &[f64]) -> Vec<Estimate> {
        self.estimates(self.carried.values(&self.bound, &self.bound.inward(points)))
    }

    /// As [`Solution::evaluate`], with standard deviations: those of the Laplace approximation of the posterior, in which the
    /// prior's part is multiplied by 0.5 to 3.25, the more the less the data tell signal from noise, as simulated records
    /// over time ask for. Methods without a prior and a noise model have none, nor have answers to exact data, and
    /// runs that did not converge. Those of local
    /// functions take a source's patches as they were found: they say how well the source is known within them, not whether
    /// a patch may be elsewhere.
    pub fn evaluate_with_errors(&mut self, points: &[f64]) -> Vec<Estimate> {
        if !self.has_bars() {
            return self.evaluate(points);
        }
        let known = self.carried.with_deviations(&self.bound, &self.bound.inward(points));
        self.estimates(known)
    }

    /// Standard deviation of a weighted sum of a head's values, such as a net force, in the head's declared unit times that of
    /// the weights: errors of neighbours go together, so that it does not follow from theirs. `points` are in declared units,
    /// point by point, with a weight each. None where [`Solution::evaluate_with_errors`] gives none, and for carriers other
    /// than local functions.
    pub fn deviation_of_sum(&self, head: &str, points: &[f64], weights: &[f64]) -> Option<f64> {
        let at = self.scene().heads.iter().position(|own| own.name == head).filter(|_| self.has_bars())?;
        let outward = self.bound.system.outward(&self.scene().heads[at].unit);
        let deviation = self.carried.deviation_of_sum(at, &self.bound.inward(points), weights)?;
        Some(outward.of(Number::engine(deviation)).as_declared())
    }

    fn estimates(&self, known: Vec<Values>) -> Vec<Estimate> {
        let of = |(head, known): (&schema::Head, Values)| {
            let outward = self.bound.system.outward(&head.unit);
            let outward = |x| outward.of(Number::engine(x)).as_declared();
            let scaled = |values: Vec<f64>| values.into_iter().map(outward).collect();
            Estimate {
                name: head.name,
                unit: head.unit,
                source: head.source,
                values: scaled(known.values),
                deviations: known.deviations.map(scaled),
                by_prior: known.by_prior.map(scaled),
            }
        };
        self.scene().heads.iter().zip(known).map(of).collect()
    }

    /// Learned scalars.
    pub fn learned(&mut self) -> Vec<LearnedValue> {
        let found = self.carried.learned(&self.bound);
        let learned = self.bound.learned.iter().zip(found);
        learned
            .map(|(learned, (value, deviation))| {
                let scalar = &self.scene().scalars[learned.slot];
                let outward = |x| self.bound.system.outward(&scalar.unit).of(Number::engine(x)).as_declared();
                let deviation = deviation.filter(|_| self.has_bars()).map(outward);
                LearnedValue { name: scalar.name, unit: scalar.unit, value: outward(value), deviation }
            })
            .collect()
    }

    /// By how much learned scalars may be off together, in declared units and with signs: a row for each of as many independent
    /// directions as there are names, of one standard deviation. In the first, the first scalar is off by all of its deviation, and the
    /// rest follow it; the others are what is left then. What [`Problem::set_uncertain`](crate::problem::Problem::set_uncertain) takes.
    /// None for names that were not learned, where [`Solution::learned`] has no deviations, and for carriers other than local functions.
    pub fn learned_together(&self, names: &[&str]) -> Option<Vec<Vec<f64>>> {
        let slot = |name: &&str| {
            self.bound.learned.iter().position(|learned| self.scene().scalars[learned.slot].name == *name)
        };
        let slots: Vec<usize> = names.iter().map(slot).collect::<Option<_>>()?;
        let all = self.carried.together(&self.bound, &slots).filter(|_| self.has_bars())?;
        let outward = |(at, x): (usize, f64)| {
            let unit = &self.scene().scalars[self.bound.learned[slots[at]].slot].unit;
            self.bound.system.outward(unit).of(Number::engine(x)).as_declared()
        };
        Some(all.into_iter().map(|own| own.into_iter().enumerate().map(outward).collect()).collect())
    }

    /// How well every term is met.
    pub fn terms(&mut self) -> Vec<TermReport> {
        let mut reports = Vec::new();
        for (group, schema) in self.scene().groups.iter().enumerate() {
            for (at, term) in schema.terms.iter().enumerate() {
                let outward = |x| self.bound.system.outward(&term.unit).of(Number::engine(x)).as_declared();
                let observation = matches!(term.kind, TermKind::Observation | TermKind::Chamfer { .. });
                let (misfits, noise) = self.carried.misfits(group, at);
                let rms = (misfits.iter().map(|x| x * x).sum::<f64>() / misfits.len() as f64).sqrt();
                reports.push(TermReport {
                    name: format!("{}.{}", schema.name, term.name),
                    equation: term.equation,
                    unit: term.unit,
                    rms: outward(rms),
                    size: outward(self.bound.sizes[group][at]),
                    noise: noise.filter(|_| observation && !schema.is_beliefs()).map(outward),
                    observation,
                });
            }
        }
        reports
    }

    /// Channels, jets and points by group: for tables.
    pub fn groups(&self) -> impl Iterator<Item = (&'static schema::Group, usize)> {
        let inputs = self.scene().coordinates.len();
        self.scene().groups.iter().zip(&self.bound.coordinates).map(move |(g, points)| (g, points.len() / inputs))
    }

    /// Name of the instruction set in use.
    pub fn isa(&self) -> &'static str {
        Isa::detect().name()
    }
}
