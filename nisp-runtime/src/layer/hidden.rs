//! A hidden layer after its matrix product: activation, then gate.

use std::marker::PhantomData;

use super::gate::{Ending, EndingAdjoint};
use super::{Shape, load_channels, load_read, store_read, takes_values};
use crate::activation::Activation;
use crate::real::Real;
use crate::rules::Rules;
use crate::simd::{Kernel, Simd};

/// A hidden layer after its matrix product.
#[derive(Debug)]
pub struct Layer<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Function of the units.
    pub activation: Activation,
    /// Channels of the activation's argument; row 0 is replaced by the activation, or has been where layers
    /// [take values](crate::layer::Layers::takes_values).
    pub argument: &'a mut [E],
    /// Biases, added to the argument's value.
    pub bias: &'a [E],
    /// Output (input likewise): slope of the activation, `[point][unit]`.
    pub slope: &'a mut [E],
    /// Output channels.
    pub output: &'a mut [E],
}

/// Adjoint of [`Layer`].
#[derive(Debug)]
pub struct LayerAdjoint<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Function of the units.
    pub activation: Activation,
    /// Argument, as [`Layer`] left it.
    pub argument: &'a [E],
    /// Slope, as [`Layer`] left it.
    pub slope: &'a [E],
    /// Adjoint of the output channels.
    pub seed: &'a [E],
    /// Output: adjoint of the argument.
    pub argument_bar: &'a mut [E],
    /// Output: the layer's output channels, recomputed.
    pub output: &'a mut [E],
}

/// `C` composes; `P` multiplies by the gate, and says which channels are wanted. Whether there is a gate is known to the
/// compiler (`G` is [`Gate`](super::Gate) or `()`): a branch between the two rules would cost a tenth of a step.
pub(crate) struct LayerKernel<'a, E, G, C, P, const K: usize, const D: usize, const S: usize> {
    pub(crate) layer: Layer<'a, E>,
    pub(crate) gate: G,
    pub(crate) rules: PhantomData<(C, P)>,
}

impl<E, G, C, P, const K: usize, const D: usize, const S: usize> Kernel<E> for LayerKernel<'_, E, G, C, P, K, D, S>
where
    E: Real,
    G: Ending<E>,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        // By value: pointers behind a reference would be read anew after every store.
        let Self { layer, gate, .. } = self;
        let Layer { shape, activation, argument, bias, slope, output } = layer;
        shape.holds(argument, K);
        shape.holds(output, K);
        shape.holds(slope, 1);
        assert!(bias.len() >= shape.width && shape.width % V::LANES == 0);
        gate.holds(shape, K);
        for p in 0..shape.points {
            for u in (0..shape.width).step_by(V::LANES) {
                let at = p * K * shape.ld + u;
                // SAFETY: lengths were checked above; u + LANES <= width.
                unsafe {
                    let a: [V; K] = load_channels(argument.as_ptr().add(at), shape.ld);
                    let (t, s) = if const { takes_values::<E>(D, S) } {
                        (a[0], V::load(slope.as_ptr().add(p * shape.ld + u)))
                    } else {
                        let (t, s) = activation.value_and_slope::<V, D>(a[0].add(V::load(bias.as_ptr().add(u))));
                        t.store(argument.as_mut_ptr().add(at));
                        s.store(slope.as_mut_ptr().add(p * shape.ld + u));
                        (t, s)
                    };
                    let y = C::compose(&activation.derivatives::<V, D>(t, s), &a);
                    let z = gate.end::<V, P, K, D, S>(at, shape.ld, y);
                    store_read(&z, output.as_mut_ptr().add(at), shape.ld, &P::READ);
                }
            }
        }
    }
}

/// Adjoint of [`LayerKernel`].
pub(crate) struct LayerAdjointKernel<'a, E, G, C, P, const K: usize, const D: usize, const S: usize> {
    pub(crate) layer: LayerAdjoint<'a, E>,
    pub(crate) gate: G,
    pub(crate) rules: PhantomData<(C, P)>,
}

impl<E, G, C, P, const K: usize, const D: usize, const S: usize> Kernel<E>
    for LayerAdjointKernel<'_, E, G, C, P, K, D, S>
where
    E: Real,
    G: EndingAdjoint<E>,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { layer, mut gate, .. } = self;
        let LayerAdjoint { shape, activation, argument, slope, seed, argument_bar, output } = layer;
        for rows in [argument, seed, &*argument_bar, &*output] {
            shape.holds(rows, K);
        }
        shape.holds(slope, 1);
        assert!(shape.width % V::LANES == 0);
        gate.holds(shape, K);
        for p in 0..shape.points {
            for u in (0..shape.width).step_by(V::LANES) {
                let at = p * K * shape.ld + u;
                // SAFETY: lengths were checked above; u + LANES <= width.
                unsafe {
                    let a: [V; K] = load_channels(argument.as_ptr().add(at), shape.ld);
                    let z_bar: [V; K] = load_read(seed.as_ptr().add(at), shape.ld, &P::READ);
                    let phi = activation.derivatives::<V, D>(a[0], V::load(slope.as_ptr().add(p * shape.ld + u)));
                    let y = C::compose(&phi, &a);
                    let (z, y_bar) = gate.end::<V, P, K, D, S>(at, shape.ld, y, z_bar);
                    let a_bar = C::compose_adjoint(&phi, &a, &y_bar);
                    store_read(&a_bar, argument_bar.as_mut_ptr().add(at), shape.ld, &[true; K]);
                    store_read(&z, output.as_mut_ptr().add(at), shape.ld, &P::READ);
                }
            }
        }
    }
}
