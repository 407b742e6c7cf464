//! What can be wrong with measurements, and what is only hard about them.

use std::fmt;

use super::samples::Samples;
use crate::random::Random;

/// What is done to an experiment before it is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Corruption {
    /// Nothing: noise alone.
    Nothing,
    /// No noise.
    Exact,
    /// The run ends after so many steps.
    Early(u64),
    /// Only so many rows, evenly spread.
    Few(usize),
    /// No rows in this part of the record, given in shares of its rows.
    Gap(f64, f64),
    /// This share of the values is off by some spreads of its column.
    Outliers(f64),
    /// The scene is told another value of a parameter than the data were made with.
    Parameter(&'static str, f64),
    /// The data come from other equations than the scene's.
    Physics,
    /// The scene of this name, which states something else than what is true.
    Stated(&'static str),
    /// A column is multiplied: a wrong unit.
    Scaled(&'static str, f64),
    /// A constant is added to a column: another zero, or another place.
    Moved(&'static str, f64),
    /// A column is reflected about a value.
    Mirrored(&'static str, f64),
    /// Two columns are turned into each other by an angle in degrees.
    Turned(&'static str, &'static str, f64),
    /// Two columns change places.
    Swapped(&'static str, &'static str),
}

use Corruption::*;

impl Corruption {
    /// True where the data come from the scene's own equations and parameters: the answer should be right, or at least say how
    /// far it may be off.
    pub(super) fn is_sound(self) -> bool {
        matches!(self, Nothing | Exact | Few(_) | Gap(..))
    }

    /// Measurements as they come from the experiment: with noise, as shares of each column's standard deviation, and spoiled.
    pub(super) fn measure(self, exact: &Samples, noise: f64, random: &mut Random) -> Samples {
        let mut samples = exact.clone();
        if self != Exact {
            for column in samples.columns.iter_mut().filter(|column| column.measured) {
                let deviation = column.noise.unwrap_or(noise * spread(&column.values));
                column.values.iter_mut().for_each(|value| *value += deviation * random.normal());
            }
        }
        self.spoil(&mut samples, random);
        samples
    }

    fn spoil(self, samples: &mut Samples, random: &mut Random) {
        match self {
            Nothing | Exact | Early(_) | Parameter(..) | Physics | Stated(_) => {}
            Few(count) => {
                let all = samples.rows();
                let kept: Vec<usize> = (0..count).map(|i| i * (all - 1) / (count - 1).max(1)).collect();
                samples.keep(|row| kept.contains(&row));
            }
            Gap(from, to) => {
                let all = samples.rows() as f64;
                samples.keep(|row| !(from * all..to * all).contains(&(row as f64)));
            }
            Outliers(share) => {
                for column in samples.columns.iter_mut().filter(|column| column.measured) {
                    let spread = spread(&column.values);
                    for value in &mut column.values {
                        if random.uniform() < share {
                            *value += 3.0 * spread * random.normal();
                        }
                    }
                }
            }
            Scaled(name, factor) => samples.change(name, |value| factor * value),
            Moved(name, by) => samples.change(name, |value| value + by),
            Mirrored(name, about) => samples.change(name, |value| 2.0 * about - value),
            Swapped(one, other) => {
                let (one, other) = (samples.index(one), samples.index(other));
                let kept = std::mem::take(&mut samples.columns[one].values);
                samples.columns[one].values = std::mem::replace(&mut samples.columns[other].values, kept);
            }
            Turned(one, other, degrees) => {
                let (one, other) = (samples.index(one), samples.index(other));
                let (sin, cos) = degrees.to_radians().sin_cos();
                for row in 0..samples.rows() {
                    let [x, y] = [one, other].map(|at| samples.columns[at].values[row]);
                    samples.columns[one].values[row] = cos * x - sin * y;
                    samples.columns[other].values[row] = sin * x + cos * y;
                }
            }
        }
    }
}

/// Standard deviation of values.
fn spread(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

impl fmt::Display for Corruption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Nothing => write!(f, "right"),
            Exact => write!(f, "exact data"),
            Early(steps) => write!(f, "{steps} steps"),
            Few(rows) => write!(f, "{rows} rows"),
            Gap(from, to) => write!(f, "gap of {:.0} %", 100.0 * (to - from)),
            Outliers(share) => write!(f, "{:.0} % outliers", 100.0 * share),
            Parameter(name, value) => write!(f, "{name} = {value}"),
            Physics => write!(f, "other physics"),
            Stated(scene) => write!(f, "{}", scene.replace('_', " ")),
            Scaled(name, factor) => write!(f, "{name} times {factor}"),
            Moved(name, by) => write!(f, "{name} moved by {by}"),
            Mirrored(name, about) => write!(f, "{name} mirrored at {about}"),
            Turned(one, other, degrees) => write!(f, "{one}, {other} turned by {degrees}"),
            Swapped(one, other) => write!(f, "{one}, {other} swapped"),
        }
    }
}
