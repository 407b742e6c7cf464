//! Values in double precision beside derivatives in single.
//!
//! Derivatives are taken at the layers' values, and a saturated network multiplies what these lose to rounding by thousands
//! at sixth order; what derivatives lose themselves it multiplies by ten. So where single precision would not do
//! ([`Real::HIGHEST_ORDER`]), values go through the network in double precision first, with as many operations as two
//! channels more on the way there, and layers begin with the activations and slopes that are found so.

use super::buffers::Buffers;
use super::reading;
use super::tile::{Network, Tile};
use crate::layer::Shape;
use crate::real::Real;

impl<E: Real> Network<'_, E> {
    /// The values of all layers at the points of a tile.
    pub(super) fn doubled_values(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<f64>) {
        let Self { isa, layout, weights, .. } = *self;
        let weights = weights.doubled().expect("kept where layers take values");
        let layers = reading::values(layout.inputs).expect("layers take values over few coordinates only");
        tile.group.doubled.as_ref().expect("kept where layers take values").load(tile, buffers);
        Network { isa, layout, weights, scalars: &[] }.layers(layers, tile.shape(layout), buffers, None);
    }
}

/// Rounds the row of each point into rows of which every `distance`-th is one's own.
pub(super) fn round_rows<E: Real>(shape: Shape, from: &[f64], to: &mut [E], distance: usize) {
    for (from, to) in from.chunks_exact(shape.ld).zip(to.chunks_exact_mut(distance * shape.ld)).take(shape.points) {
        to[..shape.width].iter_mut().zip(from).for_each(|(to, from)| *to = E::from_f64(*from));
    }
}
