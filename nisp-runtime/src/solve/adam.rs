//! Adam: first-order steps of nearly constant length (Kingma and Ba 2015, algorithm 1).
//!
//! For wide networks, and for parity with published results.

use super::fault::Fault;
use super::method::{FAULTS_IN_A_ROW, Method, Step, Verdict};
use super::objective::Objective;
use super::state::State;
use super::vector;
use crate::real::Real;
use crate::wide::widest;
use rayon::prelude::*;

/// Settings of [`Adam`]; the default is the schedule of the paper that this project starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamSettings {
    /// First learning rate.
    pub rate: f64,
    /// Factor on the rate every `decay_steps` steps.
    pub decay: f64,
    /// Steps between two decays.
    pub decay_steps: u64,
    /// Decay of the mean of gradients.
    pub beta_1: f64,
    /// Decay of the mean of squared gradients.
    pub beta_2: f64,
    /// Added to the root of the mean square.
    pub epsilon: f64,
}

impl Default for AdamSettings {
    fn default() -> Self {
        Self { rate: 1e-3, decay: 0.9, decay_steps: 5000, beta_1: 0.9, beta_2: 0.999, epsilon: 1e-8 }
    }
}

/// The present iterate and the running means. The means are kept twice: a step writes the other copy, so that refusing
/// it costs nothing and restores every bit.
pub struct Adam<E> {
    settings: AdamSettings,
    now: Moments<E>,
    trial: Moments<E>,
    gradient: Vec<E>,
    trial_gradient: Vec<E>,
    loss: Option<f64>,
    steps: u64,
    /// Factor on the rate, below one after a fault.
    caution: f64,
    faults: u64,
}

struct Moments<E> {
    theta: Vec<E>,
    mean: Vec<E>,
    square: Vec<E>,
}

/// Constants of one update, rounded once.
#[derive(Clone, Copy)]
struct Coefficients<E> {
    keep_mean: E,
    add_mean: E,
    keep_square: E,
    add_square: E,
    rate: E,
    root: E,
    epsilon: E,
}

/// Elements below which a second thread does not pay.
const PARALLEL: usize = 1 << 15;

impl<E: Real> Adam<E> {
    /// Starts at `theta`.
    pub fn new(theta: Vec<E>, settings: AdamSettings) -> Self {
        let zeros = || vec![E::ZERO; theta.len()];
        Self {
            settings,
            trial: Moments { theta: zeros(), mean: zeros(), square: zeros() },
            gradient: zeros(),
            trial_gradient: zeros(),
            now: Moments { mean: zeros(), square: zeros(), theta },
            loss: None,
            steps: 0,
            caution: 1.0,
            faults: 0,
        }
    }

    fn coefficients(&self) -> Coefficients<E> {
        let s = &self.settings;
        let t = (self.steps + 1).min(i32::MAX as u64) as i32;
        let decays = (self.steps / s.decay_steps.max(1)).min(i32::MAX as u64) as i32;
        let unbias = 1.0 - s.beta_1.powi(t);
        Coefficients {
            keep_mean: E::from_f64(s.beta_1),
            add_mean: E::from_f64(1.0 - s.beta_1),
            keep_square: E::from_f64(s.beta_2),
            add_square: E::from_f64(1.0 - s.beta_2),
            rate: E::from_f64(s.rate * s.decay.powi(decays) * self.caution / unbias),
            root: E::from_f64(1.0 / (1.0 - s.beta_2.powi(t))),
            epsilon: E::from_f64(s.epsilon),
        }
    }

    fn refuse(&mut self, fault: Fault) -> Result<Step, Fault> {
        self.faults += 1;
        if self.faults >= FAULTS_IN_A_ROW {
            return Err(fault);
        }
        self.caution *= 0.25;
        Ok(self.report(0.0, Verdict::Faulty(fault)))
    }

    fn report(&self, length: f64, verdict: Verdict) -> Step {
        Step {
            loss: self.loss.unwrap_or(f64::INFINITY),
            gradient_norm: vector::norm(&self.gradient),
            decrement: None,
            length,
            evaluations: 1,
            verdict,
        }
    }
}

