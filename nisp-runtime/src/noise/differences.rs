//! Noise by eighth differences of neighbours.

use super::{MEDIAN, median};

/// Values of which the first and the last of an eighth difference are apart.
pub(crate) const EIGHT: usize = 8;

/// From eighth differences, of which a signal that is sampled well has none: their median magnitude, so that a layer or an
/// outlier does not count. Noise of deviation s gives differences of deviation `sqrt(12870) s`.
pub(crate) fn by_differences(values: &[f64]) -> Option<f64> {
    of_differences(differences(values).collect())
}

/// Factors of the values in an eighth difference.
const EIGHTH: [f64; EIGHT + 1] = [1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0];

/// Variances of eighth differences of values that have such variances.
pub(super) fn of_eighth(variances: &[f64]) -> Vec<f64> {
    variances.windows(EIGHTH.len()).map(|own| own.iter().zip(EIGHTH).map(|(own, c)| c * c * own).sum()).collect()
}

/// Magnitudes of eighth differences, in the order of the values.
pub(crate) fn differences(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    values.windows(EIGHTH.len()).map(|window| window.iter().zip(EIGHTH).map(|(y, c)| c * y).sum::<f64>().abs())
}

/// The noise that makes eighth differences of these magnitudes.
pub(crate) fn of_differences(differences: Vec<f64>) -> Option<f64> {
    Some(median(differences)? / (MEDIAN * 12870.0_f64.sqrt()))
}
