//! One way to solve, over all samples.

use std::time::Duration;

use nisp::network::{Architecture, Inputs};
use nisp::solve::driver::Flow;
use nisp::{Optimizer, Settings, Width, recover};
use nisp_equations::Prepared;

use crate::interrupt;
use crate::score::score;

/// A method with its network, or local functions.
#[derive(Clone)]
pub(crate) struct Trial {
    pub(super) local: bool,
    pub(super) optimizer: Optimizer,
    pub(super) precision: Width,
    pub(super) width: usize,
    pub(super) threads: usize,
    pub(super) seed: u64,
}

impl Trial {
    /// Its method and precision, in tables.
    pub(super) fn name(&self) -> String {
        match (self.local, self.precision) {
            (true, _) => "local functions".into(),
            (false, Width::F64) => self.optimizer.name().into(),
            (false, precision) => format!("{} {}", self.optimizer.name(), precision.name()),
        }
    }

    /// The width of its network; nothing for local functions.
    pub(super) fn width(&self) -> String {
        if self.local { String::new() } else { self.width.to_string() }
    }

    /// Mean error of the sources (of the fields where there is no source) and mean wall time.
    pub(super) fn over(&self, samples: &[Prepared], budget: f64) -> Result<(f64, f64), String> {
        // Adam stands for the paper, which sees the plain coordinates.
        let inputs = match self.optimizer {
            Optimizer::Adam => Inputs::Coordinates,
            _ => Inputs::Automatic,
        };
        let (mut errors, mut seconds) = (0.0, 0.0);
        for sample in samples {
            let settings = Settings {
                precision: self.precision,
                optimizer: self.optimizer,
                local: sample.local,
                architecture: Architecture { inputs, ..Architecture::modified(self.width, 2) },
                seed: self.seed,
                budget: Some(Duration::from_secs_f64(budget)),
                threads: self.threads,
                ..Settings::default()
            };
            let go_on = &mut |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
            let solution = recover(&sample.problem, &settings, go_on).map_err(|error| error.to_string())?;
            let scores = sample.truth.as_ref().map_or_else(Vec::new, |truth| score(&solution, truth));
            let has_source = scores.iter().any(|score| score.if_zero.is_some());
            let wanted = || scores.iter().filter(|score| score.if_zero.is_some() == has_source);
            errors += wanted().map(|score| score.mean_abs).sum::<f64>() / wanted().count() as f64;
            seconds += solution.wall_s;
        }
        let count = samples.len() as f64;
        Ok((errors / count, seconds / count))
    }
}
