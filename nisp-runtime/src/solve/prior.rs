//! Gaussian beliefs about the parameters themselves.

use super::fault::Fault;
use super::vector;
use std::ops::Range;

/// Independent Gaussian beliefs about groups of parameters: `precision |theta_group|^2 / 2` is added to the loss.
/// Parameters in no group have a flat prior.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WeightPrior {
    groups: Vec<PriorGroup>,
}

/// Parameters that share a precision, for instance the weights of one head.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorGroup {
    /// Name for reports.
    pub name: String,
    /// The parameters.
    pub range: Range<usize>,
    /// Inverse variance, alpha in MacKay's papers.
    pub precision: f64,
}

impl WeightPrior {
    /// A prior on `len` parameters.
    ///
    /// # Errors
    /// Names a group that reaches beyond `len`, overlaps an earlier one, or whose precision is negative or not finite.
    pub fn new(groups: Vec<PriorGroup>, len: usize) -> Result<Self, Fault> {
        let mut taken = vec![false; len];
        for group in &groups {
            let valid = group.precision >= 0.0 && group.precision.is_finite();
            let free = taken.get(group.range.clone()).is_some_and(|range| !range.contains(&true));
            if !valid || !free {
                return Err(Fault::state(format!("prior group {}", group.name)));
            }
            taken[group.range.clone()].fill(true);
        }
        Ok(Self { groups })
    }

    /// A prior on groups that are known to be disjoint and sound.
    pub(crate) fn of<const N: usize>(groups: [PriorGroup; N]) -> Self {
        Self { groups: groups.into() }
    }

    /// One precision for all of `len` parameters.
    pub fn uniform(precision: f64, len: usize) -> Self {
        Self { groups: vec![PriorGroup { name: "weights".into(), range: 0..len, precision }] }
    }

    /// The groups.
    pub fn groups(&self) -> &[PriorGroup] {
        &self.groups
    }

    pub(crate) fn set_precision(&mut self, group: usize, precision: f64) {
        self.groups[group].precision = precision;
    }

    /// `sum precision |theta_group|^2 / 2`
    pub fn value(&self, theta: &[f64]) -> f64 {
        self.groups.iter().map(|group| 0.5 * group.precision * group.square(theta)).sum()
    }

    /// Adds the gradient of [`Self::value`].
    pub(crate) fn add_gradient(&self, theta: &[f64], gradient: &mut [f64]) {
        for group in &self.groups {
            let range = group.range.clone();
            vector::add_scaled(&mut gradient[range.clone()], group.precision, &theta[range]);
        }
    }

    /// Writes the precision of every parameter.
    pub(crate) fn write_diagonal(&self, out: &mut [f64]) {
        out.fill(0.0);
        for group in &self.groups {
            out[group.range.clone()].fill(group.precision);
        }
    }
}

impl PriorGroup {
    /// `|theta_group|^2`
    pub(crate) fn square(&self, theta: &[f64]) -> f64 {
        let weights = &theta[self.range.clone()];
        vector::dot(weights, weights)
    }
}
