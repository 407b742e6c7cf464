//! The equations that NISP ships, and how each is bound to measurements.
//!
//! Without the feature `shipped` it is what binds equations of a user's own, which compiles in a fraction of the time.

#![cfg_attr(
    not(feature = "shipped"),
    allow(dead_code, unused_imports, reason = "much of it binds shipped equations only")
)]

#[cfg(feature = "shipped")]
pub mod bubble;
pub mod catalogue;
pub mod contact;
mod copies;
mod error;
#[cfg(feature = "shipped")]
pub mod membrane;
#[cfg(feature = "shipped")]
pub mod pendulum;
mod places;
#[cfg(feature = "shipped")]
pub mod plate;
pub mod rivals;
#[cfg(feature = "shipped")]
pub mod rlc;
pub mod series;
#[cfg(feature = "shipped")]
pub mod sponge;
mod tables;
pub mod truth;
mod yardsticks;

#[cfg(feature = "shipped")]
pub use catalogue::catalogue;
pub use catalogue::{Assumed, Binding, Entry, Measured, Prepared, Request, Wanted};
pub use contact::Contact;
pub use copies::noisy_copy;
pub use error::PrepareError;
pub use truth::Truth;
pub use yardsticks::{Yardstick, yardsticks};
