//! A square root of the covariance of all parameters: what is known of an answer without the rows that it was found from.

use faer::Mat;

use super::curvature::Curvature;
use super::vector;

/// `R` with the covariance `R^T R`, upper trapezoidal. A quantity whose derivatives by the parameters are `g` has the standard
/// deviation `|R g|`: as a root it loses half as many digits as the covariance itself would.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Root {
    parameters: usize,
    /// Row after row, each from its diagonal on.
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
        let count = parts.len() / len.max(1);
        curvature.cholesky.solve_lower(&mut parts, count);
        curvature.cholesky.solve_upper(&mut parts, count);
        let triangle = Mat::from_fn(count, len, |row, column| parts[row * len + column]);
        let triangle = triangle.qr();
        let triangle = triangle.thin_R();
        let row = |row: usize| (row..len).map(move |column| triangle[(row, column)]);
        Self { parameters: len, rows: (0..count.min(len)).flat_map(row).collect() }
    }

    /// From the numbers of [`Root::numbers`]; nothing if they are not those of a root over so many parameters.
    pub(crate) fn restored(parameters: usize, rows: Vec<f64>) -> Option<Self> {
        let mut lengths = (1..=parameters).rev().scan(0, |end, width| {
            *end += width;
            Some(*end)
        });
        (rows.is_empty() || lengths.any(|end| end == rows.len())).then_some(Self { parameters, rows })
    }

    /// All of its entries.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.rows
    }

    /// The standard deviation of a quantity with these derivatives by the parameters.
    pub(crate) fn deviation(&self, slopes: &[f64]) -> f64 {
        let (mut rest, mut square) = (self.rows.as_slice(), 0.0);
        for first in 0..self.parameters {
            let Some((row, after)) = rest.split_at_checked(self.parameters - first).filter(|(row, _)| !row.is_empty())
            else {
                break;
            };
            square += vector::dot(row, &slopes[first..]).powi(2);
            rest = after;
        }
        square.sqrt()
    }
}
