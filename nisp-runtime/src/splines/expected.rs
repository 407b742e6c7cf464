//! Sources of the size that the evidence expects. The most likely size of a source that is hardly told from none is nothing, or
//! nearly so; the mean over all sizes that are likely is not.

use super::iterate::{Phase, State};
use super::solver::Solver;
use super::step::TOLERANCE;
use crate::solve::fault::Fault;

/// Ratio of sizes that are compared, and most of them to either side.
const RATIO: f64 = std::f64::consts::SQRT_2;
const SMALLER: i32 = 4;
const LARGER: i32 = 8;
/// Share of the evidence that no longer counts.
const FAINT: f64 = 0.02;
/// Steps to an iterate of another size at most, and the change of a coefficient, in natural sizes, that no longer matters.
const STEPS: usize = 30;
const SETTLED: f64 = 1e-3;

impl Solver<'_> {
    /// The iterate at which sources have the mean of all sizes, in the shares of the evidence, with waves as long as in the most
    /// likely one; that one where there is no such iterate.
    pub(super) fn expected(&mut self, state: State) -> Result<State, Fault> {
        let Some(found) = self.step(&state, Phase::Solve)? else { return Ok(state) };
        let (mut all, mut mean) = (1.0, 1.0);
        for (sign, most) in [(-1, SMALLER), (1, LARGER)] {
            for factor in (1..=most).map(|power| RATIO.powi(sign * power)) {
                let other = self.step(&self.scaled(&state, factor), Phase::Solve)?;
                let share = other.map_or(0.0, |other| (other.evidence - found.evidence).exp());
                if share.is_nan() || share < FAINT {
                    break;
                }
                (all, mean) = (all + share, mean + share * factor);
            }
        }
        let mut other = self.scaled(&state, mean / all);
        for _ in 0..STEPS {
            let Some(found) = self.step(&other, Phase::Solve)? else { return Ok(state) };
            if found.change < SETTLED && other.tolerance <= TOLERANCE {
                return Ok(other);
            }
            other = State { classes: other.classes, ..found.next };
        }
        Ok(state)
    }

    /// The same iterate with sources believed to be `factor` times as large.
    fn scaled(&self, state: &State, factor: f64) -> State {
        let mut scaled = state.clone();
        for class in
            (0..self.roughness.len()).filter_map(|head| Some([self.amplitude[head]?, self.roughness[head]])).flatten()
        {
            scaled.classes[class].size *= factor;
        }
        scaled
    }
}
