//! Points on a boundary, evenly spaced, with outward normals and weights that add up to its length or area.

use super::interior::{cell_middles, cells};
use super::round::{on_ball, on_cylinder};
use super::{Domain, Points, Shape, edges};

/// Points from which the size of a combined boundary is found.
const MEASURED: usize = 4096;

/// Steps in which the arc length of an ellipse is tabulated. The sum converges spectrally: this is exact to rounding
/// for any ellipse less flat than 1 : 100.
const ARC_STEPS: usize = 4096;

impl Domain {
    /// About `count` points on the whole boundary.
    pub fn boundary(&self, count: usize) -> Points {
        let mut out = Points { dim: self.dim(), coords: vec![], normals: Some(vec![]), weights: Some(vec![]) };
        match &self.shape {
            Shape::Box { low, high } => on_box(low, high, count, &mut out),
            Shape::Ellipse { centre, semi_axes } => on_ellipse(*centre, *semi_axes, count, &mut out),
            Shape::Polygon { vertices } => on_polygon(vertices, count, &mut out),
            Shape::Ball { centre, radius } => on_ball(*centre, *radius, count, &mut out),
            Shape::Cylinder { base, ends } => on_cylinder(base, *ends, count, &mut out),
            Shape::Solid(solid) => solid.boundary(count, &mut out),
            Shape::Pair(pair) => return pair.boundary(count),
        }
        out
    }

    /// Length of a plane domain's edge, area of a solid's surface, 2 for an interval.
    pub fn boundary_measure(&self) -> f64 {
        match &self.shape {
            Shape::Box { low, high } => {
                (0..low.len()).map(|axis| 2.0 * face(low, high, axis).iter().product::<f64>()).sum()
            }
            Shape::Ellipse { semi_axes, .. } => arc_table(*semi_axes)[ARC_STEPS],
            Shape::Polygon { vertices } => edges(vertices).map(|(p, q)| distance(p, q)).sum(),
            Shape::Ball { radius, .. } => 4.0 * std::f64::consts::PI * radius * radius,
            Shape::Cylinder { base, ends } => base.boundary_measure() * (ends[1] - ends[0]) + 2.0 * base.measure(),
            Shape::Solid(solid) => solid.area(),
            Shape::Pair(pair) => pair.boundary(MEASURED).weights.iter().flatten().sum(),
        }
    }
}

/// Side lengths of the faces across an axis.
fn face(low: &[f64], high: &[f64], axis: usize) -> Vec<f64> {
    (0..low.len()).filter(|&other| other != axis).map(|other| high[other] - low[other]).collect()
}

fn on_box(low: &[f64], high: &[f64], count: usize, out: &mut Points) {
    let dim = low.len();
    let areas: Vec<f64> = (0..dim).map(|axis| face(low, high, axis).iter().product()).collect();
    let total: f64 = 2.0 * areas.iter().sum::<f64>();
    for axis in 0..dim {
        let lengths = face(low, high, axis);
        let share = (count as f64 * areas[axis] / total).round().max(1.0) as usize;
        let counts = cells(&lengths, share);
        let points: usize = counts.iter().product();
        let middles = cell_middles(&counts);
        for (end, sign) in [(low, -1.0), (high, 1.0)] {
            for index in 0..points {
                let mut inner = middles[index * (dim - 1)..(index + 1) * (dim - 1)].iter();
                let along = |other: usize| {
                    let u = if other == axis { None } else { inner.next() };
                    u.map_or(end[axis], |u| low[other] + u * (high[other] - low[other]))
                };
                let point: Vec<f64> = (0..dim).map(along).collect();
                let normal: Vec<f64> = (0..dim).map(|other| if other == axis { sign } else { 0.0 }).collect();
                out.add(&point, &normal, areas[axis] / points as f64);
            }
        }
    }
}

/// Arc length from the positive first axis, at equal steps of the parameter.
fn arc_table([a, b]: [f64; 2]) -> Vec<f64> {
    let step = std::f64::consts::TAU / ARC_STEPS as f64;
    // Middles of the steps: for a periodic integrand as good as any rule.
    let speed = |index: usize| {
        let angle = (index as f64 + 0.5) * step;
        (a * angle.sin()).hypot(b * angle.cos())
    };
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain((0..ARC_STEPS).map(|index| {
            sum += step * speed(index);
            sum
        }))
        .collect()
}

fn on_ellipse(centre: [f64; 2], [a, b]: [f64; 2], count: usize, out: &mut Points) {
    let table = arc_table([a, b]);
    let weight = table[ARC_STEPS] / count.max(1) as f64;
    for index in 0..count {
        let arc = index as f64 * weight;
        let cell = table.partition_point(|&length| length <= arc).clamp(1, ARC_STEPS) - 1;
        let share = (arc - table[cell]) / (table[cell + 1] - table[cell]);
        let angle = std::f64::consts::TAU * (cell as f64 + share) / ARC_STEPS as f64;
        let (sin, cos) = angle.sin_cos();
        let (nx, ny) = (cos / a, sin / b);
        let size = nx.hypot(ny);
        out.add(&[centre[0] + a * cos, centre[1] + b * sin], &[nx / size, ny / size], weight);
    }
}

fn on_polygon(vertices: &[[f64; 2]], count: usize, out: &mut Points) {
    let total: f64 = edges(vertices).map(|(p, q)| distance(p, q)).sum();
    for (p, q) in edges(vertices) {
        let length = distance(p, q);
        let pieces = (count as f64 * length / total).round().max(1.0) as usize;
        // Counterclockwise corners: outside is to the right of each edge.
        let normal = [(q[1] - p[1]) / length, (p[0] - q[0]) / length];
        for piece in 0..pieces {
            let u = (piece as f64 + 0.5) / pieces as f64;
            out.add(&[p[0] + u * (q[0] - p[0]), p[1] + u * (q[1] - p[1])], &normal, length / pieces as f64);
        }
    }
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (q[0] - p[0]).hypot(q[1] - p[1])
}
