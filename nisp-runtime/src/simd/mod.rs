//! Vectors of the instruction set that the machine has, chosen at run time.
//!
//! Code generic over [`Simd`] must be `#[inline(always)]` all the way down to the intrinsics and must be entered
//! through [`dispatch`]: its trampolines carry `#[target_feature]`. A call through a closure or a function that is not
//! inlined loses the features, and with them a factor of a hundred.

use crate::real::Real;

/// A vector of `LANES` elements.
pub trait Simd: Copy + Send + Sync + 'static {
    /// Element type.
    type Elem: Real;
    /// Number of elements.
    const LANES: usize;
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
    /// `self * b - c`
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Smaller of the two, per lane.
    fn min(self, b: Self) -> Self;
    /// Larger of the two, per lane.
    fn max(self, b: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Sum of all lanes, in a fixed order (pairwise by halves).
    fn sum(self) -> Self::Elem;
    /// Applies a scalar function to every lane: for the rare functions of residuals (`sin`, `ln`), not for hot loops.
    fn map(self, f: fn(f64) -> f64) -> Self;
}
