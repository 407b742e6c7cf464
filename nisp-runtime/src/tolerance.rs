//! How far equations may be off in a step of splines: a state that is far off finds its way along loose ones.

/// The tolerance of the first step, and the largest.
const LOOSE: f64 = 1e-2;
/// Its fall from step to step, at first.
const FALL: f64 = 0.1;
/// Shares of a step that were taken: below the first it led nearly nowhere, below the second it had to be short.
const STUCK: f64 = 0.1;
const SHORT: f64 = 0.5;

/// A tolerance, and its fall from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tolerance {
    pub(crate) size: f64,
    fall: f64,
}

impl Tolerance {
    /// That of the first step.
    pub(crate) const FIRST: Self = Self { size: LOOSE, fall: FALL };

    /// After a step of which a share was taken. Strict equations that are not linear leave steps no room: where they lead nowhere,
    /// looser ones do, and become strict more slowly at first.
    pub(crate) fn after(self, share: f64, strictest: f64) -> Self {
        let (times, fall) = match share {
            ..STUCK if self.size < LOOSE => (self.fall.recip(), self.fall.sqrt()),
            ..SHORT => (1.0, self.fall),
            _ => (self.fall, self.fall.powi(2).max(FALL)),
        };
        Self { size: (self.size * times).clamp(strictest, LOOSE), fall }
    }

    /// As plain numbers.
    pub(crate) fn numbers(self) -> [f64; 2] {
        [self.size, self.fall]
    }
}

impl From<[f64; 2]> for Tolerance {
    fn from([size, fall]: [f64; 2]) -> Self {
        Self { size, fall }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole steps make equations strict; where steps lead nowhere they become loose, and strict again in more steps.
    #[test]
    fn equations_become_strict_more_slowly_after_steps_that_led_nowhere() {
        let steps = |mut tolerance: Tolerance| {
            let mut steps = 0;
            while tolerance.size > 1e-6 {
                tolerance = tolerance.after(1.0, 1e-6);
                steps += 1;
            }
            (steps, tolerance)
        };
        let (whole, strict) = steps(Tolerance::FIRST);
        assert_eq!(whole, 4);
        let stuck = strict.after(0.01, 1e-6);
        assert!((stuck.size - 1e-5).abs() < 1e-12, "{stuck:?}");
        assert_eq!(steps(stuck).0, 2);
        assert_eq!(stuck.after(0.3, 1e-6), stuck);
    }
}
