//! The equations that NISP ships, and how each is bound to measurements.

pub mod bubble;
pub mod catalogue;
pub mod contact;
mod copies;
mod error;
pub mod membrane;
pub mod pendulum;
mod places;
pub mod plate;
mod record;
pub mod rivals;
pub mod rlc;
pub mod series;
pub mod sponge;
mod tables;
pub mod truth;
mod yardsticks;

pub use catalogue::{Assumed, Binding, Entry, Measured, Prepared, Request, Wanted, catalogue};
pub use contact::Contact;
pub use copies::noisy_copy;
pub use error::PrepareError;
pub use record::Record;
pub use truth::Truth;
pub use yardsticks::{Yardstick, yardsticks};
