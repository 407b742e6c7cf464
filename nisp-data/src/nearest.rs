//! Nearest neighbours and the distances built on them: Chamfer between clouds, overlap of masks.

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::DataError;

/// A k-d tree over points of `D` coordinates.
pub struct Nearest<const D: usize> {
    tree: ImmutableKdTree<f64, D>,
    points: Vec<[f64; D]>,
}

/// The nearest point of a tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Its index in the points that the tree was made of.
    pub index: usize,
    /// Its squared distance.
    pub squared_distance: f64,
}

impl<const D: usize> Nearest<D> {
    /// Builds the tree. There must be a point, and all must be finite.
    pub fn new(points: &[[f64; D]]) -> Result<Nearest<D>, DataError> {
        if points.is_empty() || points.iter().flatten().any(|value| !value.is_finite()) {
            return Err(DataError::invalid("nearest neighbours need at least one point, and only finite ones"));
        }
        let tree = ImmutableKdTree::new_from_slice(points)
            .map_err(|error| DataError::invalid(format!("nearest neighbours: {error}")))?;
        Ok(Nearest { tree, points: points.to_vec() })
    }

    /// The nearest point; among equally near ones the first. A query that is not finite has distance NaN.
    pub fn nearest(&self, query: &[f64; D]) -> Neighbour {
        if query.iter().any(|value| !value.is_finite()) {
            return Neighbour { index: 0, squared_distance: f64::NAN };
        }
        let found = self.tree.query(query).nearest_one::<SquaredEuclidean<f64>>().execute();
        // The tree's order of equals depends on its layout. Look at everything as near, up to rounding.
        let reach = found.distance * (1.0 + 1e-12);
        let ties = self.tree.query(query).within::<SquaredEuclidean<f64>>(reach).unsorted().execute();
        let candidates = ties.iter().map(|tie| tie.item as usize).chain([found.item as usize]);
        let measured = candidates.map(|index| (squared_distance(query, &self.points[index]), index));
        let (squared_distance, index) = measured
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .unwrap_or((found.distance, found.item as usize));
        Neighbour { index, squared_distance }
    }

    /// The `count` nearest points, or all if there are fewer, by their indices.
    pub fn nearest_many(&self, query: &[f64; D], count: usize) -> impl Iterator<Item = usize> + use<D> {
        let count = std::num::NonZeroUsize::new(count.min(self.points.len())).unwrap_or(std::num::NonZeroUsize::MIN);
        let found = self.tree.query(query).nearest_n::<SquaredEuclidean<f64>>(count).execute();
        found.into_iter().map(|neighbour| neighbour.item as usize)
    }

    /// The nearest point of each query.
    pub fn nearest_all(&self, queries: &[[f64; D]]) -> Vec<Neighbour> {
        queries.iter().map(|query| self.nearest(query)).collect()
    }
}

fn squared_distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// Mean squared distance from each point of `from` to its nearest of `to`.
pub fn chamfer_one_way<const D: usize>(from: &[[f64; D]], to: &[[f64; D]]) -> Result<f64, DataError> {
    if from.is_empty() {
        return Err(DataError::invalid("the Chamfer distance needs at least one point on either side"));
    }
    let tree = Nearest::new(to)?;
    Ok(from.iter().map(|point| tree.nearest(point).squared_distance).sum::<f64>() / from.len() as f64)
}

/// Chamfer distance: mean squared nearest distances of both directions, added.
pub fn chamfer<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> Result<f64, DataError> {
    Ok(chamfer_one_way(a, b)? + chamfer_one_way(b, a)?)
}

/// Intersection over union of two masks on the same points; 1 if both are empty.
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
    use crate::domain::{Domain, Sampling};

    fn brute<const D: usize>(points: &[[f64; D]], query: &[f64; D]) -> Neighbour {
        let all = points.iter().map(|point| squared_distance(query, point)).enumerate();
        let (index, squared_distance) = all.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        Neighbour { index, squared_distance }
    }

    /// A regular grid: many equal coordinates, and queries half-way between points.
    #[test]
    fn agrees_with_looking_at_every_point() {
        let grid: Vec<[f64; 3]> =
            (0..1000).map(|i| [f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)]).collect();
        let tree = Nearest::new(&grid).unwrap();
        let box3 = Domain::cuboid(&[-1.0; 3], &[11.0; 3]).unwrap();
        let mut queries: Vec<[f64; 3]> =
            box3.interior(500, Sampling::Sobol, 1).iter().map(|p| [p[0], p[1], p[2]]).collect();
        queries.extend((0..200).map(|i| [0.5 * f64::from(i % 20), 0.5, 4.5]));
        for query in &queries {
            assert_eq!(tree.nearest(query), brute(&grid, query), "{query:?}");
        }
        let same = Nearest::new(&vec![[1.0, 2.0]; 300]).unwrap();
        assert_eq!(same.nearest(&[0.0, 0.0]), Neighbour { index: 0, squared_distance: 5.0 });
    }

    #[test]
    fn odd_queries_do_not_panic() {
        let tree = Nearest::new(&[[0.0, 0.0], [1.0, 1.0]]).unwrap();
        assert!(tree.nearest(&[f64::NAN, 0.0]).squared_distance.is_nan());
        assert_eq!(tree.nearest(&[1e200, 0.0]).squared_distance, f64::INFINITY);
        assert!(Nearest::<2>::new(&[]).is_err());
        assert!(Nearest::new(&[[f64::INFINITY]]).is_err());
    }

    #[test]
    fn metrics_match_hand_counts() {
        let (a, b) = ([[0.0, 0.0], [1.0, 0.0]], [[0.0, 2.0]]);
        assert_eq!(chamfer(&a, &b).unwrap(), (4.0 + 5.0) / 2.0 + 4.0);
        let overlap = intersection_over_union(&[true, true, false, false], &[true, false, true, false]).unwrap();
        assert_eq!(overlap, 1.0 / 3.0);
        assert_eq!(intersection_over_union(&[false], &[false]).unwrap(), 1.0);
        assert!(intersection_over_union(&[true], &[]).is_err());
    }
}
