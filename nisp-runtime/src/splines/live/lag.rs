//! How long answers wait, and how wide cells are, by the first rows.

use super::evidence::Stretch;
use super::record::MeasuredRow;
use crate::problem::Bound;
use crate::units::Engine;

/// How much larger a source's deviation may be at the lag than after any wait.
const NEAR: f64 = 1.02;

/// Heads that the lag waits for: sources, or everything where there are none.
pub(super) fn sought(bound: &Bound) -> Vec<usize> {
    let heads = bound.problem.scene().schema.heads;
    let sources: Vec<usize> = (0..heads.len()).filter(|&head| heads[head].source).collect();
    if sources.is_empty() { (0..heads.len()).collect() } else { sources }
}

/// Width of a cell: the usual distance of two rows. The median does not mind gaps, and the mean not that rows come in bursts.
pub(super) fn width(rows: &[MeasuredRow<Engine>]) -> f64 {
    let mut apart: Vec<f64> = rows.windows(2).map(|pair| pair[1].at - pair[0].at).collect();
    apart.sort_by(f64::total_cmp);
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    mean.min(apart[apart.len() / 2].max(mean / 4.0))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The distance from the end of a stretch, in whole cells, from which on deviations are nearly those of its middle.
pub(super) fn settled_lag(stretch: &Stretch, heads: &[usize], (start, end): (f64, f64), width: f64) -> f64 {
    let cells = (((end - start) / width) as usize).max(2);
    let lag = |head: usize| {
        let deviation = |cell: usize| stretch.deviation(head, end - cell as f64 * width);
        let mut middle: Vec<f64> = (cells / 4..=3 * cells / 4).map(deviation).collect();
        middle.sort_by(f64::total_cmp);
        let most = NEAR * middle[middle.len() / 2];
        let ahead: Vec<f64> = (0..cells).map(deviation).collect();
        // Where an equation reads a source's rate the deviation may dip before it settles.
        let is_settled = |&cell: &usize| ahead[cell] <= most && mean(&ahead[cell..2 * cell]) <= most;
        (1..cells / 2).find(is_settled).unwrap_or(cells / 2)
    };
    heads.iter().map(|&head| lag(head)).max().unwrap_or(1) as f64 * width
}
