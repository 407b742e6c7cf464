//! Line search for the strong Wolfe conditions: bracketing, then zooming in by cubic interpolation (Nocedal and
//! Wright, Numerical Optimization, algorithms 3.5 and 3.6).
//!
//! Where differences of the loss drown in rounding, the approximate Wolfe conditions of Hager and Zhang (2005) take over:
//! they compare slopes, which stay accurate long after the losses are equal.

use super::fault::Fault;
use super::objective::Objective;
use super::vector;
use crate::real::Real;

/// Least decrease, as a share of what the slope promises.
const DECREASE: f64 = 1e-4;
/// Most slope left, as a share of the slope at the start.
const CURVATURE: f64 = 0.9;
/// Evaluations before giving up.
const EVALUATIONS: usize = 25;
/// Growth of the step while the slope is still downhill.
const EXPANSION: f64 = 4.0;

/// Buffers of a search; after a success they hold the point that was found.
pub(crate) struct LineSearch<E> {
    /// The accepted point.
    pub(crate) theta: Vec<E>,
    /// Its gradient.
    pub(crate) gradient: Vec<E>,
    trial_theta: Vec<E>,
    trial_gradient: Vec<E>,
}

/// How a search ended.
pub(crate) enum Found {
    /// A better point.
    Better {
        /// Multiple of the direction.
        step: f64,
        /// Loss there.
        loss: f64,
        /// Evaluations spent.
        evaluations: usize,
    },
    /// No better point along the direction; with the last fault met, if any.
    Nothing {
        /// The last fault.
        fault: Option<Fault>,
        /// Evaluations spent.
        evaluations: usize,
    },
}

/// A point on the line; a faulty one has an infinite loss.
#[derive(Clone, Copy)]
struct Point {
    step: f64,
    loss: f64,
    slope: f64,
}

/// The line and what has been seen on it.
struct Line<'a, E: Real, O: ?Sized> {
    origin: &'a [E],
    direction: &'a [E],
    start: Point,
    objective: &'a mut O,
    buffers: &'a mut LineSearch<E>,
    /// Best point so far with a sufficient decrease; its position and gradient are in the buffers.
    best: Option<Point>,
    evaluations: usize,
    fault: Option<Fault>,
}

impl<E: Real> LineSearch<E> {
    pub(crate) fn new(len: usize) -> Self {
        let zeros = || vec![E::ZERO; len];
        Self { theta: zeros(), gradient: zeros(), trial_theta: zeros(), trial_gradient: zeros() }
    }

    /// Searches from `origin`, where the objective is `loss` and its derivative along `direction` is `slope < 0`,
    /// trying the multiple `first` of `direction` first.
    pub(crate) fn run<O: Objective<E> + ?Sized>(
        &mut self,
        objective: &mut O,
        origin: &[E],
        direction: &[E],
        (loss, slope): (f64, f64),
        first: f64,
    ) -> Found {
        let start = Point { step: 0.0, loss, slope };
        let mut line =
            Line { origin, direction, start, objective, buffers: self, best: None, evaluations: 0, fault: None };
        line.bracket(first);
        let (evaluations, fault) = (line.evaluations, line.fault);
        match line.best {
            Some(Point { step, loss, .. }) => Found::Better { step, loss, evaluations },
            None => Found::Nothing { fault, evaluations },
        }
    }
}

impl<E: Real, O: Objective<E> + ?Sized> Line<'_, E, O> {
    /// Expands the step until a minimum is bracketed, then zooms in. The result is in `best`.
    fn bracket(&mut self, first: f64) {
        let mut low = self.start;
        let mut step = first;
        while self.evaluations < EVALUATIONS {
            let (point, done) = self.evaluate(step);
            if done {
                return;
            }
            if !self.decreases(point) || (self.evaluations > 1 && point.loss > low.loss) {
                return self.zoom(low, point);
            }
            if point.slope >= 0.0 {
                return self.zoom(point, low);
            }
            low = point;
            step *= EXPANSION;
        }
    }

    /// Shrinks the interval between `low`, which decreases sufficiently and points towards `high`, and `high`.
    fn zoom(&mut self, mut low: Point, mut high: Point) {
        let mut width = (high.step - low.step).abs();
        while self.evaluations < EVALUATIONS {
            let mut step = interpolate(low, high);
            // An interval that cubics do not halve is halved.
            if (high.step - low.step).abs() > 0.66 * width {
                step = 0.5 * (low.step + high.step);
            }
            width = (high.step - low.step).abs();
            if width <= f64::EPSILON * low.step.max(high.step) {
                return;
            }
            let (point, done) = self.evaluate(step);
            if done {
                return;
            }
            if !self.decreases(point) || point.loss > low.loss {
                high = point;
            } else {
                if point.slope * (high.step - low.step) >= 0.0 {
                    high = low;
                }
                low = point;
            }
        }
    }

    /// Evaluates a step, remembers it where it is the best so far, and says whether it satisfies the conditions.
    fn evaluate(&mut self, step: f64) -> (Point, bool) {
        self.evaluations += 1;
        let buffers = &mut *self.buffers;
        vector::along(&mut buffers.trial_theta, self.origin, step, self.direction);
        let point = match self.objective.gradient(&buffers.trial_theta, &mut buffers.trial_gradient) {
            Ok(loss) => Point { step, loss, slope: vector::dot(&buffers.trial_gradient, self.direction) },
            Err(fault) => {
                self.fault = Some(fault);
                Point { step, loss: f64::INFINITY, slope: f64::INFINITY }
            }
        };
        let done = self.satisfies(point);
        if done || (self.decreases(point) && self.best.is_none_or(|best| point.loss < best.loss)) {
            self.best = Some(point);
            std::mem::swap(&mut self.buffers.theta, &mut self.buffers.trial_theta);
            std::mem::swap(&mut self.buffers.gradient, &mut self.buffers.trial_gradient);
        }
        (point, done)
    }

    fn decreases(&self, point: Point) -> bool {
        point.loss <= self.start.loss + DECREASE * point.step * self.start.slope && point.loss < self.start.loss
    }

    fn satisfies(&self, point: Point) -> bool {
        let slope = self.start.slope;
        let wolfe = self.decreases(point) && point.slope.abs() <= -CURVATURE * slope;
        // Small residuals are differences of large numbers: the rounding of their squares is far more than that of one sum.
        let noise = E::EPSILON.to_f64().sqrt() * self.start.loss.abs();
        let approximate = point.loss <= self.start.loss + noise
            && (2.0 * DECREASE - 1.0) * slope >= point.slope
            && point.slope >= CURVATURE * slope;
        wolfe || approximate
    }
}

/// Minimum of the cubic through two points with their slopes, kept a tenth of the interval away from its ends.
fn interpolate(low: Point, high: Point) -> f64 {
    let width = high.step - low.step;
    let middle = low.step + 0.5 * width;
    if !high.loss.is_finite() || !high.slope.is_finite() {
        return low.step + 0.1 * width;
    }
    let d1 = low.slope + high.slope - 3.0 * (high.loss - low.loss) / width;
    let square = d1 * d1 - low.slope * high.slope;
    if square < 0.0 {
        return middle;
    }
    let d2 = square.sqrt() * width.signum();
    let step = high.step - width * (high.slope + d2 - d1) / (high.slope - low.slope + 2.0 * d2);
    let share = (step - low.step) / width;
    if share.is_finite() { low.step + share.clamp(0.1, 0.9) * width } else { middle }
}
