//! What rows say of their noise after a step: what is left of them, and how many unknowns they settle, in the mean over random
//! combinations of them (Hutchinson 1990).

use rand::RngExt;
use rand::rngs::StdRng;
use rayon::prelude::*;

use crate::local::block::Block;
use crate::local::normal::factor::Factor;
use crate::weighed::Tally;

/// Random combinations at most and at least: the more rows there are, the less each says of how many unknowns they settle.
const MOST_PROBES: usize = 16;
const FEWEST_PROBES: usize = 2;
/// Signs of all combinations together at most, where these are more than the fewest.
const SIGNS: usize = 65_536;

/// Rows, summed up one batch after the other.
pub(super) struct Sampled {
    probes: Vec<Probe>,
    /// Rows that were added.
    added: usize,
    /// Sum of their squares after the step.
    squares: f64,
}

/// A random combination of rows.
struct Probe {
    /// Signs of all rows.
    signs: Vec<bool>,
    /// Its derivatives by the coefficients and by the learned scalars.
    by: Vec<f64>,
    below: Vec<f64>,
}

impl Sampled {
    /// For so many rows, of so many coefficients and learned scalars.
    pub(super) fn new(rows: usize, lens: (usize, usize), random: &mut StdRng) -> Self {
        let mut probe = || {
            let signs = (0..rows).map(|_| random.random()).collect();
            Probe { signs, by: vec![0.0; lens.0], below: vec![0.0; lens.1] }
        };
        let count = (SIGNS / rows.max(1)).clamp(FEWEST_PROBES, MOST_PROBES);
        Self { probes: (0..count).map(|_| probe()).collect(), added: 0, squares: 0.0 }
    }

    /// Adds rows, each given by its block and its number there, as they are after a step of the coefficients and the learned scalars.
    pub(super) fn add(&mut self, rows: &[(&Block, usize)], (step, shared): (&[f64], &[f64])) {
        self.squares =
            rows.iter().fold(self.squares, |sum, (block, row)| sum + block.after(*row, step, shared).powi(2));
        let first = self.added;
        self.probes.par_iter_mut().for_each(|probe| {
            let signed = rows.iter().zip(&probe.signs[first..]);
            signed.for_each(|((block, row), sign)| block.add_signed(*row, *sign, &mut probe.by, &mut probe.below));
        });
        self.added += rows.len();
    }

    /// What the rows say, of which so many count and settle so many unknowns.
    pub(super) fn tally(&self, count: usize, used: f64) -> Tally {
        Tally { squares: self.squares, count: count as f64, used }
    }
}

/// How many unknowns rows settle, sum by sum; nothing where the factor gives no products.
pub(super) fn used(sums: &[Sampled], factor: &Factor) -> Option<Vec<f64>> {
    let probes = || sums.iter().flat_map(|sum| &sum.probes);
    let by: Vec<&[f64]> = probes().map(|probe| probe.by.as_slice()).collect();
    let below: Vec<Vec<f64>> = probes().map(|probe| probe.below.clone()).collect();
    let mut products = factor.products(&by, &below)?.into_iter();
    let mean = |count: usize| products.by_ref().take(count).sum::<f64>() / count as f64;
    Some(sums.iter().map(|sum| sum.probes.len()).map(mean).collect())
}
