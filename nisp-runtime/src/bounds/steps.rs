//! Steps after which no number is beyond its bound.
//!
//! Which numbers a step leaves at their bounds is found by block principal pivoting (Judice and Pires 1994): those on the wrong side
//! are turned, all at once, until there are none. Numbers that depend on several unknowns each may be turned round in circles; then
//! an interior-point method (Nocedal and Wright 2006, 16.6) finds which they are, in one to three dozen steps.

/// How stiff a number is held at its bound, how far beyond it a number may be, both over the head's scale.
pub(crate) const WALL: f64 = 1e4;
const BEYOND: f64 = 1e-6;
/// How often numbers on the wrong side are turned before the interior is asked, and afterwards.
const QUICK: usize = 6;
const MOST: usize = 12;
/// Steps in the interior at most.
const INWARD: usize = 30;
/// Share of the present product of distances and forces that a step in the interior asks for, and of the way to the boundary that it
/// goes at most.
const CENTRED: f64 = 0.1;
const SHORT: f64 = 0.95;
/// A number is settled where its distance or its force is this share of the other, each over its mean.
const CLEAR: f64 = 1e-3;

/// What pulls a number to where it is to be, over its head's scale and inside of its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spring {
    /// Which number.
    pub(crate) at: usize,
    /// The root of what the square of the distance from the target is multiplied by.
    pub(crate) stiffness: f64,
    pub(crate) target: f64,
}

/// A problem of least squares with so many numbers that have bounds.
pub(crate) struct Bounded<'a, S> {
    pub(crate) count: usize,
    /// How far a number is inside of its bound after a step.
    pub(crate) inside: &'a dyn Fn(&S, usize) -> f64,
    /// The step with these springs, or nothing if there is none.
    pub(crate) pulled: &'a mut dyn FnMut(&[Spring]) -> Option<S>,
}

impl<S> Bounded<'_, S> {
    /// A step within all bounds. `step` is that without springs; where it is not enough, those in `held` are held first.
    pub(crate) fn within(&mut self, step: S, held: Vec<usize>) -> S {
        if (0..self.count).all(|at| (self.inside)(&step, at) >= -BEYOND) {
            return step;
        }
        let mut is_held = vec![false; self.count];
        held.iter().for_each(|&at| is_held[at] = true);
        let Some((mut last, is_settled)) = self.pivoted(&mut is_held, QUICK) else { return step };
        if !is_settled && let Some(found) = self.inward(&last, &is_held) {
            is_held = found;
            let Some((settled, _)) = self.pivoted(&mut is_held, MOST) else { return last };
            last = settled;
        }
        last
    }

    /// Turns numbers on the wrong side at most so often; the last step, and whether none are left.
    fn pivoted(&mut self, is_held: &mut [bool], most: usize) -> Option<(S, bool)> {
        let mut turns = 0;
        loop {
            let held = (0..self.count).filter(|&at| is_held[at]);
            let springs: Vec<Spring> = held.map(|at| Spring { at, stiffness: WALL, target: 0.0 }).collect();
            let last = (self.pulled)(&springs)?;
            let inside = |at: usize| (self.inside)(&last, at);
            // A spring that keeps a number from going further in is in the way.
            let is_wrong = |&at: &usize| if is_held[at] { inside(at) > 0.0 } else { inside(at) < -BEYOND };
            let wrong: Vec<usize> = (0..self.count).filter(is_wrong).collect();
            if wrong.is_empty() || turns >= most {
                return Some((last, wrong.is_empty()));
            }
            wrong.into_iter().for_each(|at| is_held[at] = !is_held[at]);
            turns += 1;
        }
    }

    /// Which numbers are at their bounds, from a step that holds some of them.
    fn inward(&mut self, last: &S, is_held: &[bool]) -> Option<Vec<bool>> {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        // Stiff springs say with what force they hold, the others how far inside they are.
        let mut distances: Vec<f64> = (0..self.count).map(|at| (self.inside)(last, at).max(0.0)).collect();
        let force = |at: usize| if is_held[at] { -WALL * WALL * (self.inside)(last, at) } else { 0.0 };
        let mut forces: Vec<f64> = (0..self.count).map(|at| force(at).max(0.0)).collect();
        for values in [&mut distances, &mut forces] {
            let least = CENTRED * mean(values);
            values.iter_mut().for_each(|value| *value = value.max(least.max(f64::MIN_POSITIVE)));
        }
        for _ in 0..INWARD {
            let wanted =
                CENTRED * distances.iter().zip(&forces).map(|(s, z)| s * z).sum::<f64>() / self.count.max(1) as f64;
            let spring =
                |(at, (s, z)): (usize, (&f64, &f64))| Spring { at, stiffness: (z / s).sqrt(), target: s + wanted / z };
            let springs: Vec<Spring> = distances.iter().zip(&forces).enumerate().map(spring).collect();
            let step = (self.pulled)(&springs)?;
            let by: Vec<f64> = (0..self.count).map(|at| (self.inside)(&step, at) - distances[at]).collect();
            let of = |at: usize| wanted / distances[at] - forces[at] - forces[at] / distances[at] * by[at];
            let forced: Vec<f64> = (0..self.count).map(of).collect();
            go(&mut distances, &by);
            go(&mut forces, &forced);
            let (far, strong) = (mean(&distances), mean(&forces));
            let unclear = |(s, z): (&f64, &f64)| (s / far).min(z / strong) > CLEAR * (s / far).max(z / strong);
            if !distances.iter().zip(&forces).any(unclear) {
                break;
            }
        }
        let (far, strong) = (mean(&distances), mean(&forces));
        Some(distances.iter().zip(&forces).map(|(s, z)| z / strong > s / far).collect())
    }
}

