//! Affine layers and fixed features of the coordinates, interpreted.

use nisp_compiler::program::Slot;
use nisp_runtime::layer::{Affine, AffineAdjoint, Features, derivatives};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Isa, Kernel, Simd};

use crate::block::{Run, load, vectors};
use crate::rules::{InterpretedLayers, holds};

/// Derivatives of features at most; the compiler refuses equations of higher order.
const MOST: usize = nisp_compiler::plan::MAX_ORDER as usize + 2;

pub(crate) struct AffineKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) layer: Affine<'a, E>,
}

impl<E: Real> Kernel<E> for AffineKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, layer } = self;
        let Affine { shape, activation, weights, bias, coordinates, value, slope, output } = layer;
        let (channels, dim) = (layers.channels, layers.coordinates);
        holds(shape, output, channels);
        holds(shape, value, 1);
        holds(shape, slope, 1);
        assert!(weights.len() >= dim * shape.width && bias.len() >= shape.width);
        assert!(coordinates.len() >= shape.points * dim && shape.width.is_multiple_of(V::LANES));
        let given = layers.slopes.are_given::<E>(dim);
        let mut phi = layers.slopes.run::<V>();
        let mut affine = Run::<V>::new(isa, &layers.hidden.affine);
        let (weights, output) = (weights.as_ptr(), output.as_mut_ptr());
        let mut unit = 0;
        while unit < shape.width {
            let vectors = vectors((shape.width - unit) / V::LANES);
            // SAFETY: lengths were checked above; a block does not reach past the width. Rules of a layer have no scalars.
            unsafe {
                affine.once();
                for point in 0..shape.points {
                    let row = point * shape.ld + unit;
                    let (value, slope) = (value.as_mut_ptr().add(row), slope.as_mut_ptr().add(row));
                    if !given {
                        for i in 0..vectors {
                            let mut a = load::<V>(bias.as_ptr().add(unit), i);
                            for at in 0..dim {
                                let x = V::splat(*coordinates.get_unchecked(point * dim + at));
                                a = load::<V>(weights.add(at * shape.width + unit), i).mul_add(x, a);
                            }
                            a.store(value.add(i * V::LANES));
                        }
                        phi.activate(activation, value, None, value, slope, vectors);
                    }
                    phi.derive(activation, value, slope, vectors);
                    affine.point(|_, (slot, index)| match slot {
                        Slot::Phi => phi.derivative(index),
                        _ => weights.add(index * shape.width + unit),
                    });
                    affine.run(vectors);
                    for channel in 0..channels {
                        let to = output.add((point * channels + channel) * shape.ld + unit);
                        for i in 0..vectors {
                            load::<V>(affine.output(channel), i).store(to.add(i * V::LANES));
                        }
                    }
                }
            }
            unit += vectors * V::LANES;
        }
    }
}

pub(crate) struct AffineAdjointKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) layer: AffineAdjoint<'a, E>,
}

impl<E: Real> Kernel<E> for AffineAdjointKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, layer } = self;
        let AffineAdjoint { shape, activation, weights, coordinates, value, slope, seed, weights_bar, bias_bar } =
            layer;
        let (channels, dim) = (layers.channels, layers.coordinates);
        holds(shape, seed, channels);
        holds(shape, value, 1);
        holds(shape, slope, 1);
        assert!(weights.len() >= dim * shape.width && weights_bar.len() >= dim * shape.width);
        assert!(bias_bar.len() >= shape.width && coordinates.len() >= shape.points * dim);
        assert!(shape.width.is_multiple_of(V::LANES));
        let mut phi = layers.slopes.run::<V>();
        let mut adjoint = Run::<V>::new(isa, &layers.hidden.affine_adjoint);
        let (weights, seed) = (weights.as_ptr(), seed.as_ptr());
        let mut unit = 0;
        while unit < shape.width {
            let vectors = vectors((shape.width - unit) / V::LANES);
            // SAFETY: lengths were checked above; a block does not reach past the width. Rules of a layer have no scalars.
            unsafe {
                adjoint.once();
                let bias_bar = bias_bar.as_mut_ptr().add(unit);
                for point in 0..shape.points {
                    let row = point * shape.ld + unit;
                    phi.derive(activation, value.as_ptr().add(row), slope.as_ptr().add(row), vectors);
                    adjoint.point(|_, (slot, index)| match slot {
                        Slot::Phi => phi.derivative(index),
                        Slot::Seed => seed.add((point * channels + index) * shape.ld + unit),
                        _ => weights.add(index * shape.width + unit),
                    });
                    adjoint.run(vectors);
                    let bar = adjoint.output(0);
                    for i in 0..vectors {
                        let a_bar = load::<V>(bar, i);
                        load::<V>(bias_bar, i).add(a_bar).store(bias_bar.add(i * V::LANES));
                        for at in 0..dim {
                            let x = V::splat(*coordinates.get_unchecked(point * dim + at));
                            let to = weights_bar.as_mut_ptr().add(at * shape.width + unit);
                            let sum = load::<V>(to, i).add(load(adjoint.output(1 + at), i));
                            a_bar.mul_add(x, sum).store(to.add(i * V::LANES));
                        }
                    }
                }
            }
            unit += vectors * V::LANES;
        }
    }
}

