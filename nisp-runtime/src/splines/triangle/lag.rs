//! A triangle over a window that moves along the coordinate.
//!
//! In a triangle over unknowns in order, the first rows alone hold the first unknowns. To forget these rows is to
//! marginalise: what they said of later unknowns has been turned into later rows already.

use super::Triangle;
use super::rotation::dot;
use crate::simd::{self, Isa, Kernel, Simd};

impl Triangle {
    /// Forgets the first unknowns, and adds as many that no row sees at the end.
    pub(in super::super) fn shift(&mut self, count: usize) {
        fn move_up(part: &mut [f64], by: usize) {
            part.copy_within(by.., 0);
            let rest = part.len() - by;
            part[rest..].fill(0.0);
        }
        move_up(&mut self.rows, count * self.band);
        move_up(&mut self.border, count * self.shared);
        move_up(&mut self.right, count);
    }

    /// Takes over another triangle of the same shape from an unknown on.
    pub(in super::super) fn copy_from(&mut self, other: &Self, first: usize) {
        let copy = |own: &mut [f64], other: &[f64], each: usize| {
            own[first * each..].copy_from_slice(&other[first * each..]);
        };
        copy(&mut self.rows, &other.rows, self.band);
        copy(&mut self.border, &other.border, self.shared);
        copy(&mut self.right, &other.right, 1);
        self.corner.copy_from_slice(&other.corner);
        self.corner_right.copy_from_slice(&other.corner_right);
    }

    /// Moves the shared unknowns that the rows are about by `moved`: right sides change by the border times that.
    pub(in super::super) fn move_shared(&mut self, moved: &[f64]) {
        if !moved.is_empty() {
            let rows = self.right.iter_mut().zip(self.border.chunks_exact(self.shared));
            rows.for_each(|(right, border)| *right -= dot(border, moved));
        }
    }

    /// How the unknowns from one on follow a shared one, written to the same places.
    pub(in super::super) fn follow_from(&self, first: usize, shared: usize, x: &mut [f64]) {
        for at in (first..self.len).rev() {
            let row = &self.rows[at * self.band..][..self.band.min(self.len - at)];
            let after = dot(&row[1..], &x[at + 1..]);
            x[at] = -(self.border[at * self.shared + shared] + after) / row[0];
        }
    }

    /// `R^-T v` of a row `v` from its first unknown on, where the shared ones are known.
    pub(in super::super) fn root_beside(&self, first: usize, slopes: &[f64]) -> Vec<f64> {
        let mut found = vec![0.0; self.len - first];
        found[..slopes.len()].copy_from_slice(slopes);
        for at in first..self.len {
            let row = &self.rows[at * self.band..][..self.band];
            let own = found[at - first] / row[0];
            found[at - first] = own;
            found[at - first + 1..].iter_mut().zip(&row[1..]).for_each(|(x, r)| *x -= r * own);
        }
        found
    }

    /// The unknowns from one on that make the rows least, written to the same places, where the shared ones are known. Returns
    /// false if the rows leave some open.
    pub(in super::super) fn solve_from(&self, first: usize, x: &mut [f64]) -> bool {
        let mut is_finite = true;
        for at in (first..self.len).rev() {
            let row = &self.rows[at * self.band..][..self.band.min(self.len - at)];
            let after = dot(&row[1..], &x[at + 1..]);
            x[at] = (self.right[at] - after) / row[0];
            is_finite &= x[at].is_finite();
        }
        is_finite
    }

    /// Standard deviation of what a row says of the unknowns from its first on, where the shared ones are known: the length of
    /// `R^-T a`, by substitution from there to the end.
    pub(in super::super) fn deviation(&self, first: usize, slopes: &[f64], scratch: &mut Vec<f64>) -> f64 {
        scratch.clear();
        scratch.extend_from_slice(slopes);
        scratch.resize((self.len - first).max(slopes.len()) + self.band, 0.0);
        simd::dispatch::<f64, _>(Isa::detect(), Substitute { triangle: self, first, x: scratch }).sqrt()
    }
}

