//! How much a record tells of its sources.

use super::heads::Heads;
use super::kept::KeptSplines;
use super::prior::{Course, Prior};
use super::straight::Belief;
use super::triangle::Triangle;
use crate::facts::Told;
use crate::schema::Scene;

/// Parts of the domain at whose ends a source is compared with what is known of it.
const PARTS: usize = 200;

/// A source that was found, as a row of the unknowns: how far any other source goes along it.
pub(super) struct Along {
    pub(super) head: usize,
    /// By unknown.
    slopes: Vec<f64>,
    /// Of the source itself.
    square: f64,
}

impl Along {
    /// All sources of a scene.
    pub(super) fn sources(heads: &Heads, schema: &Scene, theta: &[f64]) -> Vec<Self> {
        let of = |head: usize| {
            let mut along = Self { head, slopes: vec![0.0; heads.len()], square: 0.0 };
            for at in places(heads, Course::Steady) {
                let value = heads.value(head, at, theta);
                let (first, slopes) = heads.value_row(head, at);
                along.slopes[first..].iter_mut().zip(&slopes).for_each(|(sum, slope)| *sum += value * slope);
                along.square += value * value;
            }
            along
        };
        (0..schema.heads.len()).filter(|&head| schema.heads[head].source).map(of).collect()
    }

    /// Their means, as rows of the unknowns.
    pub(super) fn means(heads: &Heads, schema: &Scene) -> Vec<Self> {
        let of = |head: usize| {
            let mut along = Self { head, slopes: vec![0.0; heads.len()], square: 0.0 };
            for at in places(heads, Course::Steady) {
                let (first, slopes) = heads.value_row(head, at);
                along.slopes[first..].iter_mut().zip(&slopes).for_each(|(sum, slope)| *sum += slope);
            }
            along
        };
        (0..schema.heads.len()).filter(|&head| schema.heads[head].source).map(of).collect()
    }

    /// The variance along this row that a source of such sizes has beforehand.
    pub(super) fn beforehand(
        &self,
        heads: &Heads,
        (prior, belief): (&Prior, Belief),
        (roughness, amplitude): (f64, f64),
    ) -> f64 {
        let slopes: Vec<f64> = heads.numbers(self.head, 0).iter().map(|&number| self.slopes[number]).collect();
        let beside: f64 = prior.triangle(roughness, amplitude).root(0, &slopes, &[]).iter().map(|x| x * x).sum();
        let line: f64 = prior.straight.along(0, &slopes).iter().take(belief.numbers).map(|x| x * x).sum();
        beside + line * (belief.far * prior.beside(roughness, amplitude)).powi(2)
    }

    /// How far a source with other coefficients goes along this one beyond it.
    fn apart(&self, theta: &[f64], other: &[f64]) -> f64 {
        self.slopes.iter().zip(theta.iter().zip(other)).map(|(slope, (own, other))| slope * (other - own)).sum()
    }

    /// The variance of how far the source goes along this one, where the unknowns' is that of a triangle.
    pub(super) fn variance(&self, triangle: &Triangle) -> f64 {
        triangle.root(0, &self.slopes, &vec![0.0; triangle.shared()]).iter().map(|x| x * x).sum()
    }
}

/// Places all along a course.
fn places(heads: &Heads, course: Course) -> Vec<f64> {
    let ends = heads.bases[0].breakpoints();
    let (first, length) = (ends[0], ends[ends.len() - 1] - ends[0]);
    (0..=PARTS).map(|at| first + length * course.passed(at as f64 / PARTS as f64)).collect()
}

/// How much is told of sources along a course; nothing without deviations. `variances` are those along every source, by kind of
/// smoothness. `open` is the share that the data leave of the variance of each source's mean.
pub(super) fn told(
    kept: &KeptSplines,
    course: Course,
    (along, open): (&[Along], &[f64]),
    variances: &[Vec<f64>],
) -> Vec<Told> {
    let places = places(&kept.heads, course);
    let of = |(at, along): (usize, &Along)| {
        let head = along.head;
        let (values, deviations) = (kept.evaluate(head, &places), kept.deviations(head, &places)?);
        let squares: f64 = values.iter().zip(&deviations).map(|(value, deviation)| (value / deviation).powi(2)).sum();
        // The truth `f` is nearer to the answer `a` than to none if `2 a (f - a) > -a a`.
        let spreads = kept.spreads.iter().zip(variances);
        let variance: f64 = spreads
            .map(|(spread, own)| spread.share * (own[at] + along.apart(&kept.theta, &spread.theta).powi(2)))
            .sum();
        let nearer = along.square / (2.0 * variance.sqrt());
        Some(Told { head, size: Some((squares / places.len() as f64).sqrt()), nearer, open: open[at] })
    };
    along.iter().enumerate().filter_map(of).collect()
}
