//! An iterate, and that as plain numbers.

use super::freedom::Unmeasured;
use crate::solve::fault::Fault;
use crate::solve::state;
use crate::weighed::{Class, restore_classes, save_classes};

/// Steps that regress the data at most.
pub(super) const REGRESS: u64 = 6;

/// What the rows of a step are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// Data and conditions on values under a prior of all heads' roughness.
    Regress,
    /// Everything, while the prior lets fields go, with the noise that the regression found: what a source does not explain yet
    /// is no noise.
    Explain,
    /// The same, with noise as free as the rest.
    Solve,
}

impl Phase {
    const ALL: [Self; 3] = [Self::Regress, Self::Explain, Self::Solve];

    /// Whether equations take part.
    pub(super) fn has_equations(self) -> bool {
        self != Self::Regress
    }

    /// The phase after this one.
    pub(super) fn next(self) -> Self {
        if self == Self::Regress { Self::Explain } else { Self::Solve }
    }
}

/// An iterate.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) theta: Vec<f64>,
    pub(super) learned: Vec<f64>,
    pub(super) classes: Vec<Class>,
    /// Tolerance of the equations.
    pub(super) tolerance: f64,
    /// The tolerance that the steps end with.
    pub(super) strictest: f64,
    /// Whether losses that leave out what is far off are still convex ones in their place.
    pub(super) convex: bool,
    pub(super) phase: Phase,
    /// Steps, and those of the phase.
    pub(super) step: u64,
    pub(super) since: u64,
    /// What equations settle by themselves, as it was counted last.
    pub(super) unmeasured: Unmeasured,
    /// What an earlier start ended at.
    pub(super) earlier: Option<Box<Ended>>,
}

/// Where a start ended, and the logarithm of its evidence.
#[derive(Clone, Debug)]
pub(super) struct Ended {
    pub(super) state: State,
    pub(super) evidence: f64,
}

/// What the names of an earlier start begin with in a saved state.
const EARLIER: &str = "earlier ";

impl State {
    /// What is known of noise and roughness, without how it was found.
    pub(super) fn known(&self) -> Vec<Class> {
        let mut classes = self.classes.clone();
        classes.iter_mut().for_each(|class| class.restart(class.size));
        classes
    }

    pub(super) fn save(&self) -> state::State {
        let saved = self.save_as("", state::State::new(super::METHOD));
        let saved = saved.with_counter("starts", 1 + u64::from(self.earlier.is_some()));
        self.earlier.iter().fold(saved, |saved, earlier| {
            let saved = saved.with(&format!("{EARLIER}evidence"), &[earlier.evidence]);
            earlier.state.save_as(EARLIER, saved)
        })
    }

    fn save_as(&self, prefix: &str, saved: state::State) -> state::State {
        let name = |name: &str| format!("{prefix}{name}");
        save_classes(&self.classes, saved, prefix)
            .with(&name("theta"), &self.theta)
            .with(&name("learned"), &self.learned)
            .with(&name("unmeasured"), &self.unmeasured.numbers())
            .with(&name("tolerance"), &[self.tolerance, self.strictest])
            .with_counter(&name("convex"), u64::from(self.convex))
            .with_counter(&name("phase"), self.phase as u64)
            .with_counter(&name("iterations"), self.step)
            .with_counter(&name("since"), self.since)
    }

    /// Takes over what [`State::save`] gave of the same problem.
    pub(super) fn restore(&mut self, saved: &state::State) -> Result<(), Fault> {
        saved.check_method(super::METHOD)?;
        if saved.counter("starts")? > 1 {
            let mut state = self.clone();
            state.restore_as(EARLIER, saved)?;
            let [evidence] = saved.scalars(&format!("{EARLIER}evidence"))?;
            self.earlier = Some(Box::new(Ended { state, evidence }));
        }
        self.restore_as("", saved)
    }

    fn restore_as(&mut self, prefix: &str, saved: &state::State) -> Result<(), Fault> {
        let name = |name: &str| format!("{prefix}{name}");
        restore_classes(&mut self.classes, saved, prefix)?;
        self.theta = saved.sized(&name("theta"), self.theta.len())?;
        self.learned = saved.sized(&name("learned"), self.learned.len())?;
        self.unmeasured = Unmeasured::from_numbers(saved.vector(&name("unmeasured"))?);
        [self.tolerance, self.strictest] = saved.scalars(&name("tolerance"))?;
        self.convex = saved.counter(&name("convex"))? == 1;
        let number = saved.counter(&name("phase"))?;
        let phase = Phase::ALL.into_iter().find(|&phase| phase as u64 == number);
        self.phase = phase.ok_or_else(|| Fault::state("phase"))?;
        (self.step, self.since) = (saved.counter(&name("iterations"))?, saved.counter(&name("since"))?);
        Ok(())
    }
}
