//! Rules of the smallest channel set, values alone, compiled here and not in users' crates: every scene reads out its
//! network, and most observe and prescribe values.

use crate::compiled::CompiledLayers;
use crate::kernel::{Layers, Rules};
use crate::real::Real;
use crate::simd::Simd;

/// Coordinates that there are layers of values over, at most.
pub(crate) const MOST_COORDINATES: usize = 4;

/// Rules for values alone.
#[derive(Debug)]
pub struct Values;

impl<const S: usize> Rules<1, 2, S> for Values {
    const READ: [bool; 1] = [true];
    #[inline(always)]
    fn compose<V: Simd>(phi: &[V; 2], _: &[V; 1]) -> [V; 1] {
        [phi[0]]
    }
    #[inline(always)]
    fn compose_adjoint<V: Simd>(phi: &[V; 2], _: &[V; 1], seed: &[V; 1]) -> [V; 1] {
        [seed[0].mul(phi[1])]
    }
    #[inline(always)]
    fn affine<V: Simd>(phi: &[V; 2], _: &[V; S]) -> [V; 1] {
        [phi[0]]
    }
    #[inline(always)]
    fn affine_adjoint<V: Simd>(phi: &[V; 2], _: &[V; S], seed: &[V; 1]) -> (V, [V; S]) {
        (seed[0].mul(phi[1]), [V::lit(0.0); S])
    }
    #[inline(always)]
    fn product<V: Simd>(f: &[V; 1], g: &[V; 1]) -> [V; 1] {
        [f[0].mul(g[0])]
    }
    #[inline(always)]
    fn product_adjoint<V: Simd>(f: &[V; 1], g: &[V; 1], seed: &[V; 1]) -> ([V; 1], [V; 1]) {
        ([seed[0].mul(g[0])], [seed[0].mul(f[0])])
    }
}

/// Element types whose layers of values over `S` coordinates are compiled in this crate.
pub trait Precompiled<const S: usize>: Sized {
    /// The layers.
    fn values() -> &'static dyn Layers<Self>;
}

macro_rules! precompiled {
    ($($elem:ident over $($coordinates:literal)*;)*) => {
        $($(
            // Not generic, so that the code belongs to this crate.
            impl Precompiled<$coordinates> for $elem {
                fn values() -> &'static dyn Layers<Self> {
                    CompiledLayers::<Values, Values, 1, 2, $coordinates>::erased()
                }
            }
        )*)*
    };
}

precompiled! {
    f32 over 1 2 3 4;
    f64 over 1 2 3 4;
}

/// The layers of values over so many coordinates, at most four.
///
/// # Panics
/// Over no coordinate, or over more than four.
pub fn precompiled<E: Real>(coordinates: usize) -> &'static dyn Layers<E> {
    match coordinates {
        1 => <E as Precompiled<1>>::values(),
        2 => <E as Precompiled<2>>::values(),
        3 => <E as Precompiled<3>>::values(),
        4 => <E as Precompiled<4>>::values(),
        _ => panic!("layers of values are compiled over one to four coordinates"),
    }
}
