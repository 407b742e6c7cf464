//! Covariances of a triangle's unknowns, as far as rows see them.

use nalgebra::{DMatrix, DVector};

use super::Triangle;
use super::rotation::dot;

/// Covariances of the unknowns: those of neighbours within the band, and those with the shared ones.
#[derive(Clone, Debug)]
pub(in super::super) struct Covariance {
    band: usize,
    shared: usize,
    /// `[unknown][band]`, from the variance on.
    rows: Vec<f64>,
    /// `[unknown][shared]`
    border: Vec<f64>,
    /// `[shared][shared]`
    pub(in super::super) corner: Vec<f64>,
}

impl Triangle {
    /// Entries of `(R^T R)^-1` within the band and the border, from the last row to the first (Takahashi, Fagan and Chen
    /// 1973).
    #[inline(never)]
    pub(in super::super) fn covariance(&self) -> Covariance {
        let (band, shared) = (self.band, self.shared);
        let mut found = Covariance {
            band,
            shared,
            rows: vec![0.0; self.len * band],
            border: vec![0.0; self.len * shared],
            corner: self.covariance_of_shared(),
        };
        let mut column = vec![0.0; band];
        let mut beside = vec![0.0; shared];
        for at in (0..self.len).rev() {
            let row = &self.rows[at * band..][..band];
            let border = &self.border[at * shared..][..shared];
            let width = band.min(self.len - at);
            for (j, out) in beside.iter_mut().enumerate() {
                let inner = (1..width).map(|k| row[k] * found.border[(at + k) * shared + j]).sum::<f64>();
                let outer = border.iter().enumerate().map(|(k, r)| r * found.corner[k * shared + j]).sum::<f64>();
                *out = -(inner + outer) / row[0];
            }
            column.fill(0.0);
            for k in 1..width {
                let own = &found.rows[(at + k) * band..][..width - k];
                column[k] += dot(own, &row[k..width]);
                column[k + 1..width].iter_mut().zip(&own[1..]).for_each(|(out, c)| *out += row[k] * c);
            }
            for (j, out) in column.iter_mut().enumerate().take(width).skip(1) {
                let inner = *out;
                let others = &found.border[(at + j) * shared..][..shared];
                let outer = border.iter().zip(others).map(|(r, c)| r * c).sum::<f64>();
                *out = -(inner + outer) / row[0];
            }
            let inner = (1..width).map(|k| row[k] * column[k]).sum::<f64>();
            let outer = border.iter().zip(&beside).map(|(r, c)| r * c).sum::<f64>();
            column[0] = (1.0 / row[0] - inner - outer) / row[0];
            found.rows[at * band..][..width].copy_from_slice(&column[..width]);
            found.border[at * shared..][..shared].copy_from_slice(&beside);
        }
        found
    }

    fn covariance_of_shared(&self) -> Vec<f64> {
        let n = self.shared;
        let mut found = vec![0.0; n * n];
        for at in (0..n).rev() {
            let row = &self.corner[at * n..][..n];
            for j in (at + 1..n).rev() {
                let sum = (at + 1..n).map(|k| row[k] * found[k * n + j]).sum::<f64>();
                (found[at * n + j], found[j * n + at]) = (-sum / row[at], -sum / row[at]);
            }
            let sum = (at + 1..n).map(|k| row[k] * found[k * n + at]).sum::<f64>();
            found[at * n + at] = (1.0 / row[at] - sum) / row[at];
        }
        found
    }
}

impl Covariance {
    /// The covariances within a band that is no wider.
    pub(in super::super) fn within(&self, band: usize) -> Self {
        let rows = self.rows.chunks_exact(self.band).flat_map(|row| &row[..band.min(self.band)]);
        Self { band: band.min(self.band), rows: rows.copied().collect(), ..self.clone() }
    }

    /// Over the unknowns of so many coefficients, from the numbers of [`Covariance::parts`]; nothing if there are not as many
    /// as there should be.
    pub(in super::super) fn restored(
        len: usize,
        band: usize,
        shared: usize,
        [rows, border, corner]: [Vec<f64>; 3],
    ) -> Option<Self> {
        let is_whole = (rows.len(), border.len(), corner.len()) == (len * band, len * shared, shared * shared);
        is_whole.then_some(Self { band, shared, rows, border, corner })
    }

    /// Covariances of neighbours, with the shared unknowns, and among these.
    pub(in super::super) fn parts(&self) -> [&[f64]; 3] {
        [&self.rows, &self.border, &self.corner]
    }

    /// Multiplies all variances and covariances.
    pub(in super::super) fn multiply(&mut self, by: f64) {
        [&mut self.rows, &mut self.border, &mut self.corner].into_iter().flatten().for_each(|entry| *entry *= by);
    }

    /// Forgets all shared unknowns but the first.
    pub(in super::super) fn forget_shared(&mut self, but: usize) {
        let all = self.shared.max(1);
        let first = |numbers: &[f64]| numbers.chunks_exact(all).flat_map(|row| &row[..but]).copied().collect();
        (self.border, self.corner) = (first(&self.border), first(&self.corner[..but * self.shared]));
        self.shared = but;
    }

    /// Variances of the shared unknowns.
    pub(in super::super) fn shared_variances(&self) -> Vec<f64> {
        self.corner.iter().step_by(self.shared + 1).copied().collect()
    }

    /// Multiplies the deviations of the shared unknowns. The variance that other unknowns have because of these grows alike; what they would
    /// have if the shared ones were known stays.
    pub(in super::super) fn stretch_shared(&mut self, by: &[f64]) {
        let n = self.shared;
        let corner = DMatrix::from_row_slice(n, n, &self.corner);
        let Some(inverse) = corner.clone().try_inverse() else { return };
        let by = DMatrix::from_diagonal(&DVector::from_column_slice(by));
        let stretched = &by * &corner * &by;
        let ways = DMatrix::from_row_slice(self.border.len() / n.max(1), n, &self.border) * inverse;
        let more = &ways * (&stretched - &corner);
        for (first, row) in self.rows.chunks_exact_mut(self.band).enumerate() {
            for (after, entry) in row.iter_mut().enumerate().take(ways.nrows() - first) {
                *entry += more.row(first).dot(&ways.row(first + after));
            }
        }
        self.border = (ways * &stretched).transpose().as_slice().to_vec();
        self.corner = stretched.as_slice().to_vec();
    }

    /// Adds to the variances of the unknowns.
    pub(in super::super) fn widen(&mut self, variances: &[f64]) {
        self.rows.chunks_exact_mut(self.band).zip(variances).for_each(|(row, variance)| row[0] += variance);
    }

    /// Variance of what a row says of the unknowns.
    pub(in super::super) fn of(&self, first: usize, slopes: &[f64], shared: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (i, a) in slopes.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            let own = &self.rows[(first + i) * self.band..][..self.band];
            let after = dot(&own[1..], &slopes[i + 1..]);
            let border = &self.border[(first + i) * self.shared..][..self.shared];
            let beside: f64 = border.iter().zip(shared).map(|(c, b)| c * b).sum();
            sum += a * (a * own[0] + 2.0 * (after + beside));
        }
        let corner = self.corner.chunks_exact(self.shared.max(1)).zip(shared);
        sum + corner.map(|(row, a)| a * row.iter().zip(shared).map(|(c, b)| c * b).sum::<f64>()).sum::<f64>()
    }
}
