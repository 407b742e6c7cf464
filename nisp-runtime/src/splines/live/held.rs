//! Sensors that stand still: at the end of their range, or because they failed. What they show then is no measurement, however well
//! a source follows it.

use super::record::{Layout, MeasuredRow};
use crate::noise::{FEWEST, by_differences, deviation, is_exact};
use crate::standing::{held, is_at_rest, moving};
use crate::units::Declared;

/// Equal values side by side, at least.
const LONG: usize = 8;
/// How many such runs chance makes, at most, of values that repeat as often as they did elsewhere.
const CHANCE: f64 = 1e-3;
/// How many times as far as ever before a state must have moved in one row to be held at nothing.
const LEAP: f64 = 3.0;

/// The values of all columns that are observed, and where they stood still.
#[derive(Debug)]
pub(super) struct Held {
    columns: Vec<Run>,
    /// The first and the last place of each stretch that was found.
    stretches: Vec<[f64; 2]>,
}

/// The last equal values of a column.
#[derive(Clone, Copy, Debug)]
struct Run {
    value: f64,
    first: f64,
    length: usize,
    /// All values so far, and how many are equal to the one before.
    rows: usize,
    repeats: usize,
    /// The least difference of two side by side: a step of the sensor, or less.
    step: f64,
    /// How far the first value was from the one before, and any other one from the one before at most.
    entered: f64,
    widest: f64,
    /// Whether it is a state, which does not leap.
    is_state: bool,
}

impl Held {
    /// Before the first row. By column that is observed, whether it is a state.
    pub(super) fn new(states: impl Iterator<Item = bool>) -> Self {
        Self { columns: states.map(Run::none).collect(), stretches: Vec::new() }
    }

    /// Leaves out of the first rows, whose noise nothing says yet, where a column stands still and is noisy elsewhere.
    pub(super) fn leave_out(&mut self, layout: &Layout, rows: &mut [MeasuredRow<Declared>]) {
        for (run, column) in self.columns.iter().zip(layout.observed()) {
            let (there, values) = measured(rows, column);
            let moving: Vec<f64> = moving(&values, FEWEST).into_iter().map(|at| values[at]).collect();
            if by_differences(&moving).is_none_or(|noise| is_exact(noise, deviation(&moving))) {
                continue;
            }
            for run in held(&values, run.is_state) {
                let own = &there[run];
                self.stretches.push([rows[own[0]].at, rows[own[own.len() - 1]].at]);
                own.iter().for_each(|&row| rows[row].values[column] = f64::NAN);
            }
        }
    }

    /// Takes a row: its place, and the value and the noise of every column that is observed, NaN where nothing was measured or
    /// nothing is known.
    pub(super) fn take(&mut self, at: f64, columns: impl Iterator<Item = [f64; 2]>) {
        for (run, [value, noise]) in self.columns.iter_mut().zip(columns) {
            if value.is_nan() {
                continue;
            }
            run.take(at, value);
            if run.is_held(noise) {
                match self.stretches.iter_mut().find(|stretch| stretch[0] == run.first) {
                    Some(stretch) => stretch[1] = at,
                    None => self.stretches.push([run.first, at]),
                }
            }
        }
    }

    /// Whether a column stood still at a place. Those before it are not asked for again.
    pub(super) fn is_at(&mut self, at: f64) -> bool {
        let slack = |[first, last]: &[f64; 2]| 1e-6 * (last - first);
        self.stretches.retain(|stretch| stretch[1] + slack(stretch) >= at);
        self.stretches.iter().any(|stretch| stretch[0] - slack(stretch) <= at)
    }
}

impl Run {
    fn none(is_state: bool) -> Self {
        Self {
            value: f64::NAN,
            first: f64::NAN,
            length: 0,
            rows: 0,
            repeats: 0,
            step: f64::INFINITY,
            entered: 0.0,
            widest: 0.0,
            is_state,
        }
    }

    fn take(&mut self, at: f64, value: f64) {
        self.rows += 1;
        if value == self.value {
            self.length += 1;
            self.repeats += 1;
        } else {
            let step = (value - self.value).abs();
            self.step = self.step.min(step);
            (self.entered, self.widest) = (step, self.widest.max(self.entered));
            (self.value, self.first, self.length) = (value, at, 1);
        }
    }

    /// Whether these values are no chance. A quantity that is nothing may be exactly that, unless it is a state and leaps there; and
    /// a sensor whose steps are larger than its noise may rest.
    fn is_held(&self, noise: f64) -> bool {
        let own = self.length.saturating_sub(1);
        let often = (self.repeats - own + 1) as f64 / (self.rows - self.length + 1) as f64;
        let is_rare = self.rows as f64 * often.powi(own as i32) < CHANCE;
        let leaps = self.is_state && self.widest > 0.0 && self.entered > LEAP * self.widest;
        self.length >= LONG && (self.value != 0.0 || leaps) && self.step < noise && is_rare
    }
}

/// Whether the first rows are at rest in all columns that are observed: more of them may tell whether sensors failed.
pub(super) fn are_at_rest(layout: &Layout, rows: &[MeasuredRow<Declared>]) -> bool {
    layout.observed().all(|column| is_at_rest(&measured(rows, column).1, FEWEST))
}

/// The rows in which a column was measured, and its values there.
fn measured(rows: &[MeasuredRow<Declared>], column: usize) -> (Vec<usize>, Vec<f64>) {
    let own = rows.iter().map(|row| row.values[column]).enumerate();
    own.filter(|(_, value)| !value.is_nan()).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where values of a noise are found to stand still.
    fn found(values: &[f64], noise: f64) -> Vec<usize> {
        let mut held = Held::new([true].into_iter());
        let mut all = vec![false; values.len()];
        for (at, &value) in values.iter().enumerate() {
            held.take(at as f64, [[value, noise]].into_iter());
            // Answers come ten rows later.
            if let Some(answered) = at.checked_sub(10) {
                all[answered] = held.is_at(answered as f64);
            }
        }
        (0..values.len()).filter(|&at| all[at]).collect()
    }

    #[test]
    fn a_sensor_that_fails_stands_still() {
        let wave = |at: usize| (0.1 * at as f64).sin() + 0.01 * ((at * at) as f64).sin();
        let sound: Vec<f64> = (0..300).map(wave).collect();
        assert!(found(&sound, 0.01).is_empty());
        let stuck = |at: usize| if (100..150).contains(&at) { sound[100] } else { sound[at] };
        let values: Vec<f64> = (0..300).map(stuck).collect();
        assert_eq!(found(&values, 0.01), (100..150).collect::<Vec<_>>());
        // A sensor whose steps are larger than its noise may rest, and nothing is exactly nothing, unless a state leaps there.
        let coarse: Vec<f64> = values.iter().map(|x| (10.0 * x).round() / 10.0).collect();
        assert!(found(&coarse, 0.03).is_empty());
        let nothing = |level: f64| -> Vec<f64> {
            (0..300).map(|at| if (94..150).contains(&at) { 0.0 } else { level + sound[at] }).collect()
        };
        assert!(found(&nothing(0.0), 0.01).is_empty());
        assert_eq!(found(&nothing(3.0), 0.01), (94..150).collect::<Vec<_>>());
    }
}
