//! The linear heads on a tile: dot products of last-layer channels with each head's weights, and their adjoint.

use super::reading::Output;
use crate::kernel::Precision;
use crate::layer::Shape;
use crate::simd::{Kernel, Simd};

/// `out[output][point] = weights[head] . rows[point][channel]`, without biases.
pub(crate) struct Heads<'a, E> {
    pub(crate) shape: Shape,
    pub(crate) channels: usize,
    pub(crate) outputs: &'a [Output],
    /// `[head][unit]`, `shape.width` apart.
    pub(crate) weights: &'a [E],
    /// Last layer's channels.
    pub(crate) rows: &'a [E],
    /// `[output][point]`, `stride` apart.
    pub(crate) out: &'a mut [E],
    pub(crate) stride: usize,
}

impl<E: Precision> Kernel<E> for Heads<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { shape, channels, outputs, weights, rows, out, stride } = self;
        assert!(rows.len() >= shape.points * channels * shape.ld && shape.width % V::LANES == 0);
        assert!(shape.points <= stride && out.len() >= outputs.len() * stride);
        for (at, output) in outputs.iter().enumerate() {
            let w = &weights[output.head * shape.width..][..shape.width];
            assert!(output.channel < channels);
            for p in 0..shape.points {
                let row = (p * channels + output.channel) * shape.ld;
                let mut sum = V::splat(E::ZERO);
                for u in (0..shape.width).step_by(V::LANES) {
                    // SAFETY: lengths were checked above; u + LANES <= width <= ld.
                    unsafe {
                        sum = V::load(w.as_ptr().add(u)).mul_add(V::load(rows.as_ptr().add(row + u)), sum);
                    }
                }
                out[at * stride + p] = sum.sum();
            }
        }
    }
}

/// Adjoint of [`Heads`] by the rows: overwrites the rows of the channels that are read.
pub(crate) struct HeadsRowsAdjoint<'a, E> {
    pub(crate) shape: Shape,
    pub(crate) channels: usize,
    pub(crate) outputs: &'a [Output],
    pub(crate) weights: &'a [E],
    /// Adjoint of `out`.
    pub(crate) seeds: &'a [E],
    pub(crate) stride: usize,
    pub(crate) rows_bar: &'a mut [E],
}

impl<E: Precision> Kernel<E> for HeadsRowsAdjoint<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { shape, channels, outputs, weights, seeds, stride, rows_bar } = self;
        assert!(rows_bar.len() >= shape.points * channels * shape.ld && shape.width % V::LANES == 0);
        assert!(outputs.iter().all(|o| o.channel < channels && weights.len() >= (o.head + 1) * shape.width));
        let mut first = 0;
        for of_channel in outputs.chunk_by(|a, b| a.channel == b.channel) {
            for p in 0..shape.points {
                let row = (p * channels + of_channel[0].channel) * shape.ld;
                for u in (0..shape.width).step_by(V::LANES) {
                    let mut sum = V::splat(E::ZERO);
                    for (i, output) in of_channel.iter().enumerate() {
                        let seed = V::splat(seeds[(first + i) * stride + p]);
                        // SAFETY: lengths were checked above.
                        sum =
                            unsafe { V::load(weights.as_ptr().add(output.head * shape.width + u)) }.mul_add(seed, sum);
                    }
                    // SAFETY: lengths were checked above.
                    unsafe { sum.store(rows_bar.as_mut_ptr().add(row + u)) };
                }
            }
            first += of_channel.len();
        }
    }
}

/// Adjoint of [`Heads`] by the weights, summed over `shape.points` points from `first` on.
pub(crate) struct HeadsWeightsAdjoint<'a, E> {
    pub(crate) shape: Shape,
    pub(crate) channels: usize,
    pub(crate) outputs: &'a [Output],
    pub(crate) first: usize,
    pub(crate) rows: &'a [E],
    pub(crate) seeds: &'a [E],
    pub(crate) stride: usize,
    /// Adds to `[head][unit]`.
    pub(crate) weights_bar: &'a mut [E],
}

impl<E: Precision> Kernel<E> for HeadsWeightsAdjoint<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { shape, channels, outputs, first, rows, seeds, stride, weights_bar } = self;
        let last = first + shape.points;
        assert!(rows.len() >= last * channels * shape.ld && shape.width % V::LANES == 0);
        for (at, output) in outputs.iter().enumerate() {
            let w_bar = &mut weights_bar[output.head * shape.width..][..shape.width];
            assert!(output.channel < channels);
            for u in (0..shape.width).step_by(V::LANES) {
                // SAFETY: lengths were checked above; u + LANES <= width <= ld.
                unsafe {
                    let mut sum = V::load(w_bar.as_ptr().add(u));
                    for p in first..last {
                        let row = (p * channels + output.channel) * shape.ld + u;
                        sum = V::load(rows.as_ptr().add(row)).mul_add(V::splat(seeds[at * stride + p]), sum);
                    }
                    sum.store(w_bar.as_mut_ptr().add(u));
                }
            }
        }
    }
}
