//! Vectors of the instruction set that the machine has, chosen at run time.
//!
//! Code generic over [`Simd`] must be `#[inline(always)]` all the way down to the intrinsics and must be entered
//! through [`dispatch`]: its trampolines carry `#[target_feature]`. A call through a closure or a function that is not
//! inlined loses the features, and with them a factor of a hundred.
//!
//! ```
//! use nisp_runtime::real::Real;
//! use nisp_runtime::simd::{Isa, Kernel, Simd, dispatch};
//!
//! struct SumOfSquares<'a, E>(&'a [E]);
//!
//! impl<E: Real> Kernel<E> for SumOfSquares<'_, E> {
//!     type Output = E;
//!     #[inline(always)]
//!     fn run<V: Simd<Elem = E>>(self) -> E {
//!         let mut sum = V::splat(E::ZERO);
//!         for chunk in self.0.chunks_exact(V::LANES) {
//!             // SAFETY: the chunk has LANES elements.
//!             let x = unsafe { V::load(chunk.as_ptr()) };
//!             sum = x.mul_add(x, sum);
//!         }
//!         sum.sum()
//!     }
//! }
//!
//! assert_eq!(dispatch(Isa::detect(), SumOfSquares(&[2.0_f32; 32])), 128.0);
//! ```

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod dispatch;
mod isa;
#[cfg(target_arch = "aarch64")]
mod neon;
mod scalar;
mod trampoline;

use crate::real::Real;
pub use dispatch::dispatch;
pub(crate) use dispatch::plain;
pub use isa::Isa;
pub use trampoline::{Element, Kernel};

/// A vector of `LANES` elements.
pub trait Simd: Copy + Send + Sync + 'static {
    /// Element type.
    type Elem: Element;
    /// The outcome of a comparison, per lane.
    type Mask: Copy;
    /// Number of elements.
    const LANES: usize;
    /// Number of vector registers that the compiler can use.
    const REGISTERS: usize;
    /// Whether [`mul_add`](Simd::mul_add) and its siblings round once. Without the instruction they multiply, round
    /// and add: a fused emulation would be a library call per lane.
    const FUSED: bool;
    /// All lanes equal to `x`.
    fn splat(x: Self::Elem) -> Self;
    /// All lanes equal to the literal `x`, rounded to the element type.
    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::splat(Self::Elem::from_f64(x))
    }
    /// Reads `LANES` elements.
    ///
    /// # Safety
    /// `p` must be valid for reads of `LANES` elements; no alignment is needed.
    unsafe fn load(p: *const Self::Elem) -> Self;
    /// Writes `LANES` elements.
    ///
    /// # Safety
    /// `p` must be valid for writes of `LANES` elements; no alignment is needed.
    unsafe fn store(self, p: *mut Self::Elem);
    /// `self + b`
    fn add(self, b: Self) -> Self;
    /// `self - b`
    fn sub(self, b: Self) -> Self;
    /// `self * b`
    fn mul(self, b: Self) -> Self;
    /// `self / b`
    fn div(self, b: Self) -> Self;
    /// `-self`
    fn neg(self) -> Self;
    /// `self * b + c`, fused where the instruction set has it.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b - c`, fused where the instruction set has it.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, fused where the instruction set has it.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// `self` where `self < b`, else `b`: the result is `b` where either is NaN.
    fn min(self, b: Self) -> Self;
    /// `self` where `self > b`, else `b`: the result is `b` where either is NaN.
    fn max(self, b: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Nearest integer, ties to even; for `|self|` below 2^22 (f32) or 2^51 (f64).
    fn round(self) -> Self;
    /// `self * 2^n` with gradual underflow, for integral `n` between -252 and 254 (f32) or -2044 and 2046 (f64).
    fn scale2(self, n: Self) -> Self;
    /// Where `self < b`; false where either is NaN.
    fn less(self, b: Self) -> Self::Mask;
    /// `yes` where the mask holds, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Sum of all lanes, in a fixed order (pairwise by halves).
    fn sum(self) -> Self::Elem;
    /// Applies a scalar function to every lane: for the rare functions of residuals (`sin`, `ln`), not for hot loops.
    fn map(self, f: fn(f64) -> f64) -> Self;
}

/// Writes the methods of [`Simd`] that are one intrinsic with vector operands, as a table `method(operands) = intrinsic`.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
macro_rules! intrinsics {
    ($($method:ident($self:ident $(, $operand:ident)*) = $intrinsic:ident;)*) => {
        $(
            #[inline(always)]
            fn $method($self $(, $operand: Self)*) -> Self {
                // SAFETY: a vector exists only behind `dispatch`, which has made sure of the instruction set.
                Self(unsafe { $intrinsic($self.0 $(, $operand.0)*) })
            }
        )*
    };
}

/// Writes the trampolines into an instruction set for its vectors.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
macro_rules! enter {
    ($features:literal: $($vector:ident),*) => {
        $(
            impl $crate::simd::trampoline::Enter for $vector {
                #[target_feature(enable = $features)]
                unsafe fn enter<K: $crate::simd::Kernel<Self::Elem>>(kernel: K) -> K::Output {
                    kernel.run::<Self>()
                }
            }
        )*
    };
}

/// Writes [`Simd::map`] through an array.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
macro_rules! map_by_lane {
    () => {
        #[inline(always)]
        fn map(self, f: fn(f64) -> f64) -> Self {
            let mut lanes = [Self::Elem::ZERO; Self::LANES];
            // SAFETY: the array has LANES elements.
            unsafe { self.store(lanes.as_mut_ptr()) };
            for x in &mut lanes {
                *x = Self::Elem::from_f64(f(x.to_f64()));
            }
            // SAFETY: as above.
            unsafe { Self::load(lanes.as_ptr()) }
        }
    };
}

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
use {enter, intrinsics, map_by_lane};
