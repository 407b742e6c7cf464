//! Matrix-free Gauss-Newton: the damped normal equations by conjugate gradients, from products `J v` and `J^T u` alone.
//!
//! For networks too wide for a Jacobian in memory. The inner iteration stops when the quadratic model no longer
//! improves (Martens 2010, Deep learning via Hessian-free optimization), which is long before the linear system is
//! solved; the damping is controlled as in [`super::marquardt`].

use super::damping::Damping;
use super::fault::Fault;
use super::method::{FAULTS_IN_A_ROW, Method, Step, Verdict};
use super::objective::LeastSquares;
use super::prior::WeightPrior;
use super::state::State;
use super::vector;

/// Inner iterations over which the model must improve by [`PROGRESS`].
const WINDOW: usize = 10;
/// Least relative improvement of the model over a window.
const PROGRESS: f64 = 5e-3;

/// Gauss-Newton by conjugate gradients, preconditioned by the diagonal of `J^T J` where the objective has it.
pub struct GaussNewton {
    theta: Vec<f64>,
    trial: Vec<f64>,
    rows: Vec<f64>,
    trial_rows: Vec<f64>,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    /// `D`
    scale: Vec<f64>,
    /// `A`
    precision: Vec<f64>,
    inner: Inner,
    prior: WeightPrior,
    most: usize,
    loss: Option<f64>,
    damping: Damping,
    faults: u64,
}

/// Vectors of the inner iteration.
struct Inner {
    residual: Vec<f64>,
    search: Vec<f64>,
    product: Vec<f64>,
    rows: Vec<f64>,
    /// Values of the model, in a ring.
    models: [f64; WINDOW],
}

impl GaussNewton {
    /// Starts at `theta`, with at most `most` inner iterations a step (100 is a good number).
    pub fn new(theta: Vec<f64>, prior: WeightPrior, most: usize) -> Self {
        let zeros = || vec![0.0; theta.len()];
        let mut precision = zeros();
        prior.write_diagonal(&mut precision);
        let inner =
            Inner { residual: zeros(), search: zeros(), product: zeros(), rows: Vec::new(), models: [0.0; WINDOW] };
        Self {
            trial: zeros(),
            rows: Vec::new(),
            trial_rows: Vec::new(),
            gradient: zeros(),
            direction: zeros(),
            scale: zeros(),
            precision,
            inner,
            prior,
            most: most.max(1),
            loss: None,
            damping: Damping::new(1e-3),
            faults: 0,
            theta,
        }
    }

