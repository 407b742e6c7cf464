//! Compiler stage 4: the minimal channel set and its rules.
//!
//! - Input: the differential operators that a group reads, as polynomials in `xi = d/dx`.
//! - Output: a [`ChannelSet`], and how its channels pass through products, activations and affine maps.
//!
//! A set of operators survives products and compositions exactly if its span is closed under `d/dxi`. The rules come
//! out of the coproduct `b_k(xi + eta) = sum of c^k_ij b_i(xi) b_j(eta)`; none is written by hand.

mod affine;
mod compose;
mod product;
mod rule;
mod set;
mod span;

pub use self::rule::Rule;
pub use self::set::{ChannelSet, Share};
pub use crate::symbolic::polynomial::{MultiIndex, Polynomial as Operator};

pub use self::affine::affine;
pub use self::compose::compose;
pub use self::product::product;
