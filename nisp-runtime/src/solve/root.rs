//! A square root of the covariance of all parameters: what is known of an answer without the rows that it was found from.

use super::curvature::Curvature;
use super::dense::{self, Cholesky};
use super::vector;

/// `R` with the covariance `R^T R`. A quantity whose derivatives by the parameters are `g` has the standard deviation `|R g|`: as
/// a root it loses half as many digits as the covariance itself would.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Root {
    parameters: usize,
    /// Row after row.
    rows: Vec<f64>,
}

impl Root {
    /// Of the posterior `H^-1 (J^T J + f^2 A) H^-1`, of which `J` are the rows that are random, `A` is the prior's precision
    /// and `f` multiplies the prior's part of deviations.
    pub(crate) fn of(curvature: &Curvature, prior_factor: f64) -> Self {
        let len = curvature.parameters();
        let mut parts: Vec<f64> = Vec::new();
        for rows in &curvature.random {
            parts.extend(&curvature.jacobian[rows.start * len..rows.end * len]);
        }
        for (at, precision) in curvature.precision.iter().enumerate().filter(|(_, precision)| **precision > 0.0) {
            let row = parts.len();
            parts.resize(row + len, 0.0);
            parts[row + at] = prior_factor * precision.sqrt();
        }
        let mut rows = fewer(parts, len);
        let count = rows.len() / len.max(1);
        curvature.cholesky.solve_lower(&mut rows, count);
        curvature.cholesky.solve_upper(&mut rows, count);
        Self { parameters: len, rows }
    }

    /// From the numbers of [`Root::numbers`]; nothing if they are not those of a root over so many parameters.
    pub(crate) fn restored(parameters: usize, rows: Vec<f64>) -> Option<Self> {
        (rows.is_empty() || parameters > 0 && rows.len().is_multiple_of(parameters))
            .then_some(Self { parameters, rows })
    }

    /// All of its entries.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.rows
    }

    /// The standard deviation of a quantity with these derivatives by the parameters.
    pub(crate) fn deviation(&self, slopes: &[f64]) -> f64 {
        let rows = self.rows.chunks_exact(self.parameters.max(1));
        rows.map(|row| vector::dot(row, slopes).powi(2)).sum::<f64>().sqrt()
    }
}

/// As many rows as there are columns, or fewer, with the same products of columns: those of their triangle, where this can be
/// found.
fn fewer(parts: Vec<f64>, len: usize) -> Vec<f64> {
    let mut cholesky = Cholesky::new(len);
    let count = parts.len() / len.max(1);
    if count <= len || !cholesky.factorise(|normal| dense::gram_of_columns(&parts, count, len, normal)) {
        return parts;
    }
    cholesky.upper()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_rows_have_the_same_products_of_columns() {
        let len = 7;
        for count in [3, 7, 40] {
            let parts: Vec<f64> = (0..count * len).map(|at| (at as f64 * 0.7 + (at % 5) as f64).sin()).collect();
            let found = fewer(parts.clone(), len);
            assert_eq!(found.len(), count.min(len) * len);
            for (i, j) in (0..len).flat_map(|i| (0..len).map(move |j| (i, j))) {
                let product = |of: &[f64]| of.chunks_exact(len).map(|row| row[i] * row[j]).sum::<f64>();
                assert!((product(&parts) - product(&found)).abs() < 1e-12 * count as f64, "{count}: {i} {j}");
            }
        }
    }
}
