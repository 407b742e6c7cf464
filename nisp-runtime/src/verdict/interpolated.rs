//! Rows that nobody measured: they lie on straight lines between others, as interpolation makes them.

/// Rows from one that was measured to the next, at most.
const LONGEST: usize = 50;
/// Measured rows in a record, at least.
const LEAST: usize = 5;
/// Share of the measured rows that may lie on a line with their neighbours by chance.
const CHANCE: f64 = 0.2;
/// Distance from a line that is rounding, as a share of the largest.
const ROUNDING: f64 = 1e-7;

/// Of evenly spaced values, which one of every so many was measured, where all the others lie on straight lines.
pub(super) fn one_of(values: &[f64]) -> Option<usize> {
    let bends: Vec<f64> = values.windows(3).map(|y| (y[2] - 2.0 * y[1] + y[0]).abs()).collect();
    let largest = bends.iter().copied().fold(0.0, f64::max);
    let bent: Vec<usize> = (0..bends.len()).filter(|&at| bends[at] > ROUNDING * largest).collect();
    let first = *bent.first()?;
    let is_one_of = |every: &usize| {
        let corners = (bends.len() - first).div_ceil(*every) + first / every;
        bent.len() >= LEAST
            && bent.len() as f64 >= (1.0 - CHANCE) * corners as f64
            && bent.iter().all(|at| at % every == first % every)
    };
    (2..=LONGEST).rev().find(is_one_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(at: f64) -> f64 {
        (0.7 * at).sin() + 0.1 * (17.0 * at * at).sin()
    }

    #[test]
    fn rows_between_others_are_found() {
        for every in [2, 5, 12] {
            let value = |at: usize| {
                let (last, share) = ((at + 3) / every, ((at + 3) % every) as f64 / every as f64);
                (1.0 - share) * wave(last as f64) + share * wave(last as f64 + 1.0)
            };
            assert_eq!(one_of(&(0..20 * every).map(value).collect::<Vec<_>>()), Some(every));
        }
    }

    #[test]
    fn measured_rows_are_not() {
        let values: Vec<f64> = (0..200).map(|at| wave(0.1 * at as f64)).collect();
        assert_eq!(one_of(&values), None);
        // Neither are those of a sensor with few steps, nor one that stands still.
        let steps: Vec<f64> = values.iter().map(|x| (4.0 * x).round() / 4.0).collect();
        assert_eq!(one_of(&steps), None);
        assert_eq!(one_of(&[1.0; 50]), None);
    }
}
