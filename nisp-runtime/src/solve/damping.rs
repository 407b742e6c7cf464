//! Control of the damping of Gauss-Newton steps by the ratio of actual to predicted decrease (Nielsen 1999).

/// Largest shrinkage of the damping after a good step. Nielsen's third makes the end game linear.
const SHRINK: f64 = 0.1;
/// Smallest damping: what rounding of the normal matrix needs anyway.
const LEAST: f64 = 1e-15;
/// Damping at which no step is left.
const MOST: f64 = 1e16;

/// A damping factor, relative to the diagonal of the normal matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Damping {
    factor: f64,
    growth: f64,
}

impl Damping {
    pub(crate) fn new(factor: f64) -> Self {
        Self { factor, growth: 2.0 }
    }

    pub(crate) fn factor(self) -> f64 {
        self.factor
    }

    /// After a refused step. Refusals in a row raise the damping faster and faster.
    pub(crate) fn raise(&mut self) {
        self.factor = (self.factor * self.growth).max(LEAST);
        self.growth *= 2.0;
    }

    /// After a fault: several of them must not exhaust the patience of the method.
    pub(crate) fn alarm(&mut self) {
        self.growth = self.growth.max(8.0);
        self.raise();
    }

    /// After an accepted step with this ratio of actual to predicted decrease.
    pub(crate) fn reward(&mut self, ratio: f64) {
        let shrink = (1.0 - (2.0 * ratio - 1.0).powi(3)).max(SHRINK);
        self.factor = (self.factor * shrink).max(LEAST);
        self.growth = 2.0;
    }

    /// No step is left.
    pub(crate) fn is_exhausted(self) -> bool {
        self.factor > MOST
    }

    pub(crate) fn save(self) -> [f64; 2] {
        [self.factor, self.growth]
    }

    pub(crate) fn restore([factor, growth]: [f64; 2]) -> Self {
        Self { factor, growth }
    }
}
