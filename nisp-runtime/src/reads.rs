//! Where a group reads a head. A condition on one side of a domain may stand at all its sides, times nothing at the others: what a
//! head is there says nothing.

use crate::facts::Facts;
use crate::residual::Programs;
use crate::schema;

/// Share of a row's largest slope that is rounding.
const ROUNDING: f64 = 1e-12;

/// By head and point, whether any row of the group changes with the head there, or with one of its derivatives.
pub(crate) fn where_read(
    facts: &Facts,
    programs: &dyn Programs<f64>,
    group: &schema::Group,
    (heads, scalars): (usize, &[f64]),
) -> Vec<Vec<bool>> {
    let mut read = vec![vec![false; facts.points]; heads];
    for row in 0..group.rows {
        let slopes = facts.slopes(programs, group, row, scalars);
        let largest = slopes.iter().flatten().fold(0.0, |most: f64, bar| most.max(bar.abs()));
        for (jet, bars) in group.jets.iter().zip(slopes) {
            read[jet.head].iter_mut().zip(bars).for_each(|(read, bar)| *read |= bar.abs() > ROUNDING * largest);
        }
    }
    read
}
