//! What a user may choose about a run.

use std::time::Duration;

use super::noise::Noise;
use crate::local::Local;
use crate::network::{Architecture, Inputs};

/// How a problem is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Element type of the network.
    pub precision: Width,
    /// Method of minimisation.
    pub optimizer: Optimizer,
    /// Shape of the network.
    pub architecture: Architecture,
    /// Local functions instead of a network.
    pub local: Option<Local>,
    /// Seed of the initial weights.
    pub seed: u64,
    /// Wall time, from the call to the answer.
    pub budget: Option<Duration>,
    /// Steps.
    pub iterations: Option<u64>,
    /// Threads; 0 for one per processor.
    pub threads: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            precision: Width::F64,
            optimizer: Optimizer::Auto,
            architecture: Architecture { inputs: Inputs::Automatic, ..Architecture::modified(16, 2) },
            local: None,
            seed: 0,
            budget: Some(Duration::from_secs(10)),
            iterations: None,
            threads: 0,
        }
    }
}

/// Width of the element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl Width {
    /// `f32` or `f64`.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// Methods of minimisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimizer {
    /// Self-scaled Broyden for exact data, Levenberg-Marquardt with evidence for noisy data.
    Auto,
    /// First order, with the paper's schedule and loss weights.
    Adam,
    /// Limited-memory BFGS.
    Lbfgs,
    /// Self-scaled Broyden, dense.
    Broyden,
    /// Levenberg-Marquardt with a fixed weak prior.
    Marquardt,
    /// Levenberg-Marquardt with prior and noise chosen by the evidence.
    Evidence,
}

impl Optimizer {
    /// Every method, by name.
    pub const ALL: [Self; 6] = [Self::Auto, Self::Adam, Self::Lbfgs, Self::Broyden, Self::Marquardt, Self::Evidence];

    /// Name as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Adam => "adam",
            Self::Lbfgs => "lbfgs",
            Self::Broyden => "broyden",
            Self::Marquardt => "lm",
            Self::Evidence => "evidence",
        }
    }

    /// The method of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|optimizer| optimizer.name() == name)
    }

    /// What `Auto` stands for, given the data and the number of parameters.
    pub(super) fn choose(self, noise: &Noise, parameters: usize, rows: usize) -> Self {
        let fast = |optimizer: Self| 3 * parameters <= MOST_DENSE && optimizer.fits(parameters, rows);
        match self {
            Self::Auto if noise.is_exact() && fast(Self::Broyden) => Self::Broyden,
            Self::Auto if !noise.is_exact() && fast(Self::Evidence) => Self::Evidence,
            Self::Auto => Self::Lbfgs,
            chosen => chosen,
        }
    }

    /// Whether the method's matrices can be worked with.
    pub(super) fn fits(self, parameters: usize, rows: usize) -> bool {
        match self {
            Self::Adam | Self::Lbfgs => true,
            Self::Auto | Self::Broyden => parameters <= MOST_DENSE,
            Self::Marquardt | Self::Evidence => {
                parameters <= MOST_DENSE && parameters.saturating_mul(rows) <= MOST_DERIVATIVES
            }
        }
    }
}

/// Side of the largest matrix that a step or an error bar may factorise: a gigabyte, and seconds.
const MOST_DENSE: usize = 12_000;
/// Derivatives of all rows by all parameters, at most: four gigabytes.
const MOST_DERIVATIVES: usize = 500_000_000;
