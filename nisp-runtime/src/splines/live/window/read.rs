//! What the window says of the heads at a place, how well it is known, and how far observations are off.

use super::Window;
use crate::engine::Learned;
use crate::schema::{self, TermKind};
use crate::solve::vector::dot;
use crate::splines::group::Group;
use crate::splines::heads::Heads;
use crate::splines::live::event::Event;
use crate::splines::live::evidence::Weights;
use crate::units::Number;

/// How far a head may be beyond its bounds as a share of its scale: exact data leave it no deviation.
const SLIGHT: f64 = 1e-3;
/// Noise below this share of the data's spread is rounding.
const ROUNDING: f64 = 1e-5;

impl Window {
    /// Learned scalars in their declared units, and their standard deviations.
    pub(in super::super) fn learned(&self) -> Vec<(f64, f64)> {
        let Weights { scalars, spread, by_learned, .. } = &self.weights;
        let schema = self.bound.problem.scene().schema;
        let of = |(at, learned): (usize, &Learned)| {
            let outward = self.bound.system.outward(&schema.scalars[learned.slot].unit);
            let deviation = spread[at * (by_learned.len() + 1)].max(0.0).sqrt() * by_learned[at].abs();
            let [value, deviation] =
                [scalars[learned.slot], deviation].map(|x| outward.of(Number::engine(x)).as_declared());
            (value, deviation)
        };
        self.bound.learned.iter().enumerate().map(of).collect()
    }

    /// A head at a place of the window in the engine's units, and its standard deviation. What the last stretch leaves open of learned
    /// scalars is in it: their values stand in all rows, and the unknowns follow them.
    pub(in super::super) fn read(&mut self, head: usize, at: f64) -> (f64, f64) {
        let local = at - self.grid.left();
        let value = self.heads.derivative(head, (self.heads.cell(local), local), 0, &self.theta);
        let (first, slopes) = self.heads.value_row(head, local);
        let beside = self.all.deviation(first, &slopes, &mut self.scratch);
        let own = first..first + slopes.len();
        let by_learned: Vec<f64> = self.follow.iter().map(|follow| dot(&slopes, &follow[own.clone()])).collect();
        let spread = self.weights.spread.chunks_exact(by_learned.len().max(1));
        let of_learned: f64 = by_learned.iter().zip(spread).map(|(one, row)| one * dot(row, &by_learned)).sum();
        (value, (beside * beside + of_learned.max(0.0)).sqrt())
    }

    /// A head's value within its bounds, and how far it is beyond them, over its deviation and rounding. Steps do not keep bounds: where a
    /// head is at one of them noise puts it beyond now and then, and no farther than that.
    pub(in super::super) fn within(&self, head: usize, (value, deviation): (f64, f64)) -> (f64, f64) {
        let within = self.heads.limits[head].map_or(value, |limits| limits.within(value));
        (within, (within - value).abs() / deviation.max(SLIGHT * self.heads.scale[head]))
    }

    /// Gives how far each observation of an event is off, over the noise of neighbours; over that of the fit where neighbours are
    /// too far apart to say. Other splines than the window's, and their coefficients, may be given for what the heads are.
    pub(in super::super) fn misfits(&self, event: &Event, other: Option<(&Heads, &[f64])>, take: &mut dyn FnMut(f64)) {
        let own = || (&self.heads, &self.theta[..], self.grid.left());
        let (heads, theta, zero) = other.map_or_else(own, |(heads, theta)| (heads, theta, 0.0));
        let schema = &self.bound.problem.scene().schema.groups[event.group];
        let columns: Vec<Vec<f64>> = event.columns.iter().map(|&x| vec![x]).collect();
        let place = [event.at - zero];
        let mut group = Group::new(schema, self.kernels[event.group], heads, &place, &columns);
        group.begin_at(&place, zero);
        let found = group.evaluate(heads, theta, &self.weights.scalars, None);
        let is_observed = |term: &schema::Term| term.kind == TermKind::Observation && event.measures(term);
        for (number, term) in schema.terms.iter().enumerate().filter(|(_, term)| is_observed(term)) {
            let told = self.weights.noise.of(event.group, number);
            let told = told.map(|noise| noise.deviation.max(ROUNDING * noise.spread));
            for row in term.first..term.first + term.rows {
                let misfit = found.row(row, 0) / told.unwrap_or(self.weights.sigma[event.group][row]);
                take(if misfit.is_nan() { f64::INFINITY } else { misfit });
            }
        }
    }
}
