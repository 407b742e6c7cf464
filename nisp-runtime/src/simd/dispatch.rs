//! From an element type and an instruction set to the vectors that work is done with.

use super::Simd;
use super::isa::{Isa, Level};
use super::scalar;
use super::trampoline::{Element, Enter, Kernel};

impl Isa {
    /// Number of elements in a vector.
    pub fn lanes<E: Element>(self) -> usize {
        dispatch::<E, _>(self, Lanes)
    }
}

/// Runs `kernel` one element at a time, on every machine: for work that no vector speeds up, compiled once.
#[inline(always)]
pub(crate) fn plain<E: Element, K: Kernel<E>>(kernel: K) -> K::Output {
    E::plain(kernel)
}

/// Runs `kernel` with the vectors of `isa`, compiled for that instruction set whatever the crate is compiled for.
#[inline(always)]
pub fn dispatch<E: Element, K: Kernel<E>>(isa: Isa, kernel: K) -> K::Output {
    E::dispatch(isa, kernel)
}

macro_rules! impl_element {
    ($elem:ident, $avx512:ident, $avx2:ident, $neon:ident) => {
        impl Element for $elem {
            #[inline(always)]
            fn dispatch<K: Kernel<Self>>(isa: Isa, kernel: K) -> K::Output {
                match isa.0 {
                    // SAFETY: an Isa of this level exists only if the machine has the features.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx512 => unsafe { super::avx512::$avx512::enter(kernel) },
                    // SAFETY: as above.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx2 => unsafe { super::avx2::$avx2::enter(kernel) },
                    // SAFETY: as above.
                    #[cfg(target_arch = "aarch64")]
                    Level::Neon => unsafe { super::neon::$neon::enter(kernel) },
                    // SAFETY: asks for no features.
                    Level::Scalar => unsafe { scalar::Single::<$elem>::enter(kernel) },
                }
            }

            #[inline(always)]
            fn plain<K: Kernel<Self>>(kernel: K) -> K::Output {
                // SAFETY: asks for no features.
                unsafe { scalar::Single::<$elem>::enter(kernel) }
            }
        }
    };
}

impl_element!(f32, F32x16, F32x8, F32x4);
impl_element!(f64, F64x8, F64x4, F64x2);

struct Lanes;

impl<E: Element> Kernel<E> for Lanes {
    type Output = usize;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> usize {
        V::LANES
    }
}
