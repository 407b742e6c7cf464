//! How many more cells a lattice has along a record than along a length: a wave that crosses its domain several times changes as often
//! along the time, and cells that do not follow it flatten its source.

use crate::schema;
use crate::solve::fault::Fault;
use crate::solve::state::State as Saved;

/// Change along a time beside that along lengths up to which an even lattice follows it.
const EVEN: f64 = 2.0;
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

    /// As many more cells along times as fields change more along these, and so many times as many at most. There are no fewer where they
    /// change less: what sets in at the start does so at once.
    pub(super) fn by(schema: &schema::Scene, changes: &[Vec<f64>], most: f64) -> Self {
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
