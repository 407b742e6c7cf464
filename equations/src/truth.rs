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
}

impl Truth {
    /// Reads whichever heads the table has.
    ///
    /// # Errors
    /// A table without any of them, a cell that is no number, times that do not rise or that leave `range`, where there
    /// is no answer to score.
    pub fn read(table: &Table, scene: &Scene, range: [f64; 2]) -> Result<Truth, PrepareError> {
        let times = table.quantity("t", "s")?;
        table.require_increasing("t")?;
        let (first, last) = (times[0], times[times.len() - 1]);
        // A truth that was rounded on its way into a file still fits.
        let slack = 1e-6 * (range[1] - range[0]);
        if first < range[0] - slack || last > range[1] + slack {
            return Err(PrepareError::TruthRange { path: table.path().into(), truth: [first, last], data: range });
        }
        let mut heads = Vec::new();
        for head in scene.heads {
            match table.quantity(head.name, head.unit.text) {
                Ok(values) => heads.push((head.name, values)),
                Err(DataError::Column { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        if heads.is_empty() {
            let heads = scene.heads.iter().map(|head| head.name).collect::<Vec<_>>().join(", ");
            let columns = table.headers().collect::<Vec<_>>().join(", ");
            return Err(PrepareError::TruthHeads { path: table.path().into(), heads, columns });
        }
        Ok(Truth { times, heads })
    }

    /// The true values of a head, if they are known.
    pub fn of(&self, head: &str) -> Option<&[f64]> {
        self.heads.iter().find(|(name, _)| *name == head).map(|(_, values)| values.as_slice())
    }
}
