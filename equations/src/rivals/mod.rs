//! Classical answers to the same question, without a network: the yardsticks every result table prints beside ours.
//!
//! - [`collocation`]: states and source as splines, the equations as weighted rows, a smoothness prior on the source
//!   whose weight maximises the evidence. The strongest of them under noise.
//! - [`smoothing_spline`]: each measurement smoothed on its own (weight by generalised cross-validation), then the
//!   equation read backwards.
//! - [`savitzky_golay`]: local polynomials instead; [`savitzky_golay_oracle`] picks the window that scores best against
//!   the truth, which nobody could do in earnest.
//! - [`zero_error`]: the error of answering "no source at all".
//!
//! [`contest`] asks all of them at once.

mod band;
mod bspline;
mod cloud_fit;
mod collocation;
mod contest;
mod savitzky_golay;
mod search;
mod smoothing;
mod systems;
mod wrench;

pub use cloud_fit::{CloudFit, inflated_tensions, pressure_by_operator};
pub use collocation::collocation;
pub use contest::{Answer, contest};
pub use savitzky_golay::{savitzky_golay, savitzky_golay_oracle};
pub use smoothing::{noise_level, smoothing_spline};
pub use systems::{Pendulum, Rlc};
pub use wrench::LinearPressure;

/// An equation of motion of second order in its states and of first order in one source.
///
/// A *jet* lists `[y, y', y'']` of each state and then `[f, f']` of the source.
pub trait System {
    /// How many states.
    fn states(&self) -> usize;
    /// How many equations, each scaled so that a residual of one is of the size of its terms' natural unit.
    fn equations(&self) -> usize;
    /// Writes the residuals, and row by row their derivatives with respect to the jet.
    fn residual(&self, jet: &[f64], residual: &mut [f64], jacobian: &mut [f64]);
    /// Reads the equation backwards: the source at `times`, from jets of the states at those times.
    fn source(&self, times: &[f64], jets: &[Vec<[f64; 3]>]) -> Vec<f64>;
    /// A time and the value the source is known to have there, where the equations leave it open.
    fn known_source(&self) -> Option<(f64, f64)>;
}

/// What was measured: one column of values per state, at common rising times.
#[derive(Debug, Clone, Copy)]
pub struct Measurements<'a> {
    /// Times, rising.
    pub times: &'a [f64],
    /// The states' measured values.
    pub states: &'a [&'a [f64]],
    /// Standard deviation of each state's noise; zero for exact values.
    pub noise: &'a [f64],
}

/// A source recovered by a rival.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// The source at the times asked for.
    pub source: Vec<f64>,
    /// What the method chose for itself: a prior's weight, a window.
    pub chosen: f64,
}

/// Why a rival has no answer.
#[derive(Debug, thiserror::Error)]
pub enum RivalError {
    /// No method knows the equation.
    #[error("they are written by hand for `pendulum`, `rlc` and some contacts, and read no other equation")]
    Unknown,
    /// The measurements do not fit the system or the method.
    #[error("{0}")]
    Input(String),
    /// The normal equations could not be factorised.
    #[error("the rival's equations are singular; use fewer knots or more measurements")]
    Singular,
}

/// Mean absolute difference.
pub fn mean_abs_error(estimate: &[f64], truth: &[f64]) -> f64 {
    estimate.iter().zip(truth).map(|(a, b)| (a - b).abs()).sum::<f64>() / truth.len().max(1) as f64
}

/// The mean absolute error of the answer f = 0.
pub fn zero_error(truth: &[f64]) -> f64 {
    mean_abs_error(&vec![0.0; truth.len()], truth)
}

/// Checks what every method needs of its input.
fn check(system: &dyn System, data: &Measurements<'_>, least: usize) -> Result<(), RivalError> {
    let count = data.times.len();
    if data.states.len() != system.states() || data.states.iter().any(|state| state.len() != count) {
        let what = format!("{} states with {count} values each are needed", system.states());
        return Err(RivalError::Input(what));
    }
    if data.noise.len() != system.states() || !data.noise.iter().all(|&noise| noise >= 0.0) {
        return Err(RivalError::Input("each state needs its noise, zero or more".into()));
    }
    if count < least {
        return Err(RivalError::Input(format!("{count} measurements; this method needs at least {least}")));
    }
    let finite = data.states.iter().flat_map(|state| state.iter()).all(|value| value.is_finite());
    if !finite || !data.times.windows(2).all(|pair| pair[0] < pair[1]) {
        return Err(RivalError::Input("times must rise and values be finite".into()));
    }
    Ok(())
}
