//! Whether a source bends as its prior says.

use super::Window;
use crate::splines::KINDS;
use crate::splines::prior::Prior;

/// Share of the prior's variance that rows have to explain for a bend to say anything.
const EXPLAINED: f64 = 1e-6;

impl Window {
    /// How far a source bends about a place, at most: the square of what its prior keeps small, over the variance that its estimate has by
    /// the prior and the rows. It is one in the mean where the prior is right. Beside a step that the prior does not know, misfits are often
    /// hidden in the noise, but the source bends too much. Nothing is said of cells that have come in with another prior.
    pub(in super::super) fn bend(&mut self, at: f64) -> Option<f64> {
        if at < self.weighed_from {
            return None;
        }
        let cell = self.grid.cell(at);
        let mut most = 0.0_f64;
        for (head, sizes) in self.weights.sizes.iter().enumerate() {
            let Some((roughness, _)) = *sizes else { continue };
            let (basis, kind) = (&self.heads.bases[head], KINDS[self.weights.kind]);
            let prior = Prior::new(basis, kind);
            // The row whose middle function is centred at the cell.
            let Some((first, factors)) = prior.smooth(roughness).nth(cell + basis.degree / 2 - kind.order / 2) else {
                continue;
            };
            let numbers = &self.heads.numbers(head, first)[..prior.width()];
            let mut slopes = vec![0.0; numbers[prior.width() - 1] + 1 - numbers[0]];
            let mut value = 0.0;
            for (&number, factor) in numbers.iter().zip(&factors) {
                slopes[number - numbers[0]] = *factor;
                value += factor * self.theta[number];
            }
            let explained = 1.0 - self.all.deviation(numbers[0], &slopes, &mut self.scratch).powi(2);
            if explained > EXPLAINED {
                most = most.max(value * value / explained);
            }
        }
        Some(most)
    }
}
