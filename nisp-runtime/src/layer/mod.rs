//! The element-wise work of a layer on a tile of points: activation, gate, and their adjoints.
//!
//! Rows are `[point][channel][unit]`, units contiguous, `ld` apart. Vectors run along the units, so weights that
//! differ per unit are loads and a point's channels stay in registers. Each forward kernel has its adjoint beside it.

use std::marker::PhantomData;

use crate::kernel::Rules;
use crate::real::Real;
use crate::simd::{Kernel, Simd};
use crate::tanh;

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

/// An affine layer on raw coordinates: the first layer and the gates. No matrix product, and derivatives in closed form.
#[derive(Debug)]
pub struct Affine<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Weights, `[coordinate][unit]`, `width` apart.
    pub weights: &'a [E],
    /// Biases, one per unit.
    pub bias: &'a [E],
    /// Network coordinates, `[point][coordinate]`.
    pub coordinates: &'a [E],
    /// Output: `tanh`, `[point][unit]`.
    pub value: &'a mut [E],
    /// Output: slope of `tanh`, `[point][unit]`.
    pub slope: &'a mut [E],
    /// Output: channels, `[point][channel][unit]`.
    pub output: &'a mut [E],
}

/// Adjoint of [`Affine`], summed over the points.
#[derive(Debug)]
pub struct AffineAdjoint<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Weights, as in [`Affine`].
    pub weights: &'a [E],
    /// Network coordinates, as in [`Affine`].
    pub coordinates: &'a [E],
    /// `tanh`, as [`Affine`] left it.
    pub value: &'a [E],
    /// Slope of `tanh`, as [`Affine`] left it.
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
        let Affine { shape, weights, bias, coordinates, value, slope, output } = self.0;
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
                    let mut a = b;
                    for (i, &wi) in w.iter().enumerate() {
                        a = wi.mul_add(V::splat(*coordinates.get_unchecked(p * S + i)), a);
                    }
                    let (t, s) = tanh::tanh_and_slope(a);
                    t.store(value.as_mut_ptr().add(p * shape.ld + u));
                    s.store(slope.as_mut_ptr().add(p * shape.ld + u));
                    let y = R::affine(&tanh::derivatives::<V, D>(t, s), &w);
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
        let AffineAdjoint { shape, weights, coordinates, value, slope, seed, weights_bar, bias_bar } = self.0;
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
                    let (a_bar, way) = R::affine_adjoint(&tanh::derivatives::<V, D>(t, s), &w, &y_bar);
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

/// A hidden layer after its matrix product.
#[derive(Debug)]
pub struct Layer<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
    /// Channels of the activation's argument; where a composition takes place, row 0 is replaced by `tanh`.
    pub argument: &'a mut [E],
    /// Biases, added to the argument's value; empty where no composition takes place.
    pub bias: &'a [E],
    /// Output: slope of `tanh`, `[point][unit]`; untouched where no composition takes place.
    pub slope: &'a mut [E],
    /// Output channels.
    pub output: &'a mut [E],
}

/// Channels of the gates `c` and `d`, as `g = c - d` and `d`: the layer puts out `d + g * z'`.
#[derive(Clone, Copy, Debug)]
pub struct Gate<'a, E> {
    /// `c - d`
    pub difference: &'a [E],
    /// `d`
    pub floor: &'a [E],
}

impl<E> Gate<'_, E> {
    /// No gate: what an ungated layer is given.
    pub(crate) fn none() -> Self {
        Self { difference: &[], floor: &[] }
    }
}

/// Adjoint of [`Layer`].
#[derive(Debug)]
pub struct LayerAdjoint<'a, E> {
    /// Shape of the tile.
    pub shape: Shape,
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

impl<E> GateAdjoint<'_, E> {
    /// No gate: what an ungated layer is given.
    pub(crate) fn none() -> Self {
        Self { gate: Gate::none(), difference_bar: &mut [], floor_bar: &mut [] }
    }
}

/// `C` composes, `P` multiplies by the gate. Without `COMPOSE` the argument already is the activation's output.
pub(crate) struct LayerKernel<
    'a,
    E,
    C,
    P,
    const K: usize,
    const D: usize,
    const S: usize,
    const COMPOSE: bool,
    const GATE: bool,
> {
    pub(crate) layer: Layer<'a, E>,
    pub(crate) gate: Gate<'a, E>,
    pub(crate) rules: PhantomData<(C, P)>,
}

impl<E, C, P, const K: usize, const D: usize, const S: usize, const COMPOSE: bool, const GATE: bool> Kernel<E>
    for LayerKernel<'_, E, C, P, K, D, S, COMPOSE, GATE>
