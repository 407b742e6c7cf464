//! Measurements at places where no equation is asked to hold: a place in a wrong unit, or columns that changed places.

use super::Check;
use crate::problem::Bound;
use crate::schema::{Group, TermKind};

/// Points that make up a domain, at least; fewer are conditions.
const FEW_POINTS: usize = 8;

/// A box of places, in the engine's units.
struct Domain {
    low: Vec<f64>,
    high: Vec<f64>,
    /// Distance of neighbours along every axis, as if points were on a lattice.
    spacing: Vec<f64>,
}

/// The box of all points at which equations are asked to hold; nothing where there are none.
fn domain(bound: &Bound) -> Option<Domain> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let groups = schema.groups.iter().zip(&bound.coordinates);
    let equations = groups.filter(|(group, points)| points.len() >= FEW_POINTS * inputs && is_equation(group));
    let points: Vec<&[f64]> = equations.flat_map(|(_, points)| points.chunks_exact(inputs)).collect();
    let end = |axis: usize, of: fn(f64, f64) -> f64| points.iter().map(|point| point[axis]).reduce(of);
    let low = (0..inputs).map(|axis| end(axis, f64::min)).collect::<Option<Vec<_>>>()?;
    let high = (0..inputs).map(|axis| end(axis, f64::max)).collect::<Option<Vec<_>>>()?;
    let along = (points.len() as f64).powf(1.0 / inputs as f64);
    let spacing = low.iter().zip(&high).map(|(low, high)| (high - low) / along).collect();
    Some(Domain { low, high, spacing })
}

/// One check for every group of measurements beside the equations.
pub(super) fn checks(bound: &Bound) -> Vec<Check> {
    let Some(domain) = domain(bound) else { return Vec::new() };
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let groups = schema.groups.iter().zip(&bound.coordinates);
    // Equations with columns hold at the rows of a table.
    let is_given = |group: &&Group| !group.columns.is_empty() && group.place.is_none() && is_equation(group);
    let given: Vec<String> = schema.groups.iter().filter(is_given).map(|group| format!("`{}`", group.name)).collect();
    let observed = groups.filter(|(group, _)| group.terms.iter().any(|term| term.kind == TermKind::Observation));
    let check = |(group, points): (&Group, &Vec<f64>)| {
        let is_outside = |point: &&[f64]| {
            (0..inputs).any(|axis| {
                let slack = domain.spacing[axis];
                point[axis] < domain.low[axis] - slack || point[axis] > domain.high[axis] + slack
            })
        };
        let all = points.len() / inputs;
        let count = points.chunks_exact(inputs).filter(is_outside).count();
        let hint = match given.as_slice() {
            [] => "check the units and the order of their coordinates".into(),
            _ => {
                format!("give rows of {} for all of them, or check the units of their coordinates", given.join(" and "))
            }
        };
        let (name, low, high) = (group.name, bound.place(&domain.low), bound.place(&domain.high));
        let said = format!(
            "{count} of the {all} points of `{name}` are outside of the points at which the equations are asked to hold, {low} to \
             {high}: {hint}"
        );
        Check::new("outside", (group.name, ""), (count as f64 / all.max(1) as f64, 0.0), said)
    };
    observed.map(check).collect()
}

/// True for a group of equations.
fn is_equation(group: &Group) -> bool {
    group.terms.iter().any(|term| term.kind == TermKind::Residual)
}
