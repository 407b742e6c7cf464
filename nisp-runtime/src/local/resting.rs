//! Which coefficients of sources rest at zero during a step. Where nothing presses they are most of all unknowns, and a matrix
//! without them is factorised in a fraction of the time. One that rests is let go of where the model says that a patch would pay:
//! its multiplier outweighs what the prior charges (Karush, Kuhn and Tucker).

use super::assembly::sparse;
use super::lattice::Lattice;
use super::place::State;
use super::solver::Solver;

/// Height over the prior's level up to which a source counts as none.
const NONE: f64 = 0.02;
/// Nodes about a patch along which it may grow in a step, and about one from a coarser lattice.
const GROWTH: usize = 2;
const COARSE_GROWTH: usize = 4;
/// Nodes more than that which are free where the matrix gets another pattern, so that it need not get one in every step.
const ROOM: usize = 1;
/// Width in nodes of the least patch that is asked whether it would pay: a node and its neighbours.
const LEAST: f64 = 3.0;
/// What a patch is taken to cost at most, as a share of what the prior charges: the model is not exact.
const CHEAP: f64 = 0.5;
/// How many times more unknowns than needed may be free before the matrix gets another pattern.
const SPARE: f64 = 1.25;

impl Solver {
    /// The unknowns that are free in the next step from a state; all of them where no source has a prior that knows patches.
    /// `slopes` are those of the quadratic model after the step that led to this state.
    pub(super) fn free_after(&self, state: &State, slopes: &[f64]) -> Vec<bool> {
        let wanted = self.free(state, Some(slopes), GROWTH);
        let count = |free: &[bool]| free.iter().filter(|free| **free).count() as f64;
        let is_within = wanted.iter().zip(&state.free).all(|(wanted, free)| !wanted || *free);
        let is_near = is_within && count(&state.free) <= SPARE * count(&wanted);
        if is_near { state.free.clone() } else { self.free(state, Some(slopes), GROWTH + ROOM) }
    }

    /// The unknowns that are free in the first step from a coarser lattice's state.
    pub(super) fn free_at_first(&self, state: &State) -> Vec<bool> {
        self.free(state, None, COARSE_GROWTH)
    }

    fn free(&self, state: &State, slopes: Option<&[f64]>, growth: usize) -> Vec<bool> {
        let mut free = vec![true; state.theta.len()];
        for head in 0..self.heads.lattices.len() {
            let Some(prior) = sparse(&self.bound, &self.settings, &self.heads, head, state.noise / self.cell) else {
                continue;
            };
            let (range, lattice) = (self.heads.first[head]..self.heads.first[head + 1], &self.heads.lattices[head]);
            let acts = state.theta[range.clone()].iter().map(|f| f / prior.level > NONE).collect();
            let mut own = grown(lattice, acts, growth);
            if let Some(slopes) = slopes {
                let gains: Vec<f64> = slopes[range.clone()].iter().map(|slope| -slope * prior.level).collect();
                let cost = CHEAP * prior.edge_of_square(LEAST);
                let pays = means(lattice, &gains).into_iter().map(|gain| gain > cost).collect();
                own.iter_mut().zip(grown(lattice, pays, growth - 1)).for_each(|(own, pays)| *own |= pays);
            }
            free[range].copy_from_slice(&own);
        }
        free
    }
}

/// Nodes that are near those that are marked: at most so many along every coordinate.
fn grown(lattice: &Lattice, marked: Vec<bool>, times: usize) -> Vec<bool> {
    let mut all = marked;
    for axis in (0..lattice.dimensions()).flat_map(|axis| std::iter::repeat_n(axis, times)) {
        let before = all.clone();
        for (a, b) in lattice.neighbours(axis) {
            all[a as usize] |= before[b as usize];
            all[b as usize] |= before[a as usize];
        }
    }
    all
}

/// Means over every node and its neighbours, also those across.
fn means(lattice: &Lattice, values: &[f64]) -> Vec<f64> {
    let (mut sums, mut counts) = (values.to_vec(), vec![1.0; values.len()]);
    for axis in 0..lattice.dimensions() {
        let (own, number) = (sums.clone(), counts.clone());
        for (a, b) in lattice.neighbours(axis).map(|(a, b)| (a as usize, b as usize)) {
            sums[a] += own[b];
            sums[b] += own[a];
            counts[a] += number[b];
            counts[b] += number[a];
        }
    }
    sums.iter().zip(&counts).map(|(sum, count)| sum / count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_grow_and_means_are_of_neighbours() {
        let lattice = Lattice::new(0, vec![0.0; 2], vec![1.0; 2], vec![5, 4]);
        let mut at = vec![0.0; 20];
        at[7] = 9.0;
        let square = [1, 2, 3, 6, 7, 8, 11, 12, 13];
        let means = means(&lattice, &at);
        let marks = grown(&lattice, at.iter().map(|x| *x > 0.0).collect(), 1);
        for node in 0..20 {
            let is_near = square.contains(&node);
            assert_eq!(marks[node], is_near, "{node}");
            // At an edge six nodes are neighbours.
            let count = if node < 5 { 6.0 } else { 9.0 };
            assert_eq!(means[node], if is_near { 9.0 / count } else { 0.0 }, "{node}");
        }
    }
}