/// Goes along a step, but stays positive.
fn go(values: &mut [f64], step: &[f64]) {
    let boundary = values.iter().zip(step).filter(|(_, by)| **by < 0.0).map(|(value, by)| -value / by);
    let share = (SHORT * boundary.fold(f64::INFINITY, f64::min)).min(1.0);
    values.iter_mut().zip(step).for_each(|(value, by)| *value += share * by);
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Least squares of `rows x - right` with `walls x >= 0`: at the end no force pulls outward, none is where a number is inside, and
    /// forces balance (Karush, Kuhn and Tucker).
    fn check(rows: &DMatrix<f64>, right: &DVector<f64>, walls: &DMatrix<f64>) {
        let solve = |springs: &[Spring]| {
            let mut matrix = rows.transpose() * rows;
            let mut vector = rows.transpose() * right;
            for spring in springs {
                let wall = walls.row(spring.at).transpose();
                matrix += spring.stiffness.powi(2) * &wall * wall.transpose();
                vector += spring.stiffness.powi(2) * spring.target * wall;
            }
            matrix.cholesky().map(|factor| factor.solve(&vector))
        };
        let inside = |x: &DVector<f64>, at: usize| (walls.row(at) * x)[0];
        let free = solve(&[]).unwrap();
        let mut bounded = Bounded { count: walls.nrows(), inside: &inside, pulled: &mut { solve } };
        let x = bounded.within(free, Vec::new());
        let distances = walls * &x;
        assert!(distances.min() > -1e-5, "{}", distances.min());
        let force = rows.transpose() * (rows * &x - right);
        // Forces of the walls that are touched, by least squares.
        let touched: Vec<usize> = (0..walls.nrows()).filter(|&at| distances[at] < 1e-5).collect();
        let own = walls.select_rows(&touched);
        let forces = own.transpose().svd(true, true).solve(&force, 1e-10).unwrap();
        let left = (own.transpose() * &forces - &force).norm();
        assert!(left < 1e-3 * force.norm() && forces.min() > -1e-2 * forces.max(), "{left} {}", forces.min());
    }

    /// Values of cubic splines, which four coefficients each settle: noisy, and half of them below zero.
    #[test]
    fn values_of_splines_are_held_where_they_must_be() {
        let mut random = StdRng::seed_from_u64(3);
        let count = 60;
        let spline = |t: f64, at: usize| {
            let u = (t * (count - 3) as f64 - at as f64 + 3.0) / 4.0;
            if (0.0..1.0).contains(&u) { (std::f64::consts::PI * u).sin().powi(3) } else { 0.0 }
        };
        let values =
            |many: usize| DMatrix::from_fn(many, count, |row, at| spline((row as f64 + 0.5) / many as f64, at));
        for seed in 0..5 {
            let wave = |row: usize| (row as f64 / 300.0 * 20.0 + f64::from(seed)).sin() + random.random::<f64>() - 0.5;
            let right = DVector::from_iterator(300, (0..300).map(wave));
            check(&values(300), &right, &values(60));
        }
    }
}
