//! Steps after which no head is beyond its bound where its functions are centred.

use super::iterate::State;
use super::rows::Rows;
use super::solver::Solver;
use super::triangle::Row;
use crate::bounds::{WALL, within};

/// A value of a bounded head: the first coefficient that it depends on, and its derivatives, over the head's scale and with the
/// sign that makes it positive inside.
struct Value {
    first: usize,
    slopes: Vec<f64>,
}

impl Value {
    fn of(&self, coefficients: &[f64]) -> f64 {
        self.slopes.iter().zip(&coefficients[self.first..]).map(|(slope, x)| slope * x).sum()
    }
}

impl Solver<'_> {
    /// A step of coefficients and of learned parameters within all bounds. It goes last, since the triangle is made anew. Noise,
    /// roughness and error bars are those without bounds, so that a source at its bound has bars.
    pub(super) fn within_bounds(
        &mut self,
        state: &State,
        rows: &Rows,
        step: (Vec<f64>, Vec<f64>),
    ) -> (Vec<f64>, Vec<f64>) {
        let values = self.bounded_values();
        let none = vec![0.0; step.1.len()];
        let inside = |step: &(Vec<f64>, Vec<f64>), at: usize| values[at].of(&state.theta) + values[at].of(&step.0);
        let is_at_bound = |at: &usize| values[*at].of(&state.theta) <= 0.0;
        let at_bound = (0..values.len()).filter(is_at_bound).collect();
        within(values.len(), step, at_bound, inside, |held| {
            self.triangle.clear();
            self.triangle.add_all(rows.walk());
            for value in held.iter().map(|&at| &values[at]) {
                let slopes: Vec<f64> = value.slopes.iter().map(|slope| WALL * slope).collect();
                let row =
                    Row { first: value.first, slopes: &slopes, shared: &none, value: WALL * value.of(&state.theta) };
                self.triangle.add(row);
            }
            self.triangle.solve()
        })
    }

    /// Values of bounded heads, one where each of their functions is centred.
    fn bounded_values(&self) -> Vec<Value> {
        let heads = &self.heads;
        let of = |head: usize, sign: f64| {
            let basis = &heads.bases[head];
            (0..basis.len()).map(move |function| {
                let (first, slopes) = heads.value_row(head, basis.centre(function));
                Value { first, slopes: slopes.iter().map(|slope| sign * slope / heads.scale[head]).collect() }
            })
        };
        let limits = heads.limits.iter().enumerate();
        limits.filter_map(|(head, limit)| limit.map(|limit| of(head, limit.sign))).flatten().collect()
    }
}
