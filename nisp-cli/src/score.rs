//! Scores against a truth that no solver has seen.

use nisp::Solution;
use nisp_equations::Truth;

/// Mean absolute errors of one head.
pub(crate) struct Score {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) mean_abs: f64,
    /// For a source, that of the answer zero.
    pub(crate) if_zero: Option<f64>,
}

/// Mean absolute errors of every head that the truth has, over the truth's times; sources first.
pub(crate) fn score(solution: &Solution, truth: &Truth) -> Vec<Score> {
    let scored = solution.evaluate(&truth.points).into_iter().filter_map(|estimate| {
        let values = truth.of(estimate.name)?;
        let mean = |of: &dyn Fn(usize) -> f64| (0..values.len()).map(of).sum::<f64>() / values.len() as f64;
        Some(Score {
            name: estimate.name,
            unit: estimate.unit.text,
            mean_abs: mean(&|i| (estimate.values[i] - values[i]).abs()),
            if_zero: estimate.source.then(|| mean(&|i| values[i].abs())),
        })
    });
    let mut scores: Vec<_> = scored.collect();
    scores.sort_by_key(|score| score.if_zero.is_none());
    scores
}
