//! Sums over long vectors, in a fixed order.
//!
//! Partial sums let the compiler use vector registers of any width; because their order is part of the program and nothing
//! is fused, every machine gives the same bits.

use crate::ends::ends;
use crate::real::Real;
use crate::wide::widest;
use nalgebra::Vector3;

const LANES: usize = 8;

widest! {
    /// `a . b` in double precision.
    pub(crate) fn dot<E: Real>(a: &[E], b: &[E]) -> f64 = dot_loop
}

#[inline(always)]
fn dot_loop<E: Real>(a: &[E], b: &[E]) -> f64 {
    sum_pairs(a, b, |x, y| x * y)
}

widest! {
    /// Euclidean distance.
    pub(crate) fn distance<E: Real>(a: &[E], b: &[E]) -> f64 = distance_loop
}

#[inline(always)]
fn distance_loop<E: Real>(a: &[E], b: &[E]) -> f64 {
    sum_pairs(a, b, |x, y| (x - y) * (x - y)).sqrt()
}

/// Standard deviation of values about their mean.
pub fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt()
}

/// Where the largest magnitude is; the first of equals, and 0 where there is none.
pub(crate) fn largest(x: &[f64]) -> usize {
    x.iter().enumerate().fold((0, 0.0), |best, (at, x)| if x.abs() > best.1 { (at, x.abs()) } else { best }).0
}

/// How far two answers differ anywhere, over the range of the first: at least a hundred-thousandth of its level, or of what is
/// `natural`, so that rounding is no difference.
pub(crate) fn farthest(x: &[f64], other: &[f64], natural: f64) -> f64 {
    let (low, high) = ends(x.iter().copied());
    let range = (high - low).max(1e-5 * high.abs().max(low.abs()).max(natural));
    let farthest = x.iter().zip(other).map(|(a, b)| (a - b).abs());
    farthest.fold(0.0, |most: f64, off| if off <= most { most } else { off }) / range
}

/// Sum of a function of each pair. Single precision has four times as many partial sums, which hide that they are widened.
#[inline(always)]
fn sum_pairs<E: Real>(a: &[E], b: &[E], of: impl Fn(f64, f64) -> f64) -> f64 {
    if size_of::<E>() == 4 { sum_in::<E, 32>(a, b, of) } else { sum_in::<E, LANES>(a, b, of) }
}

/// The same in so many partial sums, a multiple of eight.
#[inline(always)]
fn sum_in<E: Real, const SUMS: usize>(a: &[E], b: &[E], of: impl Fn(f64, f64) -> f64) -> f64 {
    let mut sums = [0.0; SUMS];
    let (a_blocks, a_rest) = a.as_chunks::<SUMS>();
    let (b_blocks, b_rest) = b.as_chunks::<SUMS>();
    for (x, y) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..SUMS {
            sums[lane] += of(x[lane].to_f64(), y[lane].to_f64());
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| of(x.to_f64(), y.to_f64())).sum();
    sums.as_chunks::<LANES>().0.iter().map(sum_lanes).sum::<f64>() + rest
}

/// Sum of eight lanes, pairwise by halves.
#[inline(always)]
pub(crate) fn sum_lanes(lanes: &[f64; LANES]) -> f64 {
    ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
}

/// Euclidean norm.
pub(crate) fn norm<E: Real>(a: &[E]) -> f64 {
    dot(a, a).sqrt()
}

widest! {
    /// `y += factor * x`
    pub(crate) fn add_scaled<E: Real>(y: &mut [E], factor: f64, x: &[E]) = add_scaled_loop
}

#[inline(always)]
fn add_scaled_loop<E: Real>(y: &mut [E], factor: f64, x: &[E]) {
    let factor = E::from_f64(factor);
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * *x;
    }
}

widest! {
    /// `out = origin + factor * direction`
    pub(crate) fn along<E: Real>(out: &mut [E], origin: &[E], factor: f64, direction: &[E]) = along_loop
}

#[inline(always)]
fn along_loop<E: Real>(out: &mut [E], origin: &[E], factor: f64, direction: &[E]) {
    let factor = E::from_f64(factor);
    for ((out, x), d) in out.iter_mut().zip(origin).zip(direction) {
        *out = *x + factor * *d;
    }
}

widest! {
    /// `out = a - b`
    pub(crate) fn difference<E: Real>(out: &mut [E], a: &[E], b: &[E]) = difference_loop
}

#[inline(always)]
fn difference_loop<E: Real>(out: &mut [E], a: &[E], b: &[E]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = *a - *b;
    }
}

widest! {
    /// True where every element is finite.
    pub(crate) fn all_finite<E: Real>(a: &[E]) -> bool = all_finite_loop
}

#[inline(always)]
fn all_finite_loop<E: Real>(a: &[E]) -> bool {
    // No branch per element.
    a.chunks(64).all(|some| some.iter().fold(true, |all, x| all & x.is_finite()))
}

/// Root of the mean of the squares; zero of nothing.
pub(crate) fn root_mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    if count == 0.0 { 0.0 } else { (sum / count).sqrt() }
}

/// The middle of a cloud, and its radius: the root mean square of the distances from there.
pub(crate) fn spread(points: impl ExactSizeIterator<Item = Vector3<f64>> + Clone) -> (Vector3<f64>, f64) {
    let count = points.len().max(1) as f64;
    let middle = points.clone().sum::<Vector3<f64>>() / count;
    let square = points.map(|point| (point - middle).norm_squared()).sum::<f64>() / count;
    (middle, square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_that_is_not_finite_is_found() {
        assert!(all_finite::<f64>(&[]) && all_finite(&[f32::MAX; 200]));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for at in [0, 63, 64, 199] {
                let mut values = [-1.0; 200];
                values[at] = bad;
                assert!(!all_finite(&values), "{bad} at {at}");
            }
        }
    }
}
