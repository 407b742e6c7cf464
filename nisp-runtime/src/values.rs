//! Rules of the smallest channel set, values alone, compiled here and not in users' crates: every scene reads out its
//! network, and most observe and prescribe values.

use crate::compiled::CompiledLayers;
use crate::layer::{Layers, MOST_COORDINATES};
use crate::rules::Rules;
use crate::simd::{Element, Simd};

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

/// Element types whose layers of values are compiled in this crate.
pub trait Precompiled: Element {
    /// The layers of values over so many coordinates.
    ///
    /// # Panics
    /// Over no coordinate, or over more than four.
    fn values(coordinates: usize) -> &'static dyn Layers<Self>;
}

macro_rules! precompiled {
    ($($elem:ident)*) => {
        $(
            // Not generic, so that the code belongs to this crate.
            impl Precompiled for $elem {
                fn values(coordinates: usize) -> &'static dyn Layers<Self> {
                    match coordinates {
                        1 => CompiledLayers::<Values, Values, 1, 2, 1>::erased(),
                        2 => CompiledLayers::<Values, Values, 1, 2, 2>::erased(),
                        3 => CompiledLayers::<Values, Values, 1, 2, 3>::erased(),
                        MOST_COORDINATES => CompiledLayers::<Values, Values, 1, 2, MOST_COORDINATES>::erased(),
                        _ => panic!("layers of values are compiled over one to four coordinates"),
                    }
                }
            }
        )*
    };
}

precompiled!(f32 f64);
