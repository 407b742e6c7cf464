//! The damped normal equations `(J^T J + A + lambda D) p = -g`, in the cheaper of two spaces.
//!
//! With about as many rows as parameters, or more, the matrix is `J^T J`. With fewer, let `M = A + lambda D` and `K = J M^(-1/2)`; then
//! `p = -M^(-1/2) (c + K^T (I + K K^T)^-1 (r - K c))` with `c = M^(-1/2) A theta`, and the matrix is `K K^T`.

use super::dense::{self, Cholesky};
use super::fault::Fault;
use super::objective::LeastSquares;
use super::prior::WeightPrior;
use super::vector;

/// The smallest entry of `D`, relative to its largest: a parameter that no row depends on is still damped.
const FLOOR: f64 = 1e-12;

/// Rows, derivatives and matrices of one linearisation.
pub(crate) struct Normal {
    len: usize,
    rows: usize,
    r: Vec<f64>,
    j: Vec<f64>,
    gradient: Vec<f64>,
    /// `D`: the diagonal of `J^T J`, floored.
    scale: Vec<f64>,
    /// `A`
    precision: Vec<f64>,
    space: Space,
}

/// The matrix that is factorised.
enum Space {
    /// Not known before the first linearisation.
    Unknown,
    Parameters {
        matrix: Vec<f64>,
        cholesky: Cholesky,
    },
    Rows(RowSpace),
}

/// `K K^T` and what it takes to come back to the parameters.
struct RowSpace {
    k: Vec<f64>,
    matrix: Vec<f64>,
    cholesky: Cholesky,
    /// `M^(-1/2)`
    root: Vec<f64>,
    c: Vec<f64>,
    u: Vec<f64>,
}

/// True if a step costs no more with the matrix of parameters than with that of rows.
///
/// Costs are operations over rates, in GF/s of processor time, as measured at 1000 and 3000 parameters on a core whose peak
/// is 114: products of columns at 98, products of rows at 80, factorisations at 85. At 3000 parameters and 1200, 2400 and
/// 3000 rows a step took 222, 336 and 399 ms with the first, 63, 275 and 456 ms with the second. To time both in every
/// run would let iterates depend on time, and to gain little: the rates' ratios differ less between machines than rates.
fn prefers_parameters(rows: usize, parameters: usize) -> bool {
    let (n, p) = (rows as f64, parameters as f64);
    let factorise = |size: f64| size.powi(3) / 3.0 / 85.0;
    n * p * p / 98.0 + factorise(p) <= p * n * n / 80.0 + factorise(n)
}

impl Normal {
    pub(crate) fn new(len: usize) -> Self {
        Self {
            len,
            rows: 0,
            r: Vec::new(),
            j: Vec::new(),
            gradient: vec![0.0; len],
            scale: vec![0.0; len],
            precision: vec![0.0; len],
            space: Space::Unknown,
        }
    }

    /// Gradient of rows and prior at the last linearisation.
    pub(crate) fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// `v^T D v`
    pub(crate) fn damped_square(&self, v: &[f64]) -> f64 {
        v.iter().zip(&self.scale).map(|(v, d)| v * v * d).sum()
    }

    /// Evaluates rows and derivatives at `theta`, and all that does not depend on the damping; gives `r^T r / 2`.
    pub(crate) fn linearise<O: LeastSquares + ?Sized>(
        &mut self,
        objective: &mut O,
        theta: &[f64],
        prior: &WeightPrior,
    ) -> Result<f64, Fault> {
        self.resize(objective.rows());
        let loss = objective.jacobian(theta, &mut self.r, &mut self.j)?;
        dense::transpose_times(&self.j, &self.r, &mut self.gradient);
        prior.add_gradient(theta, &mut self.gradient);
        prior.write_diagonal(&mut self.precision);
        if let Space::Parameters { matrix, .. } = &mut self.space {
            dense::gram_of_columns(&self.j, self.rows, self.len, matrix);
            let diagonal = matrix.iter().step_by(self.len + 1);
            self.scale.iter_mut().zip(diagonal).for_each(|(d, x)| *d = *x);
        } else {
            self.scale.fill(0.0);
            for row in self.j.chunks_exact(self.len) {
                self.scale.iter_mut().zip(row).for_each(|(d, x)| *d += x * x);
            }
        }
        let largest = self.scale.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        self.scale.iter_mut().for_each(|d| *d = d.max(FLOOR * largest));
        Ok(loss)
    }

