//! Least squares given by a residual and its derivatives, row by row.

use nisp_runtime::solve::fault::Fault;
use nisp_runtime::solve::objective::{Block, BlockKind, LeastSquares, Objective};

type Row = Box<dyn Fn(usize, &[f64], &mut [f64]) -> f64>;

/// Rows `residual / sigma`, in blocks.
pub(crate) struct Rows {
    len: usize,
    rows: usize,
    row: Row,
    pub(crate) blocks: Vec<Block>,
    /// Calls of `residuals` and `jacobian` so far.
    pub(crate) calls: usize,
    /// Calls that report a fault.
    pub(crate) faulty: Vec<usize>,
}

impl Rows {
    /// `row(i, theta, derivatives)` gives residual `i`.
    pub(crate) fn new(len: usize, rows: usize, row: impl Fn(usize, &[f64], &mut [f64]) -> f64 + 'static) -> Self {
        let block =
            Block { term: "data".into(), kind: BlockKind::Observation, rows: 0..rows, sigma: 1.0, count: rows as f64 };
        Self { len, rows, row: Box::new(row), blocks: vec![block], calls: 0, faulty: vec![] }
    }

    fn sigma(&self, row: usize) -> f64 {
        self.blocks.iter().find(|block| block.rows.contains(&row)).unwrap().sigma
    }

    fn count(&mut self) -> Result<(), Fault> {
        self.calls += 1;
        if self.faulty.contains(&self.calls) { Err(Fault::residual("balance", Some(17))) } else { Ok(()) }
    }
}

impl Objective<f64> for Rows {
    fn len(&self) -> usize {
        self.len
    }

    fn value(&mut self, theta: &[f64]) -> Result<f64, Fault> {
        let mut r = vec![0.0; self.rows];
        self.residuals(theta, &mut r)
    }

    fn gradient(&mut self, theta: &[f64], gradient: &mut [f64]) -> Result<f64, Fault> {
        let mut r = vec![0.0; self.rows];
        let value = self.residuals(theta, &mut r)?;
        self.vector_jacobian(theta, &r, gradient)?;
        Ok(value)
    }
}

impl LeastSquares for Rows {
    fn rows(&self) -> usize {
        self.rows
    }

    fn residuals(&mut self, theta: &[f64], r: &mut [f64]) -> Result<f64, Fault> {
        let mut j = vec![0.0; self.rows * self.len];
        self.jacobian(theta, r, &mut j)
    }

    fn jacobian(&mut self, theta: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault> {
        self.count()?;
        for (i, row) in j.chunks_exact_mut(self.len).enumerate() {
            let sigma = self.sigma(i);
            r[i] = (self.row)(i, theta, row) / sigma;
            row.iter_mut().for_each(|x| *x /= sigma);
            if !r[i].is_finite() {
                return Err(Fault::residual("data", Some(i)));
            }
        }
        Ok(0.5 * r.iter().map(|r| r * r).sum::<f64>())
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn set_sigma(&mut self, block: usize, sigma: f64) {
        self.blocks[block].sigma = sigma;
    }

    fn jacobian_vector(&mut self, theta: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        let mut row = vec![0.0; self.len];
        for (i, out) in out.iter_mut().enumerate() {
            (self.row)(i, theta, &mut row);
            *out = row.iter().zip(v).map(|(j, v)| j * v).sum::<f64>() / self.sigma(i);
        }
        Ok(())
    }

    fn vector_jacobian(&mut self, theta: &[f64], u: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        let mut row = vec![0.0; self.len];
        out.fill(0.0);
        for (i, u) in u.iter().enumerate() {
            (self.row)(i, theta, &mut row);
            out.iter_mut().zip(&row).for_each(|(out, j)| *out += j * u / self.sigma(i));
        }
        Ok(())
    }
}

/// `theta_0 exp(-theta_1 t) + theta_2` at `rows` times in [0, 4], against exact values for (2, 1.5, 0.3).
pub(crate) fn exponential(rows: usize) -> Rows {
    Rows::new(3, rows, move |i, theta, row| {
        let t = 4.0 * i as f64 / (rows - 1) as f64;
        let e = (-theta[1] * t).exp();
        row.copy_from_slice(&[e, -theta[0] * t * e, 1.0]);
        theta[0] * e + theta[2] - (2.0 * (-1.5 * t).exp() + 0.3)
    })
}

/// `cos(pi k (i + 1/2) / rows)`: for k < rows these are orthogonal, with squared length `rows / 2` (`rows` for k = 0).
pub(crate) fn cosine(k: usize, i: usize, rows: usize) -> f64 {
    (std::f64::consts::PI * k as f64 * (i as f64 + 0.5) / rows as f64).cos()
}
