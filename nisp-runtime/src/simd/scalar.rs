//! Single numbers: for machines without one of our instruction sets, and as the plain reading of the others.

use super::Simd;
use super::trampoline::{Element, Enter, Kernel};
use crate::real::Real;

/// One element: arrays of several make code ten times as large, which the compiler neither inlines nor makes vectors of.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct Single<E>(E);

/// What has no common name in [`Real`].
pub(super) trait Bits: Element {
    /// Magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// 2^n for integral n in the range of normal exponents.
    fn exp2(n: Self) -> Self;
    /// One and a half times the number of values in the mantissa: added and subtracted, it rounds to an integer.
    const ROUNDER: Self;
}

macro_rules! bits {
    ($elem:ident, $rounder:literal, $bias:literal, $shift:literal) => {
        impl Bits for $elem {
            const ROUNDER: Self = $rounder;
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                self.copysign(sign)
            }
            #[inline(always)]
            fn exp2(n: Self) -> Self {
                // The sum has `n + bias` in the lowest bits of its mantissa; the shift takes it to the exponent.
                $elem::from_bits((n + ($rounder + $bias)).to_bits() << $shift)
            }
        }
    };
}

bits!(f32, 12_582_912.0, 127.0, 23);
bits!(f64, 6_755_399_441_055_744.0, 1023.0, 52);

impl<E: Bits> Enter for Single<E> {
    #[inline(never)]
    unsafe fn enter<K: Kernel<E>>(kernel: K) -> K::Output {
        kernel.run::<Self>()
    }
}

impl<E: Bits> Simd for Single<E> {
    type Elem = E;
    type Mask = bool;
    const LANES: usize = 1;
    const REGISTERS: usize = 16;
    const FUSED: bool = false;
    #[inline(always)]
    fn splat(x: E) -> Self {
        Self(x)
    }
    #[inline(always)]
    unsafe fn load(p: *const E) -> Self {
        // SAFETY: the caller vouches for an element.
        Self(unsafe { p.read() })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut E) {
        // SAFETY: the caller vouches for an element.
        unsafe { p.write(self.0) }
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0)
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0)
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0)
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(self.0 / b.0)
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.mul(b).add(c)
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul(b).sub(c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c.sub(self.mul(b))
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(if self.0 < b.0 { self.0 } else { b.0 })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(if self.0 > b.0 { self.0 } else { b.0 })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(Real::sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(Real::abs(self.0))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(E::copysign(self.0, sign.0))
    }
    #[inline(always)]
    fn round(self) -> Self {
        // The method of f32 is a library call on x86 without SSE4.1.
        Self((self.0 + E::ROUNDER) - E::ROUNDER)
    }
    #[inline(always)]
    fn scale2(self, n: Self) -> Self {
        // In two halves: 2^n itself may underflow where the product must not.
        let half = n.mul(Self::lit(0.5)).round();
        let rest = n.sub(half);
        self.mul(Self(E::exp2(half.0))).mul(Self(E::exp2(rest.0)))
    }
    #[inline(always)]
    fn less(self, b: Self) -> bool {
        self.0 < b.0
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn sum(self) -> E {
        self.0
    }
    #[inline(always)]
    fn map(self, f: fn(f64) -> f64) -> Self {
        Self(E::from_f64(f(self.0.to_f64())))
    }
}
