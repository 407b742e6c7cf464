//! The state of one lattice on another.

use rayon::prelude::*;

use super::LocalError;
use super::block::Block;
use super::heads::Heads;
use super::normal::Normal;
use super::phase::{CONVEX_STEPS, WARM_STEPS};
use super::place::{Place, State};
use super::solver::Solver;

/// Stiffness of coefficients that no point sees.
const NEGLIGIBLE: f64 = 1e-9;

impl Solver {
    /// The state of another lattice on this one: of hats its values at their middles, of splines its values at all points, by least
    /// squares.
    pub(super) fn taken_over(&self, other: &Heads, state: &State) -> Result<Place, LocalError> {
        let of_head = |head: usize| match self.heads.lattices[head].degree {
            1 => Ok(self.at_middles(head, other, &state.theta)),
            _ => self.by_points(head, other, &state.theta),
        };
        let theta: Vec<Vec<f64>> =
            (0..self.heads.lattices.len()).into_par_iter().map(of_head).collect::<Result<_, _>>()?;
        // Who comes with a state needs no regression, and few steps before the penalty may end at its level.
        let state = State { theta: theta.concat(), lowest: f64::INFINITY, free: Vec::new(), ..state.clone() };
        let free = self.free_at_first(&state);
        Ok(Place { skipped: CONVEX_STEPS - WARM_STEPS, ..self.place(&State { free, ..state }, 0) })
    }

    /// Coefficients of hats, which are values of another lattice.
    fn at_middles(&self, head: usize, other: &Heads, theta: &[f64]) -> Vec<f64> {
        let lattice = &self.heads.lattices[head];
        let middle = |number| lattice.middle(number);
        (0..lattice.len()).map(|number| other.height(head, &middle(number)[..lattice.inputs()], theta)).collect()
    }

    /// Coefficients of splines with which a head comes nearest to its values on another lattice, at all points that read it.
    fn by_points(&self, head: usize, other: &Heads, theta: &[f64]) -> Result<Vec<f64>, LocalError> {
        let alone = self.heads.alone(head);
        let inputs = alone.lattices[0].inputs();
        let groups = self.bound.problem.scene().schema.groups.iter().zip(&self.bound.coordinates);
        let reading = groups.filter(|(group, _)| group.jets.iter().any(|jet| jet.head == head));
        let points: Vec<&[f64]> = reading.flat_map(|(_, points)| points.chunks_exact(inputs)).collect();
        let row = |point: &&[f64]| {
            let (dofs, slopes) = alone.parts(0, point).into_iter().map(|(at, value)| (at as u32, value)).unzip();
            let misfits = vec![-other.sum(head, point, theta)];
            Block { misfits, by_learned: Vec::new(), dofs, slopes, excess: 0.0 }
        };
        let rows: Vec<Block> = points.par_iter().map(row).collect();
        let mut together: Vec<Vec<u32>> = rows.iter().map(|row| row.dofs.clone()).collect();
        together.sort_unstable();
        together.dedup();
        let mut normal = Normal::new(alone.len(), 0, &together).ok_or(LocalError::Memory)?;
        normal.add_all(&rows);
        (0..alone.len()).for_each(|at| normal.add_stiffness(at, NEGLIGIBLE));
        let factor = normal.factor().ok_or(LocalError::Factorisation)?;
        let (coefficients, _) = normal.step(&factor).ok_or(LocalError::Factorisation)?;
        Ok(coefficients)
    }
}
