//! What every carrier shows while it solves, and what it keeps of its answer: heads that can be read at any point, and the
//! posterior that their deviations follow from.

use crate::problem::Frame;
use crate::schema::Unit;
use crate::solve::state::State;

/// What a caller sees after every step.
pub(crate) struct Progress<'a> {
    /// Steps so far.
    pub(crate) iteration: u64,
    /// Seconds so far.
    pub(crate) elapsed_s: f64,
    /// The loss before the step.
    pub(crate) loss: f64,
    /// Gives the state before the step, which whoever goes on from it repeats.
    pub(crate) checkpoint: &'a dyn Fn() -> State,
}

/// A head at some points.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the head.
    pub name: &'static str,
    /// Its declared unit.
    pub unit: Unit,
    /// True for a source.
    pub source: bool,
    /// Values in the declared unit, one per point.
    pub values: Vec<f64>,
    /// Standard deviations, one per point, where the method gives them.
    pub deviations: Option<Vec<f64>>,
    /// The part of each that is only the prior's word, so multiplied: smoothing that no measurement speaks for or against.
    pub by_prior: Option<Vec<f64>>,
}

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
