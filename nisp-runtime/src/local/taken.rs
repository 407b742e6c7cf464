//! The state of one lattice on another.

use super::LocalError;
use super::heads::Heads;
use super::phase::{CONVEX_STEPS, WARM_STEPS};
use super::place::{Place, State};
use super::solver::Solver;

/// Stiffness of coefficients that no point sees.
const NEGLIGIBLE: f64 = 1e-9;

impl Solver {
    /// The state of another lattice on this one: of hats its values at their middles, of splines its values at all points, by least
    /// squares.
    pub(super) fn taken_over(&mut self, other: &Heads, state: &State) -> Result<Place, LocalError> {
        let inputs = self.heads.lattices[0].inputs();
        let learned = state.learned.len();
        let is_hat = |head: &usize| self.heads.lattices[*head].degree == 1;
        let (hats, splines): (Vec<usize>, Vec<usize>) = (0..self.heads.lattices.len()).partition(is_hat);
        let mut is_spline = vec![false; self.heads.len()];
        let mut rows = Vec::new();
        for &head in &splines {
            is_spline[self.heads.first[head]..self.heads.first[head + 1]].fill(true);
            for (group, points) in self.bound.problem.scene().schema.groups.iter().zip(&self.bound.coordinates) {
                for point in points.chunks_exact(inputs).filter(|_| group.jets.iter().any(|jet| jet.head == head)) {
                    rows.push(self.heads.difference(head, point, other, &state.theta, learned));
                }
            }
        }
        self.normal.clear();
        self.normal.add_all(&rows);
        for at in 0..self.heads.len() {
            self.normal.add_stiffness(at, NEGLIGIBLE);
        }
        (0..learned).for_each(|at| self.normal.add_learned(at, 1.0, 0.0));
        self.normal.set_free(Some(&is_spline)).ok_or(LocalError::Memory)?;
        let factor = self.normal.factor().ok_or(LocalError::Factorisation)?;
        let (mut theta, _) = self.normal.step(&factor).ok_or(LocalError::Factorisation)?;
        for head in hats {
            for number in 0..self.heads.lattices[head].len() {
                let middle = self.heads.lattices[head].middle(number);
                theta[self.heads.first[head] + number] = other.height(head, &middle[..inputs], &state.theta);
            }
        }
        // Who comes with a state needs no regression, and few steps before the penalty may end at its level.
        let state = State { theta, lowest: f64::INFINITY, free: Vec::new(), ..state.clone() };
        let free = self.free_at_first(&state);
        Ok(Place { skipped: CONVEX_STEPS - WARM_STEPS, ..self.place(&State { free, ..state }, 0) })
    }
}
