//! Local functions that were found: their coefficients, and draws from their posterior.

use super::draws::Deviations;
use super::group::{Group, Places};
use super::heads::Heads;
use super::lattice::{Exponents, Lattice, MOST_COORDINATES};
use crate::bounds::limits;
use crate::carrier::{Kept, Outputs};
use crate::engine::Learned;
use crate::loss::Loss;
use crate::problem::Frame;
use crate::schema::Jet;
use crate::solve::fault::Fault;
use crate::solve::state::State;
use crate::solve::vector;

/// Name of the carrier in files.
pub(crate) const CARRIER: &str = "local functions";

/// Points whose rows are held at a time.
const PART: usize = 4096;

/// Heads on lattices, and what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct KeptLattices {
    pub(super) heads: Heads,
    pub(super) theta: Vec<f64>,
    /// Parameters of learned scalars.
    pub(crate) learned: Vec<f64>,
    pub(super) draws: Deviations,
}

impl KeptLattices {
    /// The same answer without draws.
    pub(crate) fn without_bars(&self) -> Self {
        let Self { heads, theta, learned, .. } = self;
        let draws = Deviations::default();
        Self { heads: heads.clone(), theta: theta.clone(), learned: learned.clone(), draws }
    }

    /// Multiplies the deviations of a head.
    pub(super) fn widen(&mut self, head: usize, times: f64) {
        let own = self.heads.first[head]..self.heads.first[head + 1];
        self.draws.coefficients.iter_mut().for_each(|draw| draw[own.clone()].iter_mut().for_each(|x| *x *= times));
    }

    /// Values of a head at points in the engine's units, flat.
    pub(crate) fn evaluate(&self, head: usize, points: &[f64]) -> Vec<f64> {
        self.heads.values(head, points, &self.theta)
    }

    /// Standard deviations of a head at points in the engine's units, flat: root mean squares of draws from the posterior.
    pub(crate) fn deviations(&self, head: usize, points: &[f64]) -> Option<Vec<f64>> {
        let spread = self.spread(head, points);
        let draws = self.draws.coefficients.len();
        (draws > 0).then(|| spread.chunks_exact(draws).map(vector::norm).collect())
    }

    /// A square root `X` of the covariance `X X^T` of a head's values at points in the engine's units, flat: a row for every
    /// point, a column for every draw.
    pub(crate) fn spread(&self, head: usize, points: &[f64]) -> Vec<f64> {
        let inputs = self.heads.lattices[head].inputs();
        let draws = &self.draws.coefficients;
        let share = (draws.len() as f64).sqrt().recip();
        let row = |point| self.heads.drawn(head, point, draws).map(|x| share * x);
        points.chunks_exact(inputs).flat_map(row).collect()
    }

    /// Standard deviation of a sum of coefficients, each times its weight, by the draws.
    pub(crate) fn deviation_of_sum(&self, weights: &[f64]) -> Option<f64> {
        let draws = &self.draws.coefficients;
        let sums: Vec<f64> = draws.iter().map(|draw| vector::dot(draw, weights)).collect();
        (!draws.is_empty()).then(|| vector::norm(&sums) / (draws.len() as f64).sqrt())
    }

    /// The weight of every coefficient in a weighted sum of a head's values at points in the engine's units, flat.
    pub(crate) fn weights_of_sum(&self, head: usize, points: &[f64], weights: &[f64]) -> Vec<f64> {
        self.heads.sum_weights(head, points, weights)
    }

    /// A square root of the covariance of the learned scalars' parameters, as [`KeptLattices::spread`] is of values.
    pub(crate) fn spread_of_learned(&self) -> Vec<f64> {
        let draws = &self.draws.learned;
        let share = (draws.len() as f64).sqrt().recip();
        (0..self.learned.len()).flat_map(|at| draws.iter().map(move |draw| share * draw[at])).collect()
    }

    /// The rows at a part of the points. Those of the heads themselves, which come first, are read without a program: its
    /// transformation of a bounded head has no inverse at the bound.
    fn part(&self, frame: &Frame, points: &[f64]) -> Outputs {
        let (schema, heads) = (&frame.scene.schema.outputs, frame.scene.schema.heads.len());
        let has_bars = !self.draws.coefficients.is_empty();
        let mut values: Vec<f64> = (0..heads).flat_map(|head| self.evaluate(head, points)).collect();
        let mut bars: Vec<f64> = (0..heads).filter_map(|head| self.deviations(head, points)).flatten().collect();
        if schema.rows > heads
            && let Some(kernel) = frame.scene.double().pop()
        {
            let (scalars, by) = Learned::read_all(&frame.learned, &frame.scalars, &self.learned);
            let losses = vec![Loss::Square; schema.terms.len()];
            let places = Places { points, ..Places::default() };
            let group = Group::new((schema, &losses), kernel, &self.heads, places, None);
            let found = group.evaluate(&self.heads, &self.theta, &scalars, has_bars);
            for row in heads..schema.rows {
                for (p, point) in points.chunks_exact(self.heads.lattices[0].inputs()).enumerate() {
                    values.push(found.row(row, p));
                    if has_bars {
                        let slope = |bar: usize| found.bar(row, bar, p);
                        bars.push(self.deviation(schema.jets, point, &slope, &by));
                    }
                }
            }
        }
        Outputs { values, deviations: has_bars.then_some(bars) }
    }

