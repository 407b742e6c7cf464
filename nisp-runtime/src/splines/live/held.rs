//! Sensors that stand still: at the end of their range, or because they failed. What they show then is no measurement, however well
//! a source follows it.

/// Equal values side by side, at least.
const LONG: usize = 8;
/// How many such runs chance makes, at most, of values that repeat as often as they did elsewhere.
const CHANCE: f64 = 1e-3;

/// The values of all columns that are observed, and where they stood still.
#[derive(Debug, Default)]
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
}

impl Held {
    /// Takes a row: its place, and the value and the noise of every column that is observed, NaN where nothing was measured or
    /// nothing is known.
    pub(super) fn take(&mut self, at: f64, columns: impl Iterator<Item = [f64; 2]>) {
        for (column, [value, noise]) in columns.enumerate() {
            if self.columns.len() == column {
                self.columns.push(Run::none());
            }
            let run = &mut self.columns[column];
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
    fn none() -> Self {
        Self { value: f64::NAN, first: f64::NAN, length: 0, rows: 0, repeats: 0, step: f64::INFINITY }
    }

    fn take(&mut self, at: f64, value: f64) {
        self.rows += 1;
        if value == self.value {
            self.length += 1;
            self.repeats += 1;
        } else {
            self.step = self.step.min((value - self.value).abs());
            (self.value, self.first, self.length) = (value, at, 1);
        }
    }

    /// Whether these values are no chance. A quantity that is nothing may be exactly that, and a sensor whose steps are larger
    /// than its noise may rest.
    fn is_held(&self, noise: f64) -> bool {
        let own = self.length.saturating_sub(1);
        let often = (self.repeats - own + 1) as f64 / (self.rows - self.length + 1) as f64;
        let is_rare = self.rows as f64 * often.powi(own as i32) < CHANCE;
        self.length >= LONG && self.value != 0.0 && self.step < noise && is_rare
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where values of a noise are found to stand still.
    fn found(values: &[f64], noise: f64) -> Vec<usize> {
        let mut held = Held::default();
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
        // A sensor whose steps are larger than its noise may rest, and nothing is exactly nothing.
        let coarse: Vec<f64> = values.iter().map(|x| (10.0 * x).round() / 10.0).collect();
        assert!(found(&coarse, 0.03).is_empty());
        let nothing: Vec<f64> = (0..300).map(|at| if (100..150).contains(&at) { 0.0 } else { sound[at] }).collect();
        assert!(found(&nothing, 0.01).is_empty());
    }
}
