//! Sources of the size that the evidence expects. The most likely size of a source that is hardly told from none is nothing, or
//! nearly so; the mean over all sizes that are likely is not.

use super::course::Run;
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
    /// likely one; that one where there is no such iterate, or no time to find it.
    pub(super) fn expected(&mut self, state: State, run: &Run<'_>) -> Result<State, Fault> {
        let Some(found) = self.step(&state, Phase::Solve)? else { return Ok(state) };
        let mut sizes = vec![(1.0, found.evidence)];
        for (sign, most) in [(-1, SMALLER), (1, LARGER)] {
            for factor in (1..=most).map(|power| RATIO.powi(sign * power)) {
                if !run.has_time_for(1) {
                    return Ok(state);
                }
                let other = self.step(&self.scaled(&state, factor), Phase::Solve)?;
                let likely = other.filter(|other| other.evidence - found.evidence >= FAINT.ln());
                let Some(other) = likely else { break };
                sizes.push((factor, other.evidence));
            }
        }
        let mut other = self.scaled(&state, mean(&sizes));
        for _ in (0..STEPS).take_while(|_| run.has_time_for(1)) {
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

/// The mean of sizes with these logarithms of their evidence, in its shares.
fn mean(sizes: &[(f64, f64)]) -> f64 {
    let most = sizes.iter().fold(f64::NEG_INFINITY, |most, (_, evidence)| most.max(*evidence));
    let share = |evidence: f64| (evidence - most).exp();
    let all: f64 = sizes.iter().map(|(_, evidence)| share(*evidence)).sum();
    sizes.iter().map(|(size, evidence)| size * share(*evidence)).sum::<f64>() / all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_sizes_is_in_the_shares_of_their_evidence() {
        let found = mean(&[(1.0, 3.0), (2.0, 3.0 + 3.0_f64.ln())]);
        assert!((found - 7.0 / 4.0).abs() < 1e-15, "{found}");
        // Of exact values a size may be likelier by more than a number can be.
        assert_eq!(mean(&[(1.0, -5e3), (2.0, 5e3)]), 2.0);
    }
}
