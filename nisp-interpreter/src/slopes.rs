//! The activation and its derivatives on a block.

use nisp_runtime::activation::Activation;
use nisp_runtime::layer::takes_values;
use nisp_runtime::real::Real;
use nisp_runtime::simd::Simd;

use crate::block::{VECTORS, load};
use crate::scratch::Scratch;

/// How many derivatives of the activation are wanted: the compiled functions know it when they are compiled, so that one
/// of a few is chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes {
    /// The activation itself and its derivatives.
    count: usize,
}

/// Chooses by the number of derivatives: order of the equations and two more.
macro_rules! with_count {
    ($count:expr, $d:ident => $body:expr) => {
        match $count {
            0..=2 => {
                const $d: usize = 2;
                $body
            }
            3 => {
                const $d: usize = 3;
                $body
            }
            4 => {
                const $d: usize = 4;
                $body
            }
            5 => {
                const $d: usize = 5;
                $body
            }
            6 => {
                const $d: usize = 6;
                $body
            }
            7 => {
                const $d: usize = 7;
                $body
            }
            _ => {
                const $d: usize = 8;
                $body
            }
        }
    };
}

impl Slopes {
    /// What rules of this order read: adjoints need one derivative more.
    pub(crate) fn of_order(order: usize) -> Self {
        Self { count: order + 2 }
    }

    /// True if activations and their slopes are given instead of computed.
    pub(crate) fn are_given<E: Real>(self, coordinates: usize) -> bool {
        takes_values::<E>(self.count, coordinates)
    }

    /// Memory for a block's derivatives.
    #[inline(always)]
    pub(crate) fn run<V: Simd>(self) -> SlopesRun<V> {
        let mut memory = Scratch::of::<V::Elem>(self.count * VECTORS * V::LANES);
        SlopesRun { count: self.count, rows: memory.start(), _memory: memory }
    }

    /// How many there are.
    pub(crate) fn count(self) -> usize {
        self.count
    }
}

/// The activation and its derivatives on a block.
pub(crate) struct SlopesRun<V: Simd> {
    count: usize,
    /// A block for each derivative.
    rows: *mut V::Elem,
    _memory: Scratch,
}

impl<V: Simd> SlopesRun<V> {
    /// The activation and its slope of `argument`, with `bias` added if there is one.
    ///
    /// # Safety
    /// All are valid for a block of so many vectors; `value` may be `argument`.
    #[inline(always)]
    pub(crate) unsafe fn activate(
        &self,
        activation: Activation,
        argument: *const V::Elem,
        bias: Option<*const V::Elem>,
        value: *mut V::Elem,
        slope: *mut V::Elem,
        vectors: usize,
    ) {
        // SAFETY: as the caller vouches.
        unsafe {
            for i in 0..vectors {
                let mut a = load::<V>(argument, i);
                if let Some(bias) = bias {
                    a = a.add(load(bias, i));
                }
                let (t, s) = with_count!(self.count, D => activation.value_and_slope::<V, D>(a));
                t.store(value.add(i * V::LANES));
                s.store(slope.add(i * V::LANES));
            }
        }
    }

    /// All derivatives, from the activation and its slope.
    ///
    /// # Safety
    /// Both are valid for a block of so many vectors.
    #[inline(always)]
    pub(crate) unsafe fn derive(
        &mut self,
        activation: Activation,
        value: *const V::Elem,
        slope: *const V::Elem,
        vectors: usize,
    ) {
        // SAFETY: as the caller vouches; the rows hold a block each.
        unsafe {
            for i in 0..vectors {
                let (t, s) = (load::<V>(value, i), load::<V>(slope, i));
                with_count!(self.count, D => {
                    for (n, phi) in activation.derivatives::<V, D>(t, s).into_iter().enumerate().take(self.count) {
                        phi.store(self.row(n).add(i * V::LANES));
                    }
                });
            }
        }
    }

    /// Where derivative `n` is.
    #[inline(always)]
    pub(crate) fn derivative(&self, n: usize) -> *const V::Elem {
        debug_assert!(n < self.count);
        // SAFETY: there is a block for each derivative.
        unsafe { self.rows.add(n * VECTORS * V::LANES) }
    }

    /// Where derivative `n` is written.
    #[inline(always)]
    pub(crate) fn row(&mut self, n: usize) -> *mut V::Elem {
        self.derivative(n).cast_mut()
    }
}
