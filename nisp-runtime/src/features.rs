//! Random Fourier features of the coordinates, with all their channels, on a tile of points.
//!
//! The argument is affine, so a channel of `sin(b . x + phase)` is a shifted sine times a polynomial in `b`: the same rule
//! as for an affine layer, with the derivatives of the sine in place of those of `tanh`.

use std::marker::PhantomData;

use crate::kernel::Rules;
use crate::layer::Shape;
use crate::real::Real;
use crate::simd::{Kernel, Simd};

/// Features `sin(b . x + phase)`; a cosine is a sine a quarter turn ahead.
#[derive(Debug)]
pub struct Features<'a, E> {
    /// Shape of the tile, with features in the place of units.
    pub shape: Shape,
    /// Projections `b`, `[coordinate][feature]`, `width` apart.
    pub projections: &'a [E],
    /// Phases, one per feature.
    pub phases: &'a [E],
    /// Network coordinates, `[point][coordinate]`.
    pub coordinates: &'a [E],
    /// Output: channels, `[point][channel][feature]`.
    pub output: &'a mut [E],
}

pub(crate) struct FeaturesKernel<'a, E, R, const K: usize, const D: usize, const S: usize>(
    pub(crate) Features<'a, E>,
    pub(crate) PhantomData<R>,
);

impl<E: Real, R: Rules<K, D, S>, const K: usize, const D: usize, const S: usize> Kernel<E>
    for FeaturesKernel<'_, E, R, K, D, S>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Features { shape, projections, phases, coordinates, output } = self.0;
        shape.holds(output, K);
        assert!(projections.len() >= S * shape.width && phases.len() >= shape.width);
        assert!(coordinates.len() >= shape.points * S && shape.width % V::LANES == 0);
        for u in (0..shape.width).step_by(V::LANES) {
            // SAFETY: lengths were checked above; u + LANES <= width.
            unsafe {
                let mut b = [V::splat(E::ZERO); S];
                for (i, b) in b.iter_mut().enumerate() {
                    *b = V::load(projections.as_ptr().add(i * shape.width + u));
                }
                for p in 0..shape.points {
                    let mut a = V::load(phases.as_ptr().add(u));
                    for (i, &b) in b.iter().enumerate() {
                        a = b.mul_add(V::splat(*coordinates.get_unchecked(p * S + i)), a);
                    }
                    let (sin, cos) = (a.map(f64::sin), a.map(f64::cos));
                    let (zero, mut phi) = (V::splat(E::ZERO), [sin; D]);
                    for (n, phi) in phi.iter_mut().enumerate() {
                        *phi = [sin, cos, zero.sub(sin), zero.sub(cos)][n % 4];
                    }
                    for (k, y) in R::affine(&phi, &b).into_iter().enumerate() {
                        y.store(output.as_mut_ptr().add((p * K + k) * shape.ld + u));
                    }
                }
            }
        }
    }
}
