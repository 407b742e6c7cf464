//! The equations that NISP ships, and how each is bound to measurements.

mod bodies;
pub mod bubble;
pub mod catalogue;
pub mod contact;
mod copies;
mod entry;
mod error;
pub mod membrane;
pub mod pendulum;
mod places;
pub mod plate;
mod prepared;
mod request;
pub mod rivals;
pub mod rlc;
mod series;
pub mod sponge;
mod tables;
pub mod truth;
mod yardsticks;

pub use catalogue::catalogue;
pub use contact::Contact;
pub use copies::noisy_copy;
pub use entry::{Binding, Entry, Series};
pub use error::PrepareError;
pub use prepared::{Assumed, Measured, Prepared};
pub use request::{Request, Wanted};
pub use truth::Truth;
pub use yardsticks::{Yardstick, yardsticks};
