//! Bodies that are seen as point clouds: what their scenes are bound to.
//!
//! `inflated` binds the scenes of `membrane` and `bubble`, `sponge` those of its own; `observed` reads samples and clouds,
//! `given` settles parameters, `calibrate` makes a sensor's calibration.

mod bubble;
mod calibrate;
mod cube;
mod given;
mod inflated;
mod membrane;
mod observed;
mod sponge;

pub(crate) use bubble::prepare as prepare_bubble;
pub(crate) use inflated::SEMI_AXES;
pub(crate) use membrane::prepare as prepare_membrane;
pub(crate) use sponge::SIDE;
pub(crate) use sponge::prepare as prepare_sponge;
