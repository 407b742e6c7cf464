//! Which update of the family is made, from what a step has shown.

use crate::solve::symmetric::RankTwo;

/// Members of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Update {
    /// `phi = tau = 1`.
    Bfgs,
    /// BFGS with Al-Baali's scaling, `tau = min(1, 1 / b)`.
    SelfScaledBfgs,
    /// Self-scaled Broyden: `phi` and `tau` from the two Rayleigh quotients `b` and `h`.
    #[default]
    SelfScaledBroyden,
}

impl Update {
    /// Name as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bfgs => "bfgs",
            Self::SelfScaledBfgs => "ssbfgs",
            Self::SelfScaledBroyden => "ssbroyden",
        }
    }
}

/// The scalars from which an update is chosen.
pub(super) struct Quotients {
    /// `s.y`
    pub(super) sy: f64,
    /// `y^T H y`
    pub(super) yw: f64,
    /// `y^T H y / s.y`: how far `H` is too large along `y`.
    pub(super) h: f64,
    /// `s^T B s / s.y`: how far `B` is too large along `s`.
    pub(super) b: f64,
}

/// The parameters `theta` (of the family: 0 is BFGS, 1 is DFP) and `tau`.
pub(super) fn choose(update: Update, q: &Quotients, first: bool, len: usize) -> (f64, f64) {
    let Quotients { h, b, .. } = *q;
    // By Cauchy and Schwarz a >= 0, and 0 where s and H y are parallel: then theta plays no part.
    let a = h * b - 1.0;
    let theta = match update {
        Update::SelfScaledBroyden if a > 1e-12 => {
            let c = (a / (a + 1.0)).sqrt();
            let rho_minus = (h * (1.0 - c)).min(1.0);
            let theta_minus = (rho_minus - 1.0) / a;
            let theta_plus = 1.0 / rho_minus;
            theta_minus.max(theta_plus.min((1.0 - b) / b))
        }
        _ => 0.0,
    };
    let sigma = 1.0 + a.max(0.0) * theta;
    if first {
        // The unit matrix has no scale of its own yet: give it the one that the step has shown.
        return (theta, h / sigma);
    }
    let rho = (1.0 / b).min(1.0);
    let tau = match update {
        Update::Bfgs => 1.0,
        Update::SelfScaledBfgs => rho,
        Update::SelfScaledBroyden => {
            // Keeps the determinant: the geometric mean of the eigenvalues that the update leaves alone.
            let mean = sigma.powf(-1.0 / (len.max(2) - 1) as f64);
            if theta <= 0.0 { (rho * mean).min(sigma) } else { rho * mean.min(1.0 / theta) }
        }
    };
    (theta, tau)
}

/// The update written in `s s^T`, `s w^T + w s^T` and `w w^T`.
pub(super) fn rank_two(q: &Quotients, theta: f64, tau: f64) -> RankTwo {
    let a = (q.h * q.b - 1.0).max(0.0);
    let phi = (1.0 - theta) / (1.0 + a * theta);
    RankTwo {
        scale: 1.0 / tau,
        a: phi * q.yw / (tau * q.sy * q.sy) + 1.0 / q.sy,
        b: -phi / (tau * q.sy),
        c: (phi - 1.0) / (tau * q.yw),
    }
}
