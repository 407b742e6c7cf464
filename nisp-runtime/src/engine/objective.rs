//! The engine as solvers see it.

use super::{Engine, LearnedMap};
use crate::kernel::Precision;
use crate::loss::deviation_of_clean;
use crate::schema::TermKind;
use crate::solve::evidence::is_free;
use crate::solve::fault::Fault;
use crate::solve::objective::{Block, BlockKind, LeastSquares, Objective};

/// Misfits beside the declared noise, up to which a network is taken to follow the data.
const FOLLOWED: f64 = 3.0;

impl<E: Precision> Objective<E> for Engine<E> {
    fn len(&self) -> usize {
        self.layout.len
    }

    fn value(&mut self, theta: &[E]) -> Result<f64, Fault> {
        self.loss(theta)
    }

    fn gradient(&mut self, theta: &[E], gradient: &mut [E]) -> Result<f64, Fault> {
        self.loss_and_gradient(theta, gradient)
    }

    fn accepted(&mut self, theta: &[E]) -> bool {
        let resampled = self.resample(theta);
        self.refresh(theta) || resampled
    }

    fn refresh(&mut self, theta: &[E]) -> bool {
        if self.chamfers().next().is_none() {
            return false;
        }
        self.set(theta);
        !self.is_assigned && self.assign()
    }
}

impl LeastSquares for Engine<f64> {
    fn rows(&self) -> usize {
        self.row_count()
    }

    fn residuals(&mut self, theta: &[f64], r: &mut [f64]) -> Result<f64, Fault> {
        self.weighted_rows(theta, r)
    }

    fn jacobian(&mut self, theta: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault> {
        self.jacobian_rows(theta, r, j)
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn set_sigma(&mut self, block: usize, sigma: f64) {
        self.blocks[block].sigma = sigma;
        let mut terms = self.groups.iter_mut().flat_map(|group| &mut group.terms);
        if let Some(term) = terms.nth(block) {
            term.size = sigma;
            term.factor = 1.0;
        }
        // Robust losses judge distances by it.
        self.is_assigned = false;
    }

    fn clean_sigma(&mut self, theta: &[f64], block: usize, effective: f64) -> Option<f64> {
        let mut terms =
            (0..self.groups.len()).flat_map(|at| (0..self.groups[at].terms.len()).map(move |term| (at, term)));
        let (group, at) = terms.nth(block)?;
        let is_robust = self.groups[group].terms[at].loss.is_robust() && is_free(&self.blocks[block]);
        let misfits = is_robust.then(|| self.misfits(group, at, theta))?;
        let found = deviation_of_clean(misfits, effective);
        let within = self.groups[group].terms[at].within;
        // What is known of the noise counts as soon as the network follows the data.
        Some(within.filter(|within| found < FOLLOWED * within).unwrap_or(found))
    }

    fn jacobian_vector(&mut self, theta: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        // A central difference: two forward passes, and as accurate as conjugate gradients can make use of.
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            out.fill(0.0);
            return Ok(());
        }
        let size = theta.iter().map(|x| x * x).sum::<f64>().sqrt().max(1.0);
        let step = 6e-6 * size / length;
        let moved = |step: f64| theta.iter().zip(v).map(|(t, v)| t + step * v).collect::<Vec<f64>>();
        let mut below = vec![0.0; out.len()];
        self.weighted_rows(&moved(step), out)?;
        self.weighted_rows(&moved(-step), &mut below)?;
        out.iter_mut().zip(&below).for_each(|(above, below)| *above = (*above - below) / (2.0 * step));
        Ok(())
    }

    fn vector_jacobian(&mut self, theta: &[f64], u: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        self.transposed_product(theta, u, out)
    }
}

impl<E: Precision> Engine<E> {
    /// The rows by term, for solvers and reports.
    pub(super) fn make_blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut next = 0;
        for group in &self.groups {
            for term in &group.terms {
                let rows = next..next + term.row_count(group.points);
                next = rows.end;
                blocks.push(Block {
                    term: format!("{}.{}", group.schema.name, term.schema.name),
                    kind: match term.schema.kind {
                        TermKind::Observation | TermKind::Chamfer { .. }
                            if term.within.is_some() && !term.loss.is_robust() =>
                        {
                            BlockKind::Observation
                        }
                        TermKind::Observation | TermKind::Chamfer { .. } => BlockKind::ObservationOfUnknownNoise,
                        TermKind::Residual | TermKind::Integral => BlockKind::Equation,
                    },
                    count: term.data_count(group.points) as f64,
                    rows,
                    sigma: term.size,
                });
            }
        }
        blocks
    }

    /// Values of the learned scalars at `theta`, in the engine's units, and their derivatives by their parameters.
    pub(crate) fn learned_values(&self, theta: &[E]) -> Vec<(f64, f64)> {
        let theta = &theta[self.layout.learned.clone()];
        self.learned.iter().zip(theta).map(|(learned, theta)| LearnedMap::at(learned.map, theta.to_f64())).collect()
    }
}
