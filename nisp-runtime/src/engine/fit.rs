//! A surface of points of `D` coordinates beside its cloud: from what belongs to what to a sum of squares at each point.

use super::assign::{self, Assignment};
use super::form::Form;
use crate::loss::Loss;

/// How the distances between a surface and its cloud count.
#[derive(Clone, Copy)]
pub(super) struct Measure {
    /// Both directions, not only cloud to surface.
    pub(super) symmetric: bool,
    /// Only the distance across the surface.
    pub(super) plane: bool,
    pub(super) loss: Loss,
}

/// A surface and its cloud, whatever the number of coordinates.
pub(super) trait Fit: Send + Sync {
    /// Points of the cloud.
    fn cloud_points(&self) -> usize;

    /// The surface to assign next, flat and point by point, to be written.
    fn surface(&mut self) -> &mut [f64];

    /// True once the cloud has been assigned.
    fn is_assigned(&self) -> bool;

    /// Assigns the cloud to the surface; `size` is what distances are divided by before a robust loss judges them. Gives
    /// the part of the sum of squared distances that no surface can mend, if sums have changed. A surface that is not
    /// finite changes nothing.
    fn refresh(&mut self, size: f64) -> Option<f64>;

    /// How far each point of the cloud is from the surface as last assigned, by coordinate or across it.
    fn misfits(&self) -> Vec<f64>;

    /// The sum at a surface point, `|R (x - o) - t|^2`: `o`, `t`, and `R` by rows, upper triangular.
    fn sum(&self, at: usize) -> (&[f64], &[f64], &[f64]);
}

/// A surface of so many points, and its cloud, flat and point by point; nothing unless there are two to four coordinates,
/// and a point of the cloud.
pub(super) fn fit(cloud: &[f64], dimensions: usize, points: usize, measure: Measure) -> Option<Box<dyn Fit>> {
    Some(match dimensions {
        2 => Box::new(Fitted::<2>::new(cloud, points, measure)?),
        3 => Box::new(Fitted::<3>::new(cloud, points, measure)?),
        4 => Box::new(Fitted::<4>::new(cloud, points, measure)?),
        _ => return None,
    })
}

struct Fitted<const D: usize> {
    measure: Measure,
    assignment: Assignment<D>,
    surface: Vec<[f64; D]>,
    /// Where sums are counted from.
    origins: Vec<[f64; D]>,
    sums: Vec<Form<D>>,
    /// Across the surface, if distances are measured so.
    normals: Vec<[f64; D]>,
    /// The cloud point nearest to each surface point, if it counts.
    partners: Vec<usize>,
}

impl<const D: usize> Fitted<D> {
    fn new(cloud: &[f64], points: usize, measure: Measure) -> Option<Self> {
        Some(Self {
            measure,
            assignment: Assignment::new(cloud.as_chunks().0.to_vec())?,
            surface: vec![[0.0; D]; points],
            origins: vec![[0.0; D]; points],
            sums: vec![Form::ZERO; points],
            normals: Vec::new(),
            partners: Vec::new(),
        })
    }

    /// True if sums follow from what belongs to what alone, and not from where the surface is.
    fn is_frozen(&self) -> bool {
        self.measure.loss == Loss::Square && !self.measure.plane && !self.measure.symmetric
    }

    /// Counts sums from the mean of what belongs to each point where that can be, so that what belongs to what decides
    /// their last bit, and from the surface otherwise.
    fn move_origins(&mut self) {
        if !self.is_frozen() {
            self.origins.copy_from_slice(&self.surface);
            return;
        }
        let (sums, origins) = (&mut self.sums, &mut self.origins);
        sums.fill(Form::ZERO);
        for (point, &at) in self.assignment.points().iter().zip(self.assignment.nearest()) {
            sums[at].add(point, None, 1.0, (Loss::Square, 1.0));
        }
        for (origin, sum) in origins.iter_mut().zip(sums) {
            *origin = sum.b.map(|total| total / sum.a[0][0].max(1.0));
        }
    }

    fn add_up(&mut self, size: f64) {
        let Self { measure, assignment, surface, origins, sums, normals, partners } = self;
        sums.fill(Form::ZERO);
        let mut add = |at: usize, datum: usize, weight: f64| {
            let point = &assignment.points()[datum];
            let distance = std::array::from_fn(|i| point[i] - origins[at][i]);
            sums[at].add(&distance, normals.get(at), weight, (measure.loss, size));
        };
        for (datum, &at) in assignment.nearest().iter().enumerate() {
            add(at, datum, 1.0);
        }
        if measure.symmetric {
            assignment.nearest_of(surface, partners);
            let weight = assignment.points().len() as f64 / surface.len() as f64;
            for (at, &datum) in partners.iter().enumerate() {
                add(at, datum, weight);
            }
        }
    }
}

impl<const D: usize> Fit for Fitted<D> {
    fn cloud_points(&self) -> usize {
        self.assignment.points().len()
    }

    fn surface(&mut self) -> &mut [f64] {
        self.surface.as_flattened_mut()
    }

    fn is_assigned(&self) -> bool {
        !self.assignment.nearest().is_empty()
    }

    fn refresh(&mut self, size: f64) -> Option<f64> {
        if self.surface.as_flattened().iter().any(|x| !x.is_finite()) {
            return None;
        }
        let changed = self.assignment.assign(&self.surface);
        if self.is_frozen() && !changed {
            return None;
        }
        if self.measure.plane {
            assign::normals(&self.surface, &mut self.normals);
        }
        self.move_origins();
        self.add_up(size);
        Some(self.sums.iter_mut().map(Form::complete_square).sum())
    }

    fn misfits(&self) -> Vec<f64> {
        let mut misfits = Vec::new();
        for (point, &at) in self.assignment.points().iter().zip(self.assignment.nearest()) {
            let distance: [f64; D] = std::array::from_fn(|i| point[i] - self.surface[at][i]);
            match self.normals.get(at) {
                Some(normal) => misfits.push(normal.iter().zip(&distance).map(|(n, r)| n * r).sum()),
                None => misfits.extend(distance),
            }
        }
        misfits
    }

    fn sum(&self, at: usize) -> (&[f64], &[f64], &[f64]) {
        let Form { a, b, .. } = &self.sums[at];
        (&self.origins[at], b, a.as_flattened())
    }
}
