//! How many more cells a lattice has along a record than along a length: a wave that crosses its domain several times changes as often
//! along the time, and cells that do not follow it flatten its source.

use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::index::sample;

use super::between::is_filled;
use super::run::REGRESS;
use super::solver::Solver;
use crate::local::LocalError;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;
use crate::solve::state::State as Saved;
use crate::solve::vector::root_mean_square;

/// Measurements that are looked at of a group, at most.
const MOST: usize = 500;
/// Change along a time beside that along lengths up to which an even lattice follows it.
const EVEN: f64 = 2.0;
/// Times as many cells at most; and where a source of all coordinates may be anything between points.
const MORE: f64 = 4.0;
const MORE_FREE: f64 = 2.0;
/// What a saved state calls it.
const NAME: &str = "proportions";

/// By coordinate, how many times as many cells there are as on an even lattice.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Proportions(Vec<f64>);

impl Proportions {
    /// As many cells along the longest length as along the longest time.
    pub(super) fn even(schema: &schema::Scene) -> Self {
        Self(vec![1.0; schema.coordinates.len()])
    }

    /// What the measurements say of their fields, regressed on an even lattice with equations at so many points; even if they say nothing.
    pub(super) fn of(bound: &Bound, points: usize, noise: &Noise) -> Result<Self, LocalError> {
        let schema = bound.problem.scene().schema;
        let even = Self::even(schema);
        let times = schema.coordinates.iter().filter(|axis| axis.unit.is_time()).count();
        if schema.observed().is_empty() || times == 0 || times == schema.coordinates.len() {
            return Ok(even);
        }
        let mut solver = Solver::new(bound, (points, &even), noise, None)?;
        let mut state = solver.first(noise);
        for _ in 0..REGRESS {
            let Ok(step) = solver.step(&state) else { return Ok(even) };
            state = step.next;
        }
        let most = if is_filled(schema) { MORE } else { MORE_FREE };
        Ok(Self::by(schema, &solver.changes_of_measured(&state.theta), most))
    }

    /// As many more cells along times as fields change more along these, and so many times as many at most. There are no fewer where they
    /// change less: what sets in at the start does so at once.
    fn by(schema: &schema::Scene, changes: &[Vec<f64>], most: f64) -> Self {
        let most_along = |own: &[f64], times: bool| {
            let along = schema.coordinates.iter().zip(own).filter(|(axis, _)| axis.unit.is_time() == times);
            along.map(|(_, change)| *change).fold(0.0, f64::max)
        };
        let ratio = |own: &Vec<f64>| (most_along(own, true) / most_along(own, false)).ln();
        let mean = (changes.iter().map(ratio).sum::<f64>() / changes.len() as f64).exp();
        let times = if mean > EVEN { mean.min(most) } else { 1.0 };
        Self(schema.coordinates.iter().map(|axis| if axis.unit.is_time() { times } else { 1.0 }).collect())
    }

    /// How many times as many functions there are as on an even lattice.
    pub(super) fn functions(&self) -> f64 {
        self.0.iter().product()
    }

    /// By coordinate, cells along the longest of those that share a scale with it, where an even lattice has so many.
    pub(super) fn cells(&self, even: usize) -> Vec<f64> {
        self.0.iter().map(|times| (times * even as f64).max(1.0)).collect()
    }

    pub(super) fn save(&self, saved: Saved) -> Saved {
        saved.with(NAME, &self.0)
    }

    pub(super) fn restored(saved: &Saved, schema: &schema::Scene) -> Result<Self, Fault> {
        let times: Vec<f64> = saved.sized(NAME, schema.coordinates.len())?;
        let is_one = times.iter().all(|times| times.is_finite() && *times > 0.0);
        if is_one { Ok(Self(times)) } else { Err(Fault::state(NAME)) }
    }
}

impl Solver<'_> {
    /// By measured field and coordinate, how much the field changes over the whole of it, at the rate at which it does where it was
    /// measured. Fields that are not of all coordinates, or do not change, are left out.
    fn changes_of_measured(&self, theta: &[f64]) -> Vec<Vec<f64>> {
        let schema = self.schema();
        let inputs = schema.coordinates.len();
        let of = |(group, points): (&schema::Group, &Vec<f64>)| {
            let measures = |term: &&schema::Term| term.kind == TermKind::Observation;
            let heads = group.terms.iter().filter(measures).flat_map(|term| term.jets).map(|&jet| group.jets[jet].head);
            let mut heads: Vec<usize> =
                heads.filter(|&head| self.heads.lattices[head].axes().len() == inputs).collect();
            heads.sort_unstable();
            heads.dedup();
            let count = points.len() / inputs;
            let chosen = sample(&mut StdRng::seed_from_u64(0), count, count.min(MOST));
            let places: Vec<f64> =
                chosen.into_iter().flat_map(|at| &points[at * inputs..][..inputs]).copied().collect();
            heads.into_iter().map(|head| self.changes(head, &places, theta)).collect::<Vec<_>>()
        };
        let all = schema.groups.iter().zip(&self.bound.coordinates).flat_map(of);
        all.filter(|changes| changes.iter().all(|change| *change > 0.0 && change.is_finite())).collect()
    }

    /// By coordinate, how much the change of a head from a time to the next cell's differs from a place to the next cell, times the
    /// number of cells: what does not change along the time does not matter.
    fn changes(&self, head: usize, places: &[f64], theta: &[f64]) -> Vec<f64> {
        let lattice = &self.heads.lattices[head];
        let inputs = lattice.dimensions();
        let shifted = |places: &[f64], axis: usize| {
            let (step, along) = (lattice.spacing(axis), || places.iter().skip(axis).step_by(inputs));
            let middle = along().sum::<f64>() / along().count() as f64;
            let mut there = places.to_vec();
            there.iter_mut().skip(axis).step_by(inputs).for_each(|x| *x += if *x < middle { step } else { -step });
            there
        };
        let values = |places: &[f64]| self.heads.values(head, places, theta);
        let time = self.schema().coordinates.iter().position(|axis| axis.unit.is_time()).unwrap_or(0);
        let change = |places: &[f64]| -> Vec<f64> {
            let (here, there) = (values(places), values(&shifted(places, time)));
            here.iter().zip(&there).map(|(here, there)| there - here).collect()
        };
        let here = change(places);
        let along = |axis: usize| {
            let there = change(&shifted(places, axis));
            lattice.cells[axis] as f64 * root_mean_square(here.iter().zip(&there).map(|(here, there)| there - here))
        };
        (0..inputs).map(along).collect()
    }
}
