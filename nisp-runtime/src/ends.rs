//! Where numbers begin and end.

/// The least and the greatest of some numbers; of none an interval that is inside out.
pub(crate) fn ends(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// The ends along every coordinate of points with so many coordinates, given as flat lists.
pub(crate) fn ranges<'a>(lists: impl IntoIterator<Item = &'a Vec<f64>> + Clone, inputs: usize) -> Vec<(f64, f64)> {
    let along = |axis: usize| lists.clone().into_iter().flat_map(move |list| list.iter().skip(axis).step_by(inputs));
    (0..inputs).map(|axis| ends(along(axis).copied())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_found_along_every_coordinate_of_all_lists() {
        let lists = [vec![1.0, -2.0, 4.0, 0.5], vec![-3.0, 0.0]];
        assert_eq!(ranges(&lists, 2), [(-3.0, 4.0), (-2.0, 0.5)]);
        assert_eq!(ends([]), (f64::INFINITY, f64::NEG_INFINITY));
    }
}
