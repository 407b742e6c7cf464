//! Self-scaled quasi-Newton methods of the Broyden family, with a dense inverse Hessian `H`.
//!
//! With the step `s`, the change of the gradient `y`, `B = H^-1` and `w = H y`, the update is
//!
//! `H+ = (H - w w^T / y.w + phi (y.w) v v^T) / tau + s s^T / s.y`, `v = s / s.y - w / y.w`
//!
//! BFGS is `phi = tau = 1`. Self-scaling (`tau < 1`) corrects the size of the whole matrix at every step, and moving
//! `phi` away from BFGS corrects its large eigenvalues: Al-Baali (1998, 2014). The choice used here is the one that
//! Urban, Stefanou and Pons (J. Comput. Phys. 523, 2025, 113656) found best for networks that solve differential
//! equations.

mod update;

pub use update::Update;
use update::{Quotients, choose, rank_two};

use super::fault::Fault;
use super::line_search::{Found, LineSearch};
use super::method::{FAULTS_IN_A_ROW, Method, Step, Verdict};
use super::objective::Objective;
use super::state::State;
use super::symmetric::Symmetric;
use super::vector;

/// First trial step where the loss falls by as much as in the last step; 2 would be exact for a parabola.
const FIRST_TRIAL: f64 = 3.0;

/// A dense quasi-Newton method with a strong Wolfe line search.
pub struct Broyden {
    update: Update,
    theta: Vec<f64>,
    gradient: Vec<f64>,
    loss: Option<f64>,
    direction: Vec<f64>,
    search: LineSearch<f64>,
    inverse: Symmetric,
    s: Vec<f64>,
    y: Vec<f64>,
    /// Updates since the matrix was last a multiple of the unit matrix.
    updates: u64,
    faults: u64,
    /// Decrease of the loss in the last step.
    decrease: f64,
}

impl Broyden {
    /// Starts at `theta`. The matrix takes `4 P^2` bytes for `P` parameters.
    pub fn new(theta: Vec<f64>, update: Update) -> Self {
        let len = theta.len();
        Self {
            update,
            gradient: vec![0.0; len],
            loss: None,
            direction: vec![0.0; len],
            search: LineSearch::new(len),
            inverse: Symmetric::new(len),
            s: vec![0.0; len],
            y: vec![0.0; len],
            updates: 0,
            faults: 0,
            decrease: 0.0,
            theta,
        }
    }

    /// Forgets the curvature.
    fn reset(&mut self) {
        self.inverse.set_identity(1.0);
        self.updates = 0;
        self.direction.iter_mut().zip(&self.gradient).for_each(|(d, g)| *d = -g);
    }

    /// Loss, gradient and first direction at theta, unless they are known.
    fn start<O: Objective<f64> + ?Sized>(&mut self, objective: &mut O) -> Result<f64, Fault> {
        if let Some(loss) = self.loss {
            return Ok(loss);
        }
        let loss = objective.gradient(&self.theta, &mut self.gradient)?;
        if self.updates == 0 {
            self.reset();
        } else {
            // The function has changed a little, and the curvature is still worth having.
            let (_, hg) = self.inverse.products(&self.gradient, &self.gradient);
            self.direction.iter_mut().zip(hg).for_each(|(d, hg)| *d = -hg);
            self.decrease = 0.0;
        }
        Ok(*self.loss.insert(loss))
    }

    /// The multiple of a direction of length `norm` to try first. The full step is often too long where the scaling
    /// has enlarged the matrix; what the last step gained says so without an evaluation (Nocedal and Wright, 3.60).
    fn first_trial(&self, norm: f64, slope: f64) -> f64 {
        if self.updates == 0 {
            (1.0 / norm).min(1.0)
        } else if self.decrease > 0.0 {
            (-FIRST_TRIAL * self.decrease / slope).min(1.0)
        } else {
            1.0
        }
    }

    /// Takes over the point that the search found at `step` times the direction, and learns from it.
    fn accept(&mut self, loss: f64, step: f64) {
        vector::difference(&mut self.s, &self.search.theta, &self.theta);
        vector::difference(&mut self.y, &self.search.gradient, &self.gradient);
        // B s = -step gradient, because s = step direction = -step H gradient.
        let sbs = -step * vector::dot(&self.s, &self.gradient);
        std::mem::swap(&mut self.theta, &mut self.search.theta);
        std::mem::swap(&mut self.gradient, &mut self.search.gradient);
        self.decrease = self.loss.map_or(0.0, |before| before - loss);
        self.loss = Some(loss);
        self.faults = 0;
        self.learn(sbs);
    }

