//! Whether the lattice resolves the answer: what a coarser one makes of the same problem.
//!
//! Equations hold to within their tolerance on any lattice, so rows cannot tell. Where an equation magnifies the error of the
//! splines, as that of a body that hardly changes its volume does in displacements alone, the answer moves with the lattice
//! instead.

use super::Local;
use super::heads::Heads;
use super::phase::CONVEX_STEPS;
use super::place::State;
use super::solver::Solver;
use crate::problem::Bound;
use crate::schema;
use crate::solve::driver::{Warning, WarningKind};

/// How much coarser.
const COARSER: f64 = 1.5;
/// What the comparison takes, in steps on the finer lattice.
pub(super) const COST: f64 = 2.0;
/// Change of a field, beside its size, above which it is not resolved.
const MOST: f64 = 1e-2;

/// Says which fields of a state move with its lattice: a step is taken from the answer on a coarser one. Nothing where that cannot be
/// taken.
pub(super) fn unresolved(bound: &Bound, settings: &Local, heads: &Heads, state: &State) -> Option<Warning> {
    let (cells, fewer) = (settings.cells, (settings.cells as f64 / COARSER).round() as usize);
    let mut coarse = Solver::new(bound, settings, fewer).ok()?;
    let start = coarse.taken_over(heads, state).ok()?.state;
    let (found, _) = coarse.step(&start, CONVEX_STEPS + 1, false, &[]).ok()?;
    let leading = leading(bound);
    let changes: Vec<(&str, f64)> = leading
        .iter()
        .map(|(_, head)| {
            let alike = leading.iter().filter(|(_, other)| other.unit.exponents == head.unit.exponents);
            (head.name, change_of(alike.map(|(at, _)| *at), (heads, state), (&coarse, &found)))
        })
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
fn leading(bound: &Bound) -> Vec<(usize, &'static schema::Head)> {
    let schema = bound.problem.scene().schema;
    let order = |head: usize| {
        let jets = schema.groups.iter().flat_map(|group| group.jets).filter(|jet| jet.head == head);
        jets.map(|jet| jet.degree.iter().sum::<u8>()).max().unwrap_or(0)
    };
    let fields = || schema.heads.iter().enumerate().filter(|(_, head)| !head.source);
    let highest = fields().map(|(at, _)| order(at)).max();
    fields().filter(|(at, _)| Some(order(*at)) == highest).collect()
}

/// By how much fields of one dimension change on another lattice, beside their size: components of a vector are judged together.
/// What a cloud's noise would hide is no change.
fn change_of(
    fields: impl Iterator<Item = usize>,
    (heads, state): (&Heads, &State),
    (other, found): (&Solver, &State),
) -> f64 {
    let schema = other.bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let (mut change, mut size, mut count, mut is_length) = (0.0, 0.0, 0.0, false);
    for at in fields {
        is_length |= schema.heads[at].unit.exponents == schema.coordinates[0].unit.exponents;
        let groups = schema.groups.iter().zip(&other.bound.coordinates);
        for (_, points) in groups.filter(|(group, _)| group.jets.iter().any(|jet| jet.head == at)) {
            for point in points.chunks_exact(inputs) {
                let value = heads.value(at, point, &state.theta);
                change += (other.heads.value(at, point, &found.theta) - value).powi(2);
                size += value * value;
                count += 1.0;
            }
        }
    }
    let noise = if is_length && !other.surfaces.is_empty() { state.noise } else { 0.0 };
    if change > noise * noise * count { (change / size).sqrt() } else { 0.0 }
}
