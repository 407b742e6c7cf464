//! What learned scalars lean on, where a source stands beside them.
//!
//! For any value of a scalar there is a source that fits the data. The value that is learned is the one whose source is smallest and
//! smoothest. That is right where the source is zero or constant over parts of the record, and means nothing where the source
//! follows what is measured. To tell the two apart the source may be larger: a scalar that the data tell stays where it was.

use super::iterate::{Phase, State};
use super::prior::Smoothness;
use super::solver::Solver;
use super::triangle::covariance::Covariance;
use crate::facts::{LARGER, by_prior};
use crate::solve::fault::Fault;

/// Steps with a larger source, at most.
pub(super) const STEPS: usize = 20;
/// What a number that the prior of a source counts is worth: no source is a process of any kind.
const WORTH: f64 = 0.5;
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
            // A short step is not the end of the way.
            if found.change.max(found.ahead) < SETTLED {
                break;
            }
        }
        Ok(state.learned.iter().zip(&end.learned).map(|(larger, own)| (larger - own).abs()).collect())
    }

    /// By learned scalar, the share of what is known of it that comes from the sources' prior alone: its variance at a state is compared with
    /// that where sources may be larger.
    pub(super) fn by_prior(&mut self, state: &State, covariance: &Covariance) -> Result<Vec<f64>, Fault> {
        let wide = self.with_larger_sources(state);
        let Some(found) = self.step(&wide, Phase::Solve)? else { return Ok(vec![0.0; state.learned.len()]) };
        let [own, wide] = [covariance, &found.covariance].map(Covariance::shared_variances);
        Ok(own.into_iter().zip(wide).take(state.learned.len()).map(|(own, wide)| by_prior(own, wide)).collect())
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

/// The factor by which the deviation of a scalar grows if the prior says this share of what is known of it.
pub(super) fn hedge(by_prior: f64) -> f64 {
    (1.0 - by_prior + WORTH * by_prior).sqrt().recip()
}
