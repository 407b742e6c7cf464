//! What equations and conditions leave open where nothing is measured: no error bars say so there.
//!
//! A little stiffness is given to every coefficient, just above what rounding gives to it. What equations and conditions determine does
//! not mind how little; deviations of what they leave open go with its root.

use super::solver::Solver;
use super::state::State;
use crate::local::draws::{Deviations, Draws};
use crate::schema;
use crate::solve::driver::{Warning, WarningKind};
use crate::solve::vector::{largest, root_mean_square};
use crate::tolerance::LOOSE;
use crate::units::Number;

/// Stiffness of every coefficient beside its own, and ten times that.
const LIFTS: [f64; 2] = [1e-13, 1e-12];
/// How much a field's deviations may fall from the one to the other. Where it is open they fall by the root of ten.
const FALL: f64 = 2.2;
/// Size of an equation's terms over the natural one up to which it is zero.
const ZERO: f64 = 1e-4;
/// Deviation of a field over how much it varies from which on it is open too, where equations are off by [`LOOSE`].
const OPEN: f64 = 0.5;

impl Solver<'_> {
    /// The fields of an answer that may be otherwise, and where most of all. Cells that are too coarse for it leave more open than the
    /// problem does.
    pub(super) fn undetermined(&mut self, state: &State, is_resolved: bool) -> Vec<Warning> {
        // Beside strict equations rounding would be stiffer than that.
        let loose = State { tolerance: LOOSE, ..state.clone() };
        self.set_sizes_at_rest(state);
        self.set_sigmas(&loose);
        let Some([deviations, stiffer]) = self.lifted(&loose) else { return Vec::new() };
        let (schema, inputs) = (self.schema(), self.schema().coordinates.len());
        let open = |(head, declared): (usize, &schema::Head)| {
            let points = self.some_points(head);
            let points: Vec<&[f64]> = points.chunks_exact(inputs).collect();
            let of = |draws: &Deviations| -> Vec<f64> {
                let of = |point: &&[f64]| root_mean_square(self.heads.drawn(head, point, &draws.coefficients));
                points.iter().map(of).collect()
            };
            let [deviations, stiffer] = [of(&deviations), of(&stiffer)];
            let [soft, stiff] = [&deviations, &stiffer].map(|all| root_mean_square(all.iter().copied()));
            let is_large = is_resolved && soft > OPEN * self.variation(state, head, &points.concat());
            if !is_large && soft <= FALL * stiff {
                return None;
            }
            let most = largest(&deviations);
            let off = self.bound.system.outward(&declared.unit).of(Number::engine(deviations[most]));
            let message = format!(
                "equations and conditions do not determine `{}`: it may be off by about {} at {}; give the conditions that are \
                 missing",
                declared.name,
                format!("{off:.1e} {}", declared.unit.text).trim_end(),
                self.bound.place(points[most]),
            );
            Some(Warning { kind: WarningKind::Undetermined, message })
        };
        schema.heads.iter().enumerate().filter_map(open).collect()
    }

    /// Gives terms of what is at rest a size: their natural one, which is smaller where all fields vary little.
    fn set_sizes_at_rest(&mut self, state: &State) {
        let share = |head: usize| self.variation(state, head, &self.some_points(head)) / self.heads.scale[head];
        let share = (0..self.schema().heads.len()).map(share).fold(0.0, f64::max).min(1.0);
        let terms = self.schema().groups.iter().zip(&self.bound.sizes);
        for (own, (term, natural)) in self.sizes.iter_mut().zip(terms.map(|(group, natural)| (group.terms, natural))) {
            for (term, natural) in term.iter().zip(natural) {
                let rows = own[term.first..term.first + term.rows].iter_mut();
                rows.filter(|size| **size < ZERO * natural).for_each(|size| *size = share * natural);
            }
        }
    }

    /// Deviations of all unknowns about a state, with little stiffness of their own and with more of it.
    fn lifted(&mut self, state: &State) -> Option<[Deviations; 2]> {
        let slopes = self.set_learned(&state.learned);
        let mut with = |lift: f64| {
            self.normal.draws = Some(Draws::new(state.theta.len(), state.learned.len()));
            let assembled = self.assemble(state, &slopes);
            self.normal.lift(lift);
            let draws = self.normal.draws.take()?;
            assembled.ok()?;
            self.normal.factor()?.deviations(&draws)
        };
        Some([with(LIFTS[0])?, with(LIFTS[1])?])
    }
}
