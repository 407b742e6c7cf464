//! Which rows of a window's tail are strays: far from what all other rows say, while these agree without them.
//!
//! What an observation is off from its prediction by all others follows from what it is off in the fit: with `C` the covariance of
//! what all are off, over their noise, leaving one out is a step of elimination with its column of `C`. The fewest rows are sought
//! without which all others agree.

/// How far a row that agrees is from its prediction by all other rows, at most, in standard deviations.
const AGREE: f64 = 4.0;
/// How far a stray is, at least.
const FAR: f64 = 6.0;
/// Strays that a tail may have. More of them are a change.
const MOST: usize = 3;
/// Rows behind a stray that agree without it, at least: a change begins with a row that stands alone.
const BEHIND: usize = 2;
/// Strays that may follow each other to the same side, and how far they are, at least. More of them are a change, and so are two that a
/// source which is too smooth misses.
const PAIR: usize = 2;
const FAR_TOGETHER: f64 = 12.0;
/// Rows that are tried for the next one to be left out.
const TRIED: usize = 3;
/// Below this variance an observation alone says what it is compared with.
const UNTOLD: f64 = 1e-9;

/// An observation that may be a stray.
#[derive(Clone)]
pub(super) struct Suspect {
    /// The place of its row, and what it observes there.
    pub(super) at: f64,
    pub(super) what: (usize, usize),
    /// How far it is off, over its noise.
    pub(super) off: f64,
    /// The products of two such are covariances of what is predicted. Elimination makes it longer.
    pub(super) root: Vec<f64>,
}

impl Suspect {
    /// The variance of how far it is off.
    fn variance(&self) -> f64 {
        1.0 - dot(&self.root, &self.root)
    }

    /// Whether another one of the same quantity is off to the same side.
    fn moves_with(&self, other: &Self) -> bool {
        self.what == other.what && self.off * other.off > 0.0
    }

    /// How far it is from its prediction by the others, in standard deviations.
    fn distance(&self) -> f64 {
        let variance = self.variance();
        if variance > UNTOLD { self.off.abs() / variance.sqrt() } else { 0.0 }
    }
}

/// Places of rows that are left out, in order.
pub(super) struct Strays {
    /// Those of strays.
    pub(super) found: Vec<f64>,
    /// Those of rows that later ones have to say more of.
    pub(super) aside: Vec<f64>,
}

impl Strays {
    /// Of observations of a tail. Their roots end at the same unknown.
    pub(super) fn among(suspects: Vec<Suspect>) -> Self {
        let mut places: Vec<f64> = suspects.iter().map(|suspect| suspect.at).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let left_out = left_out(&suspects);
        let agrees = |place: usize| left_out.iter().all(|stray| stray.at != places[place]);
        // Whether what is off at two places is off to the same side.
        let moves_with = |place: usize, other: usize| {
            let (own, other) = (places[place], places[other]);
            let at = |at: f64| left_out.iter().filter(move |stray| stray.at == at);
            at(own).any(|own| at(other).any(|other| own.moves_with(other)))
        };
        // Rows in a row that move together.
        let together = |place: usize| {
            let before = (1..=place).rev().take_while(|&other| moves_with(other, other - 1)).count();
            let behind = (place + 1..places.len()).take_while(|&other| moves_with(other, other - 1)).count();
            before + 1 + behind
        };
        let is_found = |&place: &usize| {
            let far = match together(place) {
                1 => FAR,
                2..=PAIR => FAR_TOGETHER,
                _ => f64::INFINITY,
            };
            let is_far = left_out.iter().any(|stray| stray.at == places[place] && stray.distance() > far);
            let behind = (place + 1..places.len()).filter(|&other| agrees(other)).count();
            is_far && behind >= BEHIND
        };
        let (found, aside): (Vec<usize>, _) = (0..places.len()).filter(|&place| !agrees(place)).partition(is_found);
        let at = |numbers: Vec<usize>| numbers.into_iter().map(|place| places[place]).collect();
        Self { found: at(found), aside: at(aside) }
    }
}

/// The observations of the rows without which all others agree, as few rows as it takes, each as it is beside all rows that agree;
/// none where these are too many.
fn left_out(suspects: &[Suspect]) -> Vec<Suspect> {
    let Some(Explained { rows, .. }) = explained(suspects.to_vec(), MOST) else { return Vec::new() };
    let beside_others = |&own: &f64| {
        let mut rest = suspects.to_vec();
        rows.iter().filter(|&&row| row != own).for_each(|&row| _ = leave_out_row(row, &mut rest));
        rest.into_iter().filter(move |suspect| suspect.at == own).collect::<Vec<_>>()
    };
    rows.iter().flat_map(beside_others).collect()
}

/// Rows that are left out, and by how much the sum of squares of all distances is smaller without them.
struct Explained {
    rows: Vec<f64>,
    gain: f64,
}

