//! The equations that NISP ships, and how each is bound to measurements.
//!
//! Without the feature `shipped` it is what binds equations of a user's own, which compiles in a fraction of the time.

#![cfg_attr(
    not(feature = "shipped"),
    allow(dead_code, unused_imports, reason = "much of it binds shipped equations only")
)]

mod bodies;
#[cfg(feature = "shipped")]
pub mod bubble;
mod camera;
pub mod catalogue;
pub mod contact;
mod copies;
mod entry;
mod error;
mod frames;
#[cfg(feature = "shipped")]
pub mod membrane;
mod pairs;
#[cfg(feature = "shipped")]
pub mod pendulum;
mod places;
#[cfg(feature = "shipped")]
pub mod plate;
mod prepared;
mod record;
mod request;
pub mod rivals;
#[cfg(feature = "shipped")]
pub mod rlc;
mod series;
#[cfg(feature = "shipped")]
pub mod sponge;
mod survey;
mod tables;
pub mod truth;
mod yardsticks;

pub use camera::camera;
#[cfg(feature = "shipped")]
pub use catalogue::catalogue;
pub use contact::Contact;
pub use copies::noisy_copy;
pub use entry::{Binding, Entry, Series, Size};
pub use error::PrepareError;
pub use frames::Frames;
pub use pairs::require_partners;
pub use prepared::{Assumed, Measured, Prepared};
pub use record::Record;
pub use request::{Request, Wanted};
pub use survey::Survey;
pub use truth::Truth;
pub use yardsticks::{Yardstick, yardsticks};
