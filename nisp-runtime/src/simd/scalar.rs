//! Arrays: for machines without one of our instruction sets, and as the plain reading of the others.

use super::Simd;
use super::trampoline::{Element, Enter, Kernel};
use crate::real::Real;

/// `N` elements of type `E`: as wide as the vectors that any target's compiler makes of it (SSE2, WebAssembly).
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct Array<E, const N: usize>([E; N]);

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

impl<E: Bits, const N: usize> Array<E, N> {
    #[inline(always)]
    fn unary(self, f: impl Fn(E) -> E) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i])))
    }
    #[inline(always)]
    fn binary(self, b: Self, f: impl Fn(E, E) -> E) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
    }
}

impl<E: Bits, const N: usize> Enter for Array<E, N> {
    #[inline(never)]
    unsafe fn enter<K: Kernel<E>>(kernel: K) -> K::Output {
        kernel.run::<Self>()
    }
}

impl<E: Bits, const N: usize> Simd for Array<E, N> {
    type Elem = E;
    type Mask = [bool; N];
    const LANES: usize = N;
    const REGISTERS: usize = 16;
    const FUSED: bool = false;
    #[inline(always)]
    fn splat(x: E) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    unsafe fn load(p: *const E) -> Self {
        // SAFETY: the caller vouches for N elements.
        Self(unsafe { p.cast::<[E; N]>().read() })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut E) {
        // SAFETY: the caller vouches for N elements.
        unsafe { p.cast::<[E; N]>().write(self.0) }
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.binary(b, |x, y| x + y)
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.binary(b, |x, y| x - y)
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.binary(b, |x, y| x * y)
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.binary(b, |x, y| x / y)
    }
    #[inline(always)]
    fn neg(self) -> Self {
        self.unary(|x| -x)
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
        self.binary(b, |x, y| if x < y { x } else { y })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.binary(b, |x, y| if x > y { x } else { y })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.unary(Real::sqrt)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.unary(Real::abs)
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.binary(sign, E::copysign)
    }
    #[inline(always)]
    fn round(self) -> Self {
        // The method of f32 is a library call on x86 without SSE4.1.
        self.unary(|x| (x + E::ROUNDER) - E::ROUNDER)
    }
    #[inline(always)]
    fn scale2(self, n: Self) -> Self {
        // In two halves: 2^n itself may underflow where the product must not.
        let half = n.mul(Self::lit(0.5)).round();
        let rest = n.sub(half);
        self.mul(half.unary(E::exp2)).mul(rest.unary(E::exp2))
    }
    #[inline(always)]
    fn less(self, b: Self) -> [bool; N] {
        std::array::from_fn(|i| self.0[i] < b.0[i])
    }
    #[inline(always)]
    fn select(mask: [bool; N], yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| if mask[i] { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn sum(self) -> E {
        let mut lanes = self.0;
        let mut n = N;
        while n > 1 {
            n /= 2;
            for i in 0..n {
                lanes[i] += lanes[i + n];
            }
        }
        lanes[0]
    }
    #[inline(always)]
    fn map(self, f: fn(f64) -> f64) -> Self {
        self.unary(|x| E::from_f64(f(x.to_f64())))
    }
}
