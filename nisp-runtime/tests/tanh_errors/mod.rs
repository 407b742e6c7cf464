//! tanh and its derivatives in twice the precision, and how far the kernels' are off.

use nisp_runtime::activation::tanh::{derivatives, tanh_and_slope};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Kernel, Simd};

use crate::double_double::{Dd, exponential};

/// Derivatives under test: the function and its first six, which are promised.
pub(crate) const D: usize = 7;

/// A derivative counts as away from its zeros where it is at least this share of the largest size, relative to s or t s,
/// that it ever has: nearer, even a slope that is rounded correctly leaves it fewer digits.
const AWAY: f64 = 2.0 / 3.0;

/// Functions that a field of second order takes, with its adjoint: their slope is made in fewer steps.
pub(crate) const FEW: usize = 4;

/// Computes `[t, s, ...]` of every input: one row per input, as where all functions are wanted, then one as where the
/// first [`FEW`] are, the others as before.
pub(crate) struct Rows<'a, E>(pub(crate) &'a [E]);

impl<E: Real> Kernel<E> for Rows<'_, E> {
    type Output = Vec<[E; D]>;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> Vec<[E; D]> {
        let mut rows = vec![[E::ZERO; D]; 2 * self.0.len()];
        let (all, few) = rows.split_at_mut(self.0.len());
        let mut lanes = vec![E::ZERO; V::LANES];
        let outputs = all.chunks_mut(V::LANES).zip(few.chunks_mut(V::LANES));
        for (inputs, (all, few)) in self.0.chunks(V::LANES).zip(outputs) {
            lanes[..inputs.len()].copy_from_slice(inputs);
            // SAFETY: `lanes` has LANES elements.
            let a = unsafe { V::load(lanes.as_ptr()) };
            let (t, s) = tanh_and_slope::<V, D>(a);
            let mut phi = derivatives::<V, D>(t, s);
            put(&phi, all, &mut lanes);
            let (t, s) = tanh_and_slope::<V, FEW>(a);
            phi[..FEW].copy_from_slice(&derivatives::<V, FEW>(t, s));
            put(&phi, few, &mut lanes);
        }
        rows
    }
}

/// Writes a vector's functions to its rows, by way of `lanes`.
#[inline(always)]
fn put<V: Simd>(phi: &[V; D], rows: &mut [[V::Elem; D]], lanes: &mut [V::Elem]) {
    for (n, value) in phi.iter().enumerate() {
        assert_eq!(lanes.len(), V::LANES);
        // SAFETY: `lanes` has LANES elements.
        unsafe { value.store(lanes.as_mut_ptr()) };
        for (row, &x) in rows.iter_mut().zip(&*lanes) {
            row[n] = x;
        }
    }
}

/// The derivatives as Taylor coefficients of the solution of t' = s, s' = -2 t s: no polynomial of ours.
fn reference<T: Copy + From<f64> + std::ops::Add<Output = T> + std::ops::Mul<Output = T>>(
    t: T,
    s: T,
    zero: T,
    inverse: impl Fn(f64) -> T,
) -> [T; D] {
    let (mut t_k, mut s_k) = ([zero; D], [zero; D]);
    (t_k[0], s_k[0]) = (t, s);
    for k in 0..D - 1 {
        let product = (0..=k).fold(zero, |sum, i| sum + t_k[i] * s_k[k - i]);
        t_k[k + 1] = s_k[k] * inverse((k + 1) as f64);
        s_k[k + 1] = product * T::from(-2.0) * inverse((k + 1) as f64);
    }
    let mut factorial = 1.0;
    std::array::from_fn(|k| {
        factorial *= k.max(1) as f64;
        t_k[k] * T::from(factorial)
    })
}

pub(crate) fn reference_single(a: f32) -> [f64; D] {
    let a = f64::from(a);
    let e = (-2.0 * a.abs()).exp();
    reference(a.tanh(), 4.0 * e / ((1.0 + e) * (1.0 + e)), 0.0, |k| 1.0 / k)
}

pub(crate) fn reference_double(a: f64) -> [Dd; D] {
    let (e, less_one) = exponential(Dd::from(-2.0 * a.abs()));
    let sum = less_one + Dd::from(2.0);
    let t = -less_one / sum;
    let t = if a < 0.0 { -t } else { t };
    reference(t, Dd::from(4.0) * e / (sum * sum), Dd::ZERO, |k| Dd::from(1.0) / Dd::from(k))
}

/// Largest |phi_n| over its factor, s or t s, for each n.
pub(crate) fn largest_ratios() -> [f64; D] {
    let mut largest = [0.0_f64; D];
    for i in 1..4000 {
        let phi = reference_single(i as f32 * 5e-3);
        for n in 1..D {
            largest[n] = largest[n].max((phi[n] / factor(&phi, n)).abs());
        }
    }
    largest
}

fn factor(phi: &[f64; D], n: usize) -> f64 {
    if n.is_multiple_of(2) { phi[0] * phi[1] } else { phi[1] }
}

/// Distance from `x` to the next number of type `E` away from zero, at least that at the least normal number times 64:
/// what a denormal slope lacks in digits, the largest coefficient hands on.
fn spacing<E: Real>(x: f64) -> f64 {
    let (least_exponent, digits) = if E::NAME == "f32" { (-126, 23) } else { (-1022, 52) };
    let exponent = (x.abs().to_bits() >> 52) as i32 - 1023;
    let exponent = exponent.max(least_exponent + 6) - digits;
    // A power of two, which may be denormal.
    if exponent >= -1022 {
        f64::from_bits(((exponent + 1023) as u64) << 52)
    } else {
        f64::from_bits(1 << (exponent + 1074))
    }
}

/// Worst errors over a set of inputs: units in the last place away from zeros, and elsewhere in units of epsilon times
/// the size that the derivative has nearby.
#[derive(Default, Debug)]
pub(crate) struct Worst {
    pub(crate) ulps: [f64; D],
    pub(crate) near_zeros: [f64; D],
}

impl Worst {
    /// `error[n]` is the computed value minus `phi[n]`.
    pub(crate) fn add<E: Real>(&mut self, phi: &[f64; D], error: &[f64; D], largest: &[f64; D]) {
        self.ulps[0] = self.ulps[0].max(error[0].abs() / spacing::<E>(phi[0]));
        for n in 1..D {
            let size = factor(phi, n).abs() * largest[n];
            if phi[n].abs() >= AWAY * size {
                self.ulps[n] = self.ulps[n].max(error[n].abs() / spacing::<E>(phi[n]));
            } else {
                self.near_zeros[n] = self.near_zeros[n].max(error[n].abs() / spacing::<E>(size));
            }
        }
    }
}
