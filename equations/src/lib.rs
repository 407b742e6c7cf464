//! The equations that NISP ships, and how each is bound to tables of measurements.

pub mod pendulum;
pub mod rivals;
pub mod rlc;
pub mod series;
pub mod truth;

pub use series::{Entry, PrepareError, Prepared, Request, catalogue};
pub use truth::Truth;
