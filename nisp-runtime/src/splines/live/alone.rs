//! Which values of a column are strays by their neighbours alone, before any equation is solved: where one stands alone, five values
//! in a row are far from any cubic, and all are near one without it. A change is far from a cubic whichever value is left out.

/// How far five values are from a cubic where one of them is a stray, at least, over how far a quarter of all are at most.
const FAR: f64 = 20.0;
/// How far they may be without the strays, and as a share of how far they are with them: where data are exact, values are off by how the
/// record bends, which may be much more in one part of it than in another.
const NEAR: f64 = 10.0;
const BENT: f64 = 0.05;
/// Values that are compared with a cubic.
const FIVE: usize = 5;
/// Strays among neighbours. More of them are a change.
const MOST: usize = 3;

/// Values behind a stray, at least: the last ones may be the beginning of a change.
const BEHIND: usize = 2;

/// Numbers of the strays among places and values, which are in order.
pub(super) fn strays(values: &[(f64, f64)]) -> Vec<usize> {
    let mut kept: Vec<usize> = (0..values.len()).collect();
    let usual = usual(values);
    let mut is_settled = vec![false; values.len()];
    loop {
        let is_far = |(first, distance): (usize, f64)| {
            (distance > FAR * usual && !is_settled[kept[first]]).then_some((first, distance))
        };
        let far = distances(values, &kept).enumerate().filter_map(is_far);
        let Some((first, farthest)) = far.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        // All that are compared with one of the five.
        let near = first.saturating_sub(FIVE - 1)..(first + 2 * FIVE - 1).min(kept.len());
        match without_strays(values, &kept[near.clone()], (NEAR * usual).max(farthest * BENT)) {
            Some(without) if !has_pair(&kept[near.clone()], &without) => {
                kept.splice(near, without);
            }
            // Two that follow each other may be a pulse: the equations have to say.
            _ => is_settled[kept[first]] = true,
        }
    }
    (0..values.len()).filter(|at| kept.binary_search(at).is_err()).collect()
}

/// How far a quarter of all five values that are not on a cubic are from it, at most: strays spoil most of the others where they are many.
/// Values that stay as they are, as rounded ones do, say nothing of how far others may be.
fn usual(values: &[(f64, f64)]) -> f64 {
    let all: Vec<usize> = (0..values.len()).collect();
    let mut distances: Vec<f64> = distances(values, &all).filter(|distance| *distance > 0.0).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 4).copied().unwrap_or(f64::INFINITY)
}

/// The rest of some neighbours without strays, as few as it takes to have all near a cubic; nothing if it takes too many. One after the
/// other would not do: two that are off to either side hide each other.
fn without_strays(values: &[(f64, f64)], near: &[usize], most: f64) -> Option<Vec<usize>> {
    (1..=MOST).find_map(|count| best_without(values, near, (count, 0), most)).map(|(_, rest)| rest)
}

/// Whether two that follow each other are lacking in a rest.
fn has_pair(all: &[usize], rest: &[usize]) -> bool {
    let lacks = |number: &usize| !rest.contains(number);
    all.windows(2).any(|pair| pair[1] == pair[0] + 1 && pair.iter().all(lacks))
}

/// The rest without so many neighbours, from a place on: the one nearest to a cubic, and the sum of squares of
/// its distances; nothing if none is near.
fn best_without(
    values: &[(f64, f64)],
    near: &[usize],
    (count, from): (usize, usize),
    most: f64,
) -> Option<(f64, Vec<usize>)> {
    if count == 0 {
        let is_near = distances(values, near).all(|distance| distance <= most);
        let square = || distances(values, near).map(|distance| distance * distance).sum();
        return is_near.then(|| (square(), near.to_vec()));
    }
    let without = |place: usize| {
        let mut rest = near.to_vec();
        rest.remove(place);
        best_without(values, &rest, (count - 1, place), most)
    };
    (from..near.len().saturating_sub(BEHIND)).filter_map(without).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// How far every five values in a row are from a cubic: the remainder of the fourth divided difference, for noise of one.
fn distances(values: &[(f64, f64)], numbers: &[usize]) -> impl Iterator<Item = f64> {
    let distance = |five: &[usize]| {
        let weight = |at: usize| -> f64 {
            let others = five.iter().filter(|&&other| other != at);
            others.map(|&other| values[at].0 - values[other].0).product::<f64>().recip()
        };
        let (mut sum, mut square) = (0.0, 0.0);
        for &at in five {
            sum += weight(at) * values[at].1;
            square += weight(at).powi(2);
        }
        sum.abs() / square.sqrt()
    };
    numbers.windows(FIVE).map(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(count: usize, value: impl Fn(usize) -> f64) -> Vec<usize> {
        strays(&(0..count).map(|i| (i as f64, value(i))).collect::<Vec<_>>())
    }

    #[test]
    fn values_that_stand_alone_are_found_and_changes_are_not() {
        // Multiples of the golden ratio stand for noise.
        let wave = |i: usize| (0.4 * i as f64).sin() + 0.1 * (i as f64 * 0.618_033_988_75).fract();
        let glitch = |i: usize, at: usize| if i == at { 9.0 } else { 0.0 };
        assert!(found(60, wave).is_empty());
        assert_eq!(found(60, |i| wave(i) + glitch(i, 17)), [17]);
        assert_eq!(found(60, |i| wave(i) + glitch(i, 17) - glitch(i, 19) + glitch(i, 40)), [17, 19, 40]);
        assert_eq!(found(60, |i| wave(i) + glitch(i, 0)), [0]);
        let since = |i: usize| i.saturating_sub(30) as f64;
        assert!(found(60, |i| wave(i) + 9.0 * since(i).min(1.0)).is_empty(), "a step");
        assert!(found(60, |i| wave(i) + 9.0 * since(i)).is_empty(), "a bend");
        assert!(found(60, |i| wave(i) + glitch(i, 30) + glitch(i, 31)).is_empty(), "a pulse");
        assert!(found(60, |i| (i / 15) as f64).is_empty(), "rounded values stay and jump");
    }
}
