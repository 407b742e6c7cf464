//! Direct collocation: states and source are splines, the equations hold at many points up to a tolerance, and a prior
//! on the source's second derivative has the weight that makes the measurements most probable.

use super::band::{Band, Factor};
use super::bspline::{Basis, SUPPORT};
use super::search::best_decade;
use super::{Estimate, Measurements, RivalError, System, check};

/// Decades of the prior's weight that are looked at.
const DECADES: (i32, i32) = (-12, 8);
/// Collocation points per knot interval.
const POINTS: usize = 3;
const GAUSS_NEWTON_STEPS: usize = 20;
/// A known value of the source is held this much more tightly than an equation.
const PIN: f64 = 1e-3;

/// Noise that stands for none.
const EXACT: f64 = 1e-8;

/// The source at times `at`, given the residual (above zero) up to which the equations are to hold. `chosen` is the
/// prior's weight.
pub fn collocation(
    system: &dyn System,
    data: &Measurements<'_>,
    tolerance: f64,
    at: &[f64],
) -> Result<Estimate, RivalError> {
    check(system, data, SUPPORT + 1)?;
    if tolerance.is_nan() || tolerance <= 0.0 {
        return Err(RivalError::Input("the tolerance must be above zero".into()));
    }
    let problem = Problem::new(system, data, tolerance);
    let mut state = vec![0.0; problem.unknowns()];
    let decade = best_decade(DECADES.0, DECADES.1, |decade| {
        let weight = 10f64.powf(decade);
        let (cost, factor) = problem.solve(weight, &mut state)?;
        // Minus twice the logarithm of the evidence, without what does not depend on the weight.
        Ok(cost + factor.log_det() - problem.prior_rank() * weight.ln())
    })?;
    let weight = 10f64.powf(decade);
    problem.solve(weight, &mut state)?;
    Ok(Estimate { source: at.iter().map(|&t| problem.source(&state, t)).collect(), chosen: weight })
}

struct Problem<'a> {
    system: &'a dyn System,
    basis: Basis,
    /// Rows that do not change: place, value; and right-hand sides.
    data: Vec<(Vec<(usize, f64)>, f64)>,
    prior: Band,
    tolerance: f64,
}