    /// Standard deviation of a quantity at a point with these derivatives by jets, then by learned scalars; `by` are those of
    /// the scalars by their parameters.
    fn deviation(&self, jets: &[Jet], point: &[f64], slope: &dyn Fn(usize) -> f64, by: &[f64]) -> f64 {
        let mut moved = vec![0.0; self.draws.coefficients.len()];
        for (at, jet) in jets.iter().enumerate().filter(|(at, _)| slope(*at) != 0.0) {
            for (index, coefficient) in jet.operator {
                let mut exponents = Exponents::default();
                exponents[..index.len()].copy_from_slice(index);
                for (dof, part) in self.heads.parts_of(jet.head, point, &exponents) {
                    let factor = slope(at) * coefficient * part;
                    moved.iter_mut().zip(&self.draws.coefficients).for_each(|(sum, draw)| *sum += factor * draw[dof]);
                }
            }
        }
        for (at, by) in by.iter().enumerate() {
            let factor = slope(jets.len() + at) * by;
            moved.iter_mut().zip(&self.draws.learned).for_each(|(sum, draw)| *sum += factor * draw[at]);
        }
        vector::norm(&moved) / (moved.len() as f64).sqrt()
    }

    /// From the numbers of [`Kept::save`].
    pub(crate) fn restored(state: &State, frame: &Frame) -> Result<Self, Fault> {
        let schema = frame.scene.schema;
        let (inputs, count) = (schema.coordinates.len(), schema.heads.len());
        let lattice = |head: usize| {
            let name = |part: &str| format!("head {head} {part}");
            let axes = schema.axes(head);
            let [low, spacing] = ["low", "spacing"].map(|part| state.sized(&name(part), axes.len()));
            let (low, spacing) = (low?, spacing?);
            let (cells, full) = (state.indices(&name("cells"))?, state.indices(&name("functions"))?);
            let degree = state.counter(&name("degree"))? as usize;
            let wrong = || Fault::state(name("lattice"));
            let is_sound =
                cells.len() == axes.len() && inputs <= MOST_COORDINATES && degree <= super::refuse::HIGHEST_DEGREE;
            let size = cells.iter().try_fold(1_usize, |size, n| size.checked_mul(n + degree));
            let is_small = size.is_some_and(|size| size <= MOST_FUNCTIONS);
            if !is_sound || !is_small || cells.contains(&0) {
                return Err(wrong());
            }
            Lattice::new(degree, low, spacing, cells).spanning(axes, inputs).keeping(full).ok_or_else(wrong)
        };
        let lattices = (0..count).map(lattice).collect::<Result<Vec<_>, Fault>>()?;
        let (offset, scale) = (state.sized("offset", count)?, state.sized("scale", count)?);
        let heads = Heads::over(lattices, offset, scale, limits(schema, &frame.system));
        let count = state.counter("draws")? as usize;
        let draws = |name: &str, len: usize| -> Result<Vec<Vec<f64>>, Fault> {
            let numbers = state.vector(name)?;
            match len.checked_mul(count).filter(|all| *all == numbers.len()) {
                None => Err(Fault::state(name)),
                Some(_) if len == 0 => Ok(Vec::new()),
                Some(_) => Ok(numbers.chunks_exact(len).map(<[f64]>::to_vec).collect()),
            }
        };
        let draws = Deviations {
            coefficients: draws("draws", heads.len())?,
            learned: draws("draws of learned", frame.learned.len())?,
        };
        let theta = state.sized("theta", heads.len())?;
        Ok(Self { heads, theta, learned: state.sized("learned", frame.learned.len())?, draws })
    }
}

/// Functions of a lattice that fit into memory with room to spare.
const MOST_FUNCTIONS: usize = 1 << 28;

impl Kept for KeptLattices {
    fn degrees(&self) -> Option<Vec<usize>> {
        Some(self.heads.lattices.iter().map(|lattice| lattice.degree).collect())
    }

    fn outputs(&self, frame: &Frame, points: &[f64]) -> Outputs {
        let inputs = frame.scene.schema.coordinates.len();
        let parts: Vec<Outputs> = points.chunks(PART * inputs).map(|points| self.part(frame, points)).collect();
        Outputs::joined(&parts, frame.scene.schema.outputs.rows)
    }

    fn save(&self) -> State {
        let state = State::new(CARRIER)
            .with("theta", &self.theta)
            .with("learned", &self.learned)
            .with("offset", &self.heads.offset)
            .with("scale", &self.heads.scale)
            .with("draws", &self.draws.coefficients.concat())
            .with("draws of learned", &self.draws.learned.concat())
            .with_counter("draws", self.draws.coefficients.len() as u64);
        self.heads.lattices.iter().enumerate().fold(state, |state, (head, lattice)| {
            let name = |part: &str| format!("head {head} {part}");
            let (low, spacing, full) = lattice.parts();
            let numbers = |counts: &[usize]| counts.iter().map(|n| *n as f64).collect::<Vec<f64>>();
            state
                .with(&name("low"), low)
                .with(&name("spacing"), spacing)
                .with(&name("cells"), &numbers(&lattice.cells))
                .with(&name("functions"), &numbers(full))
                .with_counter(&name("degree"), lattice.degree as u64)
        })
    }
}
