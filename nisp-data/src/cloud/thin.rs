//! Fewer points of a cloud, spread evenly.

use std::collections::HashMap;

use super::Cloud;

impl Cloud {
    /// Of every cube of a grid with this edge, in the cloud's unit, the point nearest to the cube's middle; in the cloud's
    /// order. Cubes with fewer than `least` points hold strays, and keep none.
    pub fn thinned(&self, edge: f64, least: usize) -> Cloud {
        // By cube: how far the kept point is from the middle, its index, and how many points there are.
        let mut kept: HashMap<[i64; 3], (f64, usize, usize)> = HashMap::new();
        for (index, point) in self.points.iter().enumerate() {
            let cube = point.map(|x| (x / edge).floor());
            let off: f64 = point.iter().zip(cube).map(|(x, low)| (x / edge - low - 0.5).powi(2)).sum();
            let own = kept.entry(cube.map(|low| low as i64)).or_insert((off, index, 0));
            own.2 += 1;
            if off < own.0 {
                (own.0, own.1) = (off, index);
            }
        }
        let mut indices: Vec<usize> =
            kept.into_values().filter(|(.., count)| *count >= least).map(|(_, index, _)| index).collect();
        indices.sort_unstable();
        Cloud { points: indices.into_iter().map(|index| self.points[index]).collect(), warnings: self.warnings.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cube_keeps_the_point_nearest_to_its_middle() {
        let points = vec![[0.1, 0.1, 0.1], [0.4, 0.5, 0.6], [-0.5, 0.5, 0.5], [1.5, 0.0, 0.0], [0.9, 0.9, 0.9]];
        let cloud = Cloud { points, warnings: Vec::new() };
        assert_eq!(cloud.thinned(1.0, 1).points, [[0.4, 0.5, 0.6], [-0.5, 0.5, 0.5], [1.5, 0.0, 0.0]]);
        assert_eq!(cloud.thinned(1.0, 3).points, [[0.4, 0.5, 0.6]]);
    }
}
