//! The two element types, `f32` and `f64`.

/// A floating-point number: `f32` or `f64`, no other can exist.
#[expect(private_bounds, reason = "seals the trait")]
pub trait Real:
    Sealed
    + Copy
    + Send
    + Sync
    + 'static
    + PartialOrd
    + std::fmt::Debug
    + std::fmt::Display
    + Default
    + std::iter::Sum
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::Div<Output = Self>
    + std::ops::Neg<Output = Self>
    + std::ops::AddAssign
    + std::ops::SubAssign
    + std::ops::MulAssign
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// Distance from one to the next larger number.
    const EPSILON: Self;
    /// Products that are summed before their sum is added to those before, where that is asked for: a long sum of few bits
    /// loses to rounding what short ones keep.
    const SUMMED: usize;
    /// Highest order of derivatives that may be taken at values of this precision; for higher ones over at most four
    /// coordinates, layers are given values in double precision.
    const HIGHEST_ORDER: usize;
    /// Name as users write it: `f32` or `f64`.
    const NAME: &'static str;
    /// Rounds to this type.
    fn from_f64(x: f64) -> Self;
    /// Widens to double precision.
    fn to_f64(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// False for NaN and infinities.
    fn is_finite(self) -> bool;
}

/// What only this module implements.
trait Sealed {}

macro_rules! real {
    ($type:ident, $summed:expr, $orders:expr) => {
        impl Sealed for $type {}

        impl Real for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $type::EPSILON;
            const SUMMED: usize = $summed;
            const HIGHEST_ORDER: usize = $orders;
            const NAME: &'static str = stringify!($type);
            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $type
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $type::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $type::abs(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $type::is_finite(self)
            }
        }
    };
}

real!(f32, 16, 4);
real!(f64, usize::MAX, usize::MAX);
