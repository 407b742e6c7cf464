//! The gate of a layer: `z = d + (c - d) z'`.

use std::marker::PhantomData;

use super::{Shape, load_channels, load_read, store_read};
use crate::real::Real;
use crate::rules::Rules;
use crate::simd::{Kernel, Simd};

/// Channels of the gates `c` and `d`, as `g = c - d` and `d`: the layer puts out `d + g * z'`.
#[derive(Clone, Copy, Debug)]
pub struct Gate<'a, E> {
    /// `c - d`
    pub difference: &'a [E],
    /// `d`
    pub floor: &'a [E],
}

/// Adjoints of the gates.
#[derive(Debug)]
pub struct GateAdjoint<'a, E> {
    /// The gates.
    pub gate: Gate<'a, E>,
    /// Adds to the adjoint of `g`.
    pub difference_bar: &'a mut [E],
    /// Adds to the adjoint of `d` beside `g`.
    pub floor_bar: &'a mut [E],
}

/// How a layer ends: with a gate, or (`()`) as it is.
pub(crate) trait Ending<E: Real> {
    /// Checks that its rows hold so many channels.
    fn holds(&self, shape: Shape, channels: usize);
    /// What the layer puts out, in the channels that are read; the others have no meaning.
    ///
    /// # Safety
    /// The gate's rows hold a vector of each channel from `at` on.
    unsafe fn end<V, P, const K: usize, const D: usize, const S: usize>(
        &self,
        at: usize,
        ld: usize,
        y: [V; K],
    ) -> [V; K]
    where
        V: Simd<Elem = E>,
        P: Rules<K, D, S>;
}

/// Adjoint of [`Ending`].
pub(crate) trait EndingAdjoint<E: Real> {
    /// Checks that its rows hold so many channels.
    fn holds(&self, shape: Shape, channels: usize);
    /// What the layer puts out, and the adjoint of `y`. Adds to the adjoints of the gates.
    ///
    /// # Safety
    /// As for [`Ending::end`], for the adjoints too.
    unsafe fn end<V, P, const K: usize, const D: usize, const S: usize>(
        &mut self,
        at: usize,
        ld: usize,
        y: [V; K],
        z_bar: [V; K],
    ) -> ([V; K], [V; K])
    where
        V: Simd<Elem = E>,
        P: Rules<K, D, S>;
}

impl<E: Real> Ending<E> for Gate<'_, E> {
    #[inline(always)]
    fn holds(&self, shape: Shape, channels: usize) {
        shape.holds(self.difference, channels);
        shape.holds(self.floor, channels);
    }

    /// `d + g y`
    #[inline(always)]
    unsafe fn end<V, P, const K: usize, const D: usize, const S: usize>(
        &self,
        at: usize,
        ld: usize,
        y: [V; K],
    ) -> [V; K]
    where
        V: Simd<Elem = E>,
        P: Rules<K, D, S>,
    {
        // SAFETY: as the caller vouches.
        let (g, d): ([V; K], [V; K]) = unsafe {
            let g = load_channels(self.difference.as_ptr().add(at), ld);
            (g, load_read(self.floor.as_ptr().add(at), ld, &P::READ))
        };
        let mut z = P::product(&g, &y);
        for k in 0..K {
            if P::READ[k] {
                z[k] = z[k].add(d[k]);
            }
        }
        z
    }
}

impl<E: Real> EndingAdjoint<E> for GateAdjoint<'_, E> {
    #[inline(always)]
    fn holds(&self, shape: Shape, channels: usize) {
        self.gate.holds(shape, channels);
        shape.holds(self.difference_bar, channels);
        shape.holds(self.floor_bar, channels);
    }

    #[inline(always)]
    unsafe fn end<V, P, const K: usize, const D: usize, const S: usize>(
        &mut self,
        at: usize,
        ld: usize,
        y: [V; K],
        z_bar: [V; K],
    ) -> ([V; K], [V; K])
    where
        V: Simd<Elem = E>,
        P: Rules<K, D, S>,
    {
        // SAFETY: as the caller vouches; likewise below.
        let g: [V; K] = unsafe { load_channels(self.gate.difference.as_ptr().add(at), ld) };
        let mut z = P::product(&g, &y);
        let (g_bar, y_bar) = P::product_adjoint(&g, &y, &z_bar);
        for k in 0..K {
            let row = at + k * ld;
            // SAFETY: see above.
            unsafe {
                let sum = self.difference_bar.as_mut_ptr().add(row);
                V::load(sum).add(g_bar[k]).store(sum);
                if P::READ[k] {
                    let sum = self.floor_bar.as_mut_ptr().add(row);
                    V::load(sum).add(z_bar[k]).store(sum);
                    z[k] = z[k].add(V::load(self.gate.floor.as_ptr().add(row)));
                }
            }
        }
        (z, y_bar)
    }
}

