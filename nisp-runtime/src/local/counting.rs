//! How the points of a cloud count: their loss, their declared deviation, and how many of them are off alike.

use std::collections::HashSet;

use nalgebra::Vector3;

use crate::loss::Loss;
use crate::problem::EngineTolerance;
use crate::schema;

/// How the misfits of a cloud's points count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Counting {
    /// The loss of a misfit over its standard deviation: while the surface is sought, and once it is near.
    far: Loss,
    near: Loss,
    /// The one at work.
    loss: Loss,
    /// The standard deviation of a point, or of all points of a region, where it is declared.
    within: Option<f64>,
    /// Length over which points are off alike, where it is declared.
    region: Option<f64>,
    /// Points that are off alike, in the mean over the cloud.
    alike: f64,
    /// What the loss is multiplied by.
    weight: f64,
}

impl Counting {
    /// As declared; `size` is the standard deviation of a term that says `within`. Clouds have outliers, so that those of one of which
    /// nothing is said count little while the surface is sought, and not at all once it is near.
    pub(super) fn of(term: &schema::Term, declared: Loss, size: f64, tolerance: Option<EngineTolerance>) -> Self {
        /// Deviations from which on a point counts less, and not at all.
        const UNLIKELY: f64 = 3.0;
        const OUTLIER: f64 = 6.0;
        let (far, near) = match declared {
            Loss::Square => (Loss::Huber(UNLIKELY), Loss::Tukey(OUTLIER)),
            declared => (declared.convex(), declared),
        };
        let within = tolerance.map(|tolerance| tolerance.size).or(term.within.map(|_| size));
        let region = tolerance.map(|tolerance| tolerance.region);
        Self { far, near, loss: far, within, region, alike: 1.0, weight: term.weight }
    }

    /// Whether the surface is near. Before, a loss that leaves out what is far off would leave out what is right.
    pub(super) fn set_near(&mut self, is_near: bool) {
        self.loss = if is_near { self.near } else { self.far };
    }

    /// Takes over the points of a cloud.
    pub(super) fn see(&mut self, cloud: &[Vector3<f64>]) {
        self.alike = alike(cloud, self.region);
    }

    /// The standard deviation that points count with, where it is declared: larger where several are worth one together.
    pub(super) fn within(&self) -> Option<f64> {
        self.within.map(|within| within * self.alike.sqrt())
    }

    /// The loss of a misfit that counts with the standard deviation `sigma`. Whether it is an outlier, the deviation of a single
    /// point says.
    pub(super) fn rho(&self, misfit: f64, sigma: f64) -> f64 {
        self.weight / self.alike * self.loss.rho(misfit / sigma * self.alike.sqrt())
    }

    /// What the square of a misfit is multiplied by to minimise its loss.
    pub(super) fn precision(&self, misfit: f64, sigma: f64) -> f64 {
        self.weight * self.loss.weight(misfit / sigma * self.alike.sqrt()) / (sigma * sigma)
    }
}

/// Points of a cloud in a cube of this size, the mean over all cubes that have any; one if there is no size.
fn alike(cloud: &[Vector3<f64>], region: Option<f64>) -> f64 {
    let Some(region) = region else { return 1.0 };
    let cubes: HashSet<[i64; 3]> =
        cloud.iter().map(|point| point.map(|x| (x / region).floor() as i64).into()).collect();
    (cloud.len() as f64 / cubes.len() as f64).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two millimetres apart on a square of 20 mm: a hundred points, in cubes of 5 mm from -10 to 10.
    #[test]
    fn points_of_a_region_are_counted() {
        let at = |i: i32| 2.0 * f64::from(i) - 9.0;
        let cloud: Vec<Vector3<f64>> = (0..100).map(|i| Vector3::new(at(i % 10), at(i / 10), 1.0)).collect();
        assert_eq!(alike(&cloud, Some(5.0)), 100.0 / 16.0);
        assert_eq!(alike(&cloud, Some(1.0)), 1.0);
        assert_eq!(alike(&cloud, None), 1.0);
        assert_eq!(alike(&[], Some(1.0)), 1.0);
    }
}
