//! The element-wise work of a layer on a tile of points: activation, gate, and their adjoints.
//!
//! Rows are `[point][channel][unit]`, units contiguous, `ld` apart. Vectors run along the units, so weights that
//! differ per unit are loads and a point's channels stay in registers. Each forward kernel has its adjoint beside it.

mod affine;
mod features;
mod gate;
mod hidden;

pub use affine::{Affine, AffineAdjoint};
pub(crate) use affine::{AffineAdjointKernel, AffineKernel};
pub use features::{Features, Function, derivatives};
pub(crate) use features::{FeaturesKernel, tabulate};
pub(crate) use gate::{Ending, EndingAdjoint, GateAdjointKernel, GateKernel};
pub use gate::{Gate, GateAdjoint, Gated, GatedAdjoint};
pub use hidden::{Layer, LayerAdjoint};
pub(crate) use hidden::{LayerAdjointKernel, LayerKernel};

use crate::real::Real;
use crate::simd::{Isa, Simd};

/// Coordinates that there are layers of values over, at most: those are compiled in this crate.
pub(crate) const MOST_COORDINATES: usize = 4;

/// Shape of the rows of a tile.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Number of points.
    pub points: usize,
    /// Units, padded to whole vectors.
    pub width: usize,
    /// Distance between rows.
    pub ld: usize,
}

/// Distance between rows: whole cache lines, and no power of two, where rows would share few cache sets.
pub(crate) fn row_distance(width: usize) -> usize {
    if width.is_multiple_of(64) { width + 16 } else { width }
}

/// True if layers of these rules are given their activations and slopes: where derivatives are of a higher order than may be
/// taken at values of this precision, and there are layers of values over as many coordinates. Adjoints read one derivative
/// more than the order, and the first is the value.
///
/// `derivatives` counts those of the activation, its value included.
#[inline(always)]
pub const fn takes_values<E: Real>(derivatives: usize, coordinates: usize) -> bool {
    derivatives - 2 > E::HIGHEST_ORDER && coordinates <= MOST_COORDINATES
}

/// The rules of a group's hidden layers, erased: each method works on a tile.
pub trait Layers<E: Real>: Send + Sync {
    /// Number of channels of the hidden layers.
    fn channels(&self) -> usize;
    /// True if activations and their slopes are given instead of computed, for they are needed in a higher precision: whoever
    /// calls [`Layers::affine`] or [`Layers::layer`] has written them to where they are kept.
    fn takes_values(&self) -> bool;
    /// Channels of `phi(W x + b)`, with `phi` and its slope kept for the adjoint.
    fn affine(&self, isa: Isa, layer: Affine<'_, E>);
    /// Adjoint of [`Layers::affine`].
    fn affine_adjoint(&self, isa: Isa, layer: AffineAdjoint<'_, E>);
    /// Channels of fixed features of the coordinates.
    fn features(&self, isa: Isa, features: Features<'_, E>);
    /// A hidden layer after its matrix product; `last` delivers only the channels that heads read, if there is a gate.
    fn layer(&self, isa: Isa, layer: Layer<'_, E>, gate: Option<Gate<'_, E>>, last: bool);
    /// Adjoint of [`Layers::layer`]. Without a gate it reads the seeds of all channels.
    fn layer_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: Option<GateAdjoint<'_, E>>, last: bool);
    /// The gate alone, after an affine layer.
    fn gate(&self, isa: Isa, layer: Gated<'_, E>);
    /// Adjoint of [`Layers::gate`].
    fn gate_adjoint(&self, isa: Isa, layer: GatedAdjoint<'_, E>);
}

impl Shape {
    /// Checks that a buffer holds rows for `channels` channels.
    #[inline(always)]
    pub(crate) fn holds<E>(&self, rows: &[E], channels: usize) {
        assert!(self.width <= self.ld && rows.len() >= self.points * channels * self.ld, "tile buffer too small");
    }
}

#[inline(always)]
unsafe fn load_channels<V: Simd, const K: usize>(p: *const V::Elem, ld: usize) -> [V; K] {
    let mut channels = [V::splat(V::Elem::ZERO); K];
    for (k, channel) in channels.iter_mut().enumerate() {
        // SAFETY: the caller vouches for K rows.
        *channel = unsafe { V::load(p.add(k * ld)) };
    }
    channels
}

#[inline(always)]
unsafe fn load_read<V: Simd, const K: usize>(p: *const V::Elem, ld: usize, read: &[bool; K]) -> [V; K] {
    let mut channels = [V::splat(V::Elem::ZERO); K];
    for (k, channel) in channels.iter_mut().enumerate() {
        if read[k] {
            // SAFETY: the caller vouches for K rows.
            *channel = unsafe { V::load(p.add(k * ld)) };
        }
    }
    channels
}

/// Writes the channels that are read.
///
/// # Safety
/// There are K rows from `p` on.
#[inline(always)]
unsafe fn store_read<V: Simd, const K: usize>(channels: &[V; K], p: *mut V::Elem, ld: usize, read: &[bool; K]) {
    for (k, channel) in channels.iter().enumerate() {
        if read[k] {
            // SAFETY: the caller vouches for K rows.
            unsafe { channel.store(p.add(k * ld)) };
        }
    }
}
