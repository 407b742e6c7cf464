//! Sources that jolt: far larger than elsewhere at one place, first to one side and within a few rows to the other. A record that jumps asks for that
//! where a finite source would move it smoothly.

use super::Check;

/// Rows within which a jolt turns to the other side, and beyond which it is over.
const NEAR: f64 = 4.0;
/// Share of its peak that it reaches on the other side, at least, and that the source has beside it, at most.
const BACK: f64 = 0.4;
const BESIDE: f64 = 0.25;
/// Its peak over what the source is at nine of ten places, at most.
const LARGEST: f64 = 10.0;

/// One check for a source over one coordinate that jolts: its places and values, at every row and between, how far rows are apart, and how a
/// place is written.
pub(crate) fn check(
    name: &'static str,
    (course, spacing): (&[(f64, f64)], f64),
    words: impl Fn(f64) -> String,
) -> Option<Check> {
    let (place, size) = jolt(course, NEAR * spacing)?;
    let said = format!(
        "`{name}` is {size:.0} times as large at {} as at nine of ten places, to one side and {NEAR} rows later at most to the other: the record \
         jumps there, as it does where a sensor was moved, changed its range or its unit, or where rows are lacking; solve the parts by \
         themselves, or give rows that are closer",
        words(place)
    );
    Some(Check::new("jolt", ("", name), (size, LARGEST), said))
}

/// Where a course jolts within a distance, and how large it is there beside nine of ten places.
fn jolt(course: &[(f64, f64)], near: f64) -> Option<(f64, f64)> {
    let (place, peak) = course.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let apart = |x: f64| (x - place).abs();
    let back = course.iter().filter(|(x, _)| apart(*x) <= near).map(|(_, value)| -value / peak).fold(0.0, f64::max);
    let beside = course.iter().filter(|(x, _)| apart(*x) > near && apart(*x) <= 3.0 * near);
    let beside = beside.map(|(_, value)| (value / peak).abs()).fold(0.0, f64::max);
    let mut sizes: Vec<f64> = course.iter().map(|(_, value)| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let size = peak.abs() / sizes[9 * sizes.len() / 10];
    (back >= BACK && beside <= BESIDE && size.is_finite()).then_some((place, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second derivative of a course that is sampled at every row.
    fn bends(of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let bend = |at: f64| of(at + 1.0) - 2.0 * of(at) + of(at - 1.0);
        (0..200).map(|at| (f64::from(at), bend(f64::from(at)))).collect()
    }

    #[test]
    fn a_course_that_jumps_asks_for_a_jolt() {
        let (place, size) = jolt(&bends(|t| (0.1 * t).sin() + f64::from(t > 120.5)), NEAR).unwrap();
        assert!((place - 120.5).abs() < 1.0 && size > 50.0, "{place}: {size}");
    }

    #[test]
    fn a_blow_and_a_push_to_and_fro_are_none() {
        // A blow bends a course to one side.
        assert_eq!(jolt(&bends(|t| (0.1 * t).sin() + (t - 120.0).max(0.0)), NEAR), None);
        // What rows resolve takes longer to turn.
        let push = |t: f64| f64::from((80.0..90.0).contains(&t)) - f64::from((90.0..100.0).contains(&t));
        let course: Vec<(f64, f64)> = (0..200).map(|at| (f64::from(at), push(f64::from(at)))).collect();
        assert_eq!(jolt(&course, NEAR), None);
    }
}
