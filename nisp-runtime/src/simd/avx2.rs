//! AVX2 with FMA: 8 lanes of f32, 4 of f64.

use super::{Simd, enter, intrinsics, map_by_lane};
use crate::real::Real;
use std::arch::x86_64::*;

/// Eight `f32`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F32x8(__m256);

/// Four `f64`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F64x4(__m256d);

/// Sum of all lanes by halves.
///
/// # Safety
/// The machine must have AVX.
#[inline(always)]
pub(super) unsafe fn sum_ps(x: __m256) -> f32 {
    // SAFETY: the caller vouches for AVX.
    unsafe {
        let x = _mm_add_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
        let x = _mm_add_ps(x, _mm_movehl_ps(x, x));
        _mm_cvtss_f32(_mm_add_ss(x, _mm_movehdup_ps(x)))
    }
}

/// Sum of all lanes by halves.
///
/// # Safety
/// The machine must have AVX.
#[inline(always)]
pub(super) unsafe fn sum_pd(x: __m256d) -> f64 {
    // SAFETY: the caller vouches for AVX.
    unsafe {
        let x = _mm_add_pd(_mm256_castpd256_pd128(x), _mm256_extractf128_pd::<1>(x));
        _mm_cvtsd_f64(_mm_add_sd(x, _mm_unpackhi_pd(x, x)))
    }
}

/// 2^n for integral n in the range of normal exponents: adding the number moves `n + bias` into the lowest bits of the
/// mantissa, from where a shift takes it to the exponent.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn exp2_ps(n: __m256) -> __m256 {
    // SAFETY: the caller vouches for AVX2.
    unsafe {
        let shifted = _mm256_add_ps(n, _mm256_set1_ps(12_582_912.0 + 127.0));
        _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_castps_si256(shifted)))
    }
}

/// See [`exp2_ps`].
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn exp2_pd(n: __m256d) -> __m256d {
    // SAFETY: the caller vouches for AVX2.
    unsafe {
        let shifted = _mm256_add_pd(n, _mm256_set1_pd(6_755_399_441_055_744.0 + 1023.0));
        _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(shifted)))
    }
}

enter!("avx2,fma": F32x8, F64x4);

impl Simd for F32x8 {
    type Elem = f32;
    type Mask = __m256;
    const LANES: usize = 8;
    const REGISTERS: usize = 16;
    const FUSED: bool = true;
    intrinsics! {
        add(self, b) = _mm256_add_ps;
        sub(self, b) = _mm256_sub_ps;
        mul(self, b) = _mm256_mul_ps;
        div(self, b) = _mm256_div_ps;
        mul_add(self, b, c) = _mm256_fmadd_ps;
        mul_sub(self, b, c) = _mm256_fmsub_ps;
        neg_mul_add(self, b, c) = _mm256_fnmadd_ps;
        min(self, b) = _mm256_min_ps;
        max(self, b) = _mm256_max_ps;
        sqrt(self) = _mm256_sqrt_ps;
    }
    map_by_lane!();
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: reached only through `dispatch`; likewise below.
        Self(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    unsafe fn load(p: *const f32) -> Self {
        // SAFETY: the caller vouches for `p`.
        Self(unsafe { _mm256_loadu_ps(p) })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f32) {
        // SAFETY: the caller vouches for `p`.
        unsafe { _mm256_storeu_ps(p, self.0) }
    }
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe {
            let bit = _mm256_set1_ps(-0.0);
            Self(_mm256_or_ps(_mm256_andnot_ps(bit, self.0), _mm256_and_ps(bit, sign.0)))
        }
    }
    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }
    #[inline(always)]
    fn scale2(self, n: Self) -> Self {
        // In two halves: 2^n itself may underflow where the product must not.
        let half = n.mul(Self::splat(0.5)).round();
        // SAFETY: see `splat`.
        unsafe { self.mul(Self(exp2_ps(half.0))).mul(Self(exp2_ps(n.sub(half).0))) }
    }
    #[inline(always)]
    fn less(self, b: Self) -> __m256 {
        // SAFETY: see `splat`.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __m256, yes: Self, no: Self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        // SAFETY: see `splat`.
        unsafe { sum_ps(self.0) }
    }
}

impl Simd for F64x4 {
    type Elem = f64;
    type Mask = __m256d;
    const LANES: usize = 4;
    const REGISTERS: usize = 16;
    const FUSED: bool = true;
    intrinsics! {
        add(self, b) = _mm256_add_pd;
        sub(self, b) = _mm256_sub_pd;
        mul(self, b) = _mm256_mul_pd;
        div(self, b) = _mm256_div_pd;
        mul_add(self, b, c) = _mm256_fmadd_pd;
        mul_sub(self, b, c) = _mm256_fmsub_pd;
        neg_mul_add(self, b, c) = _mm256_fnmadd_pd;
        min(self, b) = _mm256_min_pd;
        max(self, b) = _mm256_max_pd;
        sqrt(self) = _mm256_sqrt_pd;
    }
    map_by_lane!();
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: reached only through `dispatch`; likewise below.
        Self(unsafe { _mm256_set1_pd(x) })
    }
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: the caller vouches for `p`.
        Self(unsafe { _mm256_loadu_pd(p) })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f64) {
        // SAFETY: the caller vouches for `p`.
        unsafe { _mm256_storeu_pd(p, self.0) }
    }
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe {
            let bit = _mm256_set1_pd(-0.0);
            Self(_mm256_or_pd(_mm256_andnot_pd(bit, self.0), _mm256_and_pd(bit, sign.0)))
        }
    }
    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_round_pd::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }
    #[inline(always)]
    fn scale2(self, n: Self) -> Self {
        // In two halves: 2^n itself may underflow where the product must not.
        let half = n.mul(Self::splat(0.5)).round();
        // SAFETY: see `splat`.
        unsafe { self.mul(Self(exp2_pd(half.0))).mul(Self(exp2_pd(n.sub(half).0))) }
    }
    #[inline(always)]
    fn less(self, b: Self) -> __m256d {
        // SAFETY: see `splat`.
        unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __m256d, yes: Self, no: Self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: see `splat`.
        unsafe { sum_pd(self.0) }
    }
}