/// Writes the updated moments of `now` to `trial`.
fn update<E: Real>(now: &Moments<E>, gradient: &[E], trial: &mut Moments<E>, c: Coefficients<E>) {
    let len = gradient.len();
    let chunk = PARALLEL / 4;
    if len < PARALLEL {
        update_chunk(
            [&mut trial.theta, &mut trial.mean, &mut trial.square],
            [&now.theta, &now.mean, &now.square, gradient],
            c,
        );
    } else {
        (
            trial.theta.par_chunks_mut(chunk),
            trial.mean.par_chunks_mut(chunk),
            trial.square.par_chunks_mut(chunk),
            now.theta.par_chunks(chunk),
            now.mean.par_chunks(chunk),
            now.square.par_chunks(chunk),
            gradient.par_chunks(chunk),
        )
            .into_par_iter()
            .for_each(|(theta, mean, square, theta_0, mean_0, square_0, gradient)| {
                update_chunk([theta, mean, square], [theta_0, mean_0, square_0, gradient], c);
            });
    }
}

widest! {
    fn update_chunk<E: Real>(new: [&mut [E]; 3], old: [&[E]; 4], c: Coefficients<E>) = update_loop
}

#[inline(always)]
fn update_loop<E: Real>(new: [&mut [E]; 3], old: [&[E]; 4], c: Coefficients<E>) {
    let [theta, mean, square] = new;
    let [theta_0, mean_0, square_0, gradient] = old;
    let len = gradient.len();
    let (theta, mean, square) = (&mut theta[..len], &mut mean[..len], &mut square[..len]);
    let (theta_0, mean_0, square_0) = (&theta_0[..len], &mean_0[..len], &square_0[..len]);
    for i in 0..len {
        let g = gradient[i];
        let m = c.keep_mean * mean_0[i] + c.add_mean * g;
        let v = c.keep_square * square_0[i] + c.add_square * (g * g);
        mean[i] = m;
        square[i] = v;
        theta[i] = theta_0[i] - c.rate * m / ((c.root * v).sqrt() + c.epsilon);
    }
}

impl<E: Real, O: Objective<E> + ?Sized> Method<E, O> for Adam<E> {
    fn name(&self) -> &'static str {
        "adam"
    }

    fn theta(&self) -> &[E] {
        &self.now.theta
    }

    fn step(&mut self, objective: &mut O) -> Result<Step, Fault> {
        if self.loss.is_none() {
            objective.refresh(&self.now.theta);
            match objective.gradient(&self.now.theta, &mut self.gradient) {
                Ok(loss) => self.loss = Some(loss),
                Err(fault) => return self.refuse(fault),
            }
        }
        let coefficients = self.coefficients();
        update(&self.now, &self.gradient, &mut self.trial, coefficients);
        // Every step is taken, so that what is frozen may follow it before the one gradient that it costs.
        objective.refresh(&self.trial.theta);
        match objective.gradient(&self.trial.theta, &mut self.trial_gradient) {
            Ok(loss) => self.loss = Some(loss),
            Err(fault) => {
                objective.refresh(&self.now.theta);
                return self.refuse(fault);
            }
        }
        std::mem::swap(&mut self.now, &mut self.trial);
        std::mem::swap(&mut self.gradient, &mut self.trial_gradient);
        self.steps += 1;
        self.faults = 0;
        self.caution = (self.caution * 1.1).min(1.0);
        let length = vector::distance(&self.now.theta, &self.trial.theta);
        let mut step = self.report(length, Verdict::Moved);
        if objective.accepted(&self.now.theta) {
            self.loss = None;
            step.verdict = Verdict::Changed;
        }
        Ok(step)
    }

    fn period(&self) -> Option<u64> {
        (self.settings.decay < 1.0).then_some(self.settings.decay_steps)
    }

    fn save(&self) -> State {
        State::new("adam")
            .with("theta", &self.now.theta)
            .with("mean", &self.now.mean)
            .with("square", &self.now.square)
            .with("gradient", &self.gradient)
            .with("loss", self.loss.as_slice())
            .with("caution", &[self.caution])
            .with_counter("steps", self.steps)
            .with_counter("faults", self.faults)
    }

    fn restore(&mut self, state: &State) -> Result<(), Fault> {
        state.check_method("adam")?;
        let len = self.now.theta.len();
        let now = Moments {
            theta: state.sized("theta", len)?,
            mean: state.sized("mean", len)?,
            square: state.sized("square", len)?,
        };
        let gradient = state.sized("gradient", len)?;
        let loss = state.vector("loss")?.first().copied();
        let [caution] = state.scalars("caution")?;
        let (steps, faults) = (state.counter("steps")?, state.counter("faults")?);
        (self.now, self.gradient, self.loss, self.caution) = (now, gradient, loss, caution);
        (self.steps, self.faults) = (steps, faults);
        Ok(())
    }
}
