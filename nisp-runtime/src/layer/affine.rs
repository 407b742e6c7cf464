//! The first layer and the gates, on raw coordinates.

use std::marker::PhantomData;

use super::{Shape, load_channels, takes_values};
use crate::activation::Activation;
use crate::real::Real;
use crate::rules::Rules;
use crate::simd::{Kernel, Simd};

/// An affine layer on raw coordinates: the first layer and the gates. No matrix product, and derivatives in closed form.
#[derive(Debug)]
pub struct Affine<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Function of the units.
    pub activation: Activation,
    /// Weights, `[coordinate][unit]`, `width` apart.
    pub weights: &'a [E],
    /// Biases, one per unit.
    pub bias: &'a [E],
    /// Network coordinates, `[point][coordinate]`.
    pub coordinates: &'a [E],
    /// Output (input where layers [take values](crate::layer::Layers::takes_values)): the activation, `[point][unit]`.
    pub value: &'a mut [E],
    /// Output (input likewise): slope of the activation, `[point][unit]`.
    pub slope: &'a mut [E],
    /// Output: channels, `[point][channel][unit]`.
    pub output: &'a mut [E],
}

/// Adjoint of [`Affine`], summed over the points.
#[derive(Debug)]
pub struct AffineAdjoint<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Function of the units.
    pub activation: Activation,
    /// Weights, as in [`Affine`].
    pub weights: &'a [E],
    /// Network coordinates, as in [`Affine`].
    pub coordinates: &'a [E],
    /// The activation, as [`Affine`] left it.
    pub value: &'a [E],
    /// Slope of the activation, as [`Affine`] left it.
    pub slope: &'a [E],
    /// Adjoint of the output channels.
    pub seed: &'a [E],
    /// Adds to the adjoint of the weights, `[coordinate][unit]`.
    pub weights_bar: &'a mut [E],
    /// Adds to the adjoint of the biases.
    pub bias_bar: &'a mut [E],
}

pub(crate) struct AffineKernel<'a, E, R, const K: usize, const D: usize, const S: usize>(
    pub(crate) Affine<'a, E>,
    pub(crate) PhantomData<R>,
);

impl<E: Real, R: Rules<K, D, S>, const K: usize, const D: usize, const S: usize> Kernel<E>
    for AffineKernel<'_, E, R, K, D, S>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Affine { shape, activation, weights, bias, coordinates, value, slope, output } = self.0;
        shape.holds(output, K);
        shape.holds(value, 1);
        shape.holds(slope, 1);
        assert!(weights.len() >= S * shape.width && bias.len() >= shape.width);
        assert!(coordinates.len() >= shape.points * S && shape.width % V::LANES == 0);
        for u in (0..shape.width).step_by(V::LANES) {
            // SAFETY: lengths were checked above; u + LANES <= width.
            unsafe {
                let w: [V; S] = load_channels(weights.as_ptr().add(u), shape.width);
                let b = V::load(bias.as_ptr().add(u));
                for p in 0..shape.points {
                    let row = p * shape.ld + u;
                    let (t, s) = if const { takes_values::<E>(D, S) } {
                        (V::load(value.as_ptr().add(row)), V::load(slope.as_ptr().add(row)))
                    } else {
                        let mut a = b;
                        for (i, &wi) in w.iter().enumerate() {
                            a = wi.mul_add(V::splat(*coordinates.get_unchecked(p * S + i)), a);
                        }
                        let (t, s) = activation.value_and_slope::<V, D>(a);
                        t.store(value.as_mut_ptr().add(row));
                        s.store(slope.as_mut_ptr().add(row));
                        (t, s)
                    };
                    let y = R::affine(&activation.derivatives::<V, D>(t, s), &w);
                    for (k, yk) in y.into_iter().enumerate() {
                        yk.store(output.as_mut_ptr().add((p * K + k) * shape.ld + u));
                    }
                }
            }
        }
    }
}

pub(crate) struct AffineAdjointKernel<'a, E, R, const K: usize, const D: usize, const S: usize>(
    pub(crate) AffineAdjoint<'a, E>,
    pub(crate) PhantomData<R>,
);

impl<E: Real, R: Rules<K, D, S>, const K: usize, const D: usize, const S: usize> Kernel<E>
    for AffineAdjointKernel<'_, E, R, K, D, S>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let AffineAdjoint { shape, activation, weights, coordinates, value, slope, seed, weights_bar, bias_bar } =
            self.0;
        shape.holds(seed, K);
        shape.holds(value, 1);
        shape.holds(slope, 1);
        assert!(weights.len() >= S * shape.width && weights_bar.len() >= S * shape.width);
        assert!(bias_bar.len() >= shape.width && coordinates.len() >= shape.points * S);
        assert!(shape.width % V::LANES == 0);
        for u in (0..shape.width).step_by(V::LANES) {
            // SAFETY: lengths were checked above; u + LANES <= width.
            unsafe {
                let w: [V; S] = load_channels(weights.as_ptr().add(u), shape.width);
                let mut w_bar: [V; S] = load_channels(weights_bar.as_ptr().add(u), shape.width);
                let mut b_bar = V::load(bias_bar.as_ptr().add(u));
                for p in 0..shape.points {
                    let t = V::load(value.as_ptr().add(p * shape.ld + u));
                    let s = V::load(slope.as_ptr().add(p * shape.ld + u));
                    let y_bar: [V; K] = load_channels(seed.as_ptr().add(p * K * shape.ld + u), shape.ld);
                    let (a_bar, way) = R::affine_adjoint(&activation.derivatives::<V, D>(t, s), &w, &y_bar);
                    b_bar = b_bar.add(a_bar);
                    for i in 0..S {
                        let x = V::splat(*coordinates.get_unchecked(p * S + i));
                        w_bar[i] = a_bar.mul_add(x, w_bar[i].add(way[i]));
                    }
                }
                for (i, wi) in w_bar.into_iter().enumerate() {
                    wi.store(weights_bar.as_mut_ptr().add(i * shape.width + u));
                }
                b_bar.store(bias_bar.as_mut_ptr().add(u));
            }
        }
    }
}
