//! Values in double precision beside derivatives in single.
//!
//! Derivatives are taken at the layers' values, and a saturated network multiplies what these lose to rounding by thousands
//! at sixth order; what derivatives lose themselves it multiplies by ten. So where single precision would not do
//! ([`Real::HIGHEST_ORDER`]), values go through the network in double precision first, with as many operations as two
//! channels more on the way there, and layers begin with the activations and slopes that are found so.

use super::buffers::Buffers;
use super::tile::{Network, Tile};
use crate::kernel::Precision;
use crate::values::Precompiled;

impl<E: Precision> Network<'_, E> {
    /// The values of all layers at the points of a tile.
    pub(super) fn doubled_values(&self, tile: &Tile<'_, E>, buffers: &mut Buffers<f64>) {
        let Self { isa, layout, weights, .. } = *self;
        let weights = weights.doubled().expect("kept where layers take values");
        let layers = f64::values(layout.inputs);
        let sites = tile.group.doubled.as_ref().expect("kept where layers take values");
        tile.load_sites(sites, buffers);
        Network { isa, layout, weights, scalars: &[] }.layers(layers, tile.shape(layout), buffers, None);
    }
}
