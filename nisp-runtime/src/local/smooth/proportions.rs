//! How a lattice divides its cells among coordinates: a field that changes more along a record than along a length needs more of them
//! there. A wave does that crosses its domain several times.

use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::index::sample;

use super::between::is_filled;
use super::run::REGRESS;
use super::solver::Solver;
use crate::noise::Noise;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;
use crate::solve::state::State as Saved;
use crate::solve::vector::root_mean_square;

/// Measurements that are looked at of a group, at most.
const MOST: usize = 500;
/// Cells along one coordinate beside those along another: less than this is as good as even, and more is not asked for.
const LEAST: f64 = 1.5;
const FARTHEST: f64 = 16.0;
/// Functions on a lattice beside those on an even one, at most, if it is no coarser than that along any coordinate.
const LARGER: f64 = 2.0;
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

    /// What the measurements say of their fields, regressed on an even lattice; even if they say nothing.
    pub(super) fn of(solver: &mut Solver<'_>, noise: &Noise) -> Self {
        let even = Self::even(solver.schema());
        if !solver.is_measured() || is_of_one_scale(solver.schema()) {
            return even;
        }
        let mut state = solver.first(noise);
        for _ in 0..REGRESS {
            let Ok(step) = solver.step(&state) else { return even };
            state = step.next;
        }
        let changes = solver.changes_of_measured(&state.theta);
        let larger = if is_filled(solver.schema()) { LARGER } else { 1.0 };
        Self::by(solver.schema(), &changes, larger).unwrap_or(even)
    }

    /// Cells in proportion to how much fields change along coordinates that share a scale, on so many times as many functions at most;
    /// nothing if that is nearly even.
    fn by(schema: &schema::Scene, changes: &[Vec<f64>], larger: f64) -> Option<Self> {
        let axes = || schema.coordinates.iter();
        let most = |own: &[f64], group: usize| {
            let tied = axes().zip(own).filter(|(axis, _)| axis.scale_group == group);
            tied.map(|(_, change)| *change).fold(0.0, f64::max)
        };
        // Fields of different sizes count alike: logarithms leave sizes out, since their mean is taken out.
        let mean = |group: usize| changes.iter().map(|own| most(own, group).ln()).sum::<f64>() / changes.len() as f64;
        let means: Vec<f64> = axes().map(|axis| mean(axis.scale_group)).collect();
        let level = means.iter().sum::<f64>() / means.len() as f64;
        let times = |mean: f64| (mean - level).exp();
        let (low, high) = means
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), &mean| (low.min(times(mean)), high.max(times(mean))));
        if !(high / low).is_finite() || high < LEAST * low {
            return None;
        }
        let share = (FARTHEST.ln() / (high / low).ln()).min(1.0);
        let times: Vec<f64> = means.iter().map(|mean| times(*mean).powf(share)).collect();
        let as_even = low.powf(-share);
        let as_large = (larger / times.iter().product::<f64>()).powf(1.0 / times.len() as f64);
        Some(Self(times.iter().map(|times| times * as_even.min(as_large)).collect()))
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

/// True where all coordinates share a scale: cells are cubes there.
fn is_of_one_scale(schema: &schema::Scene) -> bool {
    schema.coordinates.iter().all(|axis| axis.scale_group == schema.coordinates[0].scale_group)
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

    /// By coordinate, the change of a head from a place to the next cell, times the number of cells.
    fn changes(&self, head: usize, places: &[f64], theta: &[f64]) -> Vec<f64> {
        let lattice = &self.heads.lattices[head];
        let inputs = lattice.dimensions();
        let here = self.heads.values(head, places, theta);
        let along = |axis: usize| {
            let step = lattice.spacing(axis);
            let along = || places.iter().skip(axis).step_by(inputs);
            let middle = along().sum::<f64>() / along().count() as f64;
            let mut there = places.to_vec();
            there.iter_mut().skip(axis).step_by(inputs).for_each(|x| *x += if *x < middle { step } else { -step });
            let there = self.heads.values(head, &there, theta);
            lattice.cells[axis] as f64 * root_mean_square(here.iter().zip(&there).map(|(here, there)| there - here))
        };
        (0..inputs).map(along).collect()
    }
}
