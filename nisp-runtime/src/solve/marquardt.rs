//! Levenberg-Marquardt: Gauss-Newton steps, damped by the diagonal of the normal matrix (Marquardt 1963), with the
//! damping controlled by the ratio of actual to predicted decrease (Nielsen 1999).
//!
//! Each step solves `(J^T J + A + lambda D) p = -g`, where `A` is the weight prior and `D` the diagonal of `J^T J`.
//! The matrix is that of parameters or that of rows, whichever costs less.

use super::damping::Damping;
use super::fault::{Fault, Kind};
use super::method::{FAULTS_IN_A_ROW, Method, Step, Verdict};
use super::normal::Normal;
use super::objective::LeastSquares;
use super::prior::WeightPrior;
use super::state::State;
use super::vector;

/// Levenberg-Marquardt on the rows of a [`LeastSquares`] objective and a [`WeightPrior`].
pub struct Marquardt {
    theta: Vec<f64>,
    trial: Vec<f64>,
    trial_rows: Vec<f64>,
    direction: Vec<f64>,
    normal: Normal,
    prior: WeightPrior,
    /// Loss at theta with the prior, once the rows there are known.
    loss: Option<f64>,
    damping: Damping,
    faults: u64,
}

impl Marquardt {
    /// Starts at `theta`, with damping 1e-3, which suits networks at their initial weights.
    pub fn new(theta: Vec<f64>, prior: WeightPrior) -> Self {
        let len = theta.len();
        Self {
            trial: vec![0.0; len],
            trial_rows: Vec::new(),
            direction: vec![0.0; len],
            normal: Normal::new(len),
            prior,
            loss: None,
            damping: Damping::new(1e-3),
            faults: 0,
            theta,
        }
    }

    /// The weight prior.
    pub fn prior(&self) -> &WeightPrior {
        &self.prior
    }

    /// Changes the weight prior; the next step evaluates afresh.
    pub fn set_prior(&mut self, prior: WeightPrior) {
        self.prior = prior;
        self.loss = None;
    }

    /// The rows of the objective have changed (another sigma); the next step evaluates afresh.
    pub fn refresh(&mut self) {
        self.loss = None;
    }

    /// Present damping factor, relative to the diagonal of the normal matrix.
    pub fn damping(&self) -> f64 {
        self.damping.factor()
    }

    /// Rows and derivatives at theta, unless they are known.
    fn linearise<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) -> Result<f64, Fault> {
        if let Some(loss) = self.loss {
            return Ok(loss);
        }
        let loss = self.normal.linearise(objective, &self.theta, &self.prior)?;
        self.trial_rows.resize(objective.rows(), 0.0);
        Ok(*self.loss.insert(loss + self.prior.value(&self.theta)))
    }

    /// After a fault: as it was, but more careful.
    fn refuse(&mut self, fault: Fault, decrement: f64) -> Result<Step, Fault> {
        self.faults += 1;
        if self.faults >= FAULTS_IN_A_ROW {
            return Err(fault);
        }
        self.damping.alarm();
        Ok(self.report(decrement, 0.0, Verdict::Faulty(fault)))
    }

    /// Computes the direction with the present damping, raising it until the matrix is positive definite.
    fn aim(&mut self) -> Result<(), Fault> {
        while !self.normal.solve(self.damping.factor(), &self.prior, &self.theta, &mut self.direction) {
            self.damping.raise();
            if self.damping.is_exhausted() {
                return Err(Fault { term: "normal equations".into(), point: None, what: Kind::Factorisation });
            }
        }
        Ok(())
    }

    /// Judges the trial point, whose loss is `trial_loss`.
    fn judge<O: LeastSquares + ?Sized>(
        &mut self,
        objective: &mut O,
        (loss, trial_loss, predicted): (f64, f64, f64),
        decrement: f64,
    ) -> Step {
        self.faults = 0;
        let ratio = (loss - trial_loss) / predicted;
        if trial_loss >= loss || ratio < 1e-4 {
            // Where the promised gain is below rounding, refusal says nothing about the model.
            let lost = predicted <= f64::EPSILON * loss || self.damping.is_exhausted();
            self.damping.raise();
            let verdict = if lost { Verdict::Exhausted } else { Verdict::Refused };
            return self.report(decrement, 0.0, verdict);
        }
        self.damping.reward(ratio);
        std::mem::swap(&mut self.theta, &mut self.trial);
        let changed = objective.accepted(&self.theta);
        let length = vector::norm(&self.direction);
        let mut step = self.report(decrement, length, Verdict::Moved);
        step.loss = trial_loss;
        if changed {
            step.verdict = Verdict::Changed;
        }
        // The rows at the new iterate are not known yet.
        self.loss = None;
        step
    }

    fn report(&self, decrement: f64, length: f64, verdict: Verdict) -> Step {
        Step {
            loss: self.loss.unwrap_or(f64::INFINITY),
            gradient_norm: vector::norm(self.normal.gradient()),
            decrement: Some(decrement),
            length,
            evaluations: 1,
            verdict,
        }
    }
}

impl<O: LeastSquares + ?Sized> Method<f64, O> for Marquardt {
    fn name(&self) -> &'static str {
        "lm"
    }

    fn theta(&self) -> &[f64] {
        &self.theta
    }

    fn step(&mut self, objective: &mut O) -> Result<Step, Fault> {
        let loss = match self.linearise(objective) {
            Ok(loss) => loss,
            Err(fault) => return self.refuse(fault, f64::INFINITY),
        };
        if self.normal.gradient().iter().all(|g| *g == 0.0) {
            return Ok(self.report(0.0, 0.0, Verdict::Exhausted));
        }
        self.aim()?;
        let slope = vector::dot(&self.direction, self.normal.gradient());
        let damped = self.damping.factor() * self.normal.damped_square(&self.direction);
        let (decrement, predicted) = (-0.5 * slope, -0.5 * slope + 0.5 * damped);
        vector::along(&mut self.trial, &self.theta, 1.0, &self.direction);
        match objective.residuals(&self.trial, &mut self.trial_rows) {
            Ok(rows) => {
                let trial_loss = rows + self.prior.value(&self.trial);
                Ok(self.judge(objective, (loss, trial_loss, predicted), decrement))
            }
            Err(fault) => self.refuse(fault, decrement),
        }
    }

    fn prior(&self) -> Option<&WeightPrior> {
        Some(&self.prior)
    }

    fn save(&self) -> State {
        let precisions: Vec<f64> = self.prior.groups().iter().map(|group| group.precision).collect();
        State::new("lm")
            .with("theta", &self.theta)
            .with("damping", &self.damping.save())
            .with("precisions", &precisions)
            .with_counter("faults", self.faults)
    }

    fn restore(&mut self, state: &State) -> Result<(), Fault> {
        state.check_method("lm")?;
        let theta = state.sized("theta", self.theta.len())?;
        let damping = Damping::restore(state.scalars("damping")?);
        let precisions: Vec<f64> = state.sized("precisions", self.prior.groups().len())?;
        let faults = state.counter("faults")?;
        for (group, precision) in precisions.into_iter().enumerate() {
            self.prior.set_precision(group, precision);
        }
        (self.theta, self.damping, self.faults) = (theta, damping, faults);
        // Rows and derivatives follow from theta, to the bit.
        self.loss = None;
        Ok(())
    }
}
