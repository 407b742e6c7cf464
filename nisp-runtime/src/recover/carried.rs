//! What every carrier says of its answer, whatever carries the heads.

use super::bars::Distrust;
use crate::carrier::Kept;
use crate::engine::Engine;
use crate::facts::Answer;
use crate::local::LocalSolution;
use crate::network::Architecture;
use crate::problem::Bound;
use crate::saved::KeptNetwork;
use crate::solve::curvature::Curvature;
use crate::solve::posterior::posterior;
use crate::solve::prior::WeightPrior;
use crate::solve::root::Root;
use crate::splines::SplineSolution;

/// Numbers of a block of error bars' derivatives: some megabytes.
const TOGETHER: usize = 1 << 22;

/// A head at some points, in the engine's units.
#[derive(Clone)]
pub(super) struct Values {
    pub(super) values: Vec<f64>,
    pub(super) deviations: Option<Vec<f64>>,
    /// The part of the deviations that only the prior speaks for.
    pub(super) by_prior: Option<Vec<f64>>,
}

impl Values {
    fn plain(values: Vec<f64>) -> Self {
        Self { values, deviations: None, by_prior: None }
    }
}

/// An answer on its carrier. Points are flat and in declared units; everything else is in the engine's.
pub(super) trait Carried: Send {
    /// Every head at points, without error bars.
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values>;
    /// Every head at points, with error bars where there are any.
    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values>;
    /// Standard deviation of a weighted sum of a head's values at points; none where they are not known jointly.
    fn deviation_of_sum(&self, _: &Bound, _head: usize, _points: &[f64], _weights: &[f64]) -> Option<f64> {
        None
    }
    /// Learned scalars and their standard deviations.
    fn learned(&mut self, bound: &Bound) -> Vec<(f64, Option<f64>)>;
    /// How far the rows of a term are off, and what they count as known to.
    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>);
    /// What the verdict is made from.
    fn answer(&mut self, bound: &Bound) -> Answer;
    /// What is kept of it in a file, with what deviations follow from if `bars`.
    fn kept(&mut self, bars: bool) -> Box<dyn Kept>;
}

/// A trained network.
pub(super) struct Network {
    pub(super) architecture: Architecture,
    pub(super) engine: Engine<f64>,
    pub(super) theta: Vec<f64>,
    /// None where there are no error bars.
    pub(super) prior: Option<WeightPrior>,
    pub(super) distrust: Distrust,
}

fn heads(bound: &Bound) -> usize {
    bound.problem.scene().schema.heads.len()
}

impl Carried for Network {
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let mut readout: Engine<f64> = bound.frame().readout(self.architecture, &bound.inward(points));
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
        for some in bound.inward(points).chunks(block) {
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
        let prior = self.prior.as_ref();
        let curvature = prior.and_then(|prior| Curvature::at(&mut self.engine, &self.theta, prior).ok());
        let first = self.engine.layout().learned.start;
        let values = self.engine.learned_values(&self.theta).into_iter().enumerate();
        let deviation = |i: usize, slope: f64| {
            let curvature = curvature.as_ref()?;
            let mut direction = vec![0.0; self.theta.len()];
            direction[first + i] = slope;
            self.distrust.bars(&posterior(curvature, &direction)).deviations.first().copied()
        };
        values.map(|(i, (value, slope))| (value, deviation(i, slope))).collect()
    }

    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>) {
        let noise = self.prior.is_some().then_some(self.engine.groups[group].terms[term].size);
        (self.engine.misfits(group, term, &self.theta), noise)
    }

    fn answer(&mut self, bound: &Bound) -> Answer {
        self.engine.answer(&self.theta, &bound.clouds)
    }

    fn kept(&mut self, bars: bool) -> Box<dyn Kept> {
        let prior = self.prior.as_ref().filter(|_| bars);
        let curvature = prior.and_then(|prior| Curvature::at(&mut self.engine, &self.theta, prior).ok());
        let root = curvature.map(|curvature| Root::of(&curvature, self.distrust.factor()));
        Box::new(KeptNetwork { architecture: self.architecture, theta: self.theta.clone(), root })
    }
}

/// Values of learned scalars from their parameters, with deviations.
fn learned(bound: &Bound, parameters: impl Iterator<Item = (f64, Option<f64>)>) -> Vec<(f64, Option<f64>)> {
    let of = |(learned, (parameter, deviation)): (&crate::engine::Learned, (f64, Option<f64>))| {
        let (value, slope) = learned.map.at(parameter);
        (value, deviation.map(|deviation| deviation * slope.abs()))
    };
    bound.learned.iter().zip(parameters).map(of).collect()
}

impl Carried for LocalSolution {
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let points = bound.inward(points);
        (0..heads(bound)).map(|head| Values::plain(self.kept.evaluate(head, &points))).collect()
    }

    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let inward = bound.inward(points);
        let mut all = self.values(bound, points);
        all.iter_mut().enumerate().for_each(|(head, own)| own.deviations = self.kept.deviations(head, &inward));
        all
    }

    fn deviation_of_sum(&self, bound: &Bound, head: usize, points: &[f64], weights: &[f64]) -> Option<f64> {
        self.kept.deviation_of_sum(head, &bound.inward(points), weights)
    }

    fn learned(&mut self, bound: &Bound) -> Vec<(f64, Option<f64>)> {
        learned(bound, self.kept.learned.iter().enumerate().map(|(at, &x)| (x, self.learned_deviation(at))))
    }

    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>) {
        self.misfits[group][term].clone()
    }

    fn answer(&mut self, _: &Bound) -> Answer {
        self.answer.clone()
    }

    fn kept(&mut self, bars: bool) -> Box<dyn Kept> {
        Box::new(if bars { self.kept.clone() } else { self.kept.without_bars() })
    }
}

impl Carried for SplineSolution {
    fn values(&self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let points = bound.inward(points);
        (0..heads(bound)).map(|head| Values::plain(self.kept.evaluate(head, &points))).collect()
    }

    fn with_deviations(&mut self, bound: &Bound, points: &[f64]) -> Vec<Values> {
        let inward = bound.inward(points);
        let mut all = self.values(bound, points);
        all.iter_mut().enumerate().for_each(|(head, own)| own.deviations = self.kept.deviations(head, &inward));
        all
    }

    fn learned(&mut self, bound: &Bound) -> Vec<(f64, Option<f64>)> {
        learned(bound, self.kept.learned().into_iter())
    }

    fn misfits(&mut self, group: usize, term: usize) -> (Vec<f64>, Option<f64>) {
        self.misfits[group][term].clone()
    }

    fn answer(&mut self, _: &Bound) -> Answer {
        self.answer.clone()
    }

    fn kept(&mut self, bars: bool) -> Box<dyn Kept> {
        Box::new(if bars { self.kept.clone() } else { self.kept.without_bars() })
    }
}