impl<'a> Problem<'a> {
    fn new(system: &'a dyn System, data: &Measurements<'_>, tolerance: f64) -> Problem<'a> {
        let times = data.times;
        let basis = Basis::new(times[0], times[times.len() - 1], (times.len() - 1).min(400));
        let fields = system.states() + 1;
        let row = |t: f64, field: usize, order: usize, scale: f64| -> Vec<(usize, f64)> {
            let alive = basis.alive(t);
            (0..SUPPORT).map(|i| ((alive.first + i) * fields + field, scale * alive.derivatives[order][i])).collect()
        };
        let measured = data
            .states
            .iter()
            .enumerate()
            .flat_map(|(field, values)| times.iter().zip(*values).map(move |(&t, &value)| (t, field, value)));
        let mut fixed: Vec<_> = measured
            .map(|(t, field, value)| {
                let noise = data.noise[field].max(EXACT);
                (row(t, field, 0, 1.0 / noise), value / noise)
            })
            .collect();
        if let Some((t, value)) = system.known_source() {
            let scale = 1.0 / (PIN * tolerance);
            fixed.push((row(t, fields - 1, 0, scale), scale * value));
        }
        let mut prior = Band::zero(basis.len() * fields, SUPPORT * fields - 1);
        let (nodes, weight) = basis.nodes(POINTS);
        nodes.iter().for_each(|&t| prior.add_row(&row(t, fields - 1, 2, weight.sqrt())));
        Problem { system, basis, data: fixed, prior, tolerance }
    }

    /// Coefficient `i` of every field stands together, which keeps the matrix narrow.
    fn fields(&self) -> usize {
        self.system.states() + 1
    }

    fn unknowns(&self) -> usize {
        self.basis.len() * self.fields()
    }

    /// Straight lines are free of the prior.
    fn prior_rank(&self) -> f64 {
        (self.basis.len() - 2) as f64
    }

    fn source(&self, state: &[f64], t: f64) -> f64 {
        let alive = self.basis.alive(t);
        let place = |i: usize| (alive.first + i) * self.fields() + self.fields() - 1;
        (0..SUPPORT).map(|i| alive.derivatives[0][i] * state[place(i)]).sum()
    }

    /// Gauss-Newton from `state` on. Returns twice the cost at the end and the factor of the last matrix.
    fn solve(&self, weight: f64, state: &mut Vec<f64>) -> Result<(f64, Factor), RivalError> {
        let (mut cost, mut matrix, mut gradient) = self.linearise(weight, state);
        for _ in 0..GAUSS_NEWTON_STEPS {
            let factor = matrix.factor()?;
            let mut step = gradient.clone();
            factor.solve(&mut step);
            let decrease: f64 = step.iter().zip(&gradient).map(|(a, b)| a * b).sum();
            let mut scale = 1.0;
            let (next, moved) = loop {
                let trial: Vec<f64> = state.iter().zip(&step).map(|(x, s)| x - scale * s).collect();
                let next = self.linearise(weight, &trial);
                if next.0 <= cost || scale < 1e-3 {
                    break (next, trial);
                }
                scale *= 0.5;
            };
            *state = moved;
            let done = decrease <= 1e-10 * (1.0 + cost);
            (cost, matrix, gradient) = next;
            if done {
                break;
            }
        }
        Ok((cost, matrix.factor()?))
    }

    /// Twice the cost, the Gauss-Newton matrix and the gradient.
    fn linearise(&self, weight: f64, state: &[f64]) -> (f64, Band, Vec<f64>) {
        let mut matrix = Band::zero(self.unknowns(), SUPPORT * self.fields() - 1);
        let mut gradient = vec![0.0; self.unknowns()];
        let mut cost = 0.0;
        let mut add = |row: &[(usize, f64)], residual: f64| {
            cost += residual * residual;
            matrix.add_row(row);
            row.iter().for_each(|&(at, entry)| gradient[at] += entry * residual);
        };
        for (row, target) in &self.data {
            let value: f64 = row.iter().map(|&(at, entry)| entry * state[at]).sum();
            add(row, value - target);
        }
        self.equations(state, &mut add);
        matrix.add(weight, &self.prior);
        let pull = self.prior.multiply(state);
        cost += weight * pull.iter().zip(state).map(|(a, b)| a * b).sum::<f64>();
        gradient.iter_mut().zip(&pull).for_each(|(g, p)| *g += weight * p);
        (cost, matrix, gradient)
    }

    /// Hands over every equation's row at every collocation point.
    fn equations(&self, state: &[f64], add: &mut impl FnMut(&[(usize, f64)], f64)) {
        let (fields, rows) = (self.fields(), self.system.equations());
        let width = 3 * (fields - 1) + 2;
        let (mut residual, mut jacobian) = (vec![0.0; rows], vec![0.0; rows * width]);
        let mut row = Vec::with_capacity(SUPPORT * fields);
        // Which field and which derivative an entry of the jet is.
        let meaning = |entry: usize| (entry / 3, entry % 3);
        for t in self.basis.nodes(POINTS).0 {
            let alive = self.basis.alive(t);
            let value = |entry: usize| -> f64 {
                let (field, order) = meaning(entry);
                let place = |i: usize| (alive.first + i) * fields + field;
                (0..SUPPORT).map(|i| alive.derivatives[order][i] * state[place(i)]).sum()
            };
            let jet: Vec<f64> = (0..width).map(value).collect();
            self.system.residual(&jet, &mut residual, &mut jacobian);
            for (value, slopes) in residual.iter().zip(jacobian.chunks(width)) {
                row.clear();
                for i in 0..SUPPORT {
                    for field in 0..fields {
                        let orders = if field + 1 == fields { 2 } else { 3 };
                        let slope: f64 = (0..orders).map(|k| slopes[3 * field + k] * alive.derivatives[k][i]).sum();
                        row.push(((alive.first + i) * fields + field, slope / self.tolerance));
                    }
                }
                add(&row, value / self.tolerance);
            }
        }
    }
}
