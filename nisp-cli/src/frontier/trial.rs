//! One way to solve, over all samples.

use std::time::Duration;

use nisp::network::{Architecture, Inputs};
use nisp::solve::driver::Flow;
use nisp::{Optimizer, Settings, Width, recover};
use nisp_equations::Prepared;

use crate::interrupt;
use crate::score::score;

/// A method with its network.
#[derive(Clone)]
pub(crate) struct Trial {
    pub(super) optimizer: Optimizer,
    pub(super) precision: Width,
    pub(super) width: usize,
    pub(super) threads: usize,
    pub(super) seed: u64,
}

impl Trial {
    /// Mean error of the sources and mean wall time.
    pub(super) fn over(&self, samples: &[Prepared], budget: f64) -> Result<(f64, f64), String> {
        // Adam stands for the paper, which sees the plain coordinates.
        let inputs = match self.optimizer {
            Optimizer::Adam => Inputs::Coordinates,
            _ => Inputs::Automatic,
        };
        let settings = Settings {
            precision: self.precision,
            optimizer: self.optimizer,
            local: None,
            architecture: Architecture { inputs, ..Architecture::modified(self.width, 2) },
            seed: self.seed,
            budget: Some(Duration::from_secs_f64(budget)),
            iterations: None,
            threads: self.threads,
        };
        let (mut errors, mut seconds) = (0.0, 0.0);
        for sample in samples {
            let go_on = &mut |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
            let solution = recover(&sample.problem, &settings, go_on).map_err(|error| error.to_string())?;
            let scores = sample.truth.as_ref().map_or_else(Vec::new, |truth| score(&solution, truth));
            let sources = || scores.iter().filter(|score| score.if_zero.is_some());
            errors += sources().map(|score| score.mean_abs).sum::<f64>() / sources().count() as f64;
            seconds += solution.wall_s;
        }
        let count = samples.len() as f64;
        Ok((errors / count, seconds / count))
    }
}
