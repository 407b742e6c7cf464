//! Colours of values, the same in pictures and in exported files.

/// A range of values and the colours that stand for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColourScale {
    /// From `low` (dark) to `high` (bright): for quantities with a natural zero at one end.
    Sequential {
        /// The value of the darkest colour.
        low: f64,
        /// The value of the brightest colour.
        high: f64,
    },
    /// From blue through white at zero to red: for errors.
    Diverging {
        /// The value of the deepest red; its negative is the deepest blue.
        largest: f64,
    },
}

impl ColourScale {
    /// A sequential scale over the finite values.
    pub fn sequential(values: &[f64]) -> ColourScale {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        if low < high {
            ColourScale::Sequential { low, high }
        } else {
            let low = if low.is_finite() { low } else { 0.0 };
            ColourScale::Sequential { low, high: low + 1.0 }
        }
    }

    /// A sequential scale over the finite values and zero, for what cannot be negative.
    pub fn from_zero(values: &[f64]) -> ColourScale {
        match ColourScale::sequential(values) {
            ColourScale::Sequential { low, high } if low > 0.0 => ColourScale::Sequential { low: 0.0, high },
            scale => scale,
        }
    }

    /// A diverging scale over the finite values.
    pub fn diverging(values: &[f64]) -> ColourScale {
        let largest =
            values.iter().copied().filter(|value| value.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
        ColourScale::Diverging { largest: if largest > 0.0 { largest } else { 1.0 } }
    }

    /// Lowest and highest value.
    pub fn range(&self) -> (f64, f64) {
        match *self {
            ColourScale::Sequential { low, high } => (low, high),
            ColourScale::Diverging { largest } => (-largest, largest),
        }
    }

    /// The colour of a value as red, green, blue. Values outside the range have the colour of its nearer end.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        let (low, high) = self.range();
        let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        let colour = match self {
            ColourScale::Sequential { .. } => colorous::VIRIDIS.eval_continuous(share),
            ColourScale::Diverging { .. } => colorous::RED_BLUE.eval_continuous(1.0 - share),
        };
        [colour.r, colour.g, colour.b]
    }
}
