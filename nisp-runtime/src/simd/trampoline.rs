//! Work that is done with vectors, the element types that have them, and the trampolines into an instruction set.

use super::Simd;
use super::isa::Isa;
use crate::real::Real;

/// Work to be done with the vectors of some instruction set.
pub trait Kernel<E> {
    /// What the work returns.
    type Output;
    /// Does the work. Must be `#[inline(always)]`, and so must everything in it that handles vectors.
    fn run<V: Simd<Elem = E>>(self) -> Self::Output;
}

/// A number that there are vectors of: `f32` or `f64`. Nobody outside can name (and misuse) the vectors themselves.
pub trait Element: Real {
    /// See the function [`dispatch`](super::dispatch).
    fn dispatch<K: Kernel<Self>>(isa: Isa, kernel: K) -> K::Output;

    /// Runs a kernel one element at a time.
    fn plain<K: Kernel<Self>>(kernel: K) -> K::Output;
}

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
