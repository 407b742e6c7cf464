//! Where equations hold: intervals, boxes, discs, ellipses, polygons, balls, cylinders, solids, what is in either of two or in
//! one and not in the other; and the points that stand for them.
//!
//! Interior and boundary points come with weights that add up to the length, area or volume, so that a weighted sum
//! over them is an integral. Boundary points have outward normals.

mod boundary;
mod combined;
mod interior;
mod points;
mod resample;
mod round;
mod sequence;
mod solid;

pub use points::Points;
pub use resample::resample;

use crate::DataError;
use crate::cloud::Surface;
use combined::Pair;
use solid::Solid;

/// A region of space, space-time or the time axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Any dimension, an interval included.
    Box {
        low: Vec<f64>,
        high: Vec<f64>,
    },
    Ellipse {
        centre: [f64; 2],
        semi_axes: [f64; 2],
    },
    /// Counterclockwise.
    Polygon {
        vertices: Vec<[f64; 2]>,
    },
    Ball {
        centre: [f64; 3],
        radius: f64,
    },
    /// Along the third coordinate.
    Cylinder {
        base: Box<Domain>,
        ends: [f64; 2],
    },
    Solid(Solid),
    Pair(Box<Pair>),
}

/// How points are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Independent draws.
    Uniform,
    /// Sobol's sequence, shifted by the seed: fills evenly at any count.
    #[default]
    Sobol,
    /// One point in each slice of each axis.
    LatinHypercube,
    /// Regular, without chance. The count is met as nearly as a regular arrangement allows.
    Grid,
}

impl Domain {
    /// From `low` to `high`.
    pub fn interval(low: f64, high: f64) -> Result<Domain, DataError> {
        Domain::cuboid(&[low], &[high])
    }

    /// A box of any dimension between two corners.
    pub fn cuboid(low: &[f64], high: &[f64]) -> Result<Domain, DataError> {
        let ordered = low.iter().zip(high).all(|(a, b)| a.is_finite() && b.is_finite() && a < b);
        if low.len() != high.len() || low.is_empty() || !ordered {
            return Err(DataError::invalid(
                "a box needs finite corners, the lower one below the upper one on each axis",
            ));
        }
        if low.len() > sequence::MAX_DIM {
            let most = sequence::MAX_DIM;
            return Err(DataError::invalid(format!("a box of {} dimensions; at most {most} are supported", low.len())));
        }
        Ok(Domain { shape: Shape::Box { low: low.to_vec(), high: high.to_vec() } })
    }

    /// A disc.
    pub fn disc(centre: [f64; 2], radius: f64) -> Result<Domain, DataError> {
        Domain::ellipse(centre, [radius, radius])
    }

    /// An ellipse with its axes along the coordinates.
    pub fn ellipse(centre: [f64; 2], semi_axes: [f64; 2]) -> Result<Domain, DataError> {
        let good = centre.iter().all(|value| value.is_finite());
        if !good || !semi_axes.iter().all(|axis| axis.is_finite() && *axis > 0.0) {
            return Err(DataError::invalid("an ellipse needs a finite centre and positive semi-axes"));
        }
        Ok(Domain { shape: Shape::Ellipse { centre, semi_axes } })
    }

    /// A simple polygon, its corners in either sense of rotation.
    pub fn polygon(vertices: &[[f64; 2]]) -> Result<Domain, DataError> {
        if vertices.len() < 3 || vertices.iter().flatten().any(|value| !value.is_finite()) {
            return Err(DataError::invalid("a polygon needs at least three finite corners"));
        }
        let area = signed_area(vertices);
        if area == 0.0 || crosses_itself(vertices) {
            return Err(DataError::invalid("the polygon has no area or crosses itself; list its corners in order"));
        }
        let mut vertices = vertices.to_vec();
        if area < 0.0 {
            vertices.reverse();
        }
        Ok(Domain { shape: Shape::Polygon { vertices } })
    }

    /// A ball.
    pub fn ball(centre: [f64; 3], radius: f64) -> Result<Domain, DataError> {
        if !(centre.iter().all(|value| value.is_finite()) && radius.is_finite() && radius > 0.0) {
            return Err(DataError::invalid("a ball needs a finite centre and a positive radius"));
        }
        Ok(Domain { shape: Shape::Ball { centre, radius } })
    }

    /// A cylinder along the third coordinate, with its lids.
    pub fn cylinder(centre: [f64; 2], radius: f64, ends: [f64; 2]) -> Result<Domain, DataError> {
        let base = Box::new(Domain::disc(centre, radius)?);
        Domain::interval(ends[0], ends[1])?;
        Ok(Domain { shape: Shape::Cylinder { base, ends } })
    }

    /// The inside of a closed surface whose coordinates are multiplied by `scale`.
    pub fn solid(surface: &Surface, scale: f64) -> Result<Domain, DataError> {
        Ok(Domain { shape: Shape::Solid(Solid::new(surface, scale)?) })
    }

    /// What is in either of two regions of the same coordinates.
    pub fn plus(self, other: Domain) -> Result<Domain, DataError> {
        self.pair(other, true)
    }

    /// What is in this region and not in another one of the same coordinates.
    pub fn minus(self, other: Domain) -> Result<Domain, DataError> {
        self.pair(other, false)
    }

    fn pair(self, second: Domain, either: bool) -> Result<Domain, DataError> {
        if self.dim() != second.dim() {
            return Err(DataError::invalid("regions to be combined must have the same coordinates"));
        }
        let pair = Pair::new(self, second, either);
        if pair.measure <= 0.0 {
            return Err(DataError::invalid("nothing of the region is left"));
        }
        Ok(Domain { shape: Shape::Pair(Box::new(pair)) })
    }

