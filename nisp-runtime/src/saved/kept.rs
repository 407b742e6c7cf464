//! Which carriers there are to be read from files.

use super::network;
use crate::carrier::Kept;
use crate::problem::Frame;
use crate::solve::fault::Fault;
use crate::solve::state::State;
use crate::{local, splines};

/// What a carrier saved of an answer in this frame.
///
/// # Errors
/// Numbers that do not belong together.
pub(super) fn restored(state: &State, frame: &Frame) -> Result<Box<dyn Kept>, Fault> {
    match state.method.as_str() {
        network::CARRIER => Ok(Box::new(network::KeptNetwork::restored(state, frame)?)),
        splines::CARRIER => Ok(Box::new(splines::KeptSplines::restored(state, frame)?)),
        local::CARRIER => Ok(Box::new(local::KeptLattices::restored(state, frame)?)),
        other => Err(Fault::state(format!("carrier {other}"))),
    }
}
