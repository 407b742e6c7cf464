//! An iterate, and that as plain numbers.

use crate::shared_noise::Alike;
use crate::solve::fault::Fault;
use crate::solve::state;
use crate::weighed::{Class, restore_classes, save_classes};

/// Kinds of noise that rows may share, by their numbers in saved states.
const SHARING: [Alike; 2] = [Alike::Rough, Alike::Smooth];

/// An iterate.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) theta: Vec<f64>,
    pub(super) learned: Vec<f64>,
    /// The numbers of the lines that sources keep near to, source by source.
    pub(super) lines: Vec<f64>,
    pub(super) classes: Vec<Class>,
    /// By source and function, how rough the source is there beside its mean; empty where it is as rough all along.
    pub(super) uneven: Vec<f64>,
    /// What the logarithm of the evidence loses for that: one roughness all along is likelier before any measurement.
    pub(super) doubt: f64,
    /// Whether equations may be missed by as much as the noise of their columns puts them off.
    pub(super) blurred: bool,
    /// How the noise that neighbouring rows of an observation share changes; nothing where each row has its own.
    pub(super) sharing: Option<Alike>,
    /// Tolerance of the equations.
    pub(super) tolerance: f64,
    /// Whether losses that leave out what is far off are still convex ones in their place.
    pub(super) convex: bool,
    /// Whether learned scalars stay near their start, until sources beside them have found their sizes.
    pub(super) held: bool,
    pub(super) step: u64,
}

/// What the rows of a step are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// Data under a prior of the fields' roughness.
    Regress,
    /// Everything under a prior of the sources' roughness.
    Solve,
}

impl State {
    /// Unknowns that all rows share: learned scalars and the numbers of lines.
    pub(super) fn shared(&self) -> usize {
        self.learned.len() + self.lines.len()
    }

    /// Which of the assumptions that are tried beside kinds of smoothness hold.
    pub(super) fn sort(&self) -> (bool, Option<Alike>) {
        (self.blurred, self.sharing)
    }

    pub(super) fn save(&self, saved: state::State, prefix: &str) -> state::State {
        save_classes(&self.classes, saved, prefix)
            .with(&format!("{prefix}theta"), &self.theta)
            .with(&format!("{prefix}learned"), &self.learned)
            .with(&format!("{prefix}lines"), &self.lines)
            .with(&format!("{prefix}uneven"), &self.uneven)
            .with(&format!("{prefix}doubt"), &[self.doubt])
            .with(&format!("{prefix}tolerance"), &[self.tolerance])
            .with_counter(&format!("{prefix}blurred"), u64::from(self.blurred))
            .with_counter(&format!("{prefix}sharing"), self.sharing.map_or(0, |own| 1 + own as u64))
            .with_counter(&format!("{prefix}convex"), u64::from(self.convex))
            .with_counter(&format!("{prefix}held"), u64::from(self.held))
            .with_counter(&format!("{prefix}step"), self.step)
    }

    /// Takes over what [`State::save`] gave of the same problem.
    pub(super) fn restore(&mut self, saved: &state::State, prefix: &str) -> Result<(), Fault> {
        restore_classes(&mut self.classes, saved, prefix)?;
        self.theta = saved.sized(&format!("{prefix}theta"), self.theta.len())?;
        self.learned = saved.sized(&format!("{prefix}learned"), self.learned.len())?;
        self.lines = saved.sized(&format!("{prefix}lines"), self.lines.len())?;
        self.uneven = saved.vector(&format!("{prefix}uneven"))?.to_vec();
        [self.doubt] = saved.scalars(&format!("{prefix}doubt"))?;
        [self.tolerance] = saved.scalars(&format!("{prefix}tolerance"))?;
        self.blurred = saved.counter(&format!("{prefix}blurred"))? == 1;
        self.sharing = match saved.counter(&format!("{prefix}sharing"))? {
            0 => None,
            number => Some(*SHARING.get(number as usize - 1).ok_or_else(|| Fault::state("sharing"))?),
        };
        self.convex = saved.counter(&format!("{prefix}convex"))? == 1;
        self.held = saved.counter(&format!("{prefix}held"))? == 1;
        self.step = saved.counter(&format!("{prefix}step"))?;
        Ok(())
    }
}
