//! Which rows of a window's tail are strays: far from what all other rows say, while these agree without them.
//!
//! What an observation is off from its prediction by all others follows from what it is off in the fit: with `C` the covariance of
//! what all are off, over their noise, leaving one out is a step of elimination with its column of `C`. The farthest is left out first,
//! then the farthest of the others.

/// How far a row that agrees is from its prediction by all other rows, at most, in standard deviations.
const AGREE: f64 = 4.0;
/// How far a stray is, at least.
const FAR: f64 = 6.0;
/// Strays that a tail may have. More of them are a change.
const MOST: usize = 3;
/// Rows behind a stray that agree without it, at least: a change begins with a row that stands alone.
const BEHIND: usize = 2;
/// Below this variance an observation alone says what it is compared with.
const UNTOLD: f64 = 1e-9;

/// An observation that may be a stray.
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
    pub(super) fn among(mut suspects: Vec<Suspect>) -> Self {
        let mut places: Vec<f64> = suspects.iter().map(|suspect| suspect.at).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let left_out = left_out(&mut suspects).unwrap_or_default();
        let agrees = |place: usize| left_out.iter().all(|stray| stray.at != places[place]);
        let is_alone = |place: usize| {
            let beside = |other: &&Suspect| {
                place > 0 && other.at == places[place - 1] || Some(&other.at) == places.get(place + 1)
            };
            let own = || left_out.iter().filter(|stray| stray.at == places[place]);
            !left_out.iter().filter(beside).any(|other| own().any(|own| own.moves_with(other)))
        };
        let is_found = |&place: &usize| {
            let is_far = left_out.iter().any(|stray| stray.at == places[place] && stray.distance() > FAR);
            let behind = (place + 1..places.len()).filter(|&other| agrees(other)).count();
            is_far && behind >= BEHIND && is_alone(place)
        };
        let (found, aside): (Vec<usize>, _) = (0..places.len()).filter(|&place| !agrees(place)).partition(is_found);
        let at = |numbers: Vec<usize>| numbers.into_iter().map(|place| places[place]).collect();
        Self { found: at(found), aside: at(aside) }
    }
}

/// Takes out the observations without which all others agree; nothing where these are too many.
fn left_out(suspects: &mut Vec<Suspect>) -> Option<Vec<Suspect>> {
    let mut left_out: Vec<Suspect> = Vec::new();
    let mut rows = 0;
    while let Some(at) = farthest(suspects) {
        if suspects[at].distance() <= AGREE {
            break;
        }
        let stray = suspects.swap_remove(at);
        rows += usize::from(left_out.iter().all(|other| other.at != stray.at));
        if rows > MOST {
            return None;
        }
        leave_out(&stray, suspects);
        left_out.push(stray);
    }
    Some(left_out)
}

fn farthest(suspects: &[Suspect]) -> Option<usize> {
    (0..suspects.len()).max_by(|&a, &b| suspects[a].distance().total_cmp(&suspects[b].distance()))
}

/// Predicts the others without one.
fn leave_out(stray: &Suspect, others: &mut [Suspect]) {
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
    fn a_row_alone_is_a_stray_and_rows_that_move_together_are_not() {
        let of = |values: &[f64]| {
            let Strays { found, aside } = Strays::among(alike(values));
            (found, aside)
        };
        assert_eq!(of(&[0.1, 5.0, -0.3, 0.3, 0.0, -0.1]), (vec![], vec![1.0]), "it may be noise");
        assert_eq!(of(&[0.1, 30.0, -0.2, 0.3, 0.0, -0.1]), (vec![1.0], vec![]));
        assert_eq!(of(&[0.1, 30.0, -50.0, -0.2, 0.3, 0.0, -0.1]), (vec![1.0, 2.0], vec![]));
        assert_eq!(of(&[0.1, 0.0, -0.2, 0.3, 30.0, -0.1]), (vec![], vec![4.0]), "one row is behind it");
        assert_eq!(of(&[0.1, 30.0, 29.0, 0.3, 0.0, -0.1]), (vec![], vec![1.0, 2.0]), "a pulse");
        assert_eq!(of(&[0.1, 0.2, -0.3, 0.1, 30.0, 29.0, 31.0, 30.5]), (vec![], vec![]), "a step");
    }
}
