//! The answer of a trained network.

use super::bars::Distrust;
use super::carried::{Carried, Values, heads};
use crate::carrier::Kept;
use crate::engine::Engine;
use crate::facts::{Answer, Leaning, Told};
use crate::local::smooth;
use crate::network::Architecture;
use crate::noise;
use crate::problem::Bound;
use crate::saved::KeptNetwork;
use crate::solve::curvature::Curvature;
use crate::solve::posterior::posterior;
use crate::solve::prior::WeightPrior;
use crate::solve::root::Root;

/// Numbers of a block of error bars' derivatives: some megabytes.
const TOGETHER: usize = 1 << 22;

/// A trained network.
pub(super) struct Trained {
    pub(super) architecture: Architecture,
    pub(super) engine: Engine<f64>,
    pub(super) theta: Vec<f64>,
    /// None where there are no error bars.
    pub(super) prior: Option<WeightPrior>,
    pub(super) distrust: Distrust,
}

impl Trained {
    /// Standard deviations of the learned scalars' parameters.
    fn deviations(&mut self) -> Vec<Option<f64>> {
        let learned = self.engine.layout().learned.clone();
        // The curvature takes memory for every row and parameter.
        let prior = self.prior.as_ref().filter(|_| !learned.is_empty());
        let curvature = prior.and_then(|prior| Curvature::at(&mut self.engine, &self.theta, prior).ok());
        let deviation = |at: usize| {
            let mut direction = vec![0.0; self.theta.len()];
            direction[at] = 1.0;
            self.distrust.bars(&posterior(curvature.as_ref()?, &direction)).deviations.first().copied()
        };
        learned.map(deviation).collect()
    }
}

impl Carried for Trained {
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let mut readout: Engine<f64> = bound.frame().readout(self.architecture, points);
        let rows = readout.raw_rows(0, &self.theta);
        let count = rows.len() / heads(bound).max(1);
        (0..heads(bound)).map(|head| Values::plain(rows[head * count..][..count].to_vec())).collect()
    }

    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let prior = self.prior.as_ref();
        let curvature = prior.and_then(|prior| Curvature::at(&mut self.engine, &self.theta, prior).ok());
        let Some(curvature) = curvature else { return self.values(bound, points) };
        // Derivatives of a point's heads by all parameters are many numbers: so many points at once.
        let inputs = bound.problem.scene().schema.coordinates.len();
        let block = inputs * (TOGETHER / (self.theta.len() * heads(bound)).max(1)).max(1);
        let empty = Values { values: Vec::new(), deviations: Some(Vec::new()), by_prior: Some(Vec::new()) };
        let mut all = vec![empty; heads(bound)];
        for some in points.chunks(block) {
            let Some((rows, derivatives)) = bound.frame().sensitivities(self.architecture, &self.theta, some) else {
                return self.values(bound, points);
            };
            let bars = self.distrust.bars(&posterior(&curvature, &derivatives));
            let count = some.len() / inputs;
            for (head, own) in all.iter_mut().enumerate() {
                let part = head * count..(head + 1) * count;
                own.values.extend_from_slice(&rows[part.clone()]);
                own.deviations.iter_mut().for_each(|all| all.extend_from_slice(&bars.deviations[part.clone()]));
                own.by_prior.iter_mut().for_each(|all| all.extend_from_slice(&bars.by_prior[part.clone()]));
            }
        }
        all
    }

    fn learned(&mut self, _: &Bound) -> Vec<(f64, Option<f64>)> {
        let deviations = self.deviations();
        let found = self.engine.learned_values(&self.theta).into_iter().zip(deviations);
        found.map(|((value, slope), deviation)| (value, deviation.map(|deviation| deviation * slope.abs()))).collect()
    }

    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>) {
        let noise = self.prior.is_some().then_some(self.engine.groups[group].terms[term].size);
        (self.engine.misfits(group, term, &self.theta), noise)
    }

    fn answer(&mut self, bound: &Bound) -> Answer {
        let mut answer = self.engine.answer(&self.theta, &bound.clouds);
        let left = self.engine.left_to_learned(&self.theta).into_iter().zip(self.deviations());
        answer.left_to_learned = left.map(|(left, deviation)| Some(left / deviation?)).collect();
        // How far scalars move where sources may be larger is not known of a network; how sure they are is.
        if bound.problem.scene().schema.heads.iter().any(|head| head.source) {
            let known = |deviation| Leaning { moved: None, deviation, by_prior: None, is_weighed: false };
            answer.leaning = self.deviations().into_iter().map(known).collect();
        }
        // Without error bars a source may follow the noise of what was measured or seen.
        let schema = bound.problem.scene().schema;
        if self.prior.is_none() && noise::estimate(bound).with_clouds(bound).is_there(schema) {
            let sources = (0..schema.heads.len()).filter(|&head| schema.heads[head].source);
            answer.told = sources.map(Told::unasked).collect();
        }
        // Where nothing is measured, points of the equations are all that a network was shown.
        let others = bound.problem.scene().schema.observed().is_empty().then(|| smooth::others(bound)).flatten();
        if let Some((groups, others)) = others
            && let Ok(mut engine) = others.engine(self.architecture) as Result<Engine<f64>, _>
        {
            answer.between = groups.into_iter().map(|at| (at, engine.facts(at, &self.theta))).collect();
        }
        answer
    }

    fn kept(&mut self, bars: bool) -> Box<dyn Kept> {
        let prior = self.prior.as_ref().filter(|_| bars);
        let curvature = prior.and_then(|prior| Curvature::at(&mut self.engine, &self.theta, prior).ok());
        let root = curvature.map(|curvature| Root::of(&curvature, self.distrust.factor()));
        Box::new(KeptNetwork { architecture: self.architecture, theta: self.theta.clone(), root })
    }
}
