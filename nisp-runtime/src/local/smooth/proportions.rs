//! How many more cells a lattice has along a record than along a length: a wave that crosses its domain several times changes as often
//! along the time, and cells that do not follow it flatten its source.

use crate::schema;
use crate::solve::fault::Fault;
use crate::solve::state::State as Saved;

/// Change along a time beside that along lengths up to which an even lattice follows it.
const EVEN: f64 = 2.0;
/// Times as many cells at most.
const MORE: f64 = 4.0;
/// The same where a source depends on all coordinates: equations say nothing of it between their points.
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

    /// Cells along the time in the ratio of how often fields change along it and along lengths; `is_filled` says whether equations are asked
    /// between their points. There are no fewer where fields change less: what sets in at the start does so at once.
    pub(super) fn by(schema: &schema::Scene, changes: &[Vec<f64>], is_filled: bool) -> Self {
        if changes.is_empty() {
            return Self::even(schema);
        }
        let most = if is_filled { MORE } else { MORE_FREE };
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

    /// By coordinate, cells along the longest coordinate of its scale, if an even lattice has so many there.
    pub(super) fn cells(&self, even: usize) -> Vec<f64> {
        self.0.iter().map(|times| (times * even as f64).max(1.0)).collect()
    }

    pub(super) fn save(&self, saved: Saved) -> Saved {
        saved.with(NAME, &self.0)
    }

    pub(super) fn restored(saved: &Saved, schema: &schema::Scene) -> Result<Self, Fault> {
        let times: Vec<f64> = saved.sized(NAME, schema.coordinates.len())?;
        let is_valid = times.iter().all(|times| (1.0..=MORE).contains(times));
        if is_valid { Ok(Self(times)) } else { Err(Fault::state(NAME)) }
    }
}
