//! Sensors that stand still: at the end of their range, because they failed, or because they are read more often than they measure.

use std::ops::Range;

/// Equal values side by side, at least.
const LONG: usize = 8;
/// Share of other values that are equal to each other where a sensor has steps, of which many values may be the same.
const STEPS: f64 = 0.2;
/// How many such runs chance makes of values that repeat as often as the others do.
const CHANCE: f64 = 1e-3;
/// A state that comes to rest at zero does so in steps like its others. One that moves there in a single row, so many times as far as in
/// any other, is held at zero by its sensor.
const LEAP: f64 = 3.0;
/// Runs of equal values, at least, that say whether a sensor has steps.
const RUNS: usize = 20;
/// The least difference of runs, as a share of the usual one, where values have no steps.
const FINE: f64 = 0.1;

/// Of values in the order of their coordinate, those that stand in long runs of equal ones, or are the largest or the least of all and
/// often so, where the other values seldom repeat anywhere. Zero is left out, since a flow that is switched off is exactly zero; of a state,
/// which does not leap, zero counts where the values leap to it.
pub(crate) fn held(values: &[f64], is_state: bool) -> Vec<Range<usize>> {
    let [least, most] = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of).unwrap_or(0.0));
    let often = |end: f64| values.iter().filter(|value| **value == end).count() >= LONG;
    let [is_cut_below, is_cut_above] = [least, most].map(often);
    let is_end = |value: f64| is_cut_below && value == least || is_cut_above && value == most;
    let (long, short): (Vec<Range<usize>>, Vec<Range<usize>>) =
        runs(values).into_iter().partition(|run| run.len() >= LONG || is_end(values[run.start]));
    let repeats: usize = short.iter().map(|run| run.len() - 1).sum();
    let others = short.iter().map(|run| run.len()).sum::<usize>().max(1) as f64;
    let mut distinct: Vec<f64> = short.iter().map(|run| values[run.start]).collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    if (distinct.len() as f64) < (1.0 - STEPS) * others {
        return Vec::new();
    }
    // No repeat among few values does not mean that there is none.
    let often = (repeats as f64 + 1.0) / (others + 1.0);
    let is_chance = |run: &Range<usize>| values.len() as f64 * often.powi(run.len() as i32 - 1) > CHANCE;
    let usual = short.windows(2).filter(|pair| pair[0].end == pair[1].start).map(|pair| step(values, pair[1].start));
    let usual = usual.fold(0.0, f64::max);
    let leaps = |run: &Range<usize>| {
        let ends = [run.start, run.end].into_iter().filter(|end| (1..values.len()).contains(end));
        usual > 0.0 && ends.map(|end| step(values, end)).any(|step| step > LEAP * usual)
    };
    let is_held = |run: &Range<usize>| match values[run.start] {
        0.0 => is_state && !is_chance(run) && leaps(run),
        value => is_end(value) || !is_chance(run),
    };
    long.into_iter().filter(is_held).collect()
}

/// Long runs of equal values of a given quantity, where the other values seldom repeat from one row to the next. They may be what was done, as
/// with a heater at full power, or the end of what its meter shows. Zero is left out: a quantity that is switched off is exactly zero.
pub(crate) fn stands(values: &[f64]) -> Vec<Range<usize>> {
    let (long, short): (Vec<Range<usize>>, Vec<Range<usize>>) =
        runs(values).into_iter().partition(|run| run.len() >= LONG);
    let others: usize = short.iter().map(|run| run.len()).sum();
    if others < LONG || (short.len() as f64) < (1.0 - STEPS) * others as f64 {
        return Vec::new();
    }
    long.into_iter().filter(|run| values[run.start] != 0.0).collect()
}

/// Numbers of the values but for long runs of equal ones, which say nothing of how noisy a sensor is that seldom repeats itself; of all
/// values where too few are left.
pub(crate) fn moving(values: &[f64], fewest: usize) -> Vec<usize> {
    let left: Vec<usize> = runs(values).into_iter().filter(|run| run.len() < LONG).flatten().collect();
    let mut distinct: Vec<f64> = left.iter().map(|&at| values[at]).collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    let repeats = (distinct.len() as f64) < (1.0 - STEPS) * left.len() as f64;
    if repeats || left.len() < fewest { (0..values.len()).collect() } else { left }
}

/// Whether values are one value but for too few others to say whether that is a sensor that failed.
pub(crate) fn is_at_rest(values: &[f64], fewest: usize) -> bool {
    let longest = runs(values).into_iter().map(|run| run.len()).max().unwrap_or(0);
    longest >= LONG && 2 * longest > values.len() && values.len() - longest < fewest
}

