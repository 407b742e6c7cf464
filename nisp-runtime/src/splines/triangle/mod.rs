//! A banded triangle, the square root of banded normal equations, made from rows one at a time.
//!
//! Rows are turned into the triangle by rotations (Givens), which keeps as many digits again as normal equations would:
//! equations that hold to a millionth stand beside data that are good to a hundredth. Unknowns come in the order of the
//! coordinate, so that a row sees a few neighbours only; the few unknowns that all rows share form a border. Time and memory
//! are linear in the rows.

pub(super) mod covariance;
mod lag;
mod rotation;
mod solved;

use rotation::{rotation, turn, turned};

use crate::simd::{self, Isa, Kernel, Simd};

/// A row: its first unknown, what the unknowns from there on are multiplied by, what the shared ones are, and its value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a> {
    pub(super) first: usize,
    pub(super) slopes: &'a [f64],
    pub(super) shared: &'a [f64],
    pub(super) value: f64,
}

/// Gives rows one at a time.
pub(super) trait Source {
    /// The next row.
    fn next(&mut self) -> Option<Row<'_>>;
}

/// The triangle `R` of `min |J x + r|`, and `-Q^T r` beside it.
#[derive(Clone, Debug)]
pub(crate) struct Triangle {
    len: usize,
    /// Unknowns that a row may see, from its first on.
    band: usize,
    shared: usize,
    /// `[unknown][band]`, from the diagonal on.
    rows: Vec<f64>,
    /// `[unknown][shared]`
    border: Vec<f64>,
    right: Vec<f64>,
    /// `[shared][shared]`, the triangle of the shared unknowns.
    corner: Vec<f64>,
    corner_right: Vec<f64>,
    /// The row that is being turned in, from its first unknown on.
    scratch: Vec<f64>,
    /// The slopes of the row that is being turned in, by the shared unknowns.
    beside: Vec<f64>,
}

impl Triangle {
    /// A triangle of no rows yet.
    pub(super) fn new(len: usize, band: usize, shared: usize) -> Self {
        Self {
            len,
            band,
            shared,
            rows: vec![0.0; len * band],
            border: vec![0.0; len * shared],
            right: vec![0.0; len],
            corner: vec![0.0; shared * shared],
            corner_right: vec![0.0; shared],
            scratch: Vec::new(),
            beside: Vec::new(),
        }
    }

    /// Unknowns that a row may see, from its first on.
    pub(super) fn band(&self) -> usize {
        self.band
    }

    /// Forgets all rows.
    pub(super) fn clear(&mut self) {
        for part in [&mut self.rows, &mut self.border, &mut self.right, &mut self.corner, &mut self.corner_right] {
            part.fill(0.0);
        }
    }

    /// Turns rows in. Cheap as long as they come in the order of their first unknown.
    pub(super) fn add_all(&mut self, rows: impl Source) {
        simd::dispatch::<f64, _>(Isa::detect(), TurnIn { triangle: self, rows });
    }

    /// Turns a row in; returns what is left of its value, which no unknown can change.
    #[inline(always)]
    pub(super) fn add(&mut self, row: Row<'_>) -> f64 {
        let (mut scratch, mut shared) = (std::mem::take(&mut self.scratch), std::mem::take(&mut self.beside));
        scratch.clear();
        scratch.extend_from_slice(row.slopes);
        shared.clear();
        shared.extend_from_slice(row.shared);
        let left = self.turn_in(row.first, &mut scratch, &mut shared, -row.value);
        (self.scratch, self.beside) = (scratch, shared);
        left
    }

    #[inline(always)]
    fn turn_in(&mut self, first: usize, row: &mut Vec<f64>, shared: &mut [f64], mut right: f64) -> f64 {
        let mut at = 0;
        while at < row.len() {
            let unknown = first + at;
            if row[at] == 0.0 {
                at += 1;
                continue;
            }
            let own = &mut self.rows[unknown * self.band..][..self.band];
            let border = &mut self.border[unknown * self.shared..][..self.shared];
            if own[0] == 0.0 {
                let rest = &row[at..];
                own[..rest.len()].copy_from_slice(rest);
                border.copy_from_slice(shared);
                self.right[unknown] = right;
                return 0.0;
            }
            let end = (at + self.band).min(at + self.len - unknown);
            if row.len() < end {
                row.resize(end, 0.0);
            }
            let (cosine, sine) = rotation(own[0], row[at]);
            turn(cosine, sine, own, &mut row[at..end]);
            turn(cosine, sine, border, shared);
            (self.right[unknown], right) = turned(cosine, sine, self.right[unknown], right);
            at += 1;
        }
        self.add_shared(shared, right)
    }

    /// Turns in a row of the shared unknowns alone.
    fn add_shared(&mut self, row: &mut [f64], mut right: f64) -> f64 {
        for at in 0..self.shared {
            if row[at] == 0.0 {
                continue;
            }
            let own = &mut self.corner[at * self.shared..][..self.shared];
            if own[at] == 0.0 {
                own[at..].copy_from_slice(&row[at..]);
                self.corner_right[at] = right;
                return 0.0;
            }
            let (cosine, sine) = rotation(own[at], row[at]);
            turn(cosine, sine, &mut own[at..], &mut row[at..]);
            (self.corner_right[at], right) = turned(cosine, sine, self.corner_right[at], right);
        }
        right
    }

