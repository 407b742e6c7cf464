//! Fixed features of the coordinates, with all their channels, on a tile of points.
//!
//! The argument is affine, so a channel of `phi(b . x + phase)` is a derivative of `phi` times a polynomial in `b`: the
//! same rule as for an affine layer, with another function in the place of the activation.

use std::marker::PhantomData;

use super::Shape;
use crate::activation::sine;
use crate::real::Real;
use crate::rules::Rules;
use crate::simd::{Kernel, Simd};

/// A function of one variable that features are made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Function {
    /// `sin a`
    Sine,
    /// `scale ln a`
    Logarithm {
        /// Factor.
        scale: f64,
    },
}

/// Features `phi(b . x + phase) + c . x + offset`.
#[derive(Debug)]
pub struct Features<'a, E> {
    /// Shape of the tile, with features in the place of units.
    pub shape: Shape,
    /// The function `phi`.
    pub function: Function,
    /// Projections `b`, `[coordinate][feature]`, `width` apart.
    pub projections: &'a [E],
    /// What `phi` and its derivatives are made of, `[point][2][feature]`.
    pub table: &'a [E],
    /// Linear parts `c`, as the projections.
    pub linear: &'a [E],
    /// Offsets, one per feature.
    pub offsets: &'a [E],
    /// Network coordinates, `[point][coordinate]`.
    pub coordinates: &'a [E],
    /// Output: channels, `[point][channel][feature]`.
    pub output: &'a mut [E],
}

pub(crate) struct FeaturesKernel<'a, E, R, const K: usize, const D: usize, const S: usize>(
    pub(crate) Features<'a, E>,
    pub(crate) PhantomData<R>,
);

/// Smallest argument of a logarithm: features are constant below, where no point of the domain lies.
const SMALLEST: f64 = 0.5;

/// What the features of a point are made of, two rows with an entry for each: sine and cosine of its argument, or logarithm
/// and argument. Points stay for many steps, and these functions go element by element.
pub(crate) fn tabulate<E: Real>(function: Function, point: &[E], projections: &[E], phases: &[E], table: &mut [E]) {
    let (values, others) = table.split_at_mut(phases.len());
    for (u, (value, other)) in values.iter_mut().zip(others).enumerate() {
        let along = point.iter().zip(projections.iter().skip(u).step_by(phases.len()));
        let a = along.fold(phases[u], |a, (x, b)| a + *b * *x).to_f64();
        [*value, *other] = match function {
            Function::Sine => [E::from_f64(a.sin()), E::from_f64(a.cos())],
            Function::Logarithm { scale } => {
                let a = a.max(SMALLEST);
                [E::from_f64(scale) * E::from_f64(a.ln()), E::from_f64(a)]
            }
        };
    }
}

/// `phi(a)` and its derivatives, from the two entries of a table.
#[inline(always)]
pub fn derivatives<V: Simd, const D: usize>(function: Function, [value, other]: [V; 2]) -> [V; D] {
    match function {
        Function::Sine => sine::derivatives(value, other),
        Function::Logarithm { scale } => {
            let mut phi = [value; D];
            // The other is the argument a; derivative n is scale (-1)^(n - 1) (n - 1)! / a^n.
            let mut last = V::splat(V::Elem::from_f64(scale)).div(other);
            for (n, phi) in phi.iter_mut().enumerate().skip(1) {
                *phi = last;
                last = last.mul(V::splat(V::Elem::from_f64(-(n as f64)))).div(other);
            }
            phi
        }
    }
}

impl<E: Real, R: Rules<K, D, S>, const K: usize, const D: usize, const S: usize> Kernel<E>
    for FeaturesKernel<'_, E, R, K, D, S>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Features { shape, function, projections, table, linear, offsets, coordinates, output } = self.0;
        shape.holds(output, K);
        assert!([projections, linear].iter().all(|x| x.len() >= S * shape.width));
        assert!(table.len() >= shape.points * 2 * shape.width && offsets.len() >= shape.width);
        assert!(coordinates.len() >= shape.points * S && shape.width % V::LANES == 0);
        for u in (0..shape.width).step_by(V::LANES) {
            // SAFETY: lengths were checked above; u + LANES <= width.
            unsafe {
                let mut b = [V::splat(E::ZERO); S];
                let mut c = b;
                for i in 0..S {
                    b[i] = V::load(projections.as_ptr().add(i * shape.width + u));
                    c[i] = V::load(linear.as_ptr().add(i * shape.width + u));
                }
                for p in 0..shape.points {
                    let entry = |row: usize| V::load(table.as_ptr().add((2 * p + row) * shape.width + u));
                    let mut line = [V::splat(E::ZERO); D];
                    line[0] = V::load(offsets.as_ptr().add(u));
                    for (i, &c) in c.iter().enumerate() {
                        let x = V::splat(*coordinates.get_unchecked(p * S + i));
                        line[0] = c.mul_add(x, line[0]);
                    }
                    if D > 1 {
                        line[1] = V::splat(E::ONE);
                    }
                    let curved = R::affine(&derivatives::<V, D>(function, [entry(0), entry(1)]), &b);
                    for (k, y) in curved.into_iter().zip(R::affine(&line, &c)).map(|(x, y)| x.add(y)).enumerate() {
                        y.store(output.as_mut_ptr().add((p * K + k) * shape.ld + u));
                    }
                }
            }
        }
    }
}
