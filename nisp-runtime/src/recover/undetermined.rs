//! What the data do not determine, said in the user's words.
//!
//! The Laplace posterior of every head has a leading direction. Where nearly all of the head's variance lies along it, and
//! it is not small beside the head itself, or most of the variance and it is larger than the head, the direction is open: multiples of it may be added to the answer, and only the
//! prior says how much. A condition that closes a direction which is open without it is named too.

use super::place::place;
use super::weigh::FEW_ROWS;
use crate::engine::Engine;
use crate::network::Architecture;
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::solve::curvature::Curvature;
use crate::solve::driver::{Warning, WarningKind};
use crate::solve::objective::LeastSquares;
use crate::solve::posterior::{Direction, directions};
use crate::solve::prior::WeightPrior;

/// Points that directions are looked at, at most.
const SAMPLE: usize = 64;

/// Share of a head's variance that an open direction has at least, and standard deviation along it at least, beside the head
/// itself: one that stands alone, or one that drowns the head.
const OPEN: [(f64, f64); 2] = [(0.99, 0.05), (0.9, 1.0)];

/// A place to look from: the solution, with rows over their standard deviations.
pub(super) struct View<'a> {
    pub(super) bound: &'a Bound,
    pub(super) engine: &'a mut Engine<f64>,
    pub(super) theta: &'a [f64],
    pub(super) prior: &'a WeightPrior,
    pub(super) architecture: Architecture,
}

/// An open direction of a head.
struct Open {
    head: usize,
    direction: Direction,
}

impl View<'_> {
    /// How many curvatures [`View::warnings`] looks at, at most.
    pub(super) fn curvatures(&self) -> usize {
        1 + (0..self.engine.blocks().len()).filter(|&block| self.condition(block).is_some()).count()
    }

    /// Directions that are open, and conditions that close directions which are open without them.
    pub(super) fn warnings(&mut self) -> Vec<Warning> {
        let points = self.sample();
        let open = self.open(&points);
        let mut warnings: Vec<Warning> = open.iter().map(|open| self.undetermined(open, &points)).collect();
        if !open.is_empty() {
            return warnings;
        }
        for block in 0..self.engine.blocks().len() {
            if let Some(equation) = self.condition(block) {
                let sigma = self.engine.blocks()[block].sigma;
                self.engine.set_sigma(block, f64::INFINITY);
                let without = self.open(&points);
                self.engine.set_sigma(block, sigma);
                warnings.extend(without.iter().map(|open| self.settled(open, &points, block, equation)));
            }
        }
        warnings
    }

    /// The equation of a block, if it is a condition that could be left out.
    fn condition(&self, block: usize) -> Option<&'static str> {
        let terms = self.engine.groups.iter().flat_map(|group| &group.terms);
        let schema = terms.map(|term| term.schema).nth(block)?;
        let few = self.engine.blocks()[block].rows.len() <= FEW_ROWS;
        (few && schema.kind == TermKind::Residual).then_some(schema.equation)
    }

    /// Points of the largest group, in declared units.
    fn sample(&self) -> Vec<f64> {
        let coordinates = self.bound.problem.scene().schema.coordinates;
        let largest = self.bound.coordinates.iter().max_by_key(|points| points.len());
        let points: Vec<&[f64]> = largest.map_or(Vec::new(), |points| points.chunks_exact(coordinates.len()).collect());
        let step = points.len().div_ceil(SAMPLE).max(1);
        let outward = |point: &&[f64]| -> Vec<f64> {
            point.iter().zip(coordinates).map(|(x, c)| x * self.bound.system.outward(&c.unit)).collect()
        };
        points.iter().step_by(step).flat_map(outward).collect()
    }

    /// Open directions of all heads; none where the curvature cannot be had.
    fn open(&mut self, points: &[f64]) -> Vec<Open> {
        let Ok(curvature) = Curvature::at(self.engine, self.theta, self.prior) else { return Vec::new() };
        let mut readout: Engine<f64> = self.bound.readout(self.architecture, points);
        let len = self.theta.len();
        let rows = readout.row_count();
        let (mut values, mut derivatives) = (vec![0.0; rows], vec![0.0; rows * len]);
        if readout.jacobian(self.theta, &mut values, &mut derivatives).is_err() {
            return Vec::new();
        }
        let heads = self.bound.problem.scene().schema.heads.len();
        let points = rows / heads.max(1);
        let of_head = values.chunks_exact(points).zip(derivatives.chunks_exact(points * len)).enumerate();
        of_head
            .filter_map(|(head, (values, derivatives))| {
                let direction = directions(&curvature, derivatives, 1).pop()?;
                let size = values.iter().map(|x| x * x).sum::<f64>().sqrt();
                let is_open =
                    OPEN.iter().any(|(share, large)| direction.share > *share && direction.deviation > large * size);
                is_open.then_some(Open { head, direction })
            })
            .collect()
    }

    fn undetermined(&self, open: &Open, points: &[f64]) -> Warning {
        let scene = self.bound.problem.scene().schema;
        let head = &scene.heads[open.head];
        let peak = open
            .direction
            .shape
            .iter()
            .copied()
            .enumerate()
            .fold((0, 0.0), |peak: (usize, f64), (at, x)| if x.abs() > peak.1.abs() { (at, x) } else { peak });
        let size = open.direction.deviation * peak.1 * self.bound.system.outward(&head.unit);
        let at = place(scene.coordinates, &points[peak.0 * scene.coordinates.len()..]);
        let name = head.name;
        let message = format!(
            "the data do not determine `{name}`: {} may be added to it, by about {size:.2e} {} at {at}, and only the prior \
             decides how much; a condition on `{name}` there would settle it",
            self.shape(open, points),
            head.unit.text,
        );
        Warning { kind: WarningKind::Undetermined, message }
    }

    fn settled(&self, open: &Open, points: &[f64], block: usize, equation: &str) -> Warning {
        let name = self.bound.problem.scene().schema.heads[open.head].name;
        let term = &self.engine.blocks()[block].term;
        let message = format!(
            "`{name}` rests on the condition `{term}: {equation}`: without it {} could be added to `{name}`, and the data \
             would not tell",
            self.shape(open, points),
        );
        Warning { kind: WarningKind::Settled, message }
    }

    /// The direction in words: an exponential where it is one.
    fn shape(&self, open: &Open, points: &[f64]) -> String {
        let scene = self.bound.problem.scene().schema;
        let share = format!("({:.1} % of its variance)", 100.0 * open.direction.share);
        match (scene.coordinates, exponent(points, &open.direction.shape)) {
            ([c], Some(rate)) => format!("a multiple of exp({rate:.3} {}) {share}", c.name),
            _ => format!("one pattern {share}"),
        }
    }
}