where
    E: Real,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Layer { shape, argument, bias, slope, output } = self.layer;
        shape.holds(argument, K);
        shape.holds(output, K);
        if COMPOSE {
            shape.holds(slope, 1);
            assert!(bias.len() >= shape.width);
        }
        if GATE {
            shape.holds(self.gate.difference, K);
            shape.holds(self.gate.floor, K);
        }
        assert!(shape.width % V::LANES == 0);
        let read = if GATE { &P::READ } else { &C::READ };
        for p in 0..shape.points {
            for u in (0..shape.width).step_by(V::LANES) {
                let at = p * K * shape.ld + u;
                // SAFETY: lengths were checked above; u + LANES <= width.
                unsafe {
                    let a: [V; K] = load_channels(argument.as_ptr().add(at), shape.ld);
                    let y = if COMPOSE {
                        let (t, s) = tanh::tanh_and_slope(a[0].add(V::load(bias.as_ptr().add(u))));
                        t.store(argument.as_mut_ptr().add(at));
                        s.store(slope.as_mut_ptr().add(p * shape.ld + u));
                        C::compose(&tanh::derivatives::<V, D>(t, s), &a)
                    } else {
                        a
                    };
                    let z = if GATE {
                        let g: [V; K] = load_channels(self.gate.difference.as_ptr().add(at), shape.ld);
                        let d: [V; K] = load_read(self.gate.floor.as_ptr().add(at), shape.ld, read);
                        let mut z = P::product(&g, &y);
                        for k in 0..K {
                            if read[k] {
                                z[k] = z[k].add(d[k]);
                            }
                        }
                        z
                    } else {
                        y
                    };
                    for k in 0..K {
                        if read[k] {
                            z[k].store(output.as_mut_ptr().add(at + k * shape.ld));
                        }
                    }
                }
            }
        }
    }
}

/// Adjoint of [`LayerKernel`].
pub(crate) struct LayerAdjointKernel<
    'a,
    E,
    C,
    P,
    const K: usize,
    const D: usize,
    const S: usize,
    const COMPOSE: bool,
    const GATE: bool,
> {
    pub(crate) layer: LayerAdjoint<'a, E>,
    pub(crate) gate: GateAdjoint<'a, E>,
    pub(crate) rules: PhantomData<(C, P)>,
}

impl<E, C, P, const K: usize, const D: usize, const S: usize, const COMPOSE: bool, const GATE: bool> Kernel<E>
    for LayerAdjointKernel<'_, E, C, P, K, D, S, COMPOSE, GATE>
where
    E: Real,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let LayerAdjoint { shape, argument, slope, seed, argument_bar, output } = self.layer;
        let GateAdjoint { gate, difference_bar, floor_bar } = self.gate;
        for rows in [argument, seed, &*argument_bar, &*output] {
            shape.holds(rows, K);
        }
        if COMPOSE {
            shape.holds(slope, 1);
        }
        if GATE {
            for rows in [gate.difference, gate.floor, &*difference_bar, &*floor_bar] {
                shape.holds(rows, K);
            }
        }
        assert!(shape.width % V::LANES == 0);
        let read = if GATE { &P::READ } else { &C::READ };
        for p in 0..shape.points {
            for u in (0..shape.width).step_by(V::LANES) {
                let at = p * K * shape.ld + u;
                // SAFETY: lengths were checked above; u + LANES <= width.
                unsafe {
                    let a: [V; K] = load_channels(argument.as_ptr().add(at), shape.ld);
                    let z_bar: [V; K] = load_read(seed.as_ptr().add(at), shape.ld, read);
                    let phi = if COMPOSE {
                        tanh::derivatives::<V, D>(a[0], V::load(slope.as_ptr().add(p * shape.ld + u)))
                    } else {
                        [V::splat(E::ZERO); D]
                    };
                    let y = if COMPOSE { C::compose(&phi, &a) } else { a };
                    let (z, y_bar) = if GATE {
                        let g: [V; K] = load_channels(gate.difference.as_ptr().add(at), shape.ld);
                        let mut z = P::product(&g, &y);
                        let (g_bar, y_bar) = P::product_adjoint(&g, &y, &z_bar);
                        for k in 0..K {
                            let row = at + k * shape.ld;
                            let sum = difference_bar.as_mut_ptr().add(row);
                            V::load(sum).add(g_bar[k]).store(sum);
                            if read[k] {
                                let sum = floor_bar.as_mut_ptr().add(row);
                                V::load(sum).add(z_bar[k]).store(sum);
                                z[k] = z[k].add(V::load(gate.floor.as_ptr().add(row)));
                            }
                        }
                        (z, y_bar)
                    } else {
                        (y, z_bar)
                    };
                    let a_bar = if COMPOSE { C::compose_adjoint(&phi, &a, &y_bar) } else { y_bar };
                    for k in 0..K {
                        let row = at + k * shape.ld;
                        a_bar[k].store(argument_bar.as_mut_ptr().add(row));
                        if read[k] {
                            z[k].store(output.as_mut_ptr().add(row));
                        }
                    }
                }
            }
        }
    }
}