    /// How many coordinates a point has.
    pub fn dim(&self) -> usize {
        match &self.shape {
            Shape::Box { low, .. } => low.len(),
            Shape::Ellipse { .. } | Shape::Polygon { .. } => 2,
            Shape::Ball { .. } | Shape::Cylinder { .. } | Shape::Solid(_) => 3,
            Shape::Pair(pair) => pair.first.dim(),
        }
    }

    /// Length, area or volume; of combined regions to about a thousandth where their boundaries cross.
    pub fn measure(&self) -> f64 {
        match &self.shape {
            Shape::Box { low, high } => low.iter().zip(high).map(|(a, b)| b - a).product(),
            Shape::Ellipse { semi_axes: [a, b], .. } => std::f64::consts::PI * a * b,
            Shape::Polygon { vertices } => signed_area(vertices),
            Shape::Ball { radius, .. } => 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3),
            Shape::Cylinder { base, ends } => base.measure() * (ends[1] - ends[0]),
            Shape::Solid(solid) => solid.volume(),
            Shape::Pair(pair) => pair.measure,
        }
    }

    /// The smallest box around the domain: its lower and its upper corner.
    pub fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        match &self.shape {
            Shape::Box { low, high } => (low.clone(), high.clone()),
            Shape::Ellipse { centre: [x, y], semi_axes: [a, b] } => (vec![x - a, y - b], vec![x + a, y + b]),
            Shape::Polygon { vertices } => {
                let pick = |axis: usize, better: fn(f64, f64) -> f64| {
                    vertices.iter().map(|vertex| vertex[axis]).reduce(better).unwrap_or(0.0)
                };
                (vec![pick(0, f64::min), pick(1, f64::min)], vec![pick(0, f64::max), pick(1, f64::max)])
            }
            Shape::Ball { centre, radius } => {
                (centre.map(|x| x - radius).to_vec(), centre.map(|x| x + radius).to_vec())
            }
            Shape::Cylinder { base, ends } => {
                let (mut low, mut high) = base.bounds();
                low.push(ends[0]);
                high.push(ends[1]);
                (low, high)
            }
            Shape::Solid(solid) => solid.bounds(),
            Shape::Pair(pair) => pair.bounds(),
        }
    }

    /// Whether a point lies inside or on the boundary.
    pub fn contains(&self, point: &[f64]) -> bool {
        match &self.shape {
            Shape::Box { low, high } => {
                point.len() == low.len() && point.iter().zip(low).zip(high).all(|((x, a), b)| a <= x && x <= b)
            }
            Shape::Ellipse { centre, semi_axes } => {
                let scaled = |axis: usize| (point[axis] - centre[axis]) / semi_axes[axis];
                point.len() == 2 && scaled(0).powi(2) + scaled(1).powi(2) <= 1.0
            }
            Shape::Polygon { vertices } => point.len() == 2 && inside_polygon([point[0], point[1]], vertices),
            Shape::Ball { centre, radius } => {
                let square: f64 = point.iter().zip(centre).map(|(x, c)| (x - c).powi(2)).sum();
                point.len() == 3 && square <= radius * radius
            }
            Shape::Cylinder { base, ends } => {
                point.len() == 3 && (ends[0]..=ends[1]).contains(&point[2]) && base.contains(&point[..2])
            }
            Shape::Solid(solid) => point.len() == 3 && solid.contains([point[0], point[1], point[2]]),
            Shape::Pair(pair) => pair.contains(point),
        }
    }

    /// The boundary as a closed curve of about `count` corners, for drawing. Empty unless the domain is plane.
    pub fn outline(&self, count: usize) -> Vec<[f64; 2]> {
        match &self.shape {
            Shape::Box { low, high } if low.len() == 2 => {
                vec![[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
            }
            Shape::Box { .. } | Shape::Ball { .. } | Shape::Cylinder { .. } | Shape::Solid(_) => Vec::new(),
            // The first one's, where the other one is a hole in it.
            Shape::Pair(pair) if !pair.either => pair.first.outline(count),
            Shape::Pair(_) => Vec::new(),
            Shape::Ellipse { centre, semi_axes } => {
                let at = |index: usize| std::f64::consts::TAU * index as f64 / count.max(3) as f64;
                let corner =
                    |angle: f64| [centre[0] + semi_axes[0] * angle.cos(), centre[1] + semi_axes[1] * angle.sin()];
                (0..count.max(3)).map(|index| corner(at(index))).collect()
            }
            Shape::Polygon { vertices } => vertices.clone(),
        }
    }
}

fn edges(vertices: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    vertices.iter().copied().zip(vertices.iter().copied().cycle().skip(1))
}

fn signed_area(vertices: &[[f64; 2]]) -> f64 {
    edges(vertices).map(|(p, q)| p[0] * q[1] - q[0] * p[1]).sum::<f64>() / 2.0
}

/// Counts the edges that a ray to the right crosses.
fn inside_polygon([x, y]: [f64; 2], vertices: &[[f64; 2]]) -> bool {
    let crossed = |(p, q): ([f64; 2], [f64; 2])| {
        (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
    };
    edges(vertices).filter(|&edge| crossed(edge)).count() % 2 == 1
}

fn crosses_itself(vertices: &[[f64; 2]]) -> bool {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let list: Vec<_> = edges(vertices).collect();
    list.iter().enumerate().any(|(index, &(a, b))| {
        list[index + 1..]
            .iter()
            .any(|&(c, d)| side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0)
    })
}