/// The fewest rows, so many at most, without which all others agree; of as many, those that explain most. The farthest is not always
/// among them: two strays side by side draw the state along, and the first row behind them seems to be far. The next ones are tried too.
fn explained(suspects: Vec<Suspect>, most: usize) -> Option<Explained> {
    let farthest = farthest(&suspects);
    if farthest.first().is_none_or(|(distance, _)| *distance <= AGREE) {
        return Some(Explained { rows: Vec::new(), gain: 0.0 });
    }
    let fewer = most.checked_sub(1)?;
    let without = |&(_, row): &(f64, f64)| {
        let mut rest = suspects.clone();
        let own = leave_out_row(row, &mut rest);
        let Explained { mut rows, gain } = explained(rest, fewer)?;
        rows.push(row);
        Some(Explained { rows, gain: gain + own })
    };
    let better = |a: &Explained, b: &Explained| b.rows.len().cmp(&a.rows.len()).then(a.gain.total_cmp(&b.gain));
    farthest[..farthest.len().min(TRIED)].iter().filter_map(without).max_by(better)
}

/// How far the rows are off, each by its farthest observation, and their places: the farthest first.
fn farthest(suspects: &[Suspect]) -> Vec<(f64, f64)> {
    let mut rows: Vec<(f64, f64)> = suspects.iter().map(|suspect| (suspect.distance(), suspect.at)).collect();
    rows.sort_by(|a, b| a.1.total_cmp(&b.1).then(b.0.total_cmp(&a.0)));
    rows.dedup_by_key(|row| row.1);
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    rows
}

/// Predicts the others without a row. Returns by how much the sum of squares of all distances is smaller.
fn leave_out_row(row: f64, suspects: &mut Vec<Suspect>) -> f64 {
    let mut gain = 0.0;
    while let Some(own) = suspects.iter().position(|suspect| suspect.at == row) {
        let own = suspects.swap_remove(own);
        gain += own.distance().powi(2);
        leave_out(&own, suspects);
    }
    gain
}

/// Predicts the others without one.
fn leave_out(stray: &Suspect, others: &mut [Suspect]) {
    if stray.variance() <= UNTOLD {
        return;
    }
    let deviation = stray.variance().sqrt();
    for other in others {
        let covariance = -dot(&stray.root, &other.root) / deviation;
        other.off -= covariance * stray.off / deviation;
        other.root.push(covariance);
    }
}

/// The product of two roots, which end together.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().rev().zip(b.iter().rev()).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that are all said to be one number, of which nothing else is known: the distance of one from the mean of the others is
    /// known in closed form.
    fn alike(values: &[f64]) -> Vec<Suspect> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let of = |(at, value): (usize, &f64)| Suspect {
            at: at as f64,
            what: (0, 0),
            off: value - mean,
            root: vec![count.sqrt().recip()],
        };
        values.iter().enumerate().map(of).collect()
    }

    #[test]
    fn what_is_left_out_is_compared_with_all_others() {
        let values = [0.5, 9.0, -0.5, 0.3, -5.0, 0.1];
        let mut suspects = alike(&values);
        for left_out in [1, 3] {
            let stray = suspects.remove(left_out);
            leave_out(&stray, &mut suspects);
        }
        for suspect in &suspects {
            // Values 1 and 4 are left out, and itself.
            let others: Vec<usize> = [0, 2, 3, 5].into_iter().filter(|&at| at as f64 != suspect.at).collect();
            let mean = others.iter().map(|&at| values[at]).sum::<f64>() / 3.0;
            let exact = (values[suspect.at as usize] - mean).abs() / (1.0 + 1.0 / 3.0_f64).sqrt();
            assert!((suspect.distance() - exact).abs() < 1e-12, "{} {exact}", suspect.distance());
        }
    }

    #[test]
    fn a_row_or_two_are_strays_and_more_that_move_together_are_not() {
        let of = |values: &[f64]| {
            let Strays { found, aside } = Strays::among(alike(values));
            (found, aside)
        };
        assert_eq!(of(&[0.1, 5.0, -0.3, 0.3, 0.0, -0.1]), (vec![], vec![1.0]), "it may be noise");
        assert_eq!(of(&[0.1, 30.0, -0.2, 0.3, 0.0, -0.1]), (vec![1.0], vec![]));
        assert_eq!(of(&[0.1, 30.0, -50.0, -0.2, 0.3, 0.0, -0.1]), (vec![1.0, 2.0], vec![]));
        assert_eq!(of(&[0.1, 0.0, -0.2, 0.3, 30.0, -0.1]), (vec![], vec![4.0]), "one row is behind it");
        assert_eq!(of(&[0.1, 30.0, 50.0, 0.3, 0.0, -0.1]), (vec![1.0, 2.0], vec![]), "two that meet");
        assert_eq!(of(&[0.1, 30.0, 29.0, 31.0, 0.3, 0.0, -0.1]), (vec![], vec![1.0, 2.0, 3.0]), "a pulse");
        assert_eq!(of(&[0.1, 0.2, -0.3, 0.1, 30.0, 29.0, 31.0, 30.5]), (vec![], vec![]), "a step");
    }
}
