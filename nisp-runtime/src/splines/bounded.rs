//! Steps after which no coefficient is beyond its head's bound.

use super::iterate::State;
use super::solver::Solver;
use super::triangle::Row;

/// How stiff a coefficient is held at its head's bound, how far beyond it a coefficient may be, and how often more of them are
/// found to be beyond.
const WALL: f64 = 1e4;
const BEYOND: f64 = 1e-6;
const MOST_WALLS: u32 = 30;

impl Solver<'_> {
    /// A step, of coefficients and of learned parameters, after which no coefficient is beyond its head's bound: those that would
    /// be are held at it, until no other is. It goes last, since the rows that hold them stay in the triangle. Noise, roughness
    /// and error bars are those without bounds, so that a source at its bound has bars.
    pub(super) fn within_bounds(&mut self, state: &State, step: Vec<f64>, shared: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
        let limits = self.heads.limits.iter().enumerate();
        let limits = limits.filter_map(|(head, limit)| limit.map(|limit| (head, limit.sign)));
        let bounded = limits.flat_map(|(head, sign)| self.heads.numbers(head, 0).iter().map(move |&at| (at, sign)));
        let mut free: Vec<(usize, f64)> = bounded.collect();
        let (mut step, mut shared) = (step, shared);
        let none = vec![0.0; shared.len()];
        for _ in 0..MOST_WALLS {
            let is_beyond = |(at, sign): &(usize, f64)| sign * (state.theta[*at] + step[*at]) < -BEYOND;
            let (beyond, rest): (Vec<_>, Vec<_>) = free.into_iter().partition(is_beyond);
            if beyond.is_empty() {
                break;
            }
            for (at, _) in beyond {
                self.triangle.add(Row { first: at, slopes: &[WALL], shared: &none, value: WALL * state.theta[at] });
            }
            free = rest;
            let Some(held) = self.triangle.solve() else { break };
            (step, shared) = held;
        }
        (step, shared)
    }
}
