//! Values in double precision beside derivatives in single.
//!
//! Derivatives are taken at the layers' values, and a saturated network multiplies what these lose to rounding by thousands
//! at sixth order; what derivatives lose themselves it multiplies by ten. So where single precision would not do
//! ([`Real::ORDERS`]), values go through the network in double precision first, at the cost of two channels more on the way
//! there, and layers begin with the activations and slopes that are found so.

use super::buffers::Buffers;
use super::reading;
use super::tile::{Network, Tile};
use crate::layer::Shape;
use crate::real::Real;

impl<E: Real> Network<'_, E> {
    /// The values of all layers at the points of a tile.
    pub(super) fn doubled_values(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<f64>) {
        let Self { isa, layout, weights, .. } = *self;
        let (Some(weights), Some(layers)) = (weights.doubled(), reading::values(layout.inputs)) else { return };
        tile.load_coordinates(layout.inputs, &mut buffers.coordinates);
        Network { isa, layout, weights, scalars: &[] }.layers(layers, tile.shape(layout), buffers, None);
    }
}

/// Rounds what is known of every point's units to rows that are so many apart.
pub(super) fn give<E: Real>(shape: Shape, from: &[f64], to: &mut [E], distance: usize) {
    for (from, to) in from.chunks_exact(shape.ld).zip(to.chunks_exact_mut(distance * shape.ld)).take(shape.points) {
        to[..shape.width].iter_mut().zip(from).for_each(|(to, from)| *to = E::from_f64(*from));
    }
}
