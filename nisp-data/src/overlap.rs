//! How far two masks overlap.

use crate::DataError;

/// Intersection over union of two masks on the same points; 1 if both are empty.
///
/// # Errors
/// Masks on different numbers of points.
pub fn intersection_over_union(a: &[bool], b: &[bool]) -> Result<f64, DataError> {
    if a.len() != b.len() {
        return Err(DataError::invalid(format!("masks on {} and on {} points cannot be compared", a.len(), b.len())));
    }
    let both = a.iter().zip(b).filter(|(x, y)| **x && **y).count();
    let either = a.iter().zip(b).filter(|(x, y)| **x || **y).count();
    Ok(if either == 0 { 1.0 } else { both as f64 / either as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_matches_hand_counts() {
        let overlap = intersection_over_union(&[true, true, false, false], &[true, false, true, false]).unwrap();
        assert_eq!(overlap, 1.0 / 3.0);
        assert_eq!(intersection_over_union(&[false], &[false]).unwrap(), 1.0);
        assert!(intersection_over_union(&[true], &[]).is_err());
    }
}
