//! Splines that were found: their coefficients, and the covariances of neighbouring ones.

use super::basis::HIGHEST_DEGREE;
use super::group::Group;
use super::heads::Heads;
use super::triangle::covariance::Covariance;
use super::triangle::{Row, Triangle};
use crate::bounds::limits;
use crate::carrier::{Kept, Outputs};
use crate::engine::Learned;
use crate::problem::Frame;
use crate::solve::fault::Fault;
use crate::solve::state::State;

/// Name of the carrier in files.
pub(crate) const CARRIER: &str = "splines";

/// Places whose rows are held at a time.
const PART: usize = 4096;

/// Heads as splines, and what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct KeptSplines {
    pub(super) heads: Heads,
    pub(super) theta: Vec<f64>,
    /// Parameters of learned scalars.
    pub(crate) learned: Vec<f64>,
    /// One for each kind of smoothness that may be the right one.
    pub(super) spreads: Vec<Spread>,
}

/// What a kind of smoothness says: its share of the evidence, coefficients, parameters of learned scalars, and their
/// covariances.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    pub(super) share: f64,
    pub(super) theta: Vec<f64>,
    pub(super) learned: Vec<f64>,
    pub(super) covariance: Covariance,
}

impl KeptSplines {
    /// The same answer without deviations.
    pub(crate) fn without_bars(&self) -> Self {
        let Self { heads, theta, learned, .. } = self;
        Self { heads: heads.clone(), theta: theta.clone(), learned: learned.clone(), spreads: Vec::new() }
    }

    /// Values of a head at places in the engine's units.
    pub(crate) fn evaluate(&self, head: usize, places: &[f64]) -> Vec<f64> {
        places.iter().map(|&at| self.heads.value(head, at, &self.theta)).collect()
    }

    /// Standard deviations of a head at places in the engine's units.
    pub(crate) fn deviations(&self, head: usize, places: &[f64]) -> Option<Vec<f64>> {
        let shared = vec![0.0; self.learned.len()];
        let deviation = |&at: &f64| {
            let (first, slopes) = self.heads.value_row(head, at);
            self.deviation(first, &slopes, &shared)
        };
        (!self.spreads.is_empty()).then(|| places.iter().map(deviation).collect())
    }

    /// A square root of the covariance of a head's values at places, row by row, where this is that of the coefficients.
    pub(crate) fn spread(&self, root: &Triangle, head: usize, places: &[f64]) -> Vec<f64> {
        let shared = vec![0.0; root.shared()];
        let row = |&at: &f64| {
            let (first, slopes) = self.heads.value_row(head, at);
            root.root(first, &slopes, &shared)
        };
        places.iter().flat_map(row).collect()
    }

    /// The same for the parameters of learned scalars.
    pub(crate) fn spread_of_learned(&self, root: &Triangle) -> Vec<f64> {
        let count = self.learned.len();
        let unit = |at: usize| (0..root.shared()).map(|other| f64::from(at == other)).collect::<Vec<f64>>();
        (0..count).flat_map(|at| root.root(0, &[], &unit(at))).collect()
    }

    /// Parameters of the learned scalars, and their standard deviations.
    pub(crate) fn learned(&self) -> Vec<(f64, Option<f64>)> {
        let count = self.learned.len();
        let deviation = |at: usize| {
            let square = |spread: &Spread| {
                let variance = spread.covariance.corner[at * (count + 1)].max(0.0);
                spread.share * (variance + (spread.learned[at] - self.learned[at]).powi(2))
            };
            (!self.spreads.is_empty()).then(|| self.spreads.iter().map(square).sum::<f64>().sqrt())
        };
        self.learned.iter().enumerate().map(|(at, &parameter)| (parameter, deviation(at))).collect()
    }

    /// Standard deviation of a quantity with these derivatives by the coefficients from `first` on and by the parameters of
    /// learned scalars: that of all kinds of smoothness together, about the answer.
    fn deviation(&self, first: usize, slopes: &[f64], shared: &[f64]) -> f64 {
        let apart = |slopes: &[f64], other: &[f64], own: &[f64]| -> f64 {
            slopes.iter().zip(other.iter().zip(own)).map(|(slope, (other, own))| slope * (other - own)).sum()
        };
        let square = |spread: &Spread| {
            let apart = apart(slopes, &spread.theta[first..], &self.theta[first..])
                + apart(shared, &spread.learned, &self.learned);
            spread.share * (spread.covariance.of(first, slopes, shared).max(0.0) + apart * apart)
        };
        self.spreads.iter().map(square).sum::<f64>().sqrt()
    }

