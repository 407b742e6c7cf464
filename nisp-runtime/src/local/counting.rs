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
    /// What is declared of points that are off alike.
    tolerance: Option<EngineTolerance>,
    /// Points that count as one, in the mean over the cloud.
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
        Self { far, near, loss: far, within, tolerance, alike: 1.0, weight: term.weight }
    }

    /// Whether the surface is near. Before, a loss that leaves out what is far off would leave out what is right.
    pub(super) fn set_near(&mut self, is_near: bool) {
        self.loss = if is_near { self.near } else { self.far };
    }

    /// Takes over the points of a cloud.
    pub(super) fn see(&mut self, cloud: &[Vector3<f64>]) {
        self.alike = self.tolerance.map_or(1.0, |tolerance| alike(cloud, tolerance));
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

/// How many points count as one where those of a region have a share of their variance in common: Kish's design effect (1965), by the
/// mean number of points in cubes of the region's size that have any.
fn alike(cloud: &[Vector3<f64>], tolerance: EngineTolerance) -> f64 {
    let cube = |point: &Vector3<f64>| point.map(|x| (x / tolerance.region).floor() as i64).into();
    let cubes: HashSet<[i64; 3]> = cloud.iter().map(cube).collect();
    1.0 + tolerance.common * (cloud.len() as f64 / cubes.len() as f64 - 1.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two millimetres apart on a square of 20 mm: a hundred points, in cubes of 5 mm from -10 to 10.
    #[test]
    fn points_of_a_region_are_counted() {
        let at = |i: i32| 2.0 * f64::from(i) - 9.0;
        let cloud: Vec<Vector3<f64>> = (0..100).map(|i| Vector3::new(at(i % 10), at(i / 10), 1.0)).collect();
        let alike =
            |cloud: &[Vector3<f64>], region, common| alike(cloud, EngineTolerance { size: 1.0, region, common });
        assert_eq!(alike(&cloud, 5.0, 1.0), 100.0 / 16.0);
        assert_eq!(alike(&cloud, 5.0, 0.5), 0.5 * (1.0 + 100.0 / 16.0));
        assert_eq!(alike(&cloud, 5.0, 0.0), 1.0);
        assert_eq!(alike(&cloud, 1.0, 1.0), 1.0);
        assert_eq!(alike(&[], 1.0, 1.0), 1.0);
    }
}
