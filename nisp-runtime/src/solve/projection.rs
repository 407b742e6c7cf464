//! Variable projection (Golub and Pereyra 1973): where rows are affine in some parameters, these are solved for exactly
//! and only the others are searched.
//!
//! With `c` the parameters that enter linearly and `phi` the others, `c(phi)` minimises the loss for given `phi`, and the
//! rows `r(phi, c(phi))` are least squares in `phi` alone. Their derivatives are those of Kaufman (1975): `J_phi` less its
//! part in the space of `J_c`, which leaves the gradient exact. A weak prior on `c` keeps it determined; it counts as rows
//! of its own.

use super::dense::{self, Cholesky};
use super::fault::{Fault, Kind};
use super::objective::{Block, BlockKind, LeastSquares, Objective};

/// Least squares in the parameters that do not enter linearly.
pub struct Projection<'a, O: ?Sized> {
    objective: &'a mut O,
    /// Numbers of the parameters that enter linearly, rising, and of the others.
    linear: Vec<usize>,
    others: Vec<usize>,
    /// Square root of the precision of the prior on the linear ones.
    root: f64,
    blocks: Vec<Block>,
    /// All parameters, where last evaluated: the linear ones solved for.
    theta: Vec<f64>,
    /// The others, there; not finite before the first time.
    at: Vec<f64>,
    rows: Vec<f64>,
    jacobian: Vec<f64>,
    /// `J_c` over the rows of its prior.
    columns: Vec<f64>,
    cholesky: Cholesky,
}

impl<'a, O: LeastSquares + ?Sized> Projection<'a, O> {
    /// Searches all parameters of `objective` but those of number `linear`, whose prior has this `precision` (above zero).
    pub fn new(objective: &'a mut O, linear: &[usize], precision: f64) -> Self {
        let len = objective.len();
        let (linear, others): (Vec<_>, Vec<_>) = (0..len).partition(|at| linear.contains(at));
        let mut blocks = objective.blocks().to_vec();
        let first = objective.rows();
        blocks.push(Block {
            term: "linear parameters".into(),
            kind: BlockKind::Prior,
            rows: first..first + linear.len(),
            sigma: 1.0,
            count: linear.len() as f64,
        });
        Self {
            root: precision.sqrt(),
            blocks,
            theta: vec![0.0; len],
            at: vec![f64::NAN; others.len()],
            rows: Vec::new(),
            jacobian: Vec::new(),
            columns: Vec::new(),
            cholesky: Cholesky::new(linear.len()),
            objective,
            linear,
            others,
        }
    }

    /// The parameters that are searched, out of all.
    pub fn searched(&self, theta: &[f64]) -> Vec<f64> {
        self.others.iter().map(|&at| theta[at]).collect()
    }

    /// All parameters, from those that are searched.
    ///
    /// # Errors
    /// A fault of the objective, or linear parameters that nothing determines.
    pub fn all(&mut self, phi: &[f64]) -> Result<Vec<f64>, Fault> {
        self.project(phi)?;
        Ok(self.theta.clone())
    }

    /// Solves for the linear parameters at `phi`, from zero: the same bits whatever came before.
    fn project(&mut self, phi: &[f64]) -> Result<(), Fault> {
        if self.at == phi {
            return Ok(());
        }
        let (len, linear, count) = (self.theta.len(), self.linear.len(), self.objective.rows());
        self.at.fill(f64::NAN);
        self.rows.resize(count + linear, 0.0);
        self.jacobian.resize((count + linear) * len, 0.0);
        self.theta.fill(0.0);
        self.others.iter().zip(phi).for_each(|(&at, x)| self.theta[at] = *x);
        self.objective.jacobian(&self.theta, &mut self.rows[..count], &mut self.jacobian[..count * len])?;
        self.columns.clear();
        for row in self.jacobian[..count * len].chunks_exact(len) {
            self.columns.extend(self.linear.iter().map(|&at| row[at]));
        }
        self.columns.resize((count + linear) * linear, 0.0);
        (0..linear).for_each(|k| self.columns[(count + k) * linear + k] = self.root);
        let columns = &self.columns;
        let solvable =
            self.cholesky.factorise(|normal| dense::gram_of_columns(columns, count + linear, linear, normal));
        if !solvable {
            return Err(Fault { term: "linear parameters".into(), point: None, what: Kind::Factorisation });
        }
        let mut solved = vec![0.0; linear];
        dense::transpose_times(&columns[..count * linear], &self.rows[..count], &mut solved);
        self.cholesky.solve(&mut solved);
        solved.iter_mut().for_each(|c| *c = -*c);
        // Rows are affine: no need to evaluate them again.
        for (row, columns) in self.rows[..count].iter_mut().zip(columns.chunks_exact(linear)) {
            *row += super::vector::dot(columns, &solved);
        }
        for (k, (&at, c)) in self.linear.iter().zip(&solved).enumerate() {
            self.theta[at] = *c;
            self.rows[count + k] = self.root * c;
        }
        if let Some(at) = self.rows.iter().position(|row| !row.is_finite()) {
            let term = self.blocks.iter().find(|block| block.rows.contains(&at));
            return Err(Fault::residual(term.map_or("rows", |block| block.term.as_str()), None));
        }
        self.at.copy_from_slice(phi);
        Ok(())
    }
}

