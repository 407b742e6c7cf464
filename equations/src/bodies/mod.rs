//! Bodies that are seen as point clouds: what their scenes are bound to.
//!
//! `inflated` binds the scenes of `membrane` and `bubble`, `sponge` those of its own; `observed` reads samples and clouds,
//! `given` settles parameters, `calibrate` makes a sensor's calibration.

mod bubble;
mod calibrate;
mod given;
mod inflated;
mod membrane;
mod observed;
mod sponge;

pub(crate) use bubble::prepare as prepare_bubble;
pub(crate) use membrane::prepare as prepare_membrane;
pub(crate) use sponge::prepare as prepare_sponge;

use nisp::schema::TermKind;
use nisp::{BindError, Problem};
use nisp_data::Cloud;

/// Gives every Chamfer term of a problem the cloud, in the term's unit.
fn bind_cloud(problem: &mut Problem, cloud: &Cloud) -> Result<(), BindError> {
    for group in problem.scene().schema.groups {
        for term in group.terms.iter().filter(|term| matches!(term.kind, TermKind::Chamfer { .. })) {
            let inward = |metres: &f64| metres / term.unit.factor;
            problem.set_cloud(group.name, term.name, cloud.points.iter().flatten().map(inward).collect())?;
        }
    }
    Ok(())
}
