//! The equations that NISP ships, and how each is bound to tables of measurements.

mod copies;
mod error;
pub mod pendulum;
pub mod rivals;
pub mod rlc;
pub mod series;
pub mod truth;

pub use copies::noisy_copy;
pub use error::PrepareError;
pub use series::{Entry, Prepared, Request, catalogue};
pub use truth::Truth;
