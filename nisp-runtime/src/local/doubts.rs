//! What speaks against an answer before anything else is judged.

use super::phase::CONVEX_STEPS;
use super::solver::Solver;
use super::surface::Surface;
use crate::solve::driver::{Warning, WarningKind};

/// Root mean square of the rows, in tolerances, above which there is no solution to speak of.
const MOST_OFF: f64 = 5.0;

impl Solver {
    /// What speaks against an answer: equations that do not hold, or a surface that is nowhere near the cloud.
    pub(super) fn doubts(&self, loss: f64, rows: usize, steps: u64) -> Vec<Warning> {
        let mut doubts = Vec::new();
        if steps < CONVEX_STEPS {
            doubts.push("it ended before the equations were solved: give more --budget or --iterations".to_string());
        }
        let off = (2.0 * loss / rows.max(1) as f64).sqrt();
        if off > MOST_OFF {
            doubts.push(format!(
                "rows are off by {off:.0} times their tolerance: the steps did not reach a solution of the equations; give \
                 more --budget, and check the parameters"
            ));
        }
        let all: usize = self.surfaces.iter().map(Surface::len).sum();
        let lost = all - self.surfaces.iter().map(|surface| surface.misfits().count()).sum::<usize>();
        if 2 * lost > all {
            doubts.push(format!(
                "{lost} of the cloud's {all} points are not near the surface: is it a cloud of this body, in its frame?"
            ));
        }
        doubts.into_iter().map(|message| Warning { kind: WarningKind::Stagnation, message }).collect()
    }
}
