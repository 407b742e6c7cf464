//! Levels that cancel. Of a pressure of a bar that varies by a pascal an equation reads the difference to another pressure: both are
//! a hundred thousand times as large as all that happens, and say nothing of it.

/// How much larger than what varies levels may make a row.
const MOST: f64 = 10.0;

/// The size of a row that adds up so much, of which so much varies or is left when levels have cancelled.
pub(crate) fn without_levels(size: f64, varying: f64) -> f64 {
    if varying > 0.0 && varying.is_finite() { size.min(MOST * varying) } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_levels_alone_are_left_out() {
        assert_eq!(without_levels(2e5, 1.0), 10.0);
        assert_eq!(without_levels(3.0, 1.0), 3.0);
        assert_eq!(without_levels(2e5, 0.0), 2e5);
    }
}
