//! What learned scalars lean on, where a source stands beside them.
//!
//! For any value of a scalar there is a source that fits the data. The value that is learned is the one whose source is smallest and
//! smoothest. That is right where the source is zero or constant over parts of the record, and means nothing where the source
//! follows what is measured. To tell the two apart the source may be larger: a scalar that the data tell stays where it was.

use super::iterate::{Phase, State};
use super::prior::Smoothness;
use super::solver::Solver;
use crate::facts::LARGER;
use crate::solve::fault::Fault;

/// Steps with a larger source, at most.
pub(super) const STEPS: usize = 20;
/// Change of a coefficient or parameter that no longer matters.
const SETTLED: f64 = 1e-3;

impl Solver<'_> {
    /// By learned scalar, how far its parameter moves from an end where sources may be [`LARGER`] times as large and as rough;
    /// nothing without sources or scalars.
    pub(super) fn leaning(&mut self, kind: Smoothness, end: &State) -> Result<Vec<f64>, Fault> {
        if !self.is_beside_sources() {
            return Ok(Vec::new());
        }
        self.set_smoothness(kind, end);
        let mut state = self.with_larger_sources(end);
        for _ in 0..STEPS {
            let Some(found) = self.step(&state, Phase::Solve)? else { break };
            state = State { classes: state.classes, ..found.next };
            if found.change < SETTLED {
                break;
            }
        }
        Ok(state.learned.iter().zip(&end.learned).map(|(larger, own)| (larger - own).abs()).collect())
    }

    /// A state where sources may be [`LARGER`] times as large and as rough.
    pub(super) fn with_larger_sources(&self, end: &State) -> State {
        let mut state = end.clone();
        for (amplitude, &roughness) in self.amplitude.iter().zip(&self.roughness) {
            let Some(amplitude) = *amplitude else { continue };
            state.classes[amplitude].size *= LARGER;
            state.classes[roughness].size *= LARGER;
        }
        state
    }
}
