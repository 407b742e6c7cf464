//! AVX-512: 16 lanes of f32, 8 of f64.

use super::{Simd, enter, intrinsics, map_by_lane};
use crate::real::Real;
use std::arch::x86_64::*;

/// `sign` for the sign bit, `x` for the others, as a truth table of `vpternlog` with operands (x, sign, sign-bit mask).
const COPYSIGN: i32 = 0b1101_1000;

/// Sixteen `f32`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F32x16(__m512);

/// Eight `f64`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F64x8(__m512d);

enter!("avx512f,avx512dq,avx512vl,avx2,fma": F32x16, F64x8);

impl Simd for F32x16 {
    type Elem = f32;
    type Mask = __mmask16;
    const LANES: usize = 16;
    const REGISTERS: usize = 32;
    const FUSED: bool = true;
    intrinsics! {
        add(self, b) = _mm512_add_ps;
        sub(self, b) = _mm512_sub_ps;
        mul(self, b) = _mm512_mul_ps;
        div(self, b) = _mm512_div_ps;
        mul_add(self, b, c) = _mm512_fmadd_ps;
        mul_sub(self, b, c) = _mm512_fmsub_ps;
        neg_mul_add(self, b, c) = _mm512_fnmadd_ps;
        min(self, b) = _mm512_min_ps;
        max(self, b) = _mm512_max_ps;
        sqrt(self) = _mm512_sqrt_ps;
        abs(self) = _mm512_abs_ps;
        scale2(self, n) = _mm512_scalef_ps;
    }
    map_by_lane!();
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: reached only through `dispatch`; likewise below.
        Self(unsafe { _mm512_set1_ps(x) })
    }
    #[inline(always)]
    unsafe fn load(p: *const f32) -> Self {
        // SAFETY: the caller vouches for `p`.
        Self(unsafe { _mm512_loadu_ps(p) })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f32) {
        // SAFETY: the caller vouches for `p`.
        unsafe { _mm512_storeu_ps(p, self.0) }
    }
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe {
            let bit = _mm512_set1_epi32(i32::MIN);
            let (x, sign) = (_mm512_castps_si512(self.0), _mm512_castps_si512(sign.0));
            Self(_mm512_castsi512_ps(_mm512_ternarylogic_epi32::<COPYSIGN>(x, sign, bit)))
        }
    }
    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }
    #[inline(always)]
    fn less(self, b: Self) -> __mmask16 {
        // SAFETY: see `splat`.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask16, yes: Self, no: Self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm512_mask_blend_ps(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        // SAFETY: see `splat`.
        unsafe {
            let half = _mm256_add_ps(_mm512_castps512_ps256(self.0), _mm512_extractf32x8_ps::<1>(self.0));
            super::avx2::sum_ps(half)
        }
    }
}

impl Simd for F64x8 {
    type Elem = f64;
    type Mask = __mmask8;
    const LANES: usize = 8;
    const REGISTERS: usize = 32;
    const FUSED: bool = true;
    intrinsics! {
        add(self, b) = _mm512_add_pd;
        sub(self, b) = _mm512_sub_pd;
        mul(self, b) = _mm512_mul_pd;
        div(self, b) = _mm512_div_pd;
        mul_add(self, b, c) = _mm512_fmadd_pd;
        mul_sub(self, b, c) = _mm512_fmsub_pd;
        neg_mul_add(self, b, c) = _mm512_fnmadd_pd;
        min(self, b) = _mm512_min_pd;
        max(self, b) = _mm512_max_pd;
        sqrt(self) = _mm512_sqrt_pd;
        abs(self) = _mm512_abs_pd;
        scale2(self, n) = _mm512_scalef_pd;
    }
    map_by_lane!();
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: reached only through `dispatch`; likewise below.
        Self(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: the caller vouches for `p`.
        Self(unsafe { _mm512_loadu_pd(p) })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f64) {
        // SAFETY: the caller vouches for `p`.
        unsafe { _mm512_storeu_pd(p, self.0) }
    }
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe {
            let bit = _mm512_set1_epi64(i64::MIN);
            let (x, sign) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(sign.0));
            Self(_mm512_castsi512_pd(_mm512_ternarylogic_epi64::<COPYSIGN>(x, sign, bit)))
        }
    }
    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }
    #[inline(always)]
    fn less(self, b: Self) -> __mmask8 {
        // SAFETY: see `splat`.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, yes: Self, no: Self) -> Self {
        // SAFETY: see `splat`.
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: see `splat`.
        unsafe {
            let half = _mm256_add_pd(_mm512_castpd512_pd256(self.0), _mm512_extractf64x4_pd::<1>(self.0));
            super::avx2::sum_pd(half)
        }
    }
}