    fn resize(&mut self, rows: usize) {
        if rows == self.rows && !matches!(self.space, Space::Unknown) {
            return;
        }
        let len = self.len;
        self.rows = rows;
        self.r = vec![0.0; rows];
        self.j = vec![0.0; rows * len];
        self.space = if prefers_parameters(rows, len) {
            Space::Parameters { matrix: vec![0.0; len * len], cholesky: Cholesky::new(len) }
        } else {
            Space::Rows(RowSpace {
                k: vec![0.0; rows * len],
                matrix: vec![0.0; rows * rows],
                cholesky: Cholesky::new(rows),
                root: vec![0.0; len],
                c: vec![0.0; len],
                u: vec![0.0; rows],
            })
        };
    }

    /// Solves for `p` with the given damping; false where the matrix is not positive definite in this precision.
    pub(crate) fn solve(&mut self, damping: f64, prior: &WeightPrior, theta: &[f64], p: &mut [f64]) -> bool {
        let len = self.len;
        match &mut self.space {
            Space::Unknown => false,
            Space::Parameters { matrix, cholesky } => {
                let solvable = cholesky.factorise(|factor| {
                    dense::copy_lower(matrix, factor, len);
                    for i in 0..len {
                        factor[i * (len + 1)] += self.precision[i] + damping * self.scale[i];
                    }
                });
                if solvable {
                    p.iter_mut().zip(&self.gradient).for_each(|(p, g)| *p = -g);
                    cholesky.solve(p);
                }
                solvable && vector::all_finite(p)
            }
            Space::Rows(space) => {
                let diagonals = self.precision.iter().zip(&self.scale);
                let roots = diagonals.map(|(a, d)| 1.0 / (a + damping * d).sqrt());
                space.root.iter_mut().zip(roots).for_each(|(root, x)| *root = x);
                space.c.fill(0.0);
                prior.add_gradient(theta, &mut space.c);
                space.solve(&self.j, &self.r, p)
            }
        }
    }
}

impl RowSpace {
    /// Solves with `root` set and `c = A theta`.
    fn solve(&mut self, j: &[f64], r: &[f64], p: &mut [f64]) -> bool {
        let (len, rows) = (p.len(), r.len());
        let Self { k, matrix, cholesky, root, c, u } = self;
        for (k, j) in k.chunks_exact_mut(len).zip(j.chunks_exact(len)) {
            k.iter_mut().zip(j).zip(root.iter()).for_each(|((k, j), root)| *k = j * root);
        }
        dense::gram(k, rows, len, matrix);
        let solvable = cholesky.factorise(|factor| {
            dense::copy_lower(matrix, factor, rows);
            (0..rows).for_each(|i| factor[i * (rows + 1)] += 1.0);
        });
        if !solvable {
            return false;
        }
        c.iter_mut().zip(root.iter()).for_each(|(c, root)| *c *= root);
        dense::times(k, c, u);
        u.iter_mut().zip(r).for_each(|(u, r)| *u = r - *u);
        cholesky.solve(u);
        dense::transpose_times(k, u, p);
        for ((p, root), c) in p.iter_mut().zip(root.iter()).zip(c.iter()) {
            *p = -root * (c + *p);
        }
        vector::all_finite(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sizes whose steps were timed, and far from them.
    #[test]
    fn the_matrix_is_the_one_that_was_faster() {
        for (rows, parameters, expected) in
            [(1200, 3000, false), (2400, 3000, false), (3000, 3000, true), (3, 3000, false), (60_000, 3000, true)]
        {
            assert_eq!(prefers_parameters(rows, parameters), expected, "{rows} rows, {parameters} parameters");
        }
    }
}
