//! Smoothing splines: each state on its own, the third derivative penalised, the weight by cross-validation.

use super::band::Band;
use super::bspline::{Alive, Basis, DEGREE, SUPPORT};
use super::search::best_decade;
use super::{Estimate, Measurements, RivalError, System, check};

/// Decades of the penalty's weight that are looked at.
const DECADES: (i32, i32) = (-16, 2);
/// Noise below this share of the values' spread is none.
const NEGLIGIBLE: f64 = 1e-3;

/// The source at times `at` from smoothing splines of the states. `chosen` is the first state's weight.
pub fn smoothing_spline(system: &dyn System, data: &Measurements<'_>, at: &[f64]) -> Result<Estimate, RivalError> {
    check(system, data, SUPPORT + 1)?;
    let smoother = Smoother::new(data.times);
    let mut jets = Vec::new();
    let mut chosen = 0.0;
    for (index, state) in data.states.iter().enumerate() {
        let decade = best_decade(DECADES.0, DECADES.1, |decade| smoother.cross_validation(10f64.powf(decade), state))?;
        let weight = 10f64.powf(decade);
        if index == 0 {
            chosen = weight;
        }
        let (coefficients, _) = smoother.fit(weight, state)?;
        jets.push(at.iter().map(|&t| jet(&smoother.basis.alive(t), &coefficients)).collect());
    }
    Ok(Estimate { source: system.source(at, &jets), chosen })
}

/// The standard deviation of the noise in measurements at rising times, from what a smoothing spline leaves of them
/// (Wahba's estimate). Zero where that is no more than a spline's own error.
///
/// # Errors
/// Too few measurements, or times that do not rise.
pub fn noise_level(times: &[f64], values: &[f64]) -> Result<f64, RivalError> {
    if times.len() != values.len() || times.len() <= SUPPORT || !times.windows(2).all(|pair| pair[0] < pair[1]) {
        return Err(RivalError::Input(format!("{} measurements at rising times are needed", SUPPORT + 1)));
    }
    let smoother = Smoother::new(times);
    let decade = best_decade(DECADES.0, DECADES.1, |decade| smoother.cross_validation(10f64.powf(decade), values))?;
    let (squares, free) = smoother.residual(10f64.powf(decade), values)?;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let size = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
    let noise = (squares / free.max(1.0)).sqrt();
    Ok(if noise > NEGLIGIBLE * size.sqrt() { noise } else { 0.0 })
}

fn jet(alive: &Alive, coefficients: &[f64]) -> [f64; 3] {
    let value = |order: usize| (0..SUPPORT).map(|i| alive.derivatives[order][i] * coefficients[alive.first + i]).sum();
    [value(0), value(1), value(2)]
}

/// What does not depend on the weight.
struct Smoother {
    basis: Basis,
    data_rows: Vec<Vec<(usize, f64)>>,
    gram: Band,
    penalty: Band,
}

impl Smoother {
    /// A knot for each measurement, so that only the penalty smooths.
    fn new(times: &[f64]) -> Smoother {
        let basis = Basis::new(times[0], times[times.len() - 1], times.len() - 1);
        let row = |alive: Alive, order: usize, scale: f64| -> Vec<(usize, f64)> {
            (0..SUPPORT).map(|i| (alive.first + i, scale * alive.derivatives[order][i])).collect()
        };
        let data_rows: Vec<_> = times.iter().map(|&t| row(basis.alive(t), 0, 1.0)).collect();
        let (nodes, weight) = basis.nodes(3);
        let mut gram = Band::zero(basis.len(), DEGREE);
        let mut penalty = gram.clone();
        data_rows.iter().for_each(|row| gram.add_row(row));
        nodes.iter().for_each(|&t| penalty.add_row(&row(basis.alive(t), 3, weight.sqrt())));
        Smoother { basis, data_rows, gram, penalty }
    }

    /// Coefficients, and the trace of the smoother (its effective number of parameters).
    fn fit(&self, weight: f64, values: &[f64]) -> Result<(Vec<f64>, f64), RivalError> {
        let mut matrix = self.gram.clone();
        matrix.add(weight, &self.penalty);
        let factor = matrix.factor()?;
        let mut coefficients = vec![0.0; self.basis.len()];
        let mut trace = 0.0;
        for (row, value) in self.data_rows.iter().zip(values) {
            let mut influence = vec![0.0; self.basis.len()];
            for &(at, entry) in row {
                coefficients[at] += entry * value;
                influence[at] = entry;
            }
            factor.solve(&mut influence);
            trace += row.iter().map(|&(at, entry)| entry * influence[at]).sum::<f64>();
        }
        factor.solve(&mut coefficients);
        Ok((coefficients, trace))
    }

    /// Generalised cross-validation's score.
    fn cross_validation(&self, weight: f64, values: &[f64]) -> Result<f64, RivalError> {
        let (squares, free) = self.residual(weight, values)?;
        Ok(values.len() as f64 * squares / free.powi(2))
    }

    /// The sum of squares that the fit leaves, and how many values it left free.
    fn residual(&self, weight: f64, values: &[f64]) -> Result<(f64, f64), RivalError> {
        let (coefficients, trace) = self.fit(weight, values)?;
        let fitted = |row: &Vec<(usize, f64)>| row.iter().map(|&(at, entry)| entry * coefficients[at]).sum::<f64>();
        let squares = self.data_rows.iter().zip(values).map(|(row, value)| (fitted(row) - value).powi(2)).sum();
        Ok((squares, values.len() as f64 - trace))
    }
}
