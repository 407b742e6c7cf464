//! What follows from a triangle once all rows are turned in.

use nalgebra::DMatrix;

use super::Triangle;

impl Triangle {
    /// The unknowns that make the rows least, and the shared ones; nothing if the rows leave some open.
    pub(in crate::splines) fn solve(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let shared = self.solve_shared()?;
        let mut x = vec![0.0; self.len];
        for at in (0..self.len).rev() {
            let row = &self.rows[at * self.band..][..self.band];
            let border = &self.border[at * self.shared..][..self.shared];
            let after: f64 = row[1..].iter().zip(&x[at + 1..]).map(|(r, x)| r * x).sum();
            let beside: f64 = border.iter().zip(&shared).map(|(r, x)| r * x).sum();
            x[at] = (self.right[at] - after - beside) / row[0];
        }
        x.iter().all(|x| x.is_finite()).then_some((x, shared))
    }

    fn solve_shared(&self) -> Option<Vec<f64>> {
        let mut x = vec![0.0; self.shared];
        for at in (0..self.shared).rev() {
            let row = &self.corner[at * self.shared..][..self.shared];
            let after: f64 = row[at + 1..].iter().zip(&x[at + 1..]).map(|(r, x)| r * x).sum();
            x[at] = (self.corner_right[at] - after) / row[at];
        }
        x.iter().all(|x| x.is_finite()).then_some(x)
    }

    /// For each of the last shared unknowns, half the slope of the rows' sum of squares along it, and half its curvature, where all unknowns
    /// but these follow.
    pub(in crate::splines) fn beside(&self, last: usize) -> Vec<[f64; 2]> {
        let range = self.shared - last..self.shared;
        let of = |at: usize| {
            let column = range.clone().map(|row| self.corner[row * self.shared + at]);
            let slope: f64 = column.clone().zip(&self.corner_right[range.clone()]).map(|(r, right)| -r * right).sum();
            [slope, column.map(|r| r * r).sum()]
        };
        range.clone().map(of).collect()
    }

    /// `R^-T v` of a row `v` of the unknowns: products of two such are covariances of what the rows say.
    pub(in crate::splines) fn root(&self, first: usize, slopes: &[f64], shared: &[f64]) -> Vec<f64> {
        let mut found = vec![0.0; self.len + self.shared];
        found[first..first + slopes.len()].copy_from_slice(slopes);
        found[self.len..].copy_from_slice(shared);
        let (banded, beside) = found.split_at_mut(self.len);
        for at in first..self.len {
            let row = &self.rows[at * self.band..][..self.band];
            let own = banded[at] / row[0];
            banded[at] = own;
            banded[at + 1..].iter_mut().zip(&row[1..]).for_each(|(x, r)| *x -= r * own);
            beside.iter_mut().zip(&self.border[at * self.shared..]).for_each(|(x, r)| *x -= r * own);
        }
        for at in 0..self.shared {
            let row = &self.corner[at * self.shared..][..self.shared];
            let own = beside[at] / row[at];
            beside[at] = own;
            beside[at + 1..].iter_mut().zip(&row[at + 1..]).for_each(|(x, r)| *x -= r * own);
        }
        found
    }

    /// Draws the first shared unknowns along slopes: what is made least is half the sum of squares less the slopes times the unknowns.
    pub(in crate::splines) fn draw(&mut self, slopes: &[f64]) {
        let mut drawn = vec![0.0; self.shared];
        for at in 0..self.shared {
            let before: f64 = (0..at).map(|row| self.corner[row * self.shared + at] * drawn[row]).sum();
            drawn[at] = (slopes.get(at).unwrap_or(&0.0) - before) / self.corner[at * (self.shared + 1)];
        }
        self.corner_right.iter_mut().zip(&drawn).for_each(|(right, drawn)| *right += drawn);
    }

    /// Sum of the logarithms of the diagonal: half that of the normal matrix's determinant.
    pub(in crate::splines) fn log_determinant(&self) -> f64 {
        self.log_determinant_of_band()
            + (0..self.shared).map(|at| self.corner[at * (self.shared + 1)].abs().ln()).sum::<f64>()
    }

    /// The same where so many of the first shared unknowns are given.
    pub(in crate::splines) fn log_determinant_beside(&self, given: usize) -> f64 {
        let (shared, open) = (self.shared, self.shared - given);
        let rest = DMatrix::from_fn(shared, open, |i, j| self.corner[i * shared + given + j]).qr().unpack_r();
        self.log_determinant_of_band() + (0..open).map(|at| rest[(at, at)].abs().ln()).sum::<f64>()
    }

    fn log_determinant_of_band(&self) -> f64 {
        self.rows.iter().step_by(self.band).map(|x| x.abs().ln()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::splines::triangle::Row;
    use nalgebra::DVector;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Slope and curvature of what is left of the rows when the other unknowns have taken theirs: a projection, by dense linear algebra.
    #[test]
    fn what_rows_say_of_the_last_unknowns_is_beside_what_the_others_take() {
        let (len, band, shared, rows) = (6, 2, 4, 30);
        let mut random = StdRng::seed_from_u64(2);
        let mut triangle = Triangle::new(len, band, shared);
        let mut dense = DMatrix::zeros(rows, len + shared);
        let mut values = DVector::zeros(rows);
        for row in 0..rows {
            let first = row * (len - band + 1) / rows;
            let mut numbers = |count: usize| (0..count).map(|_| random.random::<f64>() - 0.5).collect::<Vec<f64>>();
            let (slopes, beside, value) = (numbers(band), numbers(shared), numbers(1)[0]);
            triangle.add(Row { first, slopes: &slopes, shared: &beside, value });
            slopes.iter().enumerate().for_each(|(k, x)| dense[(row, first + k)] = *x);
            beside.iter().enumerate().for_each(|(k, x)| dense[(row, len + k)] = *x);
            values[row] = value;
        }
        for last in 1..=shared {
            let others = dense.columns(0, len + shared - last).clone_owned();
            let inverse = (others.transpose() * &others).try_inverse().unwrap();
            let left = |of: &DVector<f64>| of - &others * (&inverse * (others.transpose() * of));
            let found = triangle.beside(last);
            assert_eq!(found.len(), last);
            for (at, [slope, curvature]) in found.into_iter().enumerate() {
                let column = dense.column(len + shared - last + at).clone_owned();
                assert!((slope - column.dot(&left(&values))).abs() < 1e-12, "{last} {at}: {slope}");
                assert!((curvature - column.dot(&left(&column))).abs() < 1e-12, "{last} {at}: {curvature}");
            }
        }
    }
}
