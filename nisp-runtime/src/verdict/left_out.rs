//! Values that a robust loss leaves out: few of them, and each by itself.

use super::Check;
use super::misfits::{Misfits, TAIL};
use crate::noise::in_order;

/// Share of the values that may be outliers.
const LEFT: f64 = 0.25;
/// How many outliers may stand next to each other, whatever their share.
const NEXT: f64 = 4.0;
/// Chance of a longer run of outliers on one side, in the whole record.
const CHANCE: f64 = 1e-4;

/// The share of values that are left out.
pub(super) fn share(left: &Misfits) -> Check {
    let out = left.rows.iter().flatten().filter(|x| x.abs() > TAIL * left.size).count();
    let said = format!(
        "{out} of {} values of `{}` are left out as outliers: so many are none, and the equations, a parameter or the carrier do not \
         fit them",
        left.count(),
        left.term.name
    );
    Check::new("left", left.name(), (out as f64 / left.count().max(1) as f64, LEFT), said)
}

/// The longest run of values that are left out on one side; nothing over several coordinates. Outliers come by chance: of a share `s` of all
/// values, `n s^k` runs of length `k` are expected.
pub(super) fn together(left: &Misfits) -> Option<Check> {
    if !left.is_record() {
        return None;
    }
    let places = in_order(&left.places, &left.places);
    let of = |row: &Vec<f64>, sign: f64| {
        let out: Vec<bool> = in_order(&left.places, row).iter().map(|x| sign * x > TAIL * left.size).collect();
        let count = out.iter().filter(|is_out| **is_out).count();
        let (length, end) = longest(&out);
        let share = count as f64 / out.len() as f64;
        let by_chance = (CHANCE / out.len() as f64).ln() / share.ln();
        (length, end, if by_chance.is_finite() { by_chance.max(NEXT) } else { NEXT })
    };
    let runs = left.rows.iter().flat_map(|row| [of(row, 1.0), of(row, -1.0)]);
    let (length, end, limit) = runs.max_by(|a, b| (a.0 as f64 / a.2).total_cmp(&(b.0 as f64 / b.2)))?;
    let [from, to] = [end.saturating_sub(length), end.saturating_sub(1)].map(|at| left.bound.place(&[places[at]]));
    let said = format!(
        "{length} values of `{}` next to each other, from {from} to {to}, are left out as outliers: a source that acts for a short time \
         looks like that; empty the cells of outliers yourself, and solve without --robust or a robust loss",
        left.term.name
    );
    Some(Check::new("left", left.name(), (length as f64, limit), said))
}

/// The length of the longest run, and where it ends.
fn longest(of: &[bool]) -> (usize, usize) {
    let mut best = (0, 0);
    let mut length = 0;
    for (at, is_in) in of.iter().enumerate() {
        length = if *is_in { length + 1 } else { 0 };
        if length > best.0 {
            best = (length, at + 1);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::longest;

    #[test]
    fn the_longest_run_is_found() {
        assert_eq!(longest(&[]), (0, 0));
        assert_eq!(longest(&[false, false]), (0, 0));
        assert_eq!(longest(&[true, false, true, true, false, true]), (2, 4));
        assert_eq!(longest(&[false, true, true, true]), (3, 4));
    }
}
