//! All rivals on the same measurements.

use std::time::Instant;

use super::{Estimate, Measurements, RivalError, System, collocation, savitzky_golay_oracle, smoothing_spline};

/// Acceleration up to which collocation lets the equations be wrong, by the noise: what serves it best on noisy data
/// blurs exact ones.
const TOLERANCE: f64 = 1e-2;
const TOLERANCE_EXACT: f64 = 1e-3;
/// Degree of the local polynomials.
const DEGREE: usize = 6;

/// A rival's answer.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The rival's name in tables.
    pub name: &'static str,
    /// Whether it was tuned on the truth, which nobody could do in earnest.
    pub oracle: bool,
    /// Seconds it took, its own tuning included.
    pub wall_s: f64,
    /// The source at the times asked for.
    pub source: Vec<f64>,
}

/// The answers of every rival at times `at`, where `truth` is the true source.
///
/// # Errors
/// Measurements that do not fit the system, or that are too few.
pub fn contest(
    system: &dyn System,
    data: &Measurements<'_>,
    at: &[f64],
    truth: &[f64],
) -> Result<Vec<Answer>, RivalError> {
    let tolerance = if data.noise.iter().any(|&noise| noise > 0.0) { TOLERANCE } else { TOLERANCE_EXACT };
    let timed = |name, oracle, method: &dyn Fn() -> Result<Estimate, RivalError>| {
        let start = Instant::now();
        let source = method()?.source;
        Ok(Answer { name, oracle, wall_s: start.elapsed().as_secs_f64(), source })
    };
    Ok(vec![
        timed("collocation", false, &|| collocation(system, data, tolerance, at))?,
        timed("smoothing spline", false, &|| smoothing_spline(system, data, at))?,
        timed("Savitzky-Golay (oracle)", true, &|| savitzky_golay_oracle(system, data, DEGREE, at, truth))?,
    ])
}
