//! The first rows solved as a whole, without their strays.
//!
//! Neighbours do not show a stray where many are close together, or where rows are so far apart that the record bends between them. The
//! equations do: where the answer misses a row far, the rows are solved once more with a loss that leaves out what is far off. What that
//! leaves out, one row or two among others that are met, are strays. Longer runs are a change.

use super::LiveError;
use super::evidence::Stretch;
use super::opening::{Doubt, Opening};
use super::record::{Layout, MeasuredRow};
use crate::problem::{Bound, Problem};
use crate::units::Declared;

/// How far a row that is met is off, at most, over the noise.
const MET: f64 = 4.0;
/// How far a stray is off, at least.
const FAR: f64 = 6.0;
/// Strays that may follow each other. More of them are a change.
const PAIR: usize = 2;
/// Rows on either side of a stray, of which all but one are met.
const BESIDE: usize = 2;
/// Share of the rows that may be strays. Where more of them are off, equations are wrong.
const MOST: f64 = 0.1;

/// The first rows, solved.
pub(super) struct First {
    pub(super) bound: Bound,
    pub(super) stretch: Stretch,
    pub(super) opening: Option<Opening>,
    pub(super) doubt: Doubt,
}

impl First {
    /// Solves rows without their strays, and marks these.
    pub(super) fn solve(
        problem: &Problem,
        layout: &Layout,
        rows: &mut [MeasuredRow<Declared>],
    ) -> Result<Self, LiveError> {
        let first = Self::of_marked(problem, layout, rows)?;
        let far = first.opening.as_ref().map(|opening| farthest(layout, &first.bound, opening, rows));
        if far.is_some_and(|far| far.iter().all(|off| *off <= MET)) {
            return Ok(first);
        }
        let mut robust = problem.clone();
        robust.set_robust(true);
        let bound = layout.bound(&robust, rows)?;
        let far = Opening::solve(&bound).0.map(|opening| farthest(layout, &bound, &opening, rows));
        let strays = strays(&far.unwrap_or_default());
        if strays.is_empty() {
            return Ok(first);
        }
        strays.iter().for_each(|&stray| rows[stray].is_stray = true);
        Self::of_marked(problem, layout, rows)
    }

    /// Solves rows but for the strays that are marked.
    pub(super) fn of_marked(
        problem: &Problem,
        layout: &Layout,
        rows: &[MeasuredRow<Declared>],
    ) -> Result<Self, LiveError> {
        let bound = layout.bound(problem, rows)?;
        let (stretch, (opening, doubt)) = rayon::join(|| Stretch::solve(&bound, None), || Opening::solve(&bound));
        Ok(Self { stretch: stretch?, opening, doubt, bound })
    }
}

/// By row, how far it is off at most, over the noise.
fn farthest(layout: &Layout, bound: &Bound, opening: &Opening, rows: &[MeasuredRow<Declared>]) -> Vec<f64> {
    let mut farthest = vec![0.0_f64; rows.len()];
    for (group, numbers) in layout.rows_of_groups(rows) {
        let terms = bound.problem.scene().schema.groups[group].terms.iter();
        for (term, (misfits, noise)) in terms.zip(&opening.misfits()[group]) {
            let Some(noise) = noise.filter(|noise| *noise > 0.0) else { continue };
            let measured = bound.measured(group, term, &numbers);
            for (misfit, &row) in misfits.iter().zip(measured.iter().cycle()) {
                farthest[row] = farthest[row].max((misfit / noise).abs());
            }
        }
    }
    farthest
}

/// Rows that are far off while most of those beside them are met; none where these are many.
fn strays(off: &[f64]) -> Vec<usize> {
    let is_far = |row: usize| off.get(row).is_some_and(|off| *off > MET);
    let mut strays = Vec::new();
    let mut row = 0;
    while row < off.len() {
        let end = row + off[row..].iter().take_while(|off| **off > MET).count();
        let beside = (row.saturating_sub(BESIDE)..row).chain(end..end + BESIDE).filter(|&row| is_far(row)).count();
        if end - row <= PAIR && end + BESIDE <= off.len() && beside <= 1 {
            strays.extend((row..end).filter(|&row| off[row] > FAR));
        }
        row = end + 1;
    }
    if strays.len() as f64 > MOST * off.len() as f64 { Vec::new() } else { strays }
}

#[cfg(test)]
mod tests {
    use super::strays;

    #[test]
    fn one_or_two_rows_among_others_are_strays_and_runs_are_not() {
        let of = |far: &[usize]| {
            strays(&(0..100).map(|row| if far.contains(&row) { 30.0 } else { 1.0 }).collect::<Vec<_>>())
        };
        assert_eq!(of(&[0, 20, 40, 41, 43, 97]), [0, 20, 40, 41, 43, 97]);
        assert_eq!(of(&[20, 60, 61, 62, 98]), [20], "a run, and the beginning of one");
        assert!(of(&(0..100).step_by(6).collect::<Vec<_>>()).is_empty(), "too many");
    }
}
