//! Functions with known minima, shared by the tests of the solvers.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub(crate) mod rows;

use nisp_runtime::solve::fault::Fault;
use nisp_runtime::solve::objective::Objective;

type Evaluate = Box<dyn FnMut(&[f64]) -> (f64, Vec<f64>)>;

type Refresh = Box<dyn FnMut(&[f64]) -> bool>;

/// A function given by its value and gradient.
pub(crate) struct Function {
    len: usize,
    evaluate: Evaluate,
    /// Evaluations so far.
    pub(crate) evaluations: usize,
    /// Evaluations that report a fault.
    pub(crate) faulty: Vec<usize>,
    /// What to do at a new iterate; true where the function has changed.
    pub(crate) on_accepted: Option<Refresh>,
}

impl Function {
    pub(crate) fn new(len: usize, evaluate: impl FnMut(&[f64]) -> (f64, Vec<f64>) + 'static) -> Self {
        Self { len, evaluate: Box::new(evaluate), evaluations: 0, faulty: Vec::new(), on_accepted: None }
    }
}

impl Objective<f64> for Function {
    fn len(&self) -> usize {
        self.len
    }

    fn value(&mut self, theta: &[f64]) -> Result<f64, Fault> {
        let mut gradient = vec![0.0; self.len];
        self.gradient(theta, &mut gradient)
    }

    fn gradient(&mut self, theta: &[f64], gradient: &mut [f64]) -> Result<f64, Fault> {
        self.evaluations += 1;
        if self.faulty.contains(&self.evaluations) {
            gradient.fill(f64::NAN);
            return Err(Fault::residual("balance", Some(17)));
        }
        let (value, g) = (self.evaluate)(theta);
        gradient.copy_from_slice(&g);
        if value.is_finite() { Ok(value) } else { Err(Fault::residual("balance", Some(3))) }
    }

    fn accepted(&mut self, theta: &[f64]) -> bool {
        self.on_accepted.as_mut().is_some_and(|refresh| refresh(theta))
    }
}

/// The same function in single precision.
pub(crate) struct Narrow(pub Function);

impl Objective<f32> for Narrow {
    fn len(&self) -> usize {
        self.0.len
    }

    fn value(&mut self, theta: &[f32]) -> Result<f64, Fault> {
        let wide: Vec<f64> = theta.iter().map(|x| f64::from(*x)).collect();
        self.0.value(&wide).map(|x| f64::from(x as f32))
    }

    fn gradient(&mut self, theta: &[f32], gradient: &mut [f32]) -> Result<f64, Fault> {
        let wide: Vec<f64> = theta.iter().map(|x| f64::from(*x)).collect();
        let mut g = vec![0.0; wide.len()];
        let value = self.0.gradient(&wide, &mut g)?;
        gradient.iter_mut().zip(g).for_each(|(out, g)| *out = g as f32);
        Ok(f64::from(value as f32))
    }
}

/// Extended Rosenbrock function; minimum 0 at ones.
pub(crate) fn rosenbrock(len: usize) -> Function {
    Function::new(len, |x| {
        let mut value = 0.0;
        let mut g = vec![0.0; x.len()];
        for i in (0..x.len()).step_by(2) {
            let (a, b) = (1.0 - x[i], x[i + 1] - x[i] * x[i]);
            value += a * a + 100.0 * b * b;
            g[i] = -2.0 * a - 400.0 * b * x[i];
            g[i + 1] = 200.0 * b;
        }
        (value, g)
    })
}

/// `sum_i k_i (x_i - 1 / (1 + i))^2 / 2` with `k_i` from 1 to `condition`.
pub(crate) fn quadratic(len: usize, condition: f64) -> Function {
    Function::new(len, move |x| {
        let mut value = 0.0;
        let mut g = vec![0.0; x.len()];
        for i in 0..x.len() {
            let k = condition.powf(i as f64 / (len - 1) as f64);
            let d = x[i] - 1.0 / (1.0 + i as f64);
            value += 0.5 * k * d * d;
            g[i] = k * d;
        }
        (value, g)
    })
}

/// `sum_i k_i (z_i^2 / 2 + z_i^4 / 4)`, `z` the coordinates reflected at the plane orthogonal to (1, 1, ...).
pub(crate) fn quartic(len: usize, condition: f64) -> Function {
    let reflect = move |x: &[f64]| -> Vec<f64> {
        let mean = 2.0 * x.iter().sum::<f64>() / len as f64;
        x.iter().map(|x| x - mean).collect()
    };
    Function::new(len, move |x| {
        let z = reflect(x);
        let mut value = 0.0;
        let mut g = vec![0.0; len];
        for i in 0..len {
            let k = condition.powf(i as f64 / (len - 1) as f64);
            value += k * (0.5 * z[i] * z[i] + 0.25 * z[i].powi(4));
            g[i] = k * (z[i] + z[i].powi(3));
        }
        (value, reflect(&g))
    })
}
