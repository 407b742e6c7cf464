//! Rao's score test (1948): how much likelier an answer would be if a number that its problem takes for known were unknown, too.
//!
//! Let `r` be all rows, `J` their derivatives by the unknowns, `b` those by the number, and `H` the normal matrix with its priors. If the
//! number were unknown too, a Gauss-Newton step would change it by `-g / h` and lower the loss by `g^2 / 2h`, with `g = b.r - (J^T b) . H^-1
//! (J^T r)` and `h = b.b - (J^T b) . H^-1 (J^T b)`. One more right-hand side of the factorised matrix tells. Steps are no longer than the
//! model may be trusted.

use super::block::Block;
use super::normal::factor::Factor;
use crate::facts::{Known, Score};
use crate::solve::vector;

/// Share of what rows say of a number that must be left when the unknowns have taken theirs: below it is rounding.
const OPEN: f64 = 1e-9;

/// What rows say of a number.
pub(super) struct Scored {
    pub(super) known: Known,
    /// `J^T b`, by the coefficients, then by the unknowns of the border.
    right: Vec<f64>,
    pub(super) below: Vec<f64>,
    /// `b.r` and `b.b`.
    slope: f64,
    square: f64,
}

impl Scored {
    /// A sum over no rows yet, for so many coefficients and unknowns of the border.
    pub(super) fn new(known: Known, coefficients: usize, border: usize) -> Self {
        Self { known, right: vec![0.0; coefficients], below: vec![0.0; border], slope: 0.0, square: 0.0 }
    }

    /// Adds the rows of a block, with their derivatives by the number.
    pub(super) fn add(&mut self, block: &Block, by: &[f64]) {
        for (by, misfit) in by.iter().zip(&block.misfits) {
            self.slope += by * misfit;
            self.square += by * by;
        }
        add(block, by, &mut self.right, &mut self.below);
    }

    /// The score with the solution for its right-hand side, as [`scores`] has it.
    fn score(
        &self,
        (step, shared): (&[f64], &[f64]),
        (gradient, below): (&[f64], &[f64]),
        by_prior: bool,
    ) -> Option<Score> {
        let slope = self.slope - vector::dot(gradient, step) - vector::dot(below, shared);
        let square = self.square - vector::dot(&self.right, step) - vector::dot(&self.below, shared);
        // Nothing is said of a number that integrals alone read: the squares of their rows are in the border.
        if self.square > 0.0 && square > OPEN * self.square {
            Score::by((self.known, by_prior), slope, square)
        } else {
            None
        }
    }
}

/// What an answer tells of a number.
#[derive(Clone, Default)]
pub(super) struct Asked {
    /// Its score; nothing of what rows do not tell from the unknowns.
    pub(super) score: Option<Score>,
    /// How the coefficients and the unknowns of the border follow a change of the number, in shares of its size.
    pub(super) follow: [Vec<f64>; 2],
}

/// What is told beside what rows say of the unknowns, `J^T r`, to which a prior may belong; nothing where the matrix leaves unknowns open.
pub(super) fn asked(
    scored: &[Scored],
    factor: &Factor,
    (gradient, below): (&[f64], &[f64]),
    by_prior: bool,
) -> Vec<Asked> {
    let right: Vec<&[f64]> = scored.iter().map(|own| own.right.as_slice()).collect();
    let on_border: Vec<&[f64]> = scored.iter().map(|own| own.below.as_slice()).collect();
    let Some(solutions) = factor.solve_all(&right, &on_border) else { return vec![Asked::default(); scored.len()] };
    let told = |(own, (step, shared)): (&Scored, (Vec<f64>, Vec<f64>))| {
        let score = own.score((&step, &shared), (gradient, below), by_prior);
        // Rows with the number moved are met by a step that takes that back.
        Asked { score, follow: [step, shared].map(|own| own.into_iter().map(|x| -x).collect()) }
    };
    scored.iter().zip(solutions).map(told).collect()
}

/// Adds to sums over the coefficients and over the learned scalars the slopes of a block's rows, each times a number.
pub(super) fn add(block: &Block, times: &[f64], right: &mut [f64], below: &mut [f64]) {
    let width = block.dofs.len();
    let learned = block.by_learned.len() / block.misfits.len().max(1);
    for (row, times) in times.iter().enumerate().filter(|(_, times)| **times != 0.0) {
        block.kept().for_each(|(at, dof)| right[dof as usize] += times * block.slopes[row * width + at]);
        let own = &block.by_learned[row * learned..][..learned];
        below.iter_mut().zip(own).for_each(|(sum, slope)| *sum += times * slope);
    }
}
