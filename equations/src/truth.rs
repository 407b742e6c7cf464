//! What is true: to score an answer, and for nothing else.

use nisp::schema::Scene;
use nisp_data::{DataError, Table};

use crate::PrepareError;

/// True values of some heads at its own times.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Times, rising.
    pub times: Vec<f64>,
    /// Values by head, in the declared unit, one for each time.
    pub heads: Vec<(&'static str, Vec<f64>)>,
    /// How many rows were left out, being at times of which the data say nothing.
    pub outside: usize,
}

impl Truth {
    /// Reads whichever heads the table has, at its times within `range`.
    ///
    /// # Errors
    /// A table without any of them, a cell that is no number, times that do not rise or are all outside.
    pub fn read(table: &Table, scene: &Scene, range: [f64; 2]) -> Result<Truth, PrepareError> {
        let times = table.quantity("t", "s")?;
        table.require_increasing("t")?;
        // A time that was rounded on its way into a file still counts.
        let slack = 1e-6 * (range[1] - range[0]);
        let inside = |t: f64| t >= range[0] - slack && t <= range[1] + slack;
        let keep = |values: Vec<f64>| times.iter().zip(values).filter(|(t, _)| inside(**t)).map(|(_, x)| x).collect();
        let kept: Vec<f64> = keep(times.clone());
        if kept.is_empty() {
            let truth = [times[0], times[times.len() - 1]];
            return Err(PrepareError::TruthRange { path: table.path().into(), truth, data: range });
        }
        let mut heads = Vec::new();
        for head in scene.heads {
            match table.quantity(head.name, head.unit.text) {
                Ok(values) => heads.push((head.name, keep(values))),
                Err(DataError::Column { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        if heads.is_empty() {
            let heads = scene.heads.iter().map(|head| head.name).collect::<Vec<_>>().join(", ");
            let columns = table.headers().collect::<Vec<_>>().join(", ");
            return Err(PrepareError::TruthHeads { path: table.path().into(), heads, columns });
        }
        Ok(Truth { outside: times.len() - kept.len(), times: kept, heads })
    }

    /// The true values of a head, if they are known.
    pub fn of(&self, head: &str) -> Option<&[f64]> {
        self.heads.iter().find(|(name, _)| *name == head).map(|(_, values)| values.as_slice())
    }
}
