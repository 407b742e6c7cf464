//! Scores against a truth that no solver has seen.

use nisp::Solution;
use nisp_data::{DataError, Table};

/// Mean absolute error of one quantity.
pub(crate) struct Score {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) mean_abs: f64,
}

/// Mean absolute errors of every head that the truth has, and of the answer zero for sources (`NAME_if_zero`).
pub(crate) fn score(solution: &Solution, truth: &Table) -> Result<Vec<Score>, DataError> {
    let times = truth.column("t")?;
    let mut scores = Vec::new();
    for estimate in solution.evaluate(times) {
        let Ok(values) = truth.quantity(estimate.name, estimate.unit.text) else { continue };
        let mean = |of: &dyn Fn(usize) -> f64| (0..values.len()).map(of).sum::<f64>() / values.len() as f64;
        let unit = estimate.unit.text;
        let mean_abs = mean(&|i| (estimate.values[i] - values[i]).abs());
        scores.push(Score { name: estimate.name.into(), unit, mean_abs });
        if estimate.source {
            let name = format!("{}_if_zero", estimate.name);
            scores.push(Score { name, unit, mean_abs: mean(&|i| values[i].abs()) });
        }
    }
    Ok(scores)
}
