//! Weighted sums over the points of a group, and what they are to be.

use super::group::Group;
use super::heads::Heads;
use super::rows::Evaluated;
use crate::schema::TermKind;

/// An integral's misfit, and its derivatives by every coefficient and by every learned parameter.
pub(super) struct Integral {
    pub(super) misfit: f64,
    pub(super) slopes: Vec<f64>,
    pub(super) by_learned: Vec<f64>,
    pub(super) sigma: f64,
}

impl Group {
    /// Rows of integral terms, and how far their sums are from what they are to be.
    pub(super) fn sums(&self, evaluated: &Evaluated, scalars: &[f64]) -> Vec<(usize, f64)> {
        let sum = |row: usize| (0..self.sites.count).map(|p| self.weight(p) * evaluated.row(row, p)).sum::<f64>();
        self.targets(scalars).into_iter().map(|(row, target)| (row, sum(row) - target)).collect()
    }

    /// What all points weigh together.
    pub(super) fn measure(&self) -> f64 {
        (0..self.sites.count).map(|p| self.weight(p).abs()).sum()
    }

    /// Weight of a point in integrals.
    fn weight(&self, p: usize) -> f64 {
        self.weights.get(p).copied().unwrap_or(1.0)
    }

    /// Rows of integral terms, and what they are to be.
    fn targets(&self, scalars: &[f64]) -> Vec<(usize, f64)> {
        let terms = self.schema.terms.iter().filter(|term| term.kind == TermKind::Integral);
        let rows: Vec<usize> = terms.flat_map(|term| term.first..term.first + term.rows).collect();
        if rows.is_empty() {
            return Vec::new();
        }
        let mut targets = vec![0.0; self.schema.rows];
        self.kernel.programs.target(scalars, &mut targets);
        rows.into_iter().map(|row| (row, targets[row])).collect()
    }

    /// By row, the weighted sums of integral terms over the points, and their derivatives by every coefficient.
    ///
    /// `learned` are the derivatives of the learned scalars by their parameters.
    pub(super) fn integrals(
        &self,
        heads: &Heads,
        evaluated: &Evaluated,
        scalars: &[f64],
        learned: &[f64],
    ) -> Vec<(usize, Integral)> {
        let mut of_targets = vec![0.0; self.schema.rows * learned.len()];
        self.kernel.programs.target_slopes(scalars, &mut of_targets);
        let integral = |(row, target): (usize, f64)| {
            let of_target = of_targets[row * learned.len()..].iter().zip(learned);
            let mut sum = Integral {
                misfit: -target,
                slopes: vec![0.0; heads.len()],
                by_learned: of_target.map(|(slope, learned)| -slope * learned).collect(),
                sigma: self.sigma[row],
            };
            for p in 0..self.sites.count {
                let seed = |bar| evaluated.bar(row, bar, p);
                let block = self.at_point(heads, (&self.sites, p), learned, evaluated.row(row, p), seed);
                let weight = self.weight(p);
                sum.misfit += weight * block.misfits[0];
                block.kept().for_each(|(at, dof)| sum.slopes[dof as usize] += weight * block.slopes[at]);
                sum.by_learned.iter_mut().zip(&block.by_learned).for_each(|(sum, by)| *sum += weight * by);
            }
            (row, sum)
        };
        self.targets(scalars).into_iter().map(integral).collect()
    }
}
