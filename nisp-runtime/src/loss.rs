//! How the misfit of a row counts: the square, or less where it is large.
//!
//! Every loss grows no faster than the square and is concave as a function of it. A square through the present misfit,
//! [`Loss::weight`] times as steep, is then nowhere below it, which is what both ways of minimising a robust loss rest on:
//! rows that square to it (`Loss::row`), and weights that are renewed in every step (`Loss::majorant`).

/// How the misfit of a row counts; thresholds in units of the row's standard deviation, or of its natural size where none
/// is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// Half the square.
    Square,
    /// Huber's: half the square up to the threshold, a straight line beyond (1964).
    Huber(f64),
    /// Welsch's: a bell upside down; misfits far beyond the threshold are left out (Dennis and Welsch 1978).
    Welsch(f64),
    /// Tukey's: misfits beyond the threshold are left out entirely (Beaton and Tukey 1974).
    Tukey(f64),
}

impl Loss {
    /// The robust loss of a variant's name, as the compiler writes it into a schema.
    pub fn named(variant: &str, threshold: f64) -> Option<Self> {
        match variant {
            "Huber" => Some(Self::Huber(threshold)),
            "Welsch" => Some(Self::Welsch(threshold)),
            "Tukey" => Some(Self::Tukey(threshold)),
            _ => None,
        }
    }

    /// What a misfit costs: half its square, or less.
    pub fn rho(self, u: f64) -> f64 {
        match self {
            Self::Huber(c) if u.abs() > c => c * (u.abs() - c / 2.0),
            Self::Square | Self::Huber(_) => u * u / 2.0,
            Self::Welsch(c) => -c * c * (-(u / c).powi(2) / 2.0).exp_m1(),
            Self::Tukey(c) => {
                let share = (u / c).powi(2).min(1.0);
                c * c / 6.0 * share * (3.0 - share * (3.0 - share))
            }
        }
    }

    /// What the square of a misfit is multiplied by where the square is to have the slope of the loss: `rho'(u) / u`.
    pub fn weight(self, u: f64) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Huber(c) => (c / u.abs()).min(1.0),
            Self::Welsch(c) => (-(u / c).powi(2) / 2.0).exp(),
            Self::Tukey(c) => (1.0 - (u / c).powi(2)).max(0.0).powi(2),
        }
    }

    /// True unless it is the square.
    pub fn is_robust(self) -> bool {
        self != Self::Square
    }

    /// The loss itself or, where it leaves out what is far off, Huber's that bends where it does. Of a state that fits nothing yet
    /// such a loss would leave out what is right; a convex one has one minimum.
    pub(crate) fn convex(self) -> Self {
        match self {
            Self::Square | Self::Huber(_) => self,
            // Of the same weight at Welsch's threshold, and at half of Tukey's.
            Self::Welsch(c) => Self::Huber(0.61 * c),
            Self::Tukey(c) => Self::Huber(0.28 * c),
        }
    }

    /// `sign(u) sqrt(2 rho(u))` and its derivative: half the square of such a row is the loss.
    pub(crate) fn row(self, u: f64) -> (f64, f64) {
        let value = (2.0 * self.rho(u)).sqrt();
        // A misfit whose square is too small for a number counts as it is.
        if value == 0.0 { (u, 1.0) } else { (value.copysign(u), self.weight(u) * u.abs() / value) }
    }

    /// `(w, e)` such that `2 rho(v) <= w v^2 + e` for all `v`, with equality at `u`.
    pub(crate) fn majorant(self, u: f64) -> (f64, f64) {
        let weight = self.weight(u);
        (weight, 2.0 * self.rho(u) - weight * u * u)
    }
}

/// Standard deviation of misfits, those of outliers left out, where `used` of the others' degrees of freedom were fitted: root
/// mean square of those within four times the deviation that the median magnitude speaks for.
pub(crate) fn deviation_of_clean(misfits: Vec<f64>, used: f64) -> f64 {
    let mut magnitudes: Vec<f64> = misfits.into_iter().map(f64::abs).collect();
    magnitudes.sort_by(f64::total_cmp);
    let middle = magnitudes.get(magnitudes.len() / 2).copied().unwrap_or(0.0) * 1.4826;
    let (mut sum, mut count) = (0.0, 0.0f64);
    for misfit in magnitudes.iter().filter(|m| **m <= 4.0 * middle) {
        sum += misfit * misfit;
        count += 1.0;
    }
    (sum / (count - used).max(0.2 * count).max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MISFITS: [f64; 10] = [-7.0, -1.0, -1e-3, 0.0, 1e-9, 1e-200, 0.4, 1.4, 2.0, 30.0];

    /// Losses beside closed forms of them.
    fn losses(u: f64) -> [(Loss, f64); 4] {
        let huber = if u.abs() <= 1.5 { u * u / 2.0 } else { 1.5 * (u.abs() - 0.75) };
        let welsch = 4.0 * (1.0 - (-(u / 2.0).powi(2) / 2.0).exp());
        let tukey = 9.0 / 6.0 * (1.0 - (1.0 - (u / 3.0).powi(2)).max(0.0).powi(3));
        [(Loss::Square, u * u / 2.0), (Loss::Huber(1.5), huber), (Loss::Welsch(2.0), welsch), (Loss::Tukey(3.0), tukey)]
    }

    #[test]
    fn convex_losses_weigh_small_misfits_alike_and_large_ones_more() {
        for loss in [Loss::Welsch(2.0), Loss::Tukey(4.0)] {
            let convex = loss.convex();
            assert!((convex.weight(0.2) - loss.weight(0.2)).abs() < 0.02, "{loss:?}");
            assert!(convex.weight(8.0) > 0.1 && loss.weight(8.0) < 1e-3, "{loss:?}");
            assert_eq!(convex.convex(), convex);
        }
        assert_eq!(Loss::Square.convex(), Loss::Square);
    }

    #[test]
    fn rows_square_to_their_loss() {
        for u in MISFITS {
            for (loss, rho) in losses(u) {
                let (value, slope) = loss.row(u);
                // The closed forms round at the size of one.
                assert!((value * value / 2.0 - rho).abs() <= 1e-12 * rho + 1e-15, "{loss:?} {u}");
                let h = 1e-6;
                let difference = (loss.row(u + h).0 - loss.row(u - h).0) / (2.0 * h);
                assert!((slope - difference).abs() < 1e-5, "{loss:?} {u}: {slope} against {difference}");
            }
        }
    }

    #[test]
    fn majorants_touch_and_are_nowhere_below() {
        for u in MISFITS {
            for (loss, rho) in losses(u) {
                let (weight, rest) = loss.majorant(u);
                assert!((weight * u * u + rest - 2.0 * rho).abs() <= 1e-12 * (1.0 + rho), "{loss:?} {u}");
                let above = |v: f64| weight * v * v + rest - 2.0 * loss.rho(v);
                assert!(MISFITS.iter().all(|&v| above(v) >= -1e-12 * (1.0 + v * v)), "{loss:?} {u}");
            }
        }
    }

    #[test]
    fn outliers_count_less_the_farther_they_are() {
        for (loss, _) in losses(0.0).into_iter().filter(|(loss, _)| loss.is_robust()) {
            assert!(loss.weight(1e-3) > 0.999, "{loss:?}");
            assert!(loss.weight(30.0) < 0.06 && loss.weight(30.0) <= loss.weight(5.0), "{loss:?}");
        }
    }
}
