//! More points where the equation is least satisfied.

use rand::RngExt;

use super::Points;
use super::sequence::generator;
use crate::DataError;

/// Draws `count` of the candidates without repetition, with chances that go as `|r|^power / mean + floor`.
///
/// `power` 0 or a large `floor` approach even sampling; 1 and 1 are the usual choice. Weights are dropped: the chosen
/// points no longer stand for equal shares.
pub fn resample(
    candidates: &Points,
    residuals: &[f64],
    count: usize,
    power: f64,
    floor: f64,
    seed: u64,
) -> Result<Points, DataError> {
    if residuals.len() != candidates.len() {
        let what = format!("{} residuals for {} candidate points", residuals.len(), candidates.len());
        return Err(DataError::invalid(what));
    }
    let sizes: Vec<f64> = residuals.iter().map(|residual| residual.abs().powf(power)).collect();
    let mean = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64;
    if !mean.is_finite() {
        return Err(DataError::invalid("residuals must be finite to choose points by them"));
    }
    let mut generator = generator(seed);
    // Exponential races (Efraimidis and Spirakis): the earliest arrivals are a weighted draw without repetition.
    let mut arrivals: Vec<(f64, usize)> = sizes
        .iter()
        .map(|size| if mean > 0.0 { size / mean + floor } else { 1.0 })
        .map(|rate| -(1.0 - generator.random::<f64>()).ln() / rate)
        .enumerate()
        .map(|(index, time)| (time, index))
        .collect();
    arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<usize> = arrivals.into_iter().take(count).map(|(_, index)| index).collect();
    chosen.sort_unstable();
    Ok(Points { weights: None, ..candidates.take(&chosen) })
}
