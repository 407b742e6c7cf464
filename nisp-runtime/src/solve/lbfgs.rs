//! L-BFGS: quasi-Newton steps from the last few changes of the gradient (Nocedal and Wright, algorithm 7.4).

use super::fault::Fault;
use super::line_search::{Found, LineSearch};
use super::method::{FAULTS_IN_A_ROW, Method, Step, Verdict};
use super::objective::Objective;
use super::state::State;
use super::vector;
use crate::real::Real;

/// Steps that are worth remembering.
pub(crate) const MEMORY: usize = 20;

/// L-BFGS with a strong Wolfe line search.
pub struct Lbfgs<E> {
    theta: Vec<E>,
    gradient: Vec<E>,
    loss: Option<f64>,
    direction: Vec<E>,
    search: LineSearch<E>,
    /// Changes of theta and of the gradient, in a ring of pairs.
    pairs: Vec<(Vec<E>, Vec<E>)>,
    /// `1 / s.y` of each pair.
    inverse: Vec<f64>,
    coefficients: Vec<f64>,
    /// Pairs taken so far; the newest is in slot `(taken - 1) % pairs.len()`.
    taken: usize,
    /// Pairs in use.
    used: usize,
    faults: u64,
}

impl<E: Real> Lbfgs<E> {
    /// Starts at `theta` and remembers the last `memory` steps (at least one is kept).
    pub fn new(theta: Vec<E>, memory: usize) -> Self {
        let zeros = || vec![E::ZERO; theta.len()];
        let memory = memory.max(1);
        Self {
            gradient: zeros(),
            loss: None,
            direction: zeros(),
            search: LineSearch::new(theta.len()),
            pairs: (0..memory).map(|_| (zeros(), zeros())).collect(),
            inverse: vec![0.0; memory],
            coefficients: vec![0.0; memory],
            taken: 0,
            used: 0,
            faults: 0,
            theta,
        }
    }

    /// Slots of the pairs in use, newest first.
    fn newest_first(&self) -> impl DoubleEndedIterator<Item = usize> + use<E> {
        let (taken, memory) = (self.taken, self.pairs.len());
        (0..self.used).map(move |age| (taken - 1 - age) % memory)
    }

    /// `direction = -H gradient`, by the two-loop recursion; the slope along it.
    fn aim(&mut self) -> f64 {
        for (d, g) in self.direction.iter_mut().zip(&self.gradient) {
            *d = -*g;
        }
        for slot in self.newest_first() {
            let (s, y) = &self.pairs[slot];
            self.coefficients[slot] = self.inverse[slot] * vector::dot(s, &self.direction);
            vector::add_scaled(&mut self.direction, -self.coefficients[slot], y);
        }
        if let Some(slot) = self.newest_first().next() {
            let y = &self.pairs[slot].1;
            let scale = E::from_f64(1.0 / (self.inverse[slot] * vector::dot(y, y)));
            self.direction.iter_mut().for_each(|d| *d *= scale);
        }
        for slot in self.newest_first().rev() {
            let (s, y) = &self.pairs[slot];
            let correction = self.inverse[slot] * vector::dot(y, &self.direction);
            vector::add_scaled(&mut self.direction, self.coefficients[slot] - correction, s);
        }
        vector::dot(&self.direction, &self.gradient)
    }

    /// Takes over the point that the search has found, and the pair of changes that led to it.
    fn accept(&mut self, loss: f64) {
        let slot = self.taken % self.pairs.len();
        let (s, y) = &mut self.pairs[slot];
        vector::difference(s, &self.search.theta, &self.theta);
        vector::difference(y, &self.search.gradient, &self.gradient);
        let (sy, yy) = (vector::dot(s, y), vector::dot(y, y));
        // Without positive curvature along the step the pair would spoil the model.
        if sy > E::EPSILON.to_f64() * yy.sqrt() * vector::norm(s) {
            self.inverse[slot] = 1.0 / sy;
            self.taken += 1;
            self.used = (self.used + 1).min(self.pairs.len());
        } else if self.used == self.pairs.len() {
            // The slot of the oldest pair has been overwritten.
            self.used -= 1;
        }
        std::mem::swap(&mut self.theta, &mut self.search.theta);
        std::mem::swap(&mut self.gradient, &mut self.search.gradient);
        self.loss = Some(loss);
        self.faults = 0;
    }

