//! What every carrier keeps of its answer: heads that can be read at any point, and the posterior that their deviations
//! follow from.

use crate::problem::Frame;
use crate::solve::fault::Fault;
use crate::solve::state::State;

/// The rows of a scene's outputs group at points, `[row][point]` in the engine's units.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Outputs {
    pub(crate) values: Vec<f64>,
    /// Standard deviations, where the posterior was kept; NaN where a row has no finite derivative.
    pub(crate) deviations: Option<Vec<f64>>,
}

/// An answer on its carrier, without the data that it was found from.
pub(crate) trait Kept: Send + Sync {
    /// The rows of the outputs group of the frame's scene, at points in the engine's units, flat.
    fn outputs(&self, frame: &Frame, points: &[f64]) -> Outputs;
    /// Degrees of the heads' splines; nothing where heads have derivatives of any order.
    fn degrees(&self) -> Option<Vec<usize>>;
    /// All of it as plain numbers; the method is the carrier's name.
    fn save(&self) -> State;
}

/// What a carrier saved of an answer in this frame.
///
/// # Errors
/// Numbers that do not belong together.
pub(crate) fn restored(state: &State, frame: &Frame) -> Result<Box<dyn Kept>, Fault> {
    match state.method.as_str() {
        super::network::CARRIER => Ok(Box::new(super::network::KeptNetwork::restored(state, frame)?)),
        crate::splines::CARRIER => Ok(Box::new(crate::splines::KeptSplines::restored(state, frame)?)),
        crate::local::CARRIER => Ok(Box::new(crate::local::KeptLattices::restored(state, frame)?)),
        other => Err(Fault::state(format!("carrier {other}"))),
    }
}

impl Outputs {
    /// Rows of parts of the points, one part after the other, as rows of all points.
    pub(crate) fn joined(parts: &[Self], rows: usize) -> Self {
        let together = |of: &dyn Fn(&Self) -> Option<&[f64]>| -> Option<Vec<f64>> {
            let parts: Vec<&[f64]> = parts.iter().map(of).collect::<Option<_>>()?;
            let row = |row: usize| {
                parts.iter().flat_map(move |part| {
                    let points = part.len() / rows.max(1);
                    part[row * points..][..points].iter().copied()
                })
            };
            Some((0..rows).flat_map(row).collect())
        };
        Self {
            values: together(&|part| Some(&part.values)).unwrap_or_default(),
            deviations: together(&|part| part.deviations.as_deref()),
        }
    }
}
