//! Whether the lattice resolves the answer: what a coarser one makes of the same problem.
//!
//! Equations hold to within their tolerance on any lattice, so rows cannot tell. Where an equation magnifies the error of the
//! splines, as that of a body that hardly changes its volume does in displacements alone, the answer moves with the lattice
//! instead.

use super::phase::CONVEX_STEPS;
use super::place::State;
use super::solver::Solver;
use crate::schema;
use crate::solve::driver::{Warning, WarningKind};

/// How much coarser.
const COARSER: f64 = 1.5;
/// What it takes, in steps on the finer lattice.
pub(super) const COST: f64 = 2.0;
/// Change of a field, beside its size, above which it is not resolved.
const MOST: f64 = 1e-2;

impl Solver {
    /// Says which fields move with the lattice, of which `cells` are along the longest coordinate: a step from the answer on a
    /// coarser one. Nothing where that cannot be taken.
    pub(super) fn unresolved(&self, state: &State, cells: usize) -> Option<Warning> {
        let fewer = (cells as f64 / COARSER).round() as usize;
        let mut coarse = Solver::new(&self.bound, &self.settings, fewer).ok()?;
        let start = coarse.taken_over(&self.heads, state).ok()?.state;
        let (found, _) = coarse.step(&start, CONVEX_STEPS + 1, false, &[]).ok()?;
        let changes: Vec<(&str, f64)> = self
            .leading()
            .into_iter()
            .map(|(_, head)| (head.name, self.change_of(head, state, &coarse, &found)))
            .filter(|(_, share)| *share > MOST)
            .collect();
        let worst = changes.iter().map(|(_, share)| *share).reduce(f64::max)?;
        let names: Vec<String> = changes.iter().map(|(name, _)| format!("`{name}`")).collect();
        let message = format!(
            "{} {} not resolved: a lattice of {fewer} cells instead of {cells} gives values that are {:.0} % of their size \
             away; take more cells, and where a body hardly changes its volume declare its pressure as a field",
            names.join(", "),
            if names.len() == 1 { "is" } else { "are" },
            100.0 * worst,
        );
        Some(Warning { kind: WarningKind::Unresolved, message })
    }

    /// The fields that are differentiated most often: a pressure beside them is a multiplier, and less accurate by an order.
    fn leading(&self) -> Vec<(usize, &'static schema::Head)> {
        let schema = self.bound.problem.scene().schema;
        let order = |head: usize| {
            let jets = schema.groups.iter().flat_map(|group| group.jets).filter(|jet| jet.head == head);
            jets.map(|jet| jet.degree.iter().sum::<u8>()).max().unwrap_or(0)
        };
        let fields = || schema.heads.iter().enumerate().filter(|(_, head)| !head.source);
        let highest = fields().map(|(at, _)| order(at)).max();
        fields().filter(|(at, _)| Some(order(*at)) == highest).collect()
    }

    /// By how much fields of the dimension of `head` change on another lattice, beside their size: components of a vector are
    /// judged together. What a cloud's noise would hide is no change.
    fn change_of(&self, head: &schema::Head, state: &State, other: &Solver, found: &State) -> f64 {
        let schema = self.bound.problem.scene().schema;
        let inputs = schema.coordinates.len();
        let (mut change, mut size, mut count) = (0.0, 0.0, 0.0);
        for (at, _) in self.leading().into_iter().filter(|(_, alike)| alike.unit.exponents == head.unit.exponents) {
            let groups = schema.groups.iter().zip(&self.bound.coordinates);
            for (_, points) in groups.filter(|(group, _)| group.jets.iter().any(|jet| jet.head == at)) {
                for point in points.chunks_exact(inputs) {
                    let value = self.heads.value(at, point, &state.theta);
                    change += (other.heads.value(at, point, &found.theta) - value).powi(2);
                    size += value * value;
                    count += 1.0;
                }
            }
        }
        let is_length = head.unit.exponents == schema.coordinates[0].unit.exponents;
        let noise = if is_length && !self.surfaces.is_empty() { state.noise } else { 0.0 };
        if change > noise * noise * count { (change / size).sqrt() } else { 0.0 }
    }
}