impl<E: Real> Ending<E> for () {
    #[inline(always)]
    fn holds(&self, _: Shape, _: usize) {}

    #[inline(always)]
    unsafe fn end<V, P, const K: usize, const D: usize, const S: usize>(&self, _: usize, _: usize, y: [V; K]) -> [V; K]
    where
        V: Simd<Elem = E>,
        P: Rules<K, D, S>,
    {
        y
    }
}

impl<E: Real> EndingAdjoint<E> for () {
    #[inline(always)]
    fn holds(&self, _: Shape, _: usize) {}

    #[inline(always)]
    unsafe fn end<V, P, const K: usize, const D: usize, const S: usize>(
        &mut self,
        _: usize,
        _: usize,
        y: [V; K],
        z_bar: [V; K],
    ) -> ([V; K], [V; K])
    where
        V: Simd<Elem = E>,
        P: Rules<K, D, S>,
    {
        (y, z_bar)
    }
}

/// The gate after an affine layer, whose output already is the activation's.
#[derive(Debug)]
pub struct Gated<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Channels to be gated.
    pub input: &'a [E],
    /// The gates.
    pub gate: Gate<'a, E>,
    /// Output channels.
    pub output: &'a mut [E],
}

/// Adjoint of [`Gated`].
#[derive(Debug)]
pub struct GatedAdjoint<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Channels to be gated.
    pub input: &'a [E],
    /// Adjoint of the output channels.
    pub seed: &'a [E],
    /// The gates, and where their adjoints go.
    pub gate: GateAdjoint<'a, E>,
    /// Output: adjoint of the input channels.
    pub input_bar: &'a mut [E],
    /// Output: the output channels, recomputed.
    pub output: &'a mut [E],
}

pub(crate) struct GateKernel<'a, E, R, const K: usize, const D: usize, const S: usize>(
    pub(crate) Gated<'a, E>,
    pub(crate) PhantomData<R>,
);

impl<E: Real, P: Rules<K, D, S>, const K: usize, const D: usize, const S: usize> Kernel<E>
    for GateKernel<'_, E, P, K, D, S>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Gated { shape, input, gate, output } = self.0;
        shape.holds(input, K);
        shape.holds(output, K);
        gate.holds(shape, K);
        assert!(shape.width % V::LANES == 0);
        for p in 0..shape.points {
            for u in (0..shape.width).step_by(V::LANES) {
                let at = p * K * shape.ld + u;
                // SAFETY: lengths were checked above; u + LANES <= width.
                unsafe {
                    let y: [V; K] = load_channels(input.as_ptr().add(at), shape.ld);
                    let z = gate.end::<V, P, K, D, S>(at, shape.ld, y);
                    store_read(&z, output.as_mut_ptr().add(at), shape.ld, &P::READ);
                }
            }
        }
    }
}

pub(crate) struct GateAdjointKernel<'a, E, R, const K: usize, const D: usize, const S: usize>(
    pub(crate) GatedAdjoint<'a, E>,
    pub(crate) PhantomData<R>,
);

impl<E: Real, P: Rules<K, D, S>, const K: usize, const D: usize, const S: usize> Kernel<E>
    for GateAdjointKernel<'_, E, P, K, D, S>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let GatedAdjoint { shape, input, seed, mut gate, input_bar, output } = self.0;
        for rows in [input, seed, &*input_bar, &*output] {
            shape.holds(rows, K);
        }
        gate.holds(shape, K);
        assert!(shape.width % V::LANES == 0);
        for p in 0..shape.points {
            for u in (0..shape.width).step_by(V::LANES) {
                let at = p * K * shape.ld + u;
                // SAFETY: lengths were checked above; u + LANES <= width.
                unsafe {
                    let y: [V; K] = load_channels(input.as_ptr().add(at), shape.ld);
                    let z_bar: [V; K] = load_read(seed.as_ptr().add(at), shape.ld, &P::READ);
                    let (z, y_bar) = gate.end::<V, P, K, D, S>(at, shape.ld, y, z_bar);
                    store_read(&y_bar, input_bar.as_mut_ptr().add(at), shape.ld, &[true; K]);
                    store_read(&z, output.as_mut_ptr().add(at), shape.ld, &P::READ);
                }
            }
        }
    }
}
