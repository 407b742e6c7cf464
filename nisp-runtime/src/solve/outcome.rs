//! When a run ends, how it ended, and what its user should know.

use super::fault::Fault;
use super::state::State;
use std::time::Duration;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Wall time; one step is taken even where it is spent.
    pub budget: Option<Duration>,
    /// Steps.
    pub iterations: u64,
    /// Estimated distance of the loss from its minimum, relative to the loss, at which the answer counts as converged.
    pub tolerance: f64,
    /// Loss at which the answer counts as converged, however far the minimum is: for exact data, whose minimum is zero.
    pub floor: f64,
    /// Steps without an improvement of the best loss by more than `tolerance` after which the method is given up; ten
    /// times as many for methods without a model of curvature, and two periods of a schedule at least.
    pub patience: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { budget: None, iterations: u64::MAX, tolerance: 1e-6, floor: 0.0, patience: 100 }
    }
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The loss is as close to its minimum as was asked for.
    Converged,
    /// Time or steps are spent.
    Budget,
    /// The method cannot go on; the warnings say why.
    NotConverged,
    /// The monitor said so.
    Interrupted,
    /// The method ended at a minimum, and what is left of the equations, conditions or data says that it is not the answer.
    Inconsistent,
}

impl Status {
    /// In files and for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Budget => "budget",
            Self::NotConverged => "not_converged",
            Self::Interrupted => "interrupted",
            Self::Inconsistent => "inconsistent",
        }
    }
}

/// The end of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<E> {
    /// Why it ended.
    pub status: Status,
    /// The iterate with the least loss.
    pub theta: Vec<E>,
    /// Its loss.
    pub loss: f64,
    /// Steps taken.
    pub iterations: u64,
    /// Evaluations of the objective.
    pub evaluations: u64,
    /// Seconds.
    pub wall_s: f64,
    /// What a user should know, each with a remedy.
    pub warnings: Vec<Warning>,
    /// Where the run stopped, for [`resume`](super::driver::resume).
    pub state: State,
}

/// Something that a user should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// The kind of the warning, for programs.
    pub kind: WarningKind,
    /// One sentence, and a remedy.
    pub message: String,
}

impl Warning {
    /// No error bars, since the budget went before they were found.
    pub(crate) fn no_bars() -> Self {
        let message = "no time was left for error bars; give a larger budget".into();
        Self { kind: WarningKind::NoBars, message }
    }

    /// Rows of an observation that share noise over a length.
    pub(crate) fn shared_noise(name: &str, length: &str) -> Self {
        let message = format!(
            "neighbouring rows of `{name}` share noise, which dies away over {length}: its sensor drifts, is slow, or was filtered; error \
             bars count it, but where the sensor lags behind, so does the answer"
        );
        Self { kind: WarningKind::SharedNoise, message }
    }

    /// Noise of an observation that goes with its level, or is larger in a part of a record: so much of it at its least and largest.
    pub(crate) fn uneven_noise(name: &str, [least, largest]: [&str; 2]) -> Self {
        let message = format!(
            "the noise of `{name}` is not alike everywhere, from {least} to {largest}: each value counts by how noisy it is"
        );
        Self { kind: WarningKind::UnevenNoise, message }
    }

    /// Values that are left out, since they stand alone, in place of what a robust loss left out together.
    pub(crate) fn left_out(name: &str, count: usize) -> Self {
        let message = format!(
            "a robust loss left out neighbouring values of `{name}` together, as none that are outliers: only values that stand alone \
             were left out instead, {count} of them"
        );
        Self { kind: WarningKind::LeftOut, message }
    }

    /// Points of a cloud that are left out, since they stand alone.
    pub(crate) fn alone(name: &str, count: usize) -> Self {
        let message = format!(
            "{count} {} of `{name}` {} far from all others: a cloud is dense where it shows a surface, so what is alone is left out",
            if count == 1 { "point" } else { "points" },
            if count == 1 { "is" } else { "are" }
        );
        Self { kind: WarningKind::LeftOut, message }
    }

    /// Conditions of groups that contradict each other where they meet.
    pub(crate) fn clash(groups: &str) -> Self {
        let message = format!(
            "conditions of {groups} contradict each other where they meet, as where a wall is suddenly heated: near there they and the \
             equations hold in the mean over cells"
        );
        Self { kind: WarningKind::Clash, message }
    }

    /// Places where fields are singular.
    pub(crate) fn singular(places: &str) -> Self {
        let message = format!(
            "fields are not smooth about {places}, where the domain has a corner that points inwards or a part of a side with a given value \
             ends: equations are not asked within two or three cells of the lattice there, and a source is what it is farther away, continued"
        );
        Self { kind: WarningKind::Singular, message }
    }

    /// A head that comes in as a square does: either sign fits.
    pub(crate) fn open_sign(name: &str) -> Self {
        let message = format!(
            "`{name}` comes in as a square does, so that the data do not say which sign it has: if it has one only, declare it \
             (`{name} >= 0`)"
        );
        Self { kind: WarningKind::Undetermined, message }
    }
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

/// Kinds of [`Warning`].
#[derive(Debug, Clone, PartialEq)]
pub enum WarningKind {
    /// A step was refused because of a fault; the run went on unless it is the last.
    Fault(Fault),
    /// The loss no longer falls, though the method expects it to.
    Stagnation,
    /// The accuracy of single precision is reached.
    SinglePrecision,
    /// Data or an equation that the network does not follow, or data that it follows into their noise.
    Unresolved,
    /// Something that was not looked at, because the budget was spent.
    OutOfTime,
    /// Error bars that the carrier cannot give.
    NoBars,
    /// Noise that neighbouring rows of an observation share.
    SharedNoise,
    /// Noise of an observation that is larger where more is measured.
    UnevenNoise,
    /// Values that stand alone, left out in place of what a robust loss left out, or points of a cloud that do.
    LeftOut,
    /// Conditions that contradict each other where they meet.
    Clash,
    /// Places where no smooth field meets the conditions, though they agree.
    Singular,
    /// A direction of the answer that neither equations nor data determine.
    Undetermined,
    /// A condition that the answer rests on: the data alone would leave a direction open.
    Settled,
}
