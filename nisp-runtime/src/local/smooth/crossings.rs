//! How often measured fields change along a record, beside how often they do along a length.

use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::index::sample;

use super::between::is_filled;
use super::clashes::Clashes;
use super::means::Asked;
use super::proportions::Proportions;
use super::run::Clock;
use super::solver::Solver;
use super::state::REGRESS;
use crate::local::LocalError;
use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::vector::root_mean_square;

/// Measurements that are looked at of a group, at most.
const MOST: usize = 500;

/// The proportions of lattices by what the measurements say of their fields, regressed on the even lattice for so many points; even if they
/// say nothing, or if there is no time to ask them.
pub(super) fn proportions(
    bound: &Bound,
    points: usize,
    asked: &(Vec<Asked>, Clashes),
    noise: &Noise,
    clock: &Clock,
) -> Result<Proportions, LocalError> {
    let schema = bound.problem.scene().schema;
    let even = Proportions::even(schema);
    if schema.observed().is_empty() || !has_waves(schema) {
        return Ok(even);
    }
    let mut solver = Solver::new(bound, (points, &even), asked, noise, None)?;
    let mut state = solver.first(noise);
    for _ in 0..REGRESS {
        let step = if clock.has_time(0.0) { solver.step(&state).ok() } else { None };
        let Some(step) = step else { return Ok(even) };
        state = step.next;
    }
    Ok(Proportions::by(schema, &solver.changes_of_measured(&state.theta), is_filled(schema)))
}

/// True where there is one time, and fields are differentiated as often along it as along lengths: what is sent out then runs on. Where they are
/// differentiated more often along lengths, as where something diffuses, it is smoothed away.
fn has_waves(schema: &schema::Scene) -> bool {
    let jets = || schema.groups.iter().flat_map(|group| group.jets);
    let order = |axis: usize| jets().map(|jet| usize::from(jet.degree[axis])).max().unwrap_or(0);
    let (times, lengths): (Vec<usize>, Vec<usize>) =
        (0..schema.coordinates.len()).partition(|&axis| schema.coordinates[axis].unit.is_time());
    let along_lengths = lengths.into_iter().map(order).max();
    matches!(times[..], [time] if order(time) > 0 && Some(order(time)) == along_lengths)
}

impl Solver<'_> {
    /// By measured field and coordinate, [`Solver::changes`] where the field was measured. Fields that are not of all coordinates, or do not
    /// change, are left out.
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

    /// By coordinate: the difference of a head between two neighbouring times, and how much that difference changes from one cell to the next,
    /// times the number of cells. What stands still, as the mean deflection of a string does, tells nothing of waves.
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
