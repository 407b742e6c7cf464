//! One way to solve, over all samples.

use std::time::Duration;

use nisp::network::{Architecture, Inputs};
use nisp::solve::driver::{Flow, Status};
use nisp::{Optimizer, RecoverError, Settings, Width, recover};
use nisp_equations::Prepared;

use crate::measure::{Means, Measure};
use nisp_cli::interrupt;

/// A method with its network, or local functions.
#[derive(Clone)]
pub(crate) struct Trial {
    pub(super) local: bool,
    pub(super) optimizer: Optimizer,
    pub(super) precision: Width,
    pub(super) width: usize,
    pub(super) layers: usize,
    pub(super) threads: usize,
    pub(super) seed: u64,
}

/// What a trial came to within a budget.
pub(crate) enum Outcome {
    Reached(Reached),
    /// The method cannot solve the scene; why.
    Refused(String),
}

/// What a trial reached, in the mean over samples.
pub(crate) struct Reached {
    /// By measure.
    pub(super) values: Vec<Option<f64>>,
    pub(super) seconds: f64,
    /// It ended without convergence before the budget on some sample.
    pub(super) gave_up: bool,
}

impl Trial {
    /// Its method, in files.
    pub(super) fn method(&self) -> &'static str {
        if self.local { "local" } else { self.optimizer.name() }
    }

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

    /// Solves every sample within the budget.
    pub(super) fn over(&self, samples: &[Prepared], measures: &[Measure], budget: f64) -> Result<Outcome, String> {
        // Adam stands for the paper, which sees the plain coordinates.
        let inputs = match self.optimizer {
            Optimizer::Adam => Inputs::Coordinates,
            _ => Inputs::Automatic,
        };
        let mut means = Means::new(measures);
        let mut gave_up = false;
        for sample in samples {
            let settings = sample.suited(Settings {
                precision: self.precision,
                optimizer: self.optimizer,
                architecture: Architecture { inputs, ..Architecture::modified(self.width, self.layers) },
                seed: self.seed,
                budget: Some(Duration::from_secs_f64(budget)),
                threads: self.threads,
                ..Settings::default()
            });
            let go_on = &mut |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
            let mut solution = match recover(&sample.problem, &settings, go_on) {
                Ok(solution) => solution,
                // Nothing that another method would mend.
                Err(error @ (RecoverError::Bind(_) | RecoverError::Threads { .. })) => return Err(error.to_string()),
                Err(error) => return Ok(Outcome::Refused(error.to_string())),
            };
            interrupt::check()?;
            gave_up |= solution.status == Status::NotConverged;
            means.add(&mut solution, sample);
        }
        Ok(Outcome::Reached(Reached { values: means.values(), seconds: means.seconds(), gave_up }))
    }
}