    /// The triangle as rows, those that hold nothing left out.
    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        let banded = (0..self.len).map(|first| Row {
            first,
            slopes: &self.rows[first * self.band..][..self.band.min(self.len - first)],
            shared: &self.border[first * self.shared..][..self.shared],
            value: -self.right[first],
        });
        let corner = (0..self.shared).map(|at| Row {
            first: 0,
            slopes: &[],
            shared: &self.corner[at * self.shared..][..self.shared],
            value: -self.corner_right[at],
        });
        let banded = banded.filter(|row| row.slopes[0] != 0.0);
        banded.chain(corner.enumerate().filter(|(at, row)| row.shared[*at] != 0.0).map(|(_, row)| row))
    }

    /// Unknowns that every row may have.
    pub(super) fn shared(&self) -> usize {
        self.shared
    }
}

/// Rows that are turned into a triangle, compiled for every instruction set.
struct TurnIn<'t, S> {
    triangle: &'t mut Triangle,
    rows: S,
}

impl<S: Source> Kernel<f64> for TurnIn<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = f64>>(mut self) {
        while let Some(row) = self.rows.next() {
            self.triangle.add(row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Rows over ten unknowns, three of them in each, and two shared ones.
    fn rows() -> Vec<(usize, [f64; 3], [f64; 2], f64)> {
        let number = |at: usize| ((at * 7919 + 13) % 101) as f64 / 101.0 - 0.4;
        let row = |at: usize| {
            let (slopes, shared) = ([0, 1, 2].map(|k| number(5 * at + k)), [0, 1].map(|k| number(11 * at + k)));
            (at / 3 % 8, slopes, shared, number(17 * at))
        };
        let mut rows: Vec<_> = (0..40).map(row).collect();
        rows.sort_by_key(|row| row.0);
        rows
    }

    /// What dense linear algebra makes of the same rows.
    #[test]
    fn a_triangle_is_the_root_of_the_normal_equations() {
        let rows = rows();
        let rows: Vec<Row<'_>> = rows
            .iter()
            .map(|(first, slopes, shared, value)| Row { first: *first, slopes, shared, value: *value })
            .collect();
        let mut triangle = Triangle::new(10, 3, 2);
        rows.iter().for_each(|&row| {
            triangle.add(row);
        });
        let dense = DMatrix::from_fn(rows.len(), 12, |i, j| match j {
            10.. => rows[i].shared[j - 10],
            _ => j.checked_sub(rows[i].first).and_then(|k| rows[i].slopes.get(k)).copied().unwrap_or(0.0),
        });
        let normal = dense.transpose() * &dense;
        let right = -dense.transpose() * DVector::from_iterator(rows.len(), rows.iter().map(|row| row.value));
        let inverse = normal.clone().try_inverse().unwrap();
        let given = normal.clone().remove_row(10).remove_column(10).determinant();
        assert!((2.0 * triangle.log_determinant_beside(1) - given.ln()).abs() < 1e-9);
        let exact = &inverse * right;
        let (x, shared) = triangle.solve().unwrap();
        for (found, exact) in x.iter().chain(&shared).zip(exact.iter()) {
            assert!((found - exact).abs() < 1e-10 * exact.abs().max(1.0), "{found} {exact}");
        }
        assert!((2.0 * triangle.log_determinant() - normal.determinant().ln()).abs() < 1e-9);
        let [one, other] = [(2, &[0.4, -1.0, 0.3][..], &[1.0, 0.5][..]), (3, &[2.0][..], &[0.0, -0.7][..])];
        let wide = |(first, slopes, shared): (usize, &[f64], &[f64])| {
            let mut row = DVector::zeros(12);
            slopes.iter().enumerate().for_each(|(k, x)| row[first + k] = *x);
            shared.iter().enumerate().for_each(|(k, x)| row[10 + k] = *x);
            row
        };
        let root = |(first, slopes, shared)| DVector::from_vec(triangle.root(first, slopes, shared));
        let exact = (wide(one).transpose() * &inverse * wide(other))[0];
        assert!((root(one).dot(&root(other)) - exact).abs() < 1e-10 * exact.abs());
        let covariance = triangle.covariance();
        for row in &rows {
            let dense = DVector::from_fn(12, |j, _| match j {
                10.. => row.shared[j - 10],
                _ => j.checked_sub(row.first).and_then(|k| row.slopes.get(k)).copied().unwrap_or(0.0),
            });
            let exact = dense.dot(&(&inverse * &dense));
            let found = covariance.of(row.first, row.slopes, row.shared);
            assert!((found - exact).abs() < 1e-9 * exact, "{found} {exact}");
        }
        let mut first = covariance.clone();
        first.forget_shared(1);
        for shared in [0.0, -1.3] {
            let (found, exact) = (first.of(4, &[0.2], &[shared]), covariance.of(4, &[0.2], &[shared, 0.0]));
            assert!((found - exact).abs() < 1e-14 * exact, "{found} {exact}");
        }
    }

    #[test]
    fn unknowns_that_no_row_sees_are_open() {
        let mut triangle = Triangle::new(3, 2, 0);
        triangle.add(Row { first: 0, slopes: &[1.0, 1.0], shared: &[], value: 0.0 });
        assert!(triangle.solve().is_none());
    }
}
