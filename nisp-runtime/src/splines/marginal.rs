//! What a value of a learned scalar is worth beside free sources, whatever the fields and the sources are.
//!
//! The rows are least where the sources are smallest, and no mass, or no damping, asks for a smaller force than the true one. But an
//! equation whose fields answer more strongly to the same sources leaves the fields more room, and makes those that the data show the
//! less likely. So a value is judged by the integral over all fields and sources: that of all rows over that of the rows without
//! data. Its logarithm is half the sum of squares and the difference of two determinants. The slope of this difference is found here.

use super::iterate::{Phase, State};
use super::solver::Solver;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;
use crate::weighed::Tally;

/// Change of a scalar's parameter over which the slope is taken.
const STEP: f64 = 1e-3;

/// How the determinants go with learned scalars.
pub(super) struct Pull {
    /// By scalar, the slope of the logarithm of what its value is worth, the sum of squares aside.
    pub(super) slopes: Vec<f64>,
    /// Half the logarithm of the determinant of the rows without data.
    unmeasured: f64,
}

impl Solver<'_> {
    /// How determinants go with learned scalars about a state, whose rows are in the triangle; nothing where no scalar is free beside a
    /// source.
    pub(super) fn pull(&mut self, state: &State, phase: Phase) -> Result<Option<Pull>, Fault> {
        if phase == Phase::Regress || state.held || !self.is_beside_sources() {
            return Ok(None);
        }
        let (all, unmeasured) = (self.triangle.log_determinant_beside(state.learned.len()), self.volume(state, false)?);
        let mut slopes = Vec::with_capacity(state.learned.len());
        for at in 0..state.learned.len() {
            let mut other = state.clone();
            other.learned[at] += STEP;
            let more = (self.volume(&other, false)? - unmeasured) - (self.volume(&other, true)? - all);
            slopes.push(if more.is_finite() { more / STEP } else { 0.0 });
        }
        self.set_learned(&state.learned);
        Ok(Some(Pull { slopes, unmeasured }))
    }

    /// Whether scalars are learned beside sources.
    pub(super) fn is_beside_sources(&self) -> bool {
        self.has_sources() && !self.bound.learned.is_empty()
    }

    /// What the logarithm of the evidence lacks where determinants go with learned scalars: rows that are no data make fields of
    /// sources whose own determinant is `worth`.
    pub(super) fn lacking(&self, pull: &Pull, state: &State, tallies: &[Tally], worth: f64) -> f64 {
        let is_no_data = |term: &schema::Term| term.kind != TermKind::Observation;
        pull.unmeasured - worth + self.log_sizes(state, tallies, is_no_data)
    }

    /// Half the logarithm of the determinant of the coefficients' rows, those of data among them or not.
    fn volume(&mut self, state: &State, measured: bool) -> Result<f64, Fault> {
        self.is_measured = measured;
        let rows = self.rows(state, Phase::Solve);
        self.is_measured = true;
        let mut triangle = self.empty(state);
        triangle.add_all(rows?.0.walk());
        Ok(triangle.log_determinant_beside(state.learned.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::triangle::{Row, Triangle};

    /// Half of `(x + y - 2)^2 + (2 y - 2)^2` less three times `y`: at `y` its slope is `4 y - 4 - 3` where `x = 2 - y`.
    #[test]
    fn shared_unknowns_are_drawn_along_slopes() {
        let mut triangle = Triangle::new(1, 1, 1);
        triangle.add(Row { first: 0, slopes: &[1.0], shared: &[1.0], value: -2.0 });
        triangle.add(Row { first: 0, slopes: &[], shared: &[2.0], value: -2.0 });
        let (x, y) = triangle.solve().unwrap();
        assert!((x[0] - 1.0).abs() < 1e-15 && (y[0] - 1.0).abs() < 1e-15, "{x:?} {y:?}");
        triangle.draw(&[3.0]);
        let (x, y) = triangle.solve().unwrap();
        assert!((x[0] - 0.25).abs() < 1e-15 && (y[0] - 1.75).abs() < 1e-15, "{x:?} {y:?}");
    }
}
