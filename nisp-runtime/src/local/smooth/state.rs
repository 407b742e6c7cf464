//! An iterate, and that as plain numbers.

use crate::solve::fault::Fault;
use crate::solve::state;
use crate::weighed::{Class, restore_classes, save_classes};

/// What the rows of a step are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// Data and conditions on values under a prior of all heads' roughness.
    Regress,
    /// Everything, while the prior lets fields go.
    Solve,
}

/// An iterate.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) theta: Vec<f64>,
    pub(super) learned: Vec<f64>,
    pub(super) classes: Vec<Class>,
    /// Tolerance of the equations.
    pub(super) tolerance: f64,
    /// Whether losses that leave out what is far off are still convex ones in their place.
    pub(super) convex: bool,
    pub(super) phase: Phase,
    /// Steps, and those of the phase.
    pub(super) step: u64,
    pub(super) since: u64,
}

impl State {
    pub(super) fn save(&self) -> state::State {
        save_classes(&self.classes, state::State::new(super::METHOD), "")
            .with("theta", &self.theta)
            .with("learned", &self.learned)
            .with("tolerance", &[self.tolerance])
            .with_counter("convex", u64::from(self.convex))
            .with_counter("phase", u64::from(self.phase == Phase::Solve))
            .with_counter("iterations", self.step)
            .with_counter("since", self.since)
    }

    /// Takes over what [`State::save`] gave of the same problem.
    pub(super) fn restore(&mut self, saved: &state::State) -> Result<(), Fault> {
        saved.check_method(super::METHOD)?;
        restore_classes(&mut self.classes, saved, "")?;
        self.theta = saved.sized("theta", self.theta.len())?;
        self.learned = saved.sized("learned", self.learned.len())?;
        [self.tolerance] = saved.scalars("tolerance")?;
        self.convex = saved.counter("convex")? == 1;
        self.phase = if saved.counter("phase")? == 1 { Phase::Solve } else { Phase::Regress };
        (self.step, self.since) = (saved.counter("iterations")?, saved.counter("since")?);
        Ok(())
    }
}
