//! The equations that NISP ships.

pub mod pendulum;
pub mod rivals;
pub mod rlc;

