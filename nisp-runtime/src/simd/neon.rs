//! NEON: 4 lanes of f32, 2 of f64.

use super::{Simd, enter, intrinsics, map_by_lane};
use crate::real::Real;
use std::arch::aarch64::*;

/// Four `f32`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F32x4(float32x4_t);

/// Two `f64`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F64x2(float64x2_t);

enter!("neon": F32x4, F64x2);

/// Writes [`Simd`] for one element type. The shift and the number to add are those of its exponent: adding the number moves
/// `n + bias` into the lowest bits of the mantissa, from where the shift takes it to the exponent.
macro_rules! neon {
    (
        $vector:ident, $elem:ident, $lanes:literal, $mask:ident, sign: $sign:expr, exponent: $to_mantissa:expr, $shift:literal,
        $dup:ident, $dup_bits:ident, $load:ident, $store:ident, $fma:ident, $fms:ident, $less:ident, $select:ident,
        $from_bits:ident, $to_bits:ident, $shift_left:ident, $sum:ident, { $($table:tt)* }
    ) => {
        impl $vector {
            /// 2^n for integral n in the range of normal exponents.
            #[inline(always)]
            fn exp2(n: Self) -> Self {
                let shifted = n.add(Self::splat($to_mantissa));
                // SAFETY: reached only through `dispatch`; likewise below.
                Self(unsafe { $from_bits($shift_left::<$shift>($to_bits(shifted.0))) })
            }
        }

        impl Simd for $vector {
            type Elem = $elem;
            type Mask = $mask;
            const LANES: usize = $lanes;
            const REGISTERS: usize = 32;
            const FUSED: bool = true;
            intrinsics! { $($table)* }
            map_by_lane!();
            #[inline(always)]
            fn splat(x: $elem) -> Self {
                // SAFETY: see `exp2`.
                Self(unsafe { $dup(x) })
            }
            #[inline(always)]
            unsafe fn load(p: *const $elem) -> Self {
                // SAFETY: the caller vouches for `p`.
                Self(unsafe { $load(p) })
            }
            #[inline(always)]
            unsafe fn store(self, p: *mut $elem) {
                // SAFETY: the caller vouches for `p`.
                unsafe { $store(p, self.0) }
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: see `exp2`. The intrinsic takes the addend first.
                Self(unsafe { $fma(c.0, self.0, b.0) })
            }
            #[inline(always)]
            fn mul_sub(self, b: Self, c: Self) -> Self {
                self.mul_add(b, c.neg())
            }
            #[inline(always)]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: see `exp2`. The intrinsic takes the minuend first.
                Self(unsafe { $fms(c.0, self.0, b.0) })
            }
            #[inline(always)]
            fn min(self, b: Self) -> Self {
                // By comparison: the instruction's own rule for NaN differs.
                Self::select(self.less(b), self, b)
            }
            #[inline(always)]
            fn max(self, b: Self) -> Self {
                Self::select(b.less(self), self, b)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                // SAFETY: see `exp2`.
                Self(unsafe { $select($dup_bits($sign), sign.0, self.0) })
            }
            #[inline(always)]
            fn scale2(self, n: Self) -> Self {
                // In two halves: 2^n itself may underflow where the product must not.
                let half = n.mul(Self::splat(0.5)).round();
                self.mul(Self::exp2(half)).mul(Self::exp2(n.sub(half)))
            }
            #[inline(always)]
            fn less(self, b: Self) -> $mask {
                // SAFETY: see `exp2`.
                unsafe { $less(self.0, b.0) }
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                // SAFETY: see `exp2`.
                Self(unsafe { $select(mask, yes.0, no.0) })
            }
            #[inline(always)]
            fn sum(self) -> $elem {
                // SAFETY: see `exp2`.
                unsafe { $sum(self.0) }
            }
        }
    };
}

neon! {
    F32x4, f32, 4, uint32x4_t, sign: 1 << 31, exponent: 12_582_912.0 + 127.0, 23,
    vdupq_n_f32, vdupq_n_u32, vld1q_f32, vst1q_f32, vfmaq_f32, vfmsq_f32, vcltq_f32, vbslq_f32,
    vreinterpretq_f32_u32, vreinterpretq_u32_f32, vshlq_n_u32, sum_f32, {
        add(self, b) = vaddq_f32;
        sub(self, b) = vsubq_f32;
        mul(self, b) = vmulq_f32;
        div(self, b) = vdivq_f32;
        neg(self) = vnegq_f32;
        sqrt(self) = vsqrtq_f32;
        abs(self) = vabsq_f32;
        round(self) = vrndnq_f32;
    }
}

neon! {
    F64x2, f64, 2, uint64x2_t, sign: 1 << 63, exponent: 6_755_399_441_055_744.0 + 1023.0, 52,
    vdupq_n_f64, vdupq_n_u64, vld1q_f64, vst1q_f64, vfmaq_f64, vfmsq_f64, vcltq_f64, vbslq_f64,
    vreinterpretq_f64_u64, vreinterpretq_u64_f64, vshlq_n_u64, vpaddd_f64, {
        add(self, b) = vaddq_f64;
        sub(self, b) = vsubq_f64;
        mul(self, b) = vmulq_f64;
        div(self, b) = vdivq_f64;
        neg(self) = vnegq_f64;
        sqrt(self) = vsqrtq_f64;
        abs(self) = vabsq_f64;
        round(self) = vrndnq_f64;
    }
}

/// Sum of all lanes by halves, in the order of the other instruction sets.
///
/// # Safety
/// The machine must have NEON.
#[inline(always)]
unsafe fn sum_f32(x: float32x4_t) -> f32 {
    // SAFETY: the caller vouches for NEON.
    unsafe {
        let half = vadd_f32(vget_low_f32(x), vget_high_f32(x));
        vget_lane_f32::<0>(half) + vget_lane_f32::<1>(half)
    }
}