/// How many rows a value stands for, where a sensor is read more often than it measures; nothing where values seldom repeat, or because
/// the sensor has steps. Long runs are of sensors that stand still.
pub(crate) fn polled(values: &[f64]) -> Option<f64> {
    let runs: Vec<Range<usize>> = runs(values).into_iter().filter(|run| run.len() < LONG).collect();
    if runs.len() < RUNS {
        return None;
    }
    let steps = runs.windows(2).filter(|pair| pair[0].end == pair[1].start).map(|pair| step(values, pair[1].start));
    let mut steps: Vec<f64> = steps.collect();
    steps.sort_by(f64::total_cmp);
    let is_fine = steps.first()? < &(FINE * steps[steps.len() / 2]);
    let rows: usize = runs.iter().map(|run| run.len()).sum();
    is_fine.then(|| rows as f64 / runs.len() as f64)
}

/// Runs of equal values, one after the other.
fn runs(values: &[f64]) -> Vec<Range<usize>> {
    let mut start = 0;
    let run = |run: &[f64]| {
        let own = start..start + run.len();
        start = own.end;
        own
    };
    values.chunk_by(|a, b| a == b).map(run).collect()
}

/// How far a value is from the one before.
fn step(values: &[f64], at: usize) -> f64 {
    (values[at] - values[at - 1]).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(at: usize) -> f64 {
        (0.1 * at as f64).sin() + 1e-3 * ((at * at) as f64).sin()
    }

    /// How many values are held.
    fn count(values: &[f64], is_state: bool) -> usize {
        held(values, is_state).into_iter().map(|run| run.len()).sum()
    }

    #[test]
    fn a_sensor_at_its_limit_stands_still() {
        let sound: Vec<f64> = (0..190).map(wave).collect();
        assert_eq!(held(&sound, true), []);
        let clipped: Vec<f64> = sound.iter().map(|x| x.min(0.8)).collect();
        assert_eq!(count(&clipped, true), clipped.iter().filter(|x| **x == 0.8).count());
        // Noise takes a sensor off its limit for a moment.
        let noisy = |at: usize| (0.1 * at as f64).sin() + 0.2 * (7.0 * (at * at) as f64).sin();
        let clipped: Vec<f64> = (0..190).map(|at| noisy(at).min(0.9)).collect();
        assert_eq!(count(&clipped, true), clipped.iter().filter(|x| **x == 0.9).count());
        // A sensor of few steps repeats everywhere.
        for fine in [2.0, 20.0] {
            let steps: Vec<f64> = sound.iter().map(|x| (fine * x).round() / fine).collect();
            assert_eq!(held(&steps, true), []);
        }
    }

    #[test]
    fn nothing_is_held_where_a_quantity_may_be_it() {
        let wave = |at: usize| 2.0 + wave(at);
        let late: Vec<f64> = (0..190).map(|at| if at < 50 { 0.0 } else { wave(at) }).collect();
        assert_eq!(held(&late, false), [], "a pump that is switched on");
        assert_eq!((held(&late, true).len(), count(&late, true)), (1, 50), "a temperature does not leap");
        let dead: Vec<f64> = (0..190).map(|at| if at < 100 { wave(at) } else { 0.0 }).collect();
        assert_eq!((held(&dead, true).len(), count(&dead, true)), (1, 90));
        let stops: Vec<f64> = (0..190).map(|at| (100.0 - at as f64).max(0.0) * (1.0 + 1e-3 * wave(at))).collect();
        assert_eq!(held(&stops, true), [], "a car that stops");
    }

    #[test]
    fn what_is_given_stands_where_others_move() {
        let heater: Vec<f64> = (0..190).map(|at| (1.0 + (0.1 * at as f64).sin()).min(1.8)).collect();
        let count: usize = stands(&heater).into_iter().map(|run| run.len()).sum();
        assert_eq!(count, heater.iter().filter(|power| **power == 1.8).count());
        // On and off, and off alone.
        let switched: Vec<f64> = (0..190).map(|at| f64::from(u8::from(at / 20 % 2 == 0))).collect();
        assert_eq!(stands(&switched), []);
        let late: Vec<f64> = (0..190).map(|at| if at < 50 { 0.0 } else { heater[at] }).collect();
        assert!(stands(&late).iter().all(|run| run.start >= 50));
    }

    #[test]
    fn the_noise_is_that_of_moving_values() {
        let values: Vec<f64> = (0..190).map(|at| if at < 120 { 3.0 } else { wave(at) }).collect();
        assert_eq!(moving(&values, 9), (120..190).collect::<Vec<_>>());
        assert_eq!(moving(&values[..125], 9), (0..125).collect::<Vec<_>>(), "too few are left");
        let steps: Vec<f64> = (0..190).map(|at| (20.0 * wave(at)).round() / 20.0).collect();
        assert_eq!(moving(&steps, 9), (0..190).collect::<Vec<_>>());
    }

    #[test]
    fn a_sensor_that_is_read_too_often_is_told_from_one_with_steps() {
        let polled_of = |every: usize| polled(&(0..400).map(|at| wave(every * (at / every))).collect::<Vec<_>>());
        assert_eq!(polled_of(1), Some(1.0));
        assert_eq!(polled_of(5), Some(5.0));
        // A slow course in steps.
        let steps: Vec<f64> = (0..400).map(|at| (0.2 * at as f64).round() / 20.0).collect();
        assert_eq!(polled(&steps), None);
    }
}
