//! Makes sources rougher by one standard deviation of their roughness, for error bars. How rough they are is itself not known exactly: where measurements tell few numbers of a source, one that is twice as rough fits them
//! nearly as well, and is sharper.

use super::solver::Solver;
use super::state::{Phase, State};

impl Solver<'_> {
    /// A state with all sources rougher by a standard deviation of their roughness.
    pub(super) fn as_rough_as_likely(&mut self, state: &State) -> Option<State> {
        let mut rougher = state.clone();
        for head in self.judged(Phase::Solve) {
            // Where the evidence is stationary, the rows of the belief have as large a sum of squares as numbers are told.
            let told = self.prior_rows(state, head).iter().map(|row| row.misfits[0].powi(2)).sum();
            rougher.classes[self.roughness[head]].size *= deviation_of_logarithm(told).exp();
        }
        let classes = rougher.classes.clone();
        Some(State { classes, ..self.step(&rougher).ok()?.next })
    }
}

/// Standard deviation of the logarithm of a size that so many numbers tell: that of the logarithm of their mean square is the root of two
/// over their count (MacKay 1992).
fn deviation_of_logarithm(told: f64) -> f64 {
    (2.0 * told.max(1.0)).sqrt().recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    /// Sizes of many samples of thirty normal numbers each.
    #[test]
    fn sizes_of_samples_spread_as_much() {
        const COUNT: usize = 30;
        const SAMPLES: usize = 4000;
        let mut random = StdRng::seed_from_u64(2);
        let mut size = || (0..COUNT).map(|_| normal(&mut random).powi(2)).sum::<f64>().ln() / 2.0;
        let logarithms: Vec<f64> = (0..SAMPLES).map(|_| size()).collect();
        let mean = logarithms.iter().sum::<f64>() / SAMPLES as f64;
        let variance = logarithms.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / SAMPLES as f64;
        let exact = deviation_of_logarithm(COUNT as f64);
        assert!((variance.sqrt() / exact - 1.0).abs() < 0.1, "{} {exact}", variance.sqrt());
    }
}
