//! Steps after which no head is beyond its bounds, at as many places as it has functions.

use super::solver::Solver;
use super::state::State;
use crate::bounds::{Bounded, Limit, Spring, WALL, each};
use crate::local::block::Block;

impl Solver<'_> {
    /// A step of coefficients and of learned parameters within all bounds, from the one that the normal equations ask for. It goes
    /// last, since walls are added to them. Noise, roughness and error bars are those without bounds, so that a source at its bound
    /// has bars.
    pub(super) fn within_bounds(&mut self, state: &State, step: (Vec<f64>, Vec<f64>)) -> (Vec<f64>, Vec<f64>) {
        let walls = self.walls(state);
        let inside = |step: &(Vec<f64>, Vec<f64>), at: usize| walls[at].after(0, &step.0, &step.1) / WALL;
        let at_bound = (0..walls.len()).filter(|&at| walls[at].misfits[0] <= 0.0).collect();
        // Kept only where a wall is in the way.
        let mut free = None;
        let pulled = &mut |springs: &[Spring]| {
            self.normal.go_back(free.get_or_insert_with(|| self.normal.sums()));
            let pulling = |spring: &Spring| {
                let mut wall = walls[spring.at].clone();
                wall.divide(std::iter::once(WALL / spring.stiffness));
                wall.misfits[0] -= spring.stiffness * spring.target;
                wall
            };
            self.normal.add_all(&springs.iter().map(pulling).collect::<Vec<Block>>());
            self.normal.step(&self.normal.factor()?)
        };
        Bounded { count: walls.len(), inside: &inside, pulled }.within(step, at_bound)
    }

    /// Rows that hold bounded heads at each of their bounds, one for each of their functions; positive inside.
    fn walls(&self, state: &State) -> Vec<Block> {
        let heads = &self.heads;
        let of = |head: usize, limit: Limit| {
            (0..heads.lattices[head].len()).map(move |function| {
                let parts = heads.parts(head, &heads.lattices[head].site(function)).into_iter();
                let factor = limit.sign * WALL / heads.scale[head];
                let (dofs, slopes): (Vec<u32>, Vec<f64>) = parts.map(|(at, value)| (at as u32, factor * value)).unzip();
                let change: f64 = dofs.iter().zip(&slopes).map(|(&at, slope)| slope * state.theta[at as usize]).sum();
                let misfit = WALL * limit.inside(heads.offset[head]) / heads.scale[head] + change;
                let by_learned = vec![0.0; state.learned.len()];
                Block { misfits: vec![misfit], by_learned, dofs, slopes, excess: 0.0 }
            })
        };
        each(&heads.limits).flat_map(|(head, limit)| of(head, limit)).collect()
    }
}
