//! The nearest of many points, through a k-d tree.

use std::num::NonZero;

use kdtree::KdTree;
use kdtree::distance::squared_euclidean;

/// Points to be searched.
#[derive(Debug)]
pub struct Nearest<const D: usize> {
    tree: KdTree<f64, usize, [f64; D]>,
}

/// A point that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Its index in the points that the tree was made of.
    pub index: usize,
    /// Its distance.
    pub distance: f64,
}

impl<const D: usize> Nearest<D> {
    /// Builds the tree; nothing where there is no point, or one that is not finite.
    pub fn of(points: &[[f64; D]]) -> Option<Self> {
        let mut tree = KdTree::new(D);
        for (index, point) in points.iter().enumerate() {
            tree.add(*point, index).ok()?;
        }
        (tree.size() > 0).then_some(Self { tree })
    }

    /// The nearest point; where the place is so far away that squares overflow, the first one, at an infinite distance; where it
    /// is not finite, the first one, at a distance of `NaN`.
    pub fn one(&self, place: &[f64; D]) -> Neighbour {
        let found = self.some(place, NonZero::<usize>::MIN);
        found.first().copied().unwrap_or_else(|| {
            let finite = place.iter().all(|x| x.is_finite());
            Neighbour { index: 0, distance: if finite { f64::INFINITY } else { f64::NAN } }
        })
    }

    /// All points, the nearest first, looked for one after the other; none where squares overflow.
    pub(crate) fn by_distance<'a>(&'a self, place: &'a [f64; D]) -> impl Iterator<Item = Neighbour> + 'a {
        let found = self.tree.iter_nearest(place, &squared_euclidean).into_iter().flatten();
        found.map(|(square, &index)| Neighbour { index, distance: square.sqrt() })
    }

    /// So many of the nearest points, the nearest first; all if there are fewer, none where squares overflow.
    pub fn some(&self, place: &[f64; D], count: NonZero<usize>) -> Vec<Neighbour> {
        let found = self.tree.nearest(place, count.get(), &squared_euclidean).unwrap_or_default();
        found.into_iter().map(|(square, &index)| Neighbour { index, distance: square.sqrt() }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
        a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
    }

    /// Random points, and a grid with many equal coordinates, by looking at every point.
    fn agrees<const D: usize>() {
        let mut random = StdRng::seed_from_u64(1);
        let mut point = || std::array::from_fn::<f64, D, _>(|_| random.random());
        let mut points: Vec<[f64; D]> = (0..500).map(|_| point()).collect();
        let places: Vec<[f64; D]> = (0..200).map(|_| point()).collect();
        for _ in 0..2 {
            let tree = Nearest::of(&points).unwrap();
            for place in &places {
                let mut exact: Vec<f64> = points.iter().map(|point| distance(point, place)).collect();
                exact.sort_by(f64::total_cmp);
                let found = tree.some(place, NonZero::new(7).unwrap());
                assert_eq!(found.len(), 7);
                for (found, exact) in found.iter().zip(exact) {
                    assert!((found.distance - exact).abs() < 1e-12);
                    assert!((distance(&points[found.index], place) - exact).abs() < 1e-12);
                }
                assert_eq!(tree.one(place).distance, found[0].distance);
                let all: Vec<f64> = tree.by_distance(place).map(|found| found.distance).collect();
                assert_eq!(all.len(), points.len());
                assert!(all.is_sorted() && all[..7].iter().zip(&found).all(|(all, found)| *all == found.distance));
            }
            points.iter_mut().flatten().for_each(|x| *x = (*x * 6.0).round() / 6.0);
        }
    }

    #[test]
    fn agrees_with_looking_at_every_point() {
        agrees::<1>();
        agrees::<2>();
        agrees::<3>();
        agrees::<4>();
    }

    #[test]
    fn odd_points_do_not_panic() {
        assert!(Nearest::<2>::of(&[]).is_none());
        assert!(Nearest::of(&[[0.0], [f64::INFINITY]]).is_none());
        let same = Nearest::of(&vec![[1.0, 2.0, 3.0]; 300]).unwrap();
        assert!((same.one(&[1.0, 2.0, 5.0]).distance - 2.0).abs() < 1e-12);
        assert_eq!(same.some(&[0.0; 3], NonZero::new(400).unwrap()).len(), 300);
        assert!(same.one(&[f64::NAN, 0.0, 0.0]).distance.is_nan());
        assert_eq!(same.one(&[1e200, 0.0, 0.0]).distance, f64::INFINITY);
    }
}