/// Substitution into the transposed triangle, compiled for every instruction set.
struct Substitute<'t> {
    triangle: &'t Triangle,
    first: usize,
    x: &'t mut [f64],
}

impl Kernel<f64> for Substitute<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Simd<Elem = f64>>(self) -> f64 {
        let Self { triangle, first, x } = self;
        let mut square = 0.0;
        for at in first..triangle.len {
            let row = &triangle.rows[at * triangle.band..][..triangle.band];
            let (own, rest) = x[at - first..].split_at_mut(1);
            let own = own[0] / row[0];
            square += own * own;
            if own != 0.0 {
                rest.iter_mut().zip(&row[1..]).for_each(|(x, r)| *x -= own * r);
            }
        }
        square
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Row, Triangle};

    /// Rows over unknowns in order, three in each: what they say of the last ones does not change when the first are forgotten.
    #[test]
    fn to_forget_the_first_unknowns_is_to_marginalise() {
        let number = |at: usize| ((at * 7919 + 13) % 101) as f64 / 101.0 - 0.4;
        let mut whole = Triangle::new(10, 3, 0);
        for at in 0..40 {
            let slopes = [0, 1, 2].map(|k| number(5 * at + k));
            whole.add(Row { first: at / 5, slopes: &slopes, shared: &[], value: number(17 * at) });
        }
        let (x, _) = whole.solve().unwrap();
        let mut part = whole.clone();
        part.shift(4);
        (6..10).for_each(|at| {
            part.add(Row { first: at, slopes: &[1.0], shared: &[], value: 0.0 });
        });
        let mut found = [0.0; 10];
        assert!(part.solve_from(0, &mut found));
        assert!(x[4..].iter().zip(&found).all(|(x, found)| (x - found).abs() < 1e-12), "{x:?} {found:?}");
        assert!(found[6..].iter().all(|&new| new == 0.0));
        let covariance = whole.covariance();
        let slopes = [0.3, -0.7, 1.1];
        for first in 4..8 {
            let exact = covariance.of(first, &slopes, &[]).sqrt();
            for (triangle, first) in [(&whole, first), (&part, first - 4)] {
                let deviation = triangle.deviation(first, &slopes, &mut Vec::new());
                assert!((deviation / exact - 1.0).abs() < 1e-12, "{deviation} {exact}");
            }
        }
    }

    /// Rows with two shared unknowns: what they say where these are known is what they say without them, moved by so much.
    #[test]
    fn unknowns_follow_those_that_are_shared() {
        let number = |at: usize| ((at * 7919 + 13) % 101) as f64 / 101.0 - 0.4;
        let shared = [0.7, -1.3];
        let (mut moving, mut known) = (Triangle::new(8, 3, 2), Triangle::new(8, 3, 0));
        for at in 0..40 {
            let (slopes, by) = ([0, 1, 2].map(|k| number(5 * at + k)), [0, 1].map(|k| number(11 * at + k)));
            let (first, value) = (at / 7, number(17 * at));
            moving.add(Row { first, slopes: &slopes, shared: &by, value });
            known.add(Row {
                first,
                slopes: &slopes,
                shared: &[],
                value: value + by[0] * shared[0] + by[1] * shared[1],
            });
        }
        let [mut before, mut after, mut exact] = [[0.0; 8]; 3];
        assert!(moving.solve_from(0, &mut before) && known.solve_from(0, &mut exact));
        let mut follow = [[0.0; 8]; 2];
        follow.iter_mut().enumerate().for_each(|(at, follow)| moving.follow_from(0, at, follow));
        moving.move_shared(&shared);
        assert!(moving.solve_from(0, &mut after));
        for at in 0..8 {
            let followed = before[at] + follow[0][at] * shared[0] + follow[1][at] * shared[1];
            assert!((after[at] - exact[at]).abs() < 1e-12 && (followed - exact[at]).abs() < 1e-12);
        }
        let slopes = [0.3, -0.7, 1.1];
        let (root, deviation) = (moving.root_beside(2, &slopes), known.deviation(2, &slopes, &mut Vec::new()));
        assert!((root.iter().map(|x| x * x).sum::<f64>().sqrt() / deviation - 1.0).abs() < 1e-12);
    }
}
