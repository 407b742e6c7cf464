//! Local polynomials: a window of measurements around each time, a polynomial through it, its derivatives.

use nalgebra::{DMatrix, DVector};

use super::{Estimate, Measurements, RivalError, System, check, mean_abs_error};

/// The source at times `at` from local polynomials of the given degree over windows of `window` measurements.
pub fn savitzky_golay(
    system: &dyn System,
    data: &Measurements<'_>,
    window: usize,
    degree: usize,
    at: &[f64],
) -> Result<Estimate, RivalError> {
    if degree < 2 || window <= degree {
        return Err(RivalError::Input(format!("a window of {window} does not carry a polynomial of degree {degree}")));
    }
    check(system, data, window)?;
    let mut jets = vec![Vec::with_capacity(at.len()); data.states.len()];
    for &t in at {
        for (state, jet) in local_jets(data, t, window, degree)?.into_iter().enumerate() {
            jets[state].push(jet);
        }
    }
    Ok(Estimate { source: system.source(at, &jets), chosen: window as f64 })
}

/// ORACLE: the window whose answer is nearest to the truth at times `at`. A bound for the method, not a method.
pub fn savitzky_golay_oracle(
    system: &dyn System,
    data: &Measurements<'_>,
    degree: usize,
    at: &[f64],
    truth: &[f64],
) -> Result<Estimate, RivalError> {
    let widest = data.times.len().min(121);
    let mut best: Option<(f64, Estimate)> = None;
    for window in (degree + 1..=widest).filter(|window| window % 2 == 1) {
        let estimate = savitzky_golay(system, data, window, degree, at)?;
        let error = mean_abs_error(&estimate.source, truth);
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, estimate));
        }
    }
    best.map(|(_, estimate)| estimate).ok_or_else(|| RivalError::Input("no window fits the measurements".into()))
}

/// `[y, y', y'']` of each state at `t`.
fn local_jets(data: &Measurements<'_>, t: f64, window: usize, degree: usize) -> Result<Vec<[f64; 3]>, RivalError> {
    let first = nearest_window(data.times, t, window);
    let times = &data.times[first..first + window];
    let half = 0.5 * (times[window - 1] - times[0]);
    let powers = DMatrix::from_fn(window, degree + 1, |row, power| ((times[row] - t) / half).powi(power as i32));
    let qr = powers.qr();
    let (q, r) = (qr.q(), qr.r());
    let fit = |state: &&[f64]| {
        let right = q.transpose() * DVector::from_column_slice(&state[first..first + window]);
        let solved = r.solve_upper_triangular(&right).ok_or(RivalError::Singular)?;
        Ok([solved[0], solved[1] / half, 2.0 * solved[2] / (half * half)])
    };
    data.states.iter().map(fit).collect()
}

/// First index of the `window` measurements nearest to `t`.
fn nearest_window(times: &[f64], t: f64, window: usize) -> usize {
    let after = times.partition_point(|&time| time < t);
    let nearest = match after {
        0 => 0,
        _ if after == times.len() || t - times[after - 1] < times[after] - t => after - 1,
        _ => after,
    };
    nearest.saturating_sub(window / 2).min(times.len() - window)
}
