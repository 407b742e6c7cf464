//! The network: its architecture, where its parameters live, and the working form of its weights.

mod init;
mod layout;
mod weights;

pub use init::initialise;
use rand::{SeedableRng, rngs::StdRng};

#[cfg(test)]
pub(crate) use init::normal;
pub use layout::{Layout, Matrix};
pub use weights::Weights;
pub(crate) use weights::{ProductAdjoint, multiply};

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
    /// A random Fourier mapping of the coordinates ahead of the first layer.
    pub fourier: Option<Fourier>,
}

/// How a hidden layer ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The modified MLP: `z = c * z' + d * (1 - z')` with gates `c` and `d` (paper, section 3.1).
    Modified,
    /// `z = z'`
    Plain,
}

/// Random Fourier features: cosines, then sines, of `frequencies` random projections of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fourier {
    /// Number of projections; there are twice as many features.
    pub frequencies: usize,
    /// Standard deviation of the projections, in radians per half the domain.
    pub deviation: f64,
}

impl Fourier {
    /// The projections, `[projection][coordinate]`: normal numbers that depend on nothing but these settings.
    pub fn projections(&self, coordinates: usize) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(0);
        (0..self.frequencies * coordinates).map(|_| self.deviation * init::normal(&mut random)).collect()
    }
}

impl Architecture {
    /// The gated network of a given size, without factorisation or Fourier mapping.
    pub fn modified(width: usize, layers: usize) -> Self {
        Self { kind: Kind::Modified, width, layers, factorised: false, fourier: None }
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
