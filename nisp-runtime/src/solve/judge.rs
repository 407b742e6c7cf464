//! Judges from the steps of a run whether it has converged, or will not.

use super::fault::Fault;
use super::method::{Step, Verdict};
use super::outcome::{Limits, Warning, WarningKind};
use super::state::State;

/// What to do after a step; the numbers are those of saved states.
#[derive(Clone, Copy)]
pub(crate) enum Judgement {
    GoOn = 0,
    Converged = 1,
    GiveUp = 2,
}

/// Steps that must agree before a run counts as converged.
const AGREEING: u64 = 3;
/// Steps that the decrease of the loss is measured over.
const WINDOW: usize = 10;
/// The same for methods without a model of curvature, whose steps are many and small.
const LONG_WINDOW: usize = 200;

/// What has been seen so far.
pub(crate) struct Judge {
    limits: Limits,
    /// Steps between the changes of the method's schedule, if it has one.
    period: Option<u64>,
    precision: &'static str,
    epsilon: f64,
    /// Losses of the last steps, in a ring.
    losses: Vec<f64>,
    seen: usize,
    first_gradient: Option<f64>,
    /// Decrement of the last step that moved: a method at its wits' end has forgotten the curvature.
    decrement: Option<f64>,
    agreeing: u64,
    best: f64,
    since_best: u64,
    /// Refused or exhausted steps in a row.
    stuck: u64,
    /// The judgement of the last step.
    judgement: Judgement,
}

impl Judge {
    pub(crate) fn new(limits: Limits, period: Option<u64>, precision: &'static str, epsilon: f64) -> Self {
        Self {
            limits,
            period,
            precision,
            epsilon,
            losses: Vec::new(),
            seen: 0,
            first_gradient: None,
            decrement: None,
            agreeing: 0,
            best: f64::INFINITY,
            since_best: 0,
            stuck: 0,
            judgement: Judgement::GoOn,
        }
    }

    /// What to do next.
    pub(crate) fn judgement(&self) -> Judgement {
        self.judgement
    }

    pub(crate) fn judge(&mut self, step: &Step) {
        self.judgement = match step.verdict {
            Verdict::Changed => self.forget(),
            Verdict::Exhausted => self.exhausted(step),
            Verdict::Faulty(_) | Verdict::Refused => self.refused(),
            Verdict::Moved => self.moved(step),
        };
    }

    /// The function has changed: what was seen is of no use.
    fn forget(&mut self) -> Judgement {
        (self.seen, self.agreeing, self.since_best, self.stuck) = (0, 0, 0, 0);
        self.best = f64::INFINITY;
        (self.first_gradient, self.decrement) = (None, None);
        Judgement::GoOn
    }

    fn refused(&mut self) -> Judgement {
        self.stuck += 1;
        if self.stuck > self.limits.patience { Judgement::GiveUp } else { Judgement::GoOn }
    }

    /// The method sees no way on: that is convergence where rounding is all that is left.
    fn exhausted(&mut self, step: &Step) -> Judgement {
        self.stuck += 1;
        // In single precision rounding is no answer: double precision would go on.
        let rounding = if self.precision == "f32" { 0.0 } else { 1e3 * self.epsilon };
        let left = self.decrement.or(step.decrement).unwrap_or(0.0);
        if left <= self.limits.tolerance.max(rounding) * step.loss {
            Judgement::Converged
        } else if self.stuck < 3 {
            Judgement::GoOn
        } else {
            Judgement::GiveUp
        }
    }

    fn moved(&mut self, step: &Step) -> Judgement {
        self.stuck = 0;
        self.decrement = step.decrement;
        let tolerance = self.limits.tolerance;
        let window = if step.decrement.is_some() { WINDOW } else { LONG_WINDOW };
        self.losses.resize(window, 0.0);
        let earlier = std::mem::replace(&mut self.losses[self.seen % window], step.loss);
        self.seen += 1;
        let first_gradient = *self.first_gradient.get_or_insert(step.gradient_norm);
        let flat = match self.period {
            // At a constant rate the loss goes up and down.
            Some(period) => self.since_best >= period.max(LONG_WINDOW as u64),
            None => self.seen > window && earlier - step.loss <= tolerance * step.loss,
        };
        let close = match step.decrement {
            Some(decrement) => decrement <= tolerance * step.loss,
            // Without curvature, a gradient that has all but vanished must do.
            None => step.gradient_norm <= tolerance.sqrt() * first_gradient,
        };
        self.agreeing = if flat && close { self.agreeing + 1 } else { 0 };
        if step.loss <= self.limits.floor || self.agreeing >= AGREEING {
            return Judgement::Converged;
        }
        if step.loss < self.best * (1.0 - tolerance) {
            (self.best, self.since_best) = (step.loss, 0);
        } else {
            self.since_best += 1;
        }
        if self.since_best <= self.patience(step) {
            Judgement::GoOn
        } else if close && step.decrement.is_some() {
            // There is no way on, and by the model's word nothing at its end.
            Judgement::Converged
        } else {
            Judgement::GiveUp
        }
    }

    /// Steps without progress after which there will be none. Steps of a constant rate end on a plateau whose height is the
    /// rate's: that says nothing until the schedule has lowered it, and lowered it again.
    fn patience(&self, step: &Step) -> u64 {
        let patience = self.limits.patience.saturating_mul(if step.decrement.is_some() { 1 } else { 10 });
        self.period.map_or(patience, |period| patience.max(period.saturating_mul(2)))
    }

    /// Adds itself to the state of the method.
    pub(crate) fn save(&self, method: State) -> State {
        method
            .with("judged losses", &self.losses)
            .with("first gradient", finite(self.first_gradient).as_slice())
            .with("last decrement", finite(self.decrement).as_slice())
            .with("judged best", finite(Some(self.best)).as_slice())
            .with_counter("seen", self.seen as u64)
            .with_counter("agreeing", self.agreeing)
            .with_counter("since best", self.since_best)
            .with_counter("stuck", self.stuck)
            .with_counter("judgement", self.judgement as u64)
    }

    /// Goes on from a saved state.
    pub(crate) fn restore(&mut self, state: &State) -> Result<(), Fault> {
        let optional = |name: &str| Ok(state.vector(name)?.first().copied());
        self.losses = state.vector("judged losses")?.to_vec();
        self.first_gradient = optional("first gradient")?;
        self.decrement = optional("last decrement")?;
        self.best = optional("judged best")?.unwrap_or(f64::INFINITY);
        self.seen = state.counter("seen")? as usize;
        self.agreeing = state.counter("agreeing")?;
        self.since_best = state.counter("since best")?;
        self.stuck = state.counter("stuck")?;
        self.judgement = match state.counter("judgement")? {
            0 => Judgement::GoOn,
            1 => Judgement::Converged,
            2 => Judgement::GiveUp,
            _ => return Err(Fault::state("judgement")),
        };
        Ok(())
    }

    /// Why it gives up.
    pub(crate) fn warning(&self) -> Warning {
        let (kind, message) = if self.precision == "f32" {
            let message = "the loss no longer falls: the accuracy of f32 is reached; go on in f64";
            (WarningKind::SinglePrecision, message)
        } else {
            let message = "the loss no longer falls, but the gradient is not small; try another optimizer or seed, \
                a wider network, or weights of the terms closer to each other";
            (WarningKind::Stagnation, message)
        };
        Warning { kind, message: message.into() }
    }
}

/// States hold finite numbers only; what is infinite is as good as not known.
fn finite(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.is_finite())
}
