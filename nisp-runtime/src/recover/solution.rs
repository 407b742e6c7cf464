//! The answer, in the user's units, with its error bars.

use std::time::Instant;

use super::{Optimizer, Settings};
use crate::engine::Engine;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::curvature::Curvature;
use crate::solve::driver::{Outcome, Status, Warning};
use crate::solve::objective::LeastSquares;
use crate::solve::posterior::{Posterior, posterior};
use crate::solve::prior::WeightPrior;

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
    /// How it was run.
    pub settings: Settings,
    bound: Bound,
    engine: Engine<f64>,
    theta: Vec<f64>,
    prior: Option<WeightPrior>,
}

/// A head at some points.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the head.
    pub name: &'static str,
    /// Its declared unit.
    pub unit: schema::Unit,
    /// True for a source.
    pub source: bool,
    /// Values in the declared unit, one per point.
    pub values: Vec<f64>,
    /// Standard deviations, one per point, where the method gives them.
    pub deviations: Option<Vec<f64>>,
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
    /// Its standard deviation, where the method gives it.
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
    /// Root mean square of its rows, in its unit.
    pub rms: f64,
    /// The natural size of its rows, in its unit.
    pub size: f64,
    /// For observations, the noise that the solver ended with, in its unit.
    pub noise: Option<f64>,
    /// True if its rows compare with data.
    pub observation: bool,
}

impl Solution {
    pub(super) fn new(
        bound: Bound,
        engine: Engine<f64>,
        outcome: Outcome<f64>,
        settings: &Settings,
        optimizer: Optimizer,
        start: Instant,
        prior: Option<WeightPrior>,
    ) -> Self {
        Self {
            status: outcome.status,
            loss: outcome.loss,
            iterations: outcome.iterations,
            wall_s: start.elapsed().as_secs_f64(),
            warnings: outcome.warnings,
            optimizer,
            settings: settings.clone(),
            bound,
            engine,
            theta: outcome.theta,
            prior,
        }
    }

    /// The scene that was solved.
    pub fn scene(&self) -> &'static schema::Scene {
        self.bound.problem.scene().schema
    }

    /// The network's parameters.
    pub fn parameters(&self) -> &[f64] {
        &self.theta
    }

    /// Every head at points given in declared units, point by point, without error bars.
    pub fn evaluate(&self, points: &[f64]) -> Vec<Estimate> {
        let mut readout: Engine<f64> = self.bound.readout(self.settings.architecture, points);
        let rows = readout.raw_rows(0, &self.theta);
        let count = rows.len() / self.scene().heads.len().max(1);
        self.estimates(|head| (rows[head * count..][..count].to_vec(), None))
    }

    /// As [`Solution::evaluate`], with standard deviations from the Laplace approximation of the posterior. Methods
    /// without a prior and a noise model have none.
    pub fn evaluate_with_errors(&mut self, points: &[f64]) -> Vec<Estimate> {
        let Some((rows, posterior)) = self.posterior(points) else { return self.evaluate(points) };
        let count = rows.len() / self.scene().heads.len().max(1);
        self.estimates(|head| {
            let range = head * count..(head + 1) * count;
            (rows[range.clone()].to_vec(), Some(posterior.deviations[range].to_vec()))
        })
    }

    fn estimates(&self, of: impl Fn(usize) -> (Vec<f64>, Option<Vec<f64>>)) -> Vec<Estimate> {
        let heads = self.scene().heads.iter().enumerate();
        heads
            .map(|(at, head)| {
                let outward = self.bound.system.outward(&head.unit);
                let (mut values, mut deviations) = of(at);
                values.iter_mut().for_each(|x| *x *= outward);
                deviations.iter_mut().flatten().for_each(|x| *x *= outward);
                Estimate { name: head.name, unit: head.unit, source: head.source, values, deviations }
            })
            .collect()
    }

    /// Values of all heads at points, and their posterior, in the engine's units.
    fn posterior(&mut self, points: &[f64]) -> Option<(Vec<f64>, Posterior)> {
        let prior = self.prior.as_ref()?;
        let curvature = Curvature::at(&mut self.engine, &self.theta, prior).ok()?;
        let mut readout: Engine<f64> = self.bound.readout(self.settings.architecture, points);
        let rows = readout.row_count();
        let (mut values, mut derivatives) = (vec![0.0; rows], vec![0.0; rows * self.theta.len()]);
        readout.jacobian(&self.theta, &mut values, &mut derivatives).ok()?;
        Some((values, posterior(&curvature, &derivatives, 3)))
    }

    /// Learned scalars.
    pub fn learned(&mut self) -> Vec<LearnedValue> {
        let curvature = self.prior.as_ref().and_then(|prior| Curvature::at(&mut self.engine, &self.theta, prior).ok());
        let first = self.engine.layout().learned.start;
        let values = self.engine.learned_values(&self.theta);
        let learned = self.engine.learned.iter().zip(values).enumerate();
        learned
            .map(|(i, (learned, (value, slope)))| {
                let scalar = &self.scene().scalars[learned.slot];
                let outward = self.bound.system.outward(&scalar.unit);
                let deviation = curvature.as_ref().map(|curvature| {
                    let mut direction = vec![0.0; self.theta.len()];
                    direction[first + i] = slope;
                    posterior(curvature, &direction, 1).deviations[0] * outward
                });
                LearnedValue { name: scalar.name, unit: scalar.unit, value: value * outward, deviation }
            })
            .collect()
    }

    /// How well every term is met.
    pub fn terms(&mut self) -> Vec<TermReport> {
        let mut reports = Vec::new();
        for group in 0..self.engine.groups.len() {
            let rows = self.engine.raw_rows(group, &self.theta);
            let bound = &self.engine.groups[group];
            for (at, term) in bound.terms.iter().enumerate() {
                let outward = self.bound.system.outward(&term.schema.unit);
                let range = term.schema.first * bound.points..(term.schema.first + term.schema.rows) * bound.points;
                let own = &rows[range];
                let rms = (own.iter().map(|x| x * x).sum::<f64>() / own.len() as f64).sqrt();
                let observation = matches!(term.schema.kind, TermKind::Observation | TermKind::Chamfer { .. });
                reports.push(TermReport {
                    name: format!("{}.{}", bound.schema.name, term.schema.name),
                    equation: term.schema.equation,
                    unit: term.schema.unit,
                    rms: rms * outward,
                    size: self.bound.sizes[group][at] * outward,
                    noise: (observation && self.prior.is_some()).then_some(term.size * outward),
                    observation,
                });
            }
        }
        reports
    }

    /// Channels, jets and points by group: for tables.
    pub fn groups(&self) -> impl Iterator<Item = (&'static schema::Group, usize)> {
        self.engine.groups.iter().map(|group| (group.schema, group.points))
    }

    /// Name of the instruction set in use.
    pub fn isa(&self) -> &'static str {
        self.engine.isa().name()
    }
}
