//! Which instruction set to use, and the trampolines into it.

use super::{Simd, scalar};
use crate::real::Real;
use std::sync::OnceLock;

/// An instruction set that this machine has: there is no safe way to make any other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Isa(Level);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Level {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "aarch64")]
    Neon,
    Scalar,
}

impl Isa {
    /// Plain code without vector instructions of our own: runs everywhere.
    pub const SCALAR: Isa = Isa(Level::Scalar);

    /// The best instruction set of this machine, or the one that the environment variable `NISP_ISA` names (`avx512`,
    /// `avx2`, `neon`, `scalar`) if the machine has it. Determined once per process.
    pub fn detect() -> Isa {
        static DETECTED: OnceLock<Isa> = OnceLock::new();
        *DETECTED.get_or_init(|| {
            let wanted = std::env::var("NISP_ISA").ok().and_then(|name| Isa::from_name(&name));
            wanted.unwrap_or_else(|| Isa::available().next().unwrap_or(Isa::SCALAR))
        })
    }

    /// Every instruction set that this machine has, best first; [`Isa::SCALAR`] is always among them.
    pub fn available() -> impl Iterator<Item = Isa> {
        Level::ALL.iter().filter(|level| level.present()).map(|&level| Isa(level))
    }

    /// The instruction set of this name (see [`Isa::name`]), if this machine has it.
    pub fn from_name(name: &str) -> Option<Isa> {
        Isa::available().find(|isa| isa.name() == name)
    }

    /// `avx512`, `avx2`, `neon` or `scalar`.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => "avx512",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => "avx2",
            #[cfg(target_arch = "aarch64")]
            Level::Neon => "neon",
            Level::Scalar => "scalar",
        }
    }

    /// Number of elements in a vector.
    pub fn lanes<E: Real>(self) -> usize {
        dispatch::<E, _>(self, Lanes)
    }
}

impl Level {
    const ALL: &[Level] = &[
        #[cfg(target_arch = "x86_64")]
        Level::Avx512,
        #[cfg(target_arch = "x86_64")]
        Level::Avx2,
        #[cfg(target_arch = "aarch64")]
        Level::Neon,
        Level::Scalar,
    ];

    fn present(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => {
                Level::Avx2.present()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "aarch64")]
            Level::Neon => std::arch::is_aarch64_feature_detected!("neon"),
            Level::Scalar => true,
        }
    }
}

/// Work to be done with the vectors of some instruction set.
pub trait Kernel<E: Real> {
    /// What the work returns.
    type Output;
    /// Does the work. Must be `#[inline(always)]`, and so must everything in it that handles vectors.
    fn run<V: Simd<Elem = E>>(self) -> Self::Output;
}

/// Runs `kernel` one element at a time, on every machine: for work that no vector speeds up, compiled once.
#[inline(always)]
pub(crate) fn plain<E: Real, K: Kernel<E>>(kernel: K) -> K::Output {
    E::plain(kernel)
}

/// Runs `kernel` with the vectors of `isa`, compiled for that instruction set whatever the crate is compiled for.
#[inline(always)]
pub fn dispatch<E: Real, K: Kernel<E>>(isa: Isa, kernel: K) -> K::Output {
    E::dispatch(isa, kernel)
}

/// Ties an element type to its vector types, without which nobody outside can name (and misuse) those.
pub(crate) trait Dispatch: Sized {
    /// See the function [`dispatch`].
    fn dispatch<K: Kernel<Self>>(isa: Isa, kernel: K) -> K::Output
    where
        Self: Real;

    /// See the function [`plain`].
    fn plain<K: Kernel<Self>>(kernel: K) -> K::Output
    where
        Self: Real;
}

macro_rules! impl_dispatch {
    ($elem:ident, $avx512:ident, $avx2:ident, $neon:ident, $lanes:literal) => {
        impl Dispatch for $elem {
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
                    Level::Scalar => unsafe { scalar::Array::<$elem, $lanes>::enter(kernel) },
                }
            }

            #[inline(always)]
            fn plain<K: Kernel<Self>>(kernel: K) -> K::Output {
                // SAFETY: asks for no features.
                unsafe { scalar::Array::<$elem, 1>::enter(kernel) }
            }
        }
    };
}

impl_dispatch!(f32, F32x16, F32x8, F32x4, 4);
impl_dispatch!(f64, F64x8, F64x4, F64x2, 2);

/// The trampoline into an instruction set. It is a method of the vector type, not a free function, because rustc cuts a
/// crate into units of compilation by the modules of such types: an instruction set's kernels are compiled beside the
/// others', not after them.
pub(super) trait Enter: Simd {
    /// Runs a kernel with vectors of this type.
    ///
    /// # Safety
    /// The machine must have the instruction set.
    unsafe fn enter<K: Kernel<Self::Elem>>(kernel: K) -> K::Output;
}

struct Lanes;

impl<E: Real> Kernel<E> for Lanes {
    type Output = usize;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> usize {
        V::LANES
    }
}
