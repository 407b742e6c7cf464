//! Sensors that stand still: at the end of their range, or because they failed.

/// Equal values side by side, at least.
const LONG: usize = 8;
/// Share of other values that are equal to each other where a sensor has steps, of which many values may be the same.
const STEPS: f64 = 0.2;
/// How many such runs chance makes of values that repeat as often as the others do.
const CHANCE: f64 = 1e-3;

/// Of values in the order of their coordinate, how many are not zero and stand in long runs of equal ones, or are the largest or
/// the least of all and often so, where the other values seldom repeat anywhere; and the value of the longest run. A quantity that
/// is nothing may be exactly that.
pub(super) fn held(values: &[f64]) -> (usize, f64) {
    let [least, most] = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of).unwrap_or(0.0));
    let often = |end: f64| values.iter().filter(|value| **value == end).count() >= LONG;
    let [is_cut_below, is_cut_above] = [least, most].map(often);
    let is_end = |value: f64| is_cut_below && value == least || is_cut_above && value == most;
    let runs: Vec<&[f64]> = values.chunk_by(|a, b| a == b).collect();
    let (long, short): (Vec<&[f64]>, Vec<&[f64]>) =
        runs.into_iter().partition(|run| run.len() >= LONG || is_end(run[0]));
    let repeats: usize = short.iter().map(|run| run.len() - 1).sum();
    let others = short.iter().map(|run| run.len()).sum::<usize>().max(1) as f64;
    let mut distinct: Vec<f64> = short.iter().map(|run| run[0]).collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    if (distinct.len() as f64) < (1.0 - STEPS) * others {
        return (0, 0.0);
    }
    // No repeat among few values does not mean that there is none.
    let often = (repeats as f64 + 1.0) / (others + 1.0);
    let is_chance = |run: &&[f64]| values.len() as f64 * often.powi(run.len() as i32 - 1) > CHANCE;
    let held = long.into_iter().filter(|run| run[0] != 0.0 && (is_end(run[0]) || !is_chance(run)));
    let held: Vec<&[f64]> = held.collect();
    let longest = held.iter().max_by_key(|run| run.len()).map_or(0.0, |run| run[0]);
    (held.iter().map(|run| run.len()).sum(), longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_at_its_limit_stands_still() {
        let wave = |at: usize| (0.1 * at as f64).sin() + 1e-3 * ((at * at) as f64).sin();
        let sound: Vec<f64> = (0..190).map(wave).collect();
        assert_eq!(held(&sound), (0, 0.0));
        let clipped: Vec<f64> = sound.iter().map(|x| x.min(0.8)).collect();
        let (count, value) = held(&clipped);
        assert_eq!((count, value), (clipped.iter().filter(|x| **x == 0.8).count(), 0.8));
        // Noise takes a sensor off its limit for a moment.
        let noisy = |at: usize| (0.1 * at as f64).sin() + 0.2 * (7.0 * (at * at) as f64).sin();
        let clipped: Vec<f64> = (0..190).map(|at| noisy(at).min(0.9)).collect();
        assert_eq!(held(&clipped), (clipped.iter().filter(|x| **x == 0.9).count(), 0.9));
        // A sensor of few steps repeats everywhere.
        for fine in [2.0, 20.0] {
            let steps: Vec<f64> = sound.iter().map(|x| (fine * x).round() / fine).collect();
            assert_eq!(held(&steps).0, 0);
        }
        // A source that is zero for a while is not held.
        let late: Vec<f64> = sound.iter().enumerate().map(|(at, x)| if at < 50 { 0.0 } else { *x }).collect();
        assert_eq!(held(&late).0, 0);
    }
}