pub(crate) struct FeaturesKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) features: Features<'a, E>,
}

impl<E: Real> Kernel<E> for FeaturesKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, features } = self;
        let Features { shape, function, projections, table, linear, offsets, coordinates, output } = features;
        let (channels, dim) = (layers.channels, layers.coordinates);
        holds(shape, output, channels);
        assert!([projections, linear].iter().all(|x| x.len() >= dim * shape.width));
        assert!(table.len() >= shape.points * 2 * shape.width && offsets.len() >= shape.width);
        assert!(coordinates.len() >= shape.points * dim && shape.width.is_multiple_of(V::LANES));
        let count = layers.slopes.count();
        let (mut curve, mut line) = (layers.slopes.run::<V>(), layers.slopes.run::<V>());
        let mut runs = [Run::<V>::new(isa, &layers.hidden.affine), Run::<V>::new(isa, &layers.hidden.affine)];
        let mut unit = 0;
        while unit < shape.width {
            let vectors = vectors((shape.width - unit) / V::LANES);
            // SAFETY: lengths were checked above; a block does not reach past the width. Rules of a layer have no scalars.
            unsafe {
                runs.iter_mut().for_each(|run| run.once());
                for point in 0..shape.points {
                    for i in 0..vectors {
                        let at = unit + i * V::LANES;
                        let value = V::load(table.as_ptr().add(2 * point * shape.width + at));
                        let other = V::load(table.as_ptr().add((2 * point + 1) * shape.width + at));
                        let phi = derivatives::<V, MOST>(function, [value, other]);
                        for (n, phi) in phi.into_iter().enumerate().take(count) {
                            phi.store(curve.row(n).add(i * V::LANES));
                        }
                        let mut straight = V::load(offsets.as_ptr().add(at));
                        for axis in 0..dim {
                            let x = V::splat(*coordinates.get_unchecked(point * dim + axis));
                            straight = V::load(linear.as_ptr().add(axis * shape.width + at)).mul_add(x, straight);
                        }
                        straight.store(line.row(0).add(i * V::LANES));
                        for n in 1..count {
                            let slope = if n == 1 { E::ONE } else { E::ZERO };
                            V::splat(slope).store(line.row(n).add(i * V::LANES));
                        }
                    }
                    let [curved, straight] = &mut runs;
                    for (run, phi, factors) in [(&mut *curved, &curve, projections), (&mut *straight, &line, linear)] {
                        run.point(|_, (slot, index)| match slot {
                            Slot::Phi => phi.derivative(index),
                            _ => factors.as_ptr().add(index * shape.width + unit),
                        });
                        run.run(vectors);
                    }
                    for channel in 0..channels {
                        let to = output.as_mut_ptr().add((point * channels + channel) * shape.ld + unit);
                        for i in 0..vectors {
                            let sum = load::<V>(curved.output(channel), i).add(load(straight.output(channel), i));
                            sum.store(to.add(i * V::LANES));
                        }
                    }
                }
            }
            unit += vectors * V::LANES;
        }
    }
}
