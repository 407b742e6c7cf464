//! What equations know along the record: a drive, a load, a coefficient that changes with time.

use super::group::Group;
use super::heads::Heads;
use crate::ends::ends;
use crate::noise;
use crate::problem::Bound;

/// A column that cells are to follow: its places in ascending order, its values there, and their noise.
pub(super) struct Column {
    pub(super) places: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) noise: f64,
}

/// Levels of all heads, in natural sizes, at which equations are looked at: what is added shows at one, what multiplies a field at
/// the other.
const LEVELS: [f64; 2] = [0.0, 1.0];
/// How well cells must follow what is known, as a share of what it varies by; they are divided by four then, and good to the sixth power.
const FOLLOWED: f64 = 1e-3;
/// Rounding of an equation's terms, as a share of the largest.
const ROUNDING: f64 = 1e-9;
/// Places that are looked at together.
const TOGETHER: usize = 4096;

/// The rows of these groups of equations along the record, where heads, of these degrees, do not vary: at the points of their columns,
/// or at these places where they have none. What does not vary either is left out, and so is what has no value.
pub(super) fn drives(bound: &Bound, groups: &[usize], degrees: &[usize], places: &[f64]) -> Vec<Column> {
    let schema = bound.problem.scene().schema;
    let heads = Heads::new(bound, degrees, &[places[0], places[places.len() - 1]]);
    let kernels = bound.problem.scene().double();
    let mut drives = Vec::new();
    for (at, kernel) in kernels.into_iter().enumerate().filter(|(at, _)| groups.contains(at)) {
        let (group, own) = (&schema.groups[at], &bound.coordinates[at]);
        let (low, high) = ends(own.iter().copied());
        let columns = bound.filled_columns(at);
        let places: Vec<f64> = match columns.is_empty() {
            true => places.iter().copied().filter(|x| (low..=high).contains(x)).collect(),
            false => own.clone(),
        };
        for level in LEVELS {
            let theta = vec![level; heads.len()];
            let mut rows = vec![Vec::with_capacity(places.len()); group.rows];
            for from in (0..places.len()).step_by(TOGETHER) {
                let part = from..(from + TOGETHER).min(places.len());
                let columns: Vec<Vec<f64>> = columns.iter().map(|column| column[part.clone()].to_vec()).collect();
                let part = Group::new(group, kernel, &heads, &places[part], &columns);
                let found = part.evaluate(&heads, &theta, &bound.scalars, None);
                rows.iter_mut()
                    .enumerate()
                    .for_each(|(row, own)| own.extend((0..part.len()).map(|p| found.row(row, p))));
            }
            drives.extend(rows.iter().filter_map(|row| drive(&places, row)));
        }
    }
    drives
}

/// A row as a column with the noise that cells may leave of it.
fn drive(places: &[f64], row: &[f64]) -> Option<Column> {
    let largest = row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let spread = noise::deviation(row);
    let values = noise::in_order(places, row);
    let noise = noise::by_differences(&values).unwrap_or_default().max(FOLLOWED * spread);
    let varies = spread > ROUNDING * largest && largest.is_finite();
    varies.then(|| Column { places: noise::in_order(places, places), values, noise })
}
