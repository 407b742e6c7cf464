//! The network: its architecture, where its parameters live, and the working form of its weights.

mod cost;
mod init;
mod inputs;
mod layout;
mod weights;

pub use crate::activation::Activation;
pub use cost::Cost;
pub use init::initialise;
pub use inputs::{Fourier, Inputs, Stretched};

pub(crate) use init::normal;
pub use layout::{Layout, Matrix};
pub use weights::Weights;
pub(crate) use weights::{Mapping, ProductAdjoint, multiply};

/// The shape of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Architecture {
    /// Gated or plain.
    pub kind: Kind,
    /// Hidden units of a layer.
    pub width: usize,
    /// Layers: one on the coordinates, the others hidden.
    pub layers: usize,
    /// Weight matrices as `diag(exp s) V` (random weight factorisation).
    pub factorised: bool,
    /// What the first layer and the gates see of the coordinates.
    pub inputs: Inputs,
    /// What the units do.
    pub activation: Activation,
}

/// How a hidden layer ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The modified MLP: `z = c * z' + d * (1 - z')` with gates `c` and `d` (paper, section 3.1).
    Modified,
    /// `z = z'`
    Plain,
}

impl Architecture {
    /// The gated network of a given size, of tanh on the plain coordinates, without factorisation.
    pub fn modified(width: usize, layers: usize) -> Self {
        let (inputs, activation) = (Inputs::Coordinates, Activation::Tanh);
        Self { kind: Kind::Modified, width, layers, factorised: false, inputs, activation }
    }

    /// The plain network of a given size.
    pub fn plain(width: usize, layers: usize) -> Self {
        Self { kind: Kind::Plain, ..Self::modified(width, layers) }
    }

    /// Number of gates: two or none.
    pub(crate) fn gates(&self) -> usize {
        match self.kind {
            Kind::Modified => 2,
            Kind::Plain => 0,
        }
    }
}
