//! How the network stands to coordinates and heads.

/// Affine maps from network outputs to the engine's units, and the coordinates' scales.
#[derive(Clone, Debug)]
pub struct Scaling {
    /// For each coordinate, the middle of its domain in the engine's units.
    pub centre: Vec<f64>,
    /// For each coordinate, half the extent of its domain in the engine's units (shared within a scale group).
    pub half: Vec<f64>,
    /// For each head, what a network output of zero stands for.
    pub offset: Vec<f64>,
    /// For each head, what a change of one in the network's output stands for.
    pub scale: Vec<f64>,
}
