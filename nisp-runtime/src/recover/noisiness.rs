//! How noisy observations are beside each other, in saved states.

use crate::problem::Bound;
use crate::solve::fault::Fault;
use crate::solve::state::State;

/// Adds how noisy observations are to a saved state.
pub(super) fn save(bound: &Bound, state: State) -> State {
    let groups = bound.noisiness.iter().enumerate();
    let rows = groups.flat_map(|(group, rows)| rows.iter().enumerate().map(move |(row, own)| (group, row, own)));
    let uneven = rows.filter(|(.., own)| !own.is_empty());
    uneven.fold(state, |state, (group, row, own)| state.with(&name(group, row), own))
}

/// The same problem, with observations as noisy as a saved state of it says.
pub(super) fn restored(mut bound: Bound, state: &State) -> Result<Bound, Fault> {
    for (group, rows) in bound.noisiness.iter_mut().enumerate() {
        let points = bound.coordinates[group].len() / bound.problem.scene().schema.coordinates.len();
        for (row, own) in rows.iter_mut().enumerate().filter(|(row, _)| state.has(&name(group, *row))) {
            *own = state.sized(&name(group, row), points)?;
        }
    }
    bound.take_noisiness();
    Ok(bound)
}

/// Its name in a saved state.
fn name(group: usize, row: usize) -> String {
    format!("noisiness {group} {row}")
}
