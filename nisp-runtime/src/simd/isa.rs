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
}

macro_rules! impl_dispatch {
    ($elem:ident, $avx512:ident, $avx2:ident, $neon:ident, $lanes:literal) => {
        impl Dispatch for $elem {
            #[inline(always)]
            fn dispatch<K: Kernel<Self>>(isa: Isa, kernel: K) -> K::Output {
                match isa.0 {
                    // SAFETY: an Isa of this level exists only if the machine has the features.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx512 => unsafe { run_avx512::<super::avx512::$avx512, K>(kernel) },
                    // SAFETY: as above.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx2 => unsafe { run_avx2::<super::avx2::$avx2, K>(kernel) },
                    // SAFETY: as above.
                    #[cfg(target_arch = "aarch64")]
                    Level::Neon => unsafe { run_neon::<super::neon::$neon, K>(kernel) },
                    Level::Scalar => run_scalar::<scalar::Array<$elem, $lanes>, K>(kernel),
                }
            }
        }
    };
}

impl_dispatch!(f32, F32x16, F32x8, F32x4, 4);
impl_dispatch!(f64, F64x8, F64x4, F64x2, 2);

/// # Safety
/// The machine must have the features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
unsafe fn run_avx512<V: Simd, K: Kernel<V::Elem>>(kernel: K) -> K::Output {
    kernel.run::<V>()
}

/// # Safety
/// The machine must have the features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_avx2<V: Simd, K: Kernel<V::Elem>>(kernel: K) -> K::Output {
    kernel.run::<V>()
}

/// # Safety
/// The machine must have the features.
#[cfg(target_arch = "aarch64")]
#[target_feature(enable = "neon")]
unsafe fn run_neon<V: Simd, K: Kernel<V::Elem>>(kernel: K) -> K::Output {
    kernel.run::<V>()
}

#[inline(never)]
fn run_scalar<V: Simd, K: Kernel<V::Elem>>(kernel: K) -> K::Output {
    kernel.run::<V>()
}

struct Lanes;

impl<E: Real> Kernel<E> for Lanes {
    type Output = usize;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> usize {
        V::LANES
    }
}
