//! The least of a function of one weight: a coarse look over decades, then golden sections around the best.

use super::RivalError;

const GOLDEN: f64 = 0.618_033_988_749_894_9;
const SECTIONS: usize = 12;

/// Returns the decimal logarithm of the best weight in `low..=high`.
pub(super) fn best_decade(
    low: i32,
    high: i32,
    mut cost: impl FnMut(f64) -> Result<f64, RivalError>,
) -> Result<f64, RivalError> {
    let (mut best, mut least) = (f64::from(low), f64::INFINITY);
    for decade in low..=high {
        // A weight so extreme that the factorisation fails is simply not the best one.
        match cost(f64::from(decade)) {
            Ok(value) if value < least => (best, least) = (f64::from(decade), value),
            Ok(_) | Err(RivalError::Singular) => {}
            Err(error) => return Err(error),
        }
    }
    if least.is_infinite() {
        return Err(RivalError::Singular);
    }
    let (mut a, mut b) = (best - 1.0, best + 1.0);
    for _ in 0..SECTIONS {
        let (left, right) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        if cost(left).unwrap_or(f64::INFINITY) < cost(right).unwrap_or(f64::INFINITY) {
            b = right;
        } else {
            a = left;
        }
    }
    Ok(0.5 * (a + b))
}
