//! Where the normal equations lead.

use super::Normal;
use super::factor::Factor;
use crate::solve::vector;

impl Normal {
    /// Factorises; nothing if the matrix is not positive definite.
    pub(in crate::local) fn factor(&self) -> Option<Factor> {
        let part = self.part.clone();
        let factor = match &part {
            Some(part) => part.factor(&self.values),
            None => self.pattern.factor(&self.values),
        }?;
        let mut found = Factor {
            factor,
            part,
            solved: Vec::new(),
            border: self.border.clone(),
            schur: self.corner.clone(),
            learned: self.learned,
        };
        found.solved = found.solve_free(&self.border)?;
        for i in 0..self.border.len() {
            for j in 0..self.border.len() {
                found.schur[(i, j)] -= vector::dot(&self.border[i], &found.solved[j]);
            }
        }
        Some(found)
    }

    /// The step to the minimum of the quadratic model: of the coefficients, and of the learned scalars.
    pub(in crate::local) fn step(&self, factor: &Factor) -> Option<(Vec<f64>, Vec<f64>)> {
        let (step, shared, _) = self.step_with(factor, &vec![0.0; self.gradient.len()], &[])?;
        Some((step, shared))
    }

    /// The step where unknowns that are not free take the steps `held`, which is zero for those that are free; and
    /// `probe . H^-1 probe` of some vectors, of the coefficients alone.
    pub(in crate::local) fn step_with(
        &self,
        factor: &Factor,
        held: &[f64],
        probes: &[Vec<f64>],
    ) -> Option<(Vec<f64>, Vec<f64>, Vec<f64>)> {
        let slopes = self.slopes_after(held, &[]);
        let right: Vec<f64> = slopes.iter().map(|g| -g).collect();
        let along = self.border.iter().map(|column| vector::dot(column, held));
        let below: Vec<f64> = self.border_gradient.iter().zip(along).map(|(g, along)| -g - along).collect();
        let sides: Vec<&[f64]> = probes.iter().map(Vec::as_slice).chain([right.as_slice()]).collect();
        let mut solutions = factor.solve_free(&sides)?;
        let mut step = solutions.pop()?;
        let shared = factor.share(&mut step, &below)?;
        step.iter_mut().zip(held).for_each(|(step, held)| *step += held);
        let inner = probes.iter().zip(&solutions).map(|(probe, solution)| vector::dot(probe, solution)).collect();
        Some((step, shared, inner))
    }

    /// The model's gradient after a step of the coefficients and of the border's unknowns.
    pub(in crate::local) fn slopes_after(&self, step: &[f64], shared: &[f64]) -> Vec<f64> {
        let mut slopes = self.gradient.clone();
        if step.iter().any(|step| *step != 0.0) {
            let product = self.pattern.times(&self.values, step);
            slopes.iter_mut().zip(product).for_each(|(slope, product)| *slope += product);
        }
        for (column, shared) in self.border.iter().zip(shared) {
            slopes.iter_mut().zip(column).for_each(|(slope, entry)| *slope += entry * shared);
        }
        slopes
    }
}
