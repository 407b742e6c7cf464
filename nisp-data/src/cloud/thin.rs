//! Fewer points where a cloud has many more than its surface can use.

use std::collections::BTreeMap;

use super::Cloud;

/// Cubes along an axis at most, from the origin on: their numbers stay exact.
const MOST_CUBES: f64 = 1e15;

/// Indices of the points in every cube of a grid with this side, in the order of the cubes.
/// `None` where cubes would be too small to be told apart.
fn cubes(points: &[[f64; 3]], side: f64) -> Option<BTreeMap<[i64; 3], Vec<usize>>> {
    let farthest = points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    let are_distinct = side > 0.0 && farthest / side < MOST_CUBES;
    are_distinct.then(|| {
        let mut cubes: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
        for (index, point) in points.iter().enumerate() {
            cubes.entry(point.map(|x| (x / side).floor() as i64)).or_default().push(index);
        }
        cubes
    })
}

impl Cloud {
    /// Thins a cloud that has many more than `each` points in the cubes of a grid with this side, in metres, to that many in the
    /// mean, and says so among the warnings.
    ///
    /// The same share is kept in every cube, up to one point. Shares keep what noise and outliers there are as frequent as they
    /// were; a fixed number from each cube would prefer points that noise has thrown far off, and means would not have the
    /// noise of a point.
    pub fn thin(&mut self, side: f64, each: usize) {
        let Some(cubes) = cubes(&self.points, side) else { return };
        let (all, count) = (self.points.len(), cubes.len());
        let step = all / (each.max(1) * count.max(1));
        if step < 2 {
            return;
        }
        self.points = cubes.into_values().flatten().step_by(step).map(|index| self.points[index]).collect();
        self.warnings.push(format!(
            "{} of the cloud's {all} points are used, one of {step} in each of {count} cubes, which the answer is as fine as",
            self.points.len()
        ));
    }

    /// Length of the cloud along its longest axis, but for strays: nine tenths of the points are within nine tenths of it.
    #[must_use]
    pub fn length(&self) -> f64 {
        let along = |axis: usize| {
            let mut values: Vec<f64> = self.points.iter().map(|point| point[axis]).collect();
            values.sort_by(f64::total_cmp);
            let at = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0);
            (at(0.95) - at(0.05)) / 0.9
        };
        (0..3).map(along).fold(0.0, f64::max)
    }

    /// One point for every cube of a grid with this side, in metres: the point nearest to the cube's middle. Points stay in the
    /// cloud's order. Cubes with fewer than `least` points hold strays, and keep none.
    ///
    /// Such a cloud shows where the surface is, evenly. It doesn't show how frequent noise and outliers are:
    /// [`thin`](Self::thin) does.
    #[must_use]
    pub fn one_of_each_cube(&self, side: f64, least: usize) -> Self {
        let Some(cubes) = cubes(&self.points, side) else { return self.clone() };
        let off = |index: usize| -> f64 {
            self.points[index].iter().map(|x| ((x / side) - (x / side).floor() - 0.5).powi(2)).sum()
        };
        let nearest = |cube: &Vec<usize>| cube.iter().copied().min_by(|i, j| off(*i).total_cmp(&off(*j)));
        let mut kept: Vec<usize> = cubes.values().filter(|cube| cube.len() >= least).filter_map(nearest).collect();
        kept.sort_unstable();
        Self {
            points: kept.into_iter().map(|index| self.points[index]).collect(),
            warnings: self.warnings.clone(),
            ..*self
        }
    }
}
