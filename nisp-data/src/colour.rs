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
    /// From pale grey at zero through yellow to dark red at `high`: for what acts on a body whose shape is lit.
    Load {
        /// The value of the darkest red.
        high: f64,
    },
    /// From blue through white at zero to red: for errors.
    Diverging {
        /// The value of the deepest red; its negative is the deepest blue.
        largest: f64,
    },
}

/// The grey of a body that nothing acts on, and the share of a load's range up to which it shines through.
const PALE: f64 = 225.0;
const BARE: f64 = 0.04;

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

    /// A load's scale up to the largest finite value.
    pub fn load(values: &[f64]) -> ColourScale {
        let most = values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
        ColourScale::Load { high: if most > 0.0 { most } else { 1.0 } }
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
            ColourScale::Load { high } => (0.0, high),
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
            ColourScale::Load { .. } => {
                let full = colorous::YELLOW_ORANGE_RED.eval_continuous(0.15 + 0.85 * share);
                let bare = 1.0 - (share / BARE).min(1.0);
                return [full.r, full.g, full.b]
                    .map(|part| (f64::from(part) * (1.0 - bare) + PALE * bare).round() as u8);
            }
            ColourScale::Diverging { .. } => colorous::RED_BLUE.eval_continuous(1.0 - share),
        };
        [colour.r, colour.g, colour.b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_cover_their_values_and_meet_zero_where_they_must() {
        assert_eq!(ColourScale::from_zero(&[2.0, 5.0]).range(), (0.0, 5.0));
        assert_eq!(ColourScale::from_zero(&[-1.0, 5.0]).range(), (-1.0, 5.0));
        assert_eq!(ColourScale::load(&[1.0, f64::NAN, 7.0]).range(), (0.0, 7.0));
        assert_eq!(ColourScale::load(&[]).range(), (0.0, 1.0));
        let load = ColourScale::Load { high: 10.0 };
        // Grey has equal parts; a full load is red.
        assert_eq!(load.colour(0.0), [225; 3]);
        assert!(load.colour(10.0)[0] > 2 * load.colour(10.0)[1]);
        assert_eq!(ColourScale::Diverging { largest: 3.0 }.range(), (-3.0, 3.0));
    }
}
