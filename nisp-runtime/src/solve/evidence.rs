//! The evidence: how probable the data are under a model, and the weights of priors and noise that make them most
//! probable (MacKay 1992, Bayesian interpolation, and A practical Bayesian framework for backpropagation networks).

use super::curvature::Curvature;
use super::objective::{Block, BlockKind};
use super::prior::WeightPrior;
use super::vector;
use std::f64::consts::TAU;

/// What the curvature at a minimum says about the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// By group of the weight prior, in its order.
    pub groups: Vec<GroupEvidence>,
    /// By block of rows, in their order.
    pub blocks: Vec<BlockEvidence>,
    /// Number of directions in parameter space that rows, not priors, determine.
    pub effective_parameters: f64,
    /// Logarithm of the probability of the rows under the model, in the Gaussian approximation around the minimum;
    /// up to a constant where parameters have a flat prior. The larger of two models on the same rows is the better.
    pub log_evidence: f64,
}

/// What the rows say about a group of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupEvidence {
    /// Name of the group.
    pub name: String,
    /// Directions of the group that rows determine (gamma): 0 for none, the size of the group for all.
    pub effective: f64,
    /// Squared length of these parameters.
    pub square: f64,
}

/// What is believed of a precision before any row is seen: a Gamma distribution, as if `count` parameters of just this
/// precision had been seen already. Without it a source that noise hides goes to zero with error bars of zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief {
    /// The precision believed in.
    pub precision: f64,
    /// Parameters that the belief is worth; 0 for none.
    pub count: f64,
}

impl GroupEvidence {
    /// Precision that these parameters speak for, with what was believed before: `gamma / |theta|^2` without a belief
    /// (MacKay 1992). Absent where neither says anything.
    pub fn precision(&self, belief: Belief) -> Option<f64> {
        let seen = self.effective + belief.count;
        let precision = seen / (self.square + belief.count / belief.precision);
        (seen > 0.0 && precision.is_finite()).then_some(precision)
    }
}

/// What the parameters say about a block of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockEvidence {
    /// Name of the term.
    pub term: String,
    /// Directions in parameter space that these rows determine.
    pub effective: f64,
    /// Squared residuals per free datum, in units of sigma squared: near one where sigma is right and the model fits.
    pub chi_square: f64,
    /// Scale that these residuals speak for: `sigma sqrt(chi_square)`.
    pub sigma: f64,
}

/// Reads the evidence from the curvature at a minimum `theta` under `prior`, with the rows in `blocks`.
pub fn evidence(curvature: &Curvature, prior: &WeightPrior, theta: &[f64], blocks: &[Block]) -> Evidence {
    let blocks = block_evidence(curvature, blocks);
    let inverse = curvature.cholesky.inverse_diagonal();
    let groups: Vec<_> = prior
        .groups()
        .iter()
        .map(|group| {
            let size = group.range.len() as f64;
            let trace: f64 = inverse[group.range.clone()].iter().sum();
            let effective = (size - group.precision * trace).clamp(0.0, size);
            GroupEvidence { name: group.name.clone(), effective, square: group.square(theta) }
        })
        .collect();
    let effective_parameters = blocks.iter().map(|(_, block)| block.effective).sum();
    let log_evidence = log_evidence(curvature, prior, theta, blocks.iter().map(|(block, _)| *block));
    let blocks = blocks.into_iter().map(|(_, evidence)| evidence).collect();
    Evidence { groups, blocks, effective_parameters, log_evidence }
}

/// Blocks beside their evidence.
fn block_evidence<'a>(curvature: &Curvature, blocks: &'a [Block]) -> Vec<(&'a Block, BlockEvidence)> {
    // Row i determines j_i^T H^-1 j_i directions.
    let leverages = curvature.variances(&mut curvature.jacobian.clone());
    let of = |block: &'a Block| {
        let rows = &curvature.rows[block.rows.clone()];
        let effective = leverages[block.rows.clone()].iter().sum::<f64>();
        // A block that is fitted exactly has no free datum left, and says nothing about its sigma.
        let free = (block.count - effective).max(1e-3 * block.count).max(f64::MIN_POSITIVE);
        let chi_square = vector::dot(rows, rows) / free;
        let sigma = block.sigma * chi_square.sqrt();
        (block, BlockEvidence { term: block.term.clone(), effective, chi_square, sigma })
    };
    blocks.iter().map(of).collect()
}

fn log_evidence<'a>(
    curvature: &Curvature,
    prior: &WeightPrior,
    theta: &[f64],
    blocks: impl Iterator<Item = &'a Block>,
) -> f64 {
    let fit = 0.5 * vector::dot(&curvature.rows, &curvature.rows) + prior.value(theta);
    let volume = 0.5 * curvature.cholesky.log_determinant();
    let prior_volume: f64 = prior
        .groups()
        .iter()
        .filter(|group| group.precision > 0.0)
        .map(|group| 0.5 * group.range.len() as f64 * group.precision.ln())
        .sum();
    let noise: f64 = blocks.map(|block| block.count * (block.sigma * TAU.sqrt()).ln()).sum();
    prior_volume - fit - volume - noise
}

/// True for blocks whose sigma the data may re-estimate.
pub(crate) fn is_free(block: &Block) -> bool {
    block.kind == BlockKind::ObservationOfUnknownNoise
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_belief_counts_as_so_many_parameters_more() {
        let none = Belief { precision: 0.25, count: 0.0 };
        let some = Belief { precision: 0.25, count: 4.0 };
        let group = |effective, square| GroupEvidence { name: "weights".into(), effective, square };
        assert_eq!(group(6.0, 2.0).precision(none), Some(3.0));
        assert_eq!(group(6.0, 2.0).precision(some), Some(10.0 / 18.0));
        // Rows that say nothing leave what was believed, or nothing.
        assert_eq!(group(0.0, 0.0).precision(some), Some(0.25));
        assert_eq!(group(0.0, 0.0).precision(none), None);
    }
}
