//! Fewer points where a cloud has many more than its surface can use.

use std::collections::BTreeMap;

use super::Cloud;

/// Cubes along an axis at most, from the origin on: their numbers stay exact.
const MOST_CUBES: f64 = 1e15;

impl Cloud {
    /// Thins a cloud that has many more than `each` points in the cubes of a grid with this side, in metres, to that many in the
    /// mean, and says so among the warnings.
    ///
    /// The same share is kept in every cube, up to one point. Shares keep what noise and outliers there are as frequent as they
    /// were; a fixed number from each cube would prefer points that noise has thrown far off, and means would not have the
    /// noise of a point.
    pub fn thin(&mut self, side: f64, each: usize) {
        let farthest = self.points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let has_cubes = side > 0.0 && farthest / side < MOST_CUBES;
        if !has_cubes {
            return;
        }
        let mut cubes: BTreeMap<[i64; 3], Vec<[f64; 3]>> = BTreeMap::new();
        for point in &self.points {
            cubes.entry(point.map(|x| (x / side).floor() as i64)).or_default().push(*point);
        }
        let (all, count) = (self.points.len(), cubes.len());
        let step = all / (each.max(1) * count);
        if step < 2 {
            return;
        }
        self.points = cubes.into_values().flatten().step_by(step).collect();
        self.warnings.push(format!(
            "{} of the cloud's {all} points are used, one of {step} in each of {count} cubes of {:.3} mm, which the answer is as fine \
             as",
            self.points.len(),
            side * 1e3
        ));
    }
}