    /// Without a better point: forgets the model, or gives up where there was none to forget.
    fn refuse(&mut self, fault: Option<Fault>) -> Result<Verdict, Fault> {
        let fresh = self.used == 0;
        self.used = 0;
        match fault {
            Some(fault) => {
                self.faults += 1;
                if self.faults >= FAULTS_IN_A_ROW { Err(fault) } else { Ok(Verdict::Faulty(fault)) }
            }
            None if fresh => Ok(Verdict::Exhausted),
            None => Ok(Verdict::Refused),
        }
    }

    fn report(&self, decrement: f64, length: f64, evaluations: usize, verdict: Verdict) -> Step {
        Step {
            loss: self.loss.unwrap_or(f64::INFINITY),
            gradient_norm: vector::norm(&self.gradient),
            decrement: Some(decrement),
            length,
            evaluations,
            verdict,
        }
    }
}

/// A state in which all pairs are in use again that were given up because no better point was found along them: in a higher
/// precision there may be one.
pub(crate) fn recalled(state: State) -> Result<State, Fault> {
    // Of a full ring, the oldest slot may hold a pair that was not taken.
    let memory = state.vector("inverse")?.len() as u64;
    let used = state.counter("taken")?.min(memory.saturating_sub(1));
    Ok(state.with_counter_at("used", used))
}

impl<E: Real, O: Objective<E> + ?Sized> Method<E, O> for Lbfgs<E> {
    fn name(&self) -> &'static str {
        "lbfgs"
    }

    fn theta(&self) -> &[E] {
        &self.theta
    }

    fn step(&mut self, objective: &mut O) -> Result<Step, Fault> {
        let loss = match self.loss {
            Some(loss) => loss,
            None => match objective.gradient(&self.theta, &mut self.gradient) {
                Ok(loss) => *self.loss.insert(loss),
                Err(fault) => {
                    let verdict = self.refuse(Some(fault))?;
                    return Ok(self.report(f64::INFINITY, 0.0, 1, verdict));
                }
            },
        };
        let mut slope = self.aim();
        if slope >= 0.0 || !slope.is_finite() {
            self.used = 0;
            slope = self.aim();
        }
        if slope == 0.0 {
            return Ok(self.report(0.0, 0.0, 0, Verdict::Exhausted));
        }
        let norm = vector::norm(&self.direction);
        let first = if self.used == 0 { (1.0 / norm).min(1.0) } else { 1.0 };
        let found = self.search.run(objective, &self.theta, &self.direction, (loss, slope), first);
        match found {
            Found::Better { step, loss, evaluations } => {
                self.accept(loss);
                let mut report = self.report(-0.5 * slope, step * norm, evaluations, Verdict::Moved);
                if objective.accepted(&self.theta) {
                    self.loss = None;
                    report.verdict = Verdict::Changed;
                }
                Ok(report)
            }
            Found::Nothing { fault, evaluations } => {
                let verdict = self.refuse(fault)?;
                Ok(self.report(-0.5 * slope, 0.0, evaluations, verdict))
            }
        }
    }

    fn save(&self) -> State {
        let mut state = State::new("lbfgs")
            .with("theta", &self.theta)
            .with("gradient", &self.gradient)
            .with("loss", self.loss.as_slice())
            .with("inverse", &self.inverse)
            .with_counter("taken", self.taken as u64)
            .with_counter("used", self.used as u64)
            .with_counter("faults", self.faults);
        for (slot, (s, y)) in self.pairs.iter().enumerate() {
            state = state.with(&format!("s{slot}"), s).with(&format!("y{slot}"), y);
        }
        state
    }

    fn restore(&mut self, state: &State) -> Result<(), Fault> {
        state.check_method("lbfgs")?;
        let (len, memory) = (self.theta.len(), self.pairs.len());
        let theta = state.sized("theta", len)?;
        let gradient = state.sized("gradient", len)?;
        let inverse = state.sized("inverse", memory)?;
        let loss = state.vector("loss")?.first().copied();
        let pairs = (0..memory)
            .map(|slot| Ok((state.sized(&format!("s{slot}"), len)?, state.sized(&format!("y{slot}"), len)?)))
            .collect::<Result<Vec<_>, Fault>>()?;
        let (taken, used) = (state.counter("taken")? as usize, state.counter("used")? as usize);
        let faults = state.counter("faults")?;
        if used > memory || used > taken {
            return Err(Fault::state("used"));
        }
        (self.theta, self.gradient, self.inverse, self.loss) = (theta, gradient, inverse, loss);
        (self.pairs, self.taken, self.used, self.faults) = (pairs, taken, used, faults);
        Ok(())
    }
}