impl<O: LeastSquares + ?Sized> Objective<f64> for Projection<'_, O> {
    fn len(&self) -> usize {
        self.others.len()
    }

    fn value(&mut self, phi: &[f64]) -> Result<f64, Fault> {
        self.project(phi)?;
        Ok(0.5 * super::vector::dot(&self.rows, &self.rows))
    }

    fn gradient(&mut self, phi: &[f64], gradient: &mut [f64]) -> Result<f64, Fault> {
        let value = self.value(phi)?;
        let mut all = vec![0.0; self.theta.len()];
        // The linear parameters are where the loss is least, so that what they would move by does not count.
        let count = self.objective.rows();
        self.objective.vector_jacobian(&self.theta, &self.rows[..count], &mut all)?;
        gradient.iter_mut().zip(&self.others).for_each(|(g, &at)| *g = all[at]);
        Ok(value)
    }

    fn accepted(&mut self, phi: &[f64]) -> bool {
        let changed = self.project(phi).is_ok() && self.objective.accepted(&self.theta);
        if changed {
            self.at.fill(f64::NAN);
        }
        changed
    }

    fn refresh(&mut self, phi: &[f64]) -> bool {
        let changed = self.project(phi).is_ok() && self.objective.refresh(&self.theta);
        if changed {
            self.at.fill(f64::NAN);
        }
        changed
    }
}

impl<O: LeastSquares + ?Sized> LeastSquares for Projection<'_, O> {
    fn rows(&self) -> usize {
        self.objective.rows() + self.linear.len()
    }

    fn residuals(&mut self, phi: &[f64], r: &mut [f64]) -> Result<f64, Fault> {
        let value = self.value(phi)?;
        r.copy_from_slice(&self.rows);
        Ok(value)
    }

    fn jacobian(&mut self, phi: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault> {
        let value = self.residuals(phi, r)?;
        let (len, linear, searched) = (self.theta.len(), self.linear.len(), self.others.len());
        let count = self.objective.rows();
        self.objective.jacobian(&self.theta, &mut self.rows[..count], &mut self.jacobian[..count * len])?;
        // What was computed with the linear parameters at zero is the more exact of the two.
        self.rows.copy_from_slice(r);
        j.fill(0.0);
        for (out, row) in j.chunks_exact_mut(searched).zip(self.jacobian[..count * len].chunks_exact(len)) {
            out.iter_mut().zip(&self.others).for_each(|(out, &at)| *out = row[at]);
        }
        // With J_c^T J_c + prior = L L^T, the rows of Q are L^-1 times those of J_c and of its prior; less Q Q^T J_phi.
        let mut q = self.columns.clone();
        self.cholesky.solve_lower(&mut q, count + linear);
        dense::subtract_projection(&q, linear, j, searched);
        Ok(value)
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn set_sigma(&mut self, block: usize, sigma: f64) {
        self.at.fill(f64::NAN);
        self.blocks[block].sigma = sigma;
        if block < self.objective.blocks().len() {
            self.objective.set_sigma(block, sigma);
        }
    }

    fn jacobian_vector(&mut self, phi: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        let (mut r, mut j) = (vec![0.0; out.len()], vec![0.0; out.len() * v.len()]);
        self.jacobian(phi, &mut r, &mut j)?;
        dense::times(&j, v, out);
        Ok(())
    }

    fn vector_jacobian(&mut self, phi: &[f64], u: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        let (mut r, mut j) = (vec![0.0; u.len()], vec![0.0; u.len() * out.len()]);
        self.jacobian(phi, &mut r, &mut j)?;
        dense::transpose_times(&j, u, out);
        Ok(())
    }
}

/// Derivatives that differ by less than this, beside the largest, are equal.
const EQUAL: f64 = 1e-9;

/// Those of the candidates (sets of parameters) in which rows are affine together, found by trying: their derivatives do
/// not change when they do. Earlier candidates are preferred to later ones.
///
/// # Errors
/// A fault of the objective.
pub fn linear_parameters<O: LeastSquares + ?Sized>(
    objective: &mut O,
    theta: &[f64],
    candidates: &[Vec<usize>],
) -> Result<Vec<usize>, Fault> {
    let (len, count) = (theta.len(), objective.rows());
    let mut derivatives = |theta: &[f64]| {
        let (mut rows, mut jacobian) = (vec![0.0; count], vec![0.0; count * len]);
        objective.jacobian(theta, &mut rows, &mut jacobian).map(|_| jacobian)
    };
    let here = derivatives(theta)?;
    let mut chosen: Vec<usize> = Vec::new();
    for candidate in candidates {
        let together = [&chosen[..], candidate].concat();
        let mut moved = theta.to_vec();
        for &at in &together {
            // Anything that follows no pattern.
            moved[at] += 0.5 * (1.0 + 7.0 * at as f64).sin();
        }
        let there = derivatives(&moved)?;
        let pairs = || here.chunks_exact(len).zip(there.chunks_exact(len));
        let of = |row: &[f64], at: usize| row[at];
        let largest = pairs().flat_map(|(a, _)| together.iter().map(move |&at| of(a, at).abs())).fold(0.0, f64::max);
        let same = |(a, b): (&[f64], &[f64])| together.iter().all(|&at| (a[at] - b[at]).abs() <= EQUAL * largest);
        if pairs().all(same) {
            chosen = together;
        }
    }
    chosen.sort_unstable();
    Ok(chosen)
}