    /// Rows and gradient at theta, and the scale of the parameters, unless they are known.
    fn linearise<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) -> Result<f64, Fault> {
        if let Some(loss) = self.loss {
            return Ok(loss);
        }
        for rows in [&mut self.rows, &mut self.trial_rows, &mut self.inner.rows] {
            rows.resize(objective.rows(), 0.0);
        }
        let loss = objective.residuals(&self.theta, &mut self.rows)? + self.prior.value(&self.theta);
        objective.vector_jacobian(&self.theta, &self.rows, &mut self.gradient)?;
        self.prior.add_gradient(&self.theta, &mut self.gradient);
        if !objective.diagonal(&self.theta, &mut self.scale)? {
            // The curvature along the gradient, for all parameters alike.
            objective.jacobian_vector(&self.theta, &self.gradient, &mut self.inner.rows)?;
            let square = vector::dot(&self.inner.rows, &self.inner.rows);
            self.scale.fill(square / vector::dot(&self.gradient, &self.gradient));
        }
        let largest = self.scale.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        self.scale.iter_mut().for_each(|d| *d = d.max(1e-12 * largest));
        Ok(*self.loss.insert(loss))
    }

    /// `product = (J^T J + A + lambda D) search`
    fn multiply<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) -> Result<(), Fault> {
        let Inner { search, product, rows, .. } = &mut self.inner;
        objective.jacobian_vector(&self.theta, search, rows)?;
        objective.vector_jacobian(&self.theta, rows, product)?;
        let factor = self.damping.factor();
        for i in 0..product.len() {
            product[i] += (self.precision[i] + factor * self.scale[i]) * search[i];
        }
        Ok(())
    }

    /// `search = preconditioned residual + beta * search`; gives the product of the residual with its preconditioned
    /// self.
    fn turn(&mut self, before: Option<f64>) -> f64 {
        let factor = 1.0 + self.damping.factor();
        let Inner { residual, search, product, .. } = &mut self.inner;
        // The product is not needed any more and lends its memory.
        for (i, z) in product.iter_mut().enumerate() {
            *z = residual[i] / (factor * self.scale[i] + self.precision[i]);
        }
        let now = vector::dot(residual, product);
        let beta = before.map_or(0.0, |before| now / before);
        search.iter_mut().zip(product).for_each(|(d, z)| *d = *z + beta * *d);
        now
    }

    /// Conjugate gradients for the direction; gives the decrease of the damped model.
    fn aim<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) -> Result<f64, Fault> {
        self.direction.fill(0.0);
        self.inner.residual.iter_mut().zip(&self.gradient).for_each(|(r, g)| *r = -g);
        self.inner.search.fill(0.0);
        let mut weight = self.turn(None);
        let mut model = 0.0;
        for iteration in 0..self.most {
            self.multiply(objective)?;
            let Inner { residual, search, product, models, .. } = &mut self.inner;
            let curvature = vector::dot(search, product);
            if curvature <= 0.0 || weight <= 0.0 {
                break;
            }
            let step = weight / curvature;
            vector::add_scaled(&mut self.direction, step, search);
            vector::add_scaled(residual, -step, product);
            model = 0.5 * (vector::dot(residual, &self.direction) - vector::dot(&self.gradient, &self.direction));
            let earlier = std::mem::replace(&mut models[iteration % WINDOW], model);
            if iteration >= WINDOW && model - earlier < PROGRESS * model {
                break;
            }
            weight = self.turn(Some(weight));
        }
        Ok(model)
    }

    fn refuse(&mut self, fault: Fault) -> Result<Step, Fault> {
        self.faults += 1;
        if self.faults >= FAULTS_IN_A_ROW {
            return Err(fault);
        }
        self.damping.alarm();
        Ok(self.report(f64::INFINITY, 0.0, Verdict::Faulty(fault)))
    }

    fn report(&self, decrement: f64, length: f64, verdict: Verdict) -> Step {
        Step {
            loss: self.loss.unwrap_or(f64::INFINITY),
            gradient_norm: vector::norm(&self.gradient),
            decrement: Some(decrement),
            length,
            evaluations: 1,
            verdict,
        }
    }

    /// One step, with faults passed on.
    fn attempt<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) -> Result<Step, Fault> {
        let loss = self.linearise(objective)?;
        if self.gradient.iter().all(|g| *g == 0.0) {
            return Ok(self.report(0.0, 0.0, Verdict::Exhausted));
        }
        let model = self.aim(objective)?;
        let square: f64 = self.direction.iter().zip(&self.scale).map(|(p, d)| p * p * d).sum();
        let predicted = model + 0.5 * self.damping.factor() * square;
        vector::along(&mut self.trial, &self.theta, 1.0, &self.direction);
        let rows = objective.residuals(&self.trial, &mut self.trial_rows)?;
        let trial_loss = rows + self.prior.value(&self.trial);
        self.faults = 0;
        let ratio = (loss - trial_loss) / predicted;
        if trial_loss >= loss || ratio < 1e-4 {
            let lost = predicted <= f64::EPSILON * loss || self.damping.is_exhausted();
            self.damping.raise();
            let verdict = if lost { Verdict::Exhausted } else { Verdict::Refused };
            return Ok(self.report(model, 0.0, verdict));
        }
        self.damping.reward(ratio);
        std::mem::swap(&mut self.theta, &mut self.trial);
        self.loss = None;
        let changed = objective.accepted(&self.theta);
        let verdict = if changed { Verdict::Changed } else { Verdict::Moved };
        let mut step = self.report(model, vector::norm(&self.direction), verdict);
        step.loss = trial_loss;
        Ok(step)
    }
}

impl<O: LeastSquares + ?Sized> Method<f64, O> for GaussNewton {
    fn name(&self) -> &'static str {
        "gauss-newton"
    }

    fn theta(&self) -> &[f64] {
        &self.theta
    }

    fn step(&mut self, objective: &mut O) -> Result<Step, Fault> {
        self.attempt(objective).or_else(|fault| self.refuse(fault))
    }

    fn prior(&self) -> Option<&WeightPrior> {
        Some(&self.prior)
    }

    fn save(&self) -> State {
        State::new("gauss-newton")
            .with("theta", &self.theta)
            .with("damping", &self.damping.save())
            .with_counter("faults", self.faults)
    }

    fn restore(&mut self, state: &State) -> Result<(), Fault> {
        state.check_method("gauss-newton")?;
        let theta = state.sized("theta", self.theta.len())?;
        let damping = Damping::restore(state.scalars("damping")?);
        let faults = state.counter("faults")?;
        (self.theta, self.damping, self.faults) = (theta, damping, faults);
        // Rows and gradient follow from theta, to the bit.
        self.loss = None;
        Ok(())
    }
}
