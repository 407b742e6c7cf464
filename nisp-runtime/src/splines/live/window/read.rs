//! What the window says of the heads at a place, and how well it is known.

use super::Window;
use crate::solve::vector::dot;

impl Window {
    /// A head at a place of the window in the engine's units, and its standard deviation. What the last stretch leaves open of learned
    /// scalars is in it: their values stand in all rows, and the unknowns follow them.
    pub(in super::super) fn read(&mut self, head: usize, at: f64) -> (f64, f64) {
        let local = at - self.grid.left();
        let value = self.heads.derivative(head, (self.heads.cell(local), local), 0, &self.theta);
        let (first, slopes) = self.heads.value_row(head, local);
        let beside = self.all.deviation(first, &slopes, &mut self.scratch);
        let own = first..first + slopes.len();
        let by_learned: Vec<f64> = self.follow.iter().map(|follow| dot(&slopes, &follow[own.clone()])).collect();
        let spread = self.weights.spread.chunks_exact(by_learned.len().max(1));
        let of_learned: f64 = by_learned.iter().zip(spread).map(|(one, row)| one * dot(row, &by_learned)).sum();
        (value, (beside * beside + of_learned.max(0.0)).sqrt())
    }
}
