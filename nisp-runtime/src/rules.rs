//! How derivatives go through activations and products, as the compiler emits it for a channel set.

use crate::simd::Simd;

/// Propagation rules of one channel set: `K` channels, derivatives of the activation up to `D - 1`, `S` coordinates.
///
/// Channel 0 is the value. `phi[n]` is the n-th derivative of the activation at the value of its argument; forward
/// rules read up to `phi[D - 2]`, adjoints one more. Channels outside [`Rules::READ`] are not computed and their
/// entries have no meaning.
pub trait Rules<const K: usize, const D: usize, const S: usize>: Send + Sync + 'static {
    /// Channels that the rules deliver.
    const READ: [bool; K];
    /// Channels of `phi(a)`; `a[0]` is not used.
    fn compose<V: Simd>(phi: &[V; D], a: &[V; K]) -> [V; K];
    /// Adjoint of [`Rules::compose`]: the adjoint of `a`, the value's included.
    fn compose_adjoint<V: Simd>(phi: &[V; D], a: &[V; K], seed: &[V; K]) -> [V; K];
    /// Channels of `phi(w . x + b)`.
    fn affine<V: Simd>(phi: &[V; D], w: &[V; S]) -> [V; K];
    /// Adjoint of [`Rules::affine`]: of the value `w . x + b`, and of `w` by way of the derivative channels.
    fn affine_adjoint<V: Simd>(phi: &[V; D], w: &[V; S], seed: &[V; K]) -> (V, [V; S]);
    /// Channels of the product of two functions.
    fn product<V: Simd>(f: &[V; K], g: &[V; K]) -> [V; K];
    /// Adjoint of [`Rules::product`].
    fn product_adjoint<V: Simd>(f: &[V; K], g: &[V; K], seed: &[V; K]) -> ([V; K], [V; K]);
}