    /// Updates the matrix from `s`, `y` and `s^T B s`, and computes the next direction.
    fn learn(&mut self, sbs: f64) {
        let g = &self.gradient;
        let (hy, hg) = self.inverse.products(&self.y, g);
        let sy = vector::dot(&self.s, &self.y);
        let yw = vector::dot(&self.y, hy);
        let norms = vector::norm(&self.s) * vector::norm(&self.y);
        let usable = sy > 1e-14 * norms && yw > 0.0 && sbs > 0.0;
        if !usable {
            self.direction.iter_mut().zip(hg).for_each(|(d, hg)| *d = -hg);
            return;
        }
        let quotients = Quotients { sy, yw, h: yw / sy, b: sbs / sy };
        let (theta, tau) = choose(self.update, &quotients, self.updates == 0, self.s.len());
        let update = rank_two(&quotients, theta, tau);
        let (sg, wg) = (vector::dot(&self.s, g), vector::dot(hy, g));
        let (to_s, to_w) = (update.a * sg + update.b * wg, update.b * sg + update.c * wg);
        for (i, d) in self.direction.iter_mut().enumerate() {
            *d = -(update.scale * hg[i] + to_s * self.s[i] + to_w * hy[i]);
        }
        self.inverse.update(update, &self.s);
        self.updates += 1;
    }

    /// Without a better point: forgets the curvature, or gives up where there was none to forget.
    fn refuse(&mut self, fault: Option<Fault>) -> Result<Verdict, Fault> {
        let fresh = self.updates == 0;
        if self.loss.is_some() {
            self.reset();
        }
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

impl<O: Objective<f64> + ?Sized> Method<f64, O> for Broyden {
    fn name(&self) -> &'static str {
        self.update.name()
    }

    fn theta(&self) -> &[f64] {
        &self.theta
    }

    fn step(&mut self, objective: &mut O) -> Result<Step, Fault> {
        let loss = match self.start(objective) {
            Ok(loss) => loss,
            Err(fault) => {
                let verdict = self.refuse(Some(fault))?;
                return Ok(self.report(f64::INFINITY, 0.0, 1, verdict));
            }
        };
        let mut slope = vector::dot(&self.direction, &self.gradient);
        if slope >= 0.0 || !slope.is_finite() {
            self.reset();
            slope = vector::dot(&self.direction, &self.gradient);
        }
        if slope == 0.0 {
            return Ok(self.report(0.0, 0.0, 0, Verdict::Exhausted));
        }
        let norm = vector::norm(&self.direction);
        let first = self.first_trial(norm, slope);
        let found = self.search.run(objective, &self.theta, &self.direction, (loss, slope), first);
        match found {
            Found::Better { step, loss, evaluations } => {
                self.accept(loss, step);
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
        State::new(self.update.name())
            .with("theta", &self.theta)
            .with("gradient", &self.gradient)
            .with("direction", &self.direction)
            .with("loss", self.loss.as_slice())
            .with("decrease", &[self.decrease])
            .with("inverse", &self.inverse.export())
            .with_counter("updates", self.updates)
            .with_counter("faults", self.faults)
    }

    fn restore(&mut self, state: &State) -> Result<(), Fault> {
        state.check_method(self.update.name())?;
        let len = self.theta.len();
        let theta = state.sized("theta", len)?;
        let gradient = state.sized("gradient", len)?;
        let direction = state.sized("direction", len)?;
        let loss = state.vector("loss")?.first().copied();
        let (updates, faults) = (state.counter("updates")?, state.counter("faults")?);
        let [decrease] = state.scalars("decrease")?;
        if !self.inverse.import(state.vector("inverse")?) {
            return Err(Fault::state("inverse"));
        }
        (self.theta, self.gradient, self.direction, self.loss) = (theta, gradient, direction, loss);
        (self.updates, self.faults, self.decrease) = (updates, faults, decrease);
        Ok(())
    }
}
