//! Fewer points where a curve has more than a picture can show.

use std::collections::HashSet;

/// Width of a column: finer than screens and paper show at a picture's usual size.
const COLUMN: f64 = 0.5;

/// A curve that covers the same: of neighbours within a column the first, the lowest, the highest and the last. Curves that run
/// to and fro keep every turn that leaves its column.
pub(super) fn curve(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let column = |point: &[f64; 2]| (point[0] / COLUMN).floor();
    let mut kept = Vec::new();
    for run in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &usize, b: &usize| run[*a][1].total_cmp(&run[*b][1]);
        let (low, high) = ((0..run.len()).min_by(by_height), (0..run.len()).max_by(by_height));
        let mut shown = [Some(0), low, high, run.len().checked_sub(1)];
        shown.sort_unstable();
        let mut before = None;
        for at in shown.into_iter().flatten() {
            if before != Some(at) {
                kept.push(run[at]);
            }
            before = Some(at);
        }
    }
    kept
}

/// Dots of a radius, but those that others hide: the first in each square of half the radius.
pub(super) fn dots(points: &[[f64; 2]], radius: f64) -> Vec<[f64; 2]> {
    let mut taken = HashSet::new();
    let square = |point: &[f64; 2]| point.map(|x| (x / (0.5 * radius)).floor() as i64);
    points.iter().filter(|point| taken.insert(square(point))).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four of every column of half a unit, and every peak among them.
    #[test]
    fn a_long_curve_keeps_its_extremes() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|i| [i as f64 * 1e-3, (0.37 * i as f64).sin()]).collect();
        (points[51_234][1], points[70_001][1]) = (9.0, -7.0);
        let shown = curve(&points);
        assert!(shown.len() <= 4 * 200, "{}", shown.len());
        assert!(shown.contains(&points[51_234]) && shown.contains(&points[70_001]));
        assert_eq!((shown[0], shown[shown.len() - 1]), (points[0], points[99_999]));
        assert!(shown.windows(2).all(|pair| pair[0][0] <= pair[1][0]), "in their order");
    }

    #[test]
    fn a_short_curve_stays_as_it_is() {
        let points: Vec<[f64; 2]> = (0..300).map(|i| [f64::from(i), f64::from(i * i % 7)]).collect();
        assert_eq!(curve(&points), points);
        assert_eq!(curve(&[]), Vec::<[f64; 2]>::new());
        assert_eq!(dots(&points, 2.0), points);
    }

    /// A grid of 40 by 30 squares, each with 25 dots.
    #[test]
    fn hidden_dots_are_left_out() {
        let points: Vec<[f64; 2]> = (0..200)
            .flat_map(|i| (0..150).map(move |j| [0.1 + 0.2 * f64::from(i), 0.1 + 0.2 * f64::from(j)]))
            .collect();
        assert_eq!(dots(&points, 2.0).len(), 40 * 30);
    }
}