    /// The rows at a part of the places.
    fn part(&self, frame: &Frame, places: &[f64]) -> Outputs {
        let schema = &frame.scene.schema.outputs;
        let Some(kernel) = frame.scene.double().pop() else { return Outputs::default() };
        let (scalars, by) = Learned::read_all(&frame.learned, &frame.scalars, &self.learned);
        let group = Group::new(schema, kernel, &self.heads, places, &[]);
        let has_bars = !self.spreads.is_empty();
        let found = group.evaluate(&self.heads, &self.theta, &scalars, has_bars.then_some(by.len()));
        let all = || (0..schema.rows).flat_map(|row| (0..places.len()).map(move |p| (row, p)));
        let deviation = |(row, p): (usize, usize)| {
            let mut one = group.bundle(&self.heads, group.cell(p), by.len());
            group.add_row(&self.heads, (&found, row, p), &by, 1.0, &mut one);
            let is_finite = |row: &Row<'_>| row.slopes.iter().chain(row.shared).all(|slope| slope.is_finite());
            let row = one.iter().next().filter(is_finite);
            row.map_or(f64::NAN, |row| self.deviation(row.first, row.slopes, row.shared))
        };
        Outputs {
            values: all().map(|(row, p)| found.row(row, p)).collect(),
            deviations: has_bars.then(|| all().map(deviation).collect()),
        }
    }

    /// From the numbers of [`Kept::save`].
    pub(crate) fn restored(state: &State, frame: &Frame) -> Result<Self, Fault> {
        let (schema, learned) = (frame.scene.schema, frame.learned.len());
        let breakpoints = state.vector("breakpoints")?;
        if breakpoints.len() < 2 || !breakpoints.is_sorted_by(|a, b| a < b) {
            return Err(Fault::state("breakpoints"));
        }
        let degrees = state.indices("degrees")?;
        let count = schema.heads.len();
        if degrees.len() != count || degrees.iter().any(|degree| *degree > HIGHEST_DEGREE) {
            return Err(Fault::state("degrees"));
        }
        let (offset, scale) = (state.sized("offset", count)?, state.sized("scale", count)?);
        let heads = Heads::over(breakpoints, &degrees, (offset, scale, limits(schema, &frame.system)));
        let spread = |at: u64| {
            let part = |name: &str| state.vector(&format!("spread {at} {name}")).map(<[f64]>::to_vec);
            let parts = [part("rows")?, part("border")?, part("corner")?];
            let covariance = Covariance::restored(heads.len(), heads.band, learned, parts);
            let [share] = state.scalars(&format!("spread {at} share"))?;
            Ok(Spread {
                share,
                theta: state.sized(&format!("spread {at} theta"), heads.len())?,
                learned: state.sized(&format!("spread {at} learned"), learned)?,
                covariance: covariance.ok_or_else(|| Fault::state("spread"))?,
            })
        };
        let spreads = (0..state.counter("spreads")?).map(spread).collect::<Result<_, Fault>>()?;
        let (theta, learned) = (state.sized("theta", heads.len())?, state.sized("learned", learned)?);
        Ok(Self { heads, theta, learned, spreads })
    }
}

impl Kept for KeptSplines {
    fn degrees(&self) -> Option<Vec<usize>> {
        Some(self.heads.bases.iter().map(|basis| basis.degree).collect())
    }

    fn outputs(&self, frame: &Frame, points: &[f64]) -> Outputs {
        let parts: Vec<Outputs> = points.chunks(PART).map(|places| self.part(frame, places)).collect();
        Outputs::joined(&parts, frame.scene.schema.outputs.rows)
    }

    fn save(&self) -> State {
        let degrees: Vec<f64> = self.heads.bases.iter().map(|basis| basis.degree as f64).collect();
        let breakpoints = self.heads.bases.first().map_or(&[][..], |basis| basis.breakpoints());
        let state = State::new(CARRIER)
            .with("breakpoints", breakpoints)
            .with("degrees", &degrees)
            .with("offset", &self.heads.offset)
            .with("scale", &self.heads.scale)
            .with("theta", &self.theta)
            .with("learned", &self.learned)
            .with_counter("spreads", self.spreads.len() as u64);
        self.spreads.iter().enumerate().fold(state, |state, (at, spread)| {
            let [rows, border, corner] = spread.covariance.parts();
            let parts = [("rows", rows), ("border", border), ("corner", corner)];
            let own = [("share", &[spread.share][..]), ("theta", &spread.theta), ("learned", &spread.learned)];
            own.into_iter()
                .chain(parts)
                .fold(state, |state, (name, part)| state.with(&format!("spread {at} {name}"), part))
        })
    }
}
