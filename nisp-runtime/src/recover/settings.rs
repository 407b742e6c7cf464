//! What a user may choose about a run.

use std::time::Duration;

use crate::engine::Resampling;
use crate::local::{Local, Patches};
use crate::network::{Architecture, Inputs};
use crate::noise::Noise;
use crate::schema;
use crate::solve::lbfgs;

/// How a problem is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Element type of the network.
    pub precision: Width,
    /// Method of minimisation.
    pub optimizer: Optimizer,
    /// Shape of the network.
    pub architecture: Architecture,
    /// What carries the heads.
    pub carrier: Carrier,
    /// Points of equations drawn anew where the equations are most off, of a network; otherwise all are used always.
    pub resampling: Option<Resampling>,
    /// How many times longer than that of the equations the gradient of the data is at first, at least, for Adam: data are
    /// regressed first, and the source is solved for then (paper, section 3.2).
    pub data_first: f64,
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
            precision: Width::Auto,
            optimizer: Optimizer::Auto,
            architecture: Architecture { inputs: Inputs::Automatic, ..Architecture::modified(16, 2) },
            carrier: Carrier::Auto,
            resampling: None,
            data_first: 50.0,
            seed: 0,
            budget: Some(Duration::from_secs(10)),
            iterations: None,
            threads: 0,
        }
    }
}

/// What carries the heads of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    /// Splines where they can carry the scene and something is measured, else a network.
    Auto,
    /// A network.
    Network,
    /// Splines over the only coordinate, or on a lattice over several.
    Splines,
    /// Splines on a lattice of cells for sources with edges, over two or three coordinates.
    Local(Local),
}

impl Carrier {
    /// The prior of patches, of sources that may act anywhere in the domain.
    pub(super) fn patches_everywhere(&self, scene: &schema::Scene) -> Option<Patches> {
        match self {
            Self::Local(local) if local.source_dimensions == scene.coordinates.len() => local.patches,
            _ => None,
        }
    }
}

/// Width of the element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Single as long as its gradient is good, and then double, with methods that work in both and scenes that are compiled
    /// in both; else double.
    Auto,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl Width {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Auto, Self::F32, Self::F64];

    /// Name as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// The choice of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|width| width.name() == name)
    }
}

/// Methods of minimisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimizer {
    /// For small networks self-scaled Broyden where data are exact and evidence where they are noisy; for wide ones whichever
    /// of L-BFGS and Gauss-Newton gets further in a short trial.
    Auto,
    /// First order, with the paper's schedule and loss weights.
    Adam,
    /// Limited-memory BFGS.
    Lbfgs,
    /// Self-scaled Broyden, dense.
    Broyden,
    /// Levenberg-Marquardt with a fixed weak prior.
    Marquardt,
    /// The same, with the weights of heads that enter linearly solved for at every step: variable projection.
    Projection,
    /// Gauss-Newton by conjugate gradients, without matrices, with a fixed weak prior.
    GaussNewton,
    /// Levenberg-Marquardt with prior and noise chosen by the evidence.
    Evidence,
}

impl Optimizer {
    /// Every method, by name.
    pub const ALL: [Self; 8] = [
        Self::Auto,
        Self::Adam,
        Self::Lbfgs,
        Self::Broyden,
        Self::Marquardt,
        Self::Projection,
        Self::GaussNewton,
        Self::Evidence,
    ];

    /// Name as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Adam => "adam",
            Self::Lbfgs => "lbfgs",
            Self::Broyden => "broyden",
            Self::Marquardt => "lm",
            Self::Projection => "varpro",
            Self::GaussNewton => "gauss-newton",
            Self::Evidence => "evidence",
        }
    }

    /// The method of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|optimizer| optimizer.name() == name)
    }

    /// True if it can be tried in single precision.
    pub fn works_in_single(self) -> bool {
        matches!(self, Self::Auto | Self::Adam | Self::Lbfgs)
    }

    /// True if its rows are divided by their standard deviations, and not just by their sizes.
    pub(super) fn counts_noise(self) -> bool {
        matches!(self, Self::Marquardt | Self::Projection | Self::GaussNewton | Self::Evidence)
    }

    /// What `Auto` may stand for, given the data and the number of parameters.
    pub(super) fn candidates(self, noise: &Noise, parameters: usize, rows: usize, single: bool) -> Vec<Self> {
        let fast = |optimizer: Self| 3 * parameters <= MOST_DENSE && optimizer.fits(parameters, rows);
        match self {
            Self::Auto if single => vec![Self::Lbfgs],
            Self::Auto if noise.is_exact() && fast(Self::Broyden) => vec![Self::Broyden],
            Self::Auto if !noise.is_exact() && fast(Self::Evidence) => vec![Self::Evidence],
            Self::Auto => vec![Self::Lbfgs, Self::GaussNewton],
            chosen => vec![chosen],
        }
    }

    /// Steps that say whether a method gets anywhere; about as costly for each.
    pub(super) fn steps_of_a_trial(self) -> usize {
        match self {
            Self::GaussNewton => 2,
            _ => 100,
        }
    }

    /// Bytes that the method's vectors and matrices take, about.
    pub(super) fn bytes(self, parameters: usize, rows: usize) -> f64 {
        /// Vectors of a few methods that keep few, and gradients of a step's chunks.
        const VECTORS: f64 = 32.0;
        let (parameters, rows) = (parameters as f64, rows as f64);
        let numbers = match self {
            Self::Adam | Self::GaussNewton => VECTORS * parameters,
            Self::Auto | Self::Lbfgs => (VECTORS + 2.0 * lbfgs::MEMORY as f64) * parameters,
            Self::Broyden => (VECTORS + parameters) * parameters,
            // The rows' derivatives, the normal matrix and its factor.
            Self::Marquardt | Self::Projection | Self::Evidence => (VECTORS + rows + 2.0 * parameters) * parameters,
        };
        size_of::<f64>() as f64 * numbers
    }

    /// Whether the method's matrices can be worked with.
    pub(super) fn fits(self, parameters: usize, rows: usize) -> bool {
        match self {
            Self::Adam | Self::Lbfgs | Self::GaussNewton => true,
            Self::Auto | Self::Broyden => parameters <= MOST_DENSE,
            Self::Marquardt | Self::Projection | Self::Evidence => {
                parameters <= MOST_DENSE && parameters.saturating_mul(rows) <= MOST_DERIVATIVES
            }
        }
    }
}

/// Side of the largest matrix that a step or an error bar may factorise: a gigabyte, and seconds.
const MOST_DENSE: usize = 12_000;
/// Derivatives of all rows by all parameters, at most: four gigabytes.
const MOST_DERIVATIVES: usize = 500_000_000;
