//! Scenes, each in a file with its equations written by hand. Their kernels are built here, since `scene` is inlined nowhere: crates
//! that inlined it would each build them again.

// In two of them nothing is measured, which the macro warns of: they are differentiated here, and not solved.
#![allow(deprecated)]

mod cart;
mod heat;
mod held;
mod karman;
mod partial;
pub mod poisson;
mod ring;
mod shape;
pub mod solids;
mod sponge;
mod triharmonic;

pub use cart::Cart;
pub use heat::Heat;
pub use held::Held;
pub use karman::Karman;
pub use partial::Partial;
pub use poisson::Poisson;
pub use ring::Ring;
pub use shape::Shape;
pub use sponge::Sponge;
pub use triharmonic::Triharmonic;

use crate::reference::Data;

/// The files of all scenes, whose texts are interpreted too.
pub const TEXTS: [&str; 11] = [
    include_str!("cart.rs"),
    include_str!("heat.rs"),
    include_str!("held.rs"),
    include_str!("karman.rs"),
    include_str!("partial.rs"),
    include_str!("poisson.rs"),
    include_str!("ring.rs"),
    include_str!("shape.rs"),
    include_str!("solids.rs"),
    include_str!("sponge.rs"),
    include_str!("triharmonic.rs"),
];

/// Points that fill a box evenly: multiples of the golden ratio's generalisation (Roberts).
fn scatter(count: usize, dimension: usize, low: f64, high: f64) -> Vec<f64> {
    let ratio = (0..60).fold(2.0_f64, |g, _| (1.0 + g).powf(1.0 / (dimension as f64 + 1.0)));
    let step = |i: usize| ratio.powi(-(i as i32 + 1));
    (1..=count).flat_map(|n| (0..dimension).map(move |i| low + (high - low) * (n as f64 * step(i)).fract())).collect()
}

fn wave(count: usize, rate: f64) -> Vec<f64> {
    (0..count).map(|i| (i as f64 * rate).sin()).collect()
}

fn group(name: &'static str, points: Vec<f64>) -> Data {
    Data { name, points, ..Data::default() }
}

/// Runs a generic check on every model.
#[macro_export]
macro_rules! each_model {
    ($check:ident!) => {
        $check!(&$crate::models::Cart);
        $check!(&$crate::models::Poisson);
        $check!(&$crate::models::Karman);
        $check!(&$crate::models::Sponge);
        $check!(&$crate::models::Triharmonic);
        $check!(&$crate::models::Heat);
        $check!(&$crate::models::Shape);
        $check!(&$crate::models::Ring);
        $check!(&$crate::models::Held);
        $check!(&$crate::models::Partial);
    };
    ($check:ident) => {
        $check(&$crate::models::Cart);
        $check(&$crate::models::Poisson);
        $check(&$crate::models::Karman);
        $check(&$crate::models::Sponge);
        $check(&$crate::models::Triharmonic);
        $check(&$crate::models::Heat);
        $check(&$crate::models::Shape);
        $check(&$crate::models::Ring);
        $check(&$crate::models::Held);
        $check(&$crate::models::Partial);
    };
}