/// The rate of an exponential through the values, if they are one to within a few per cent of the largest.
fn exponent(x: &[f64], y: &[f64]) -> Option<f64> {
    const CLOSE: f64 = 0.03;
    let peak = y.iter().copied().fold(0.0, |peak: f64, y| if y.abs() > peak.abs() { y } else { peak });
    // Where it has decayed, what is left may have any sign.
    let high = x.iter().zip(y).filter(|(_, y)| **y / peak > 10.0 * CLOSE).map(|(x, y)| (*x, (*y / peak).ln()));
    let high: Vec<(f64, f64)> = high.collect();
    let count = high.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| high.iter().map(of).sum::<f64>() / count;
    let (mean_x, mean_y) = (mean(&|p| p.0), mean(&|p| p.1));
    let rate = mean(&|p| (p.0 - mean_x) * (p.1 - mean_y)) / mean(&|p| (p.0 - mean_x).powi(2));
    let fit = |x: f64| (mean_y + rate * (x - mean_x)).exp();
    let close = x.len() == y.len() && x.iter().zip(y).all(|(x, y)| (fit(*x) - y / peak).abs() < CLOSE);
    (rate.is_finite() && close).then_some(rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_told_from_other_shapes() {
        let x: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
        let decay: Vec<f64> = x.iter().map(|x| -0.3 * (-2.0 * x).exp() + 0.001 * (9.0 * x).sin()).collect();
        assert!((exponent(&x, &decay).unwrap() + 2.0).abs() < 0.05);
        let wave: Vec<f64> = x.iter().map(|x| 1.5 + x.sin()).collect();
        assert_eq!(exponent(&x, &wave), None);
        assert_eq!(exponent(&x, &x), None);
    }
}
