//! What the theory of a free surface leaves unexplained, as a smooth field over the plane of the rim.

use std::num::NonZero;

use nisp::nearest::Nearest;
use nisp_data::{Cloud, DataError};
use serde::{Deserialize, Serialize};

/// Nodes along the longer axis: on a bubble of twelve centimetres every two millimetres.
const NODES: usize = 61;
/// Points of which a node takes the median: it is known to a tenth of their noise.
const POINTS: NonZero<usize> = NonZero::new(100).unwrap();

/// How far a seen surface is from the theory's: vectors in metres on a grid over the plane of the rim.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// First and last node along x, in metres.
    x_m: [f64; 2],
    /// The same along y.
    y_m: [f64; 2],
    /// Vectors, row by row along x.
    vectors_m: Vec<Vec<[f64; 3]>>,
}

/// A point of a cloud in the frame of the rim, and how far it is from the theory's surface.
pub(crate) struct Off {
    /// Its place over the plane of the rim, in metres.
    pub(crate) place: [f64; 2],
    /// Its distance along the surface's normal, in metres.
    pub(crate) distance: f64,
    /// The normal, of unit length.
    pub(crate) normal: [f64; 3],
}

impl Deviation {
    /// The median of what the nearest points are off, at nodes over a rectangle around the origin with these half sides.
    ///
    /// # Errors
    /// No points, or some that are not finite.
    pub(crate) fn fit(points: &[Off], half: [f64; 2]) -> Result<Self, DataError> {
        let places: Vec<[f64; 2]> = points.iter().map(|point| point.place).collect();
        let none = || DataError::Invalid("a deviation needs at least one point, and only finite ones".into());
        let tree = Nearest::of(&places).ok_or_else(none)?;
        let spacing = 2.0 * half[0].max(half[1]) / (NODES - 1) as f64;
        let counts = half.map(|half| 2 + (2.0 * half / spacing) as usize);
        let at = |axis: usize, index: usize| half[axis] * (2.0 * index as f64 / (counts[axis] - 1) as f64 - 1.0);
        let node = |row: usize, column: usize| {
            let near: Vec<&Off> =
                tree.some(&[at(0, column), at(1, row)], POINTS).iter().map(|found| &points[found.index]).collect();
            let mut distances: Vec<f64> = near.iter().map(|point| point.distance).collect();
            let middle = distances.len() / 2;
            let (_, median, _) = distances.select_nth_unstable_by(middle, f64::total_cmp);
            let normal: [f64; 3] = std::array::from_fn(|axis| near.iter().map(|point| point.normal[axis]).sum::<f64>());
            let length = super::face::length(normal);
            normal.map(|x| *median * x / length)
        };
        let row = |row: usize| (0..counts[0]).map(|column| node(row, column)).collect();
        let vectors_m = (0..counts[1]).map(row).collect();
        Ok(Self { x_m: [-half[0], half[0]], y_m: [-half[1], half[1]], vectors_m })
    }

    /// The deviation at a place, linear between nodes and constant beyond the last.
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let rows = self.vectors_m.len();
        let columns = self.vectors_m.first().map_or(0, Vec::len);
        if rows < 2 || columns < 2 {
            return [0.0; 3];
        }
        let place = |value: f64, [first, last]: [f64; 2], nodes: usize| {
            let share = ((value - first) / (last - first)).clamp(0.0, 1.0) * (nodes - 1) as f64;
            let low = (share as usize).min(nodes - 2);
            (low, share - low as f64)
        };
        let ((column, s), (row, t)) = (place(x, self.x_m, columns), place(y, self.y_m, rows));
        let corner = |down: usize, right: usize| self.vectors_m[row + down][column + right];
        let [a, b, c, d] = [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)];
        std::array::from_fn(|i| (1.0 - t) * ((1.0 - s) * a[i] + s * b[i]) + t * ((1.0 - s) * c[i] + s * d[i]))
    }

    /// Takes the deviation off a cloud in the frame of the rim.
    pub(crate) fn correct(&self, cloud: &mut Cloud) {
        for point in &mut cloud.points {
            let off = self.at([point[0], point[1]]);
            *point = std::array::from_fn(|axis| point[axis] - off[axis]);
        }
    }

    /// Places of all nodes over the plane of the rim, and the deviation's length at each: above zero where the surface was seen
    /// above the theory's. In metres.
    pub fn sizes(&self) -> (Vec<[f64; 2]>, Vec<f64>) {
        let rows = self.vectors_m.len();
        let along = |[first, last]: [f64; 2], index: usize, count: usize| {
            first + (last - first) * index as f64 / (count.max(2) - 1) as f64
        };
        let node = |(row, vectors): (usize, &Vec<[f64; 3]>)| -> Vec<([f64; 2], f64)> {
            let y = along(self.y_m, row, rows);
            let own = vectors.iter().enumerate();
            own.map(|(at, v)| ([along(self.x_m, at, vectors.len()), y], super::face::length(*v).copysign(v[2])))
                .collect()
        };
        self.vectors_m.iter().enumerate().flat_map(node).unzip()
    }

    /// Whether the grid is one.
    pub(crate) fn is_whole(&self) -> bool {
        let columns = self.vectors_m.first().map_or(0, Vec::len);
        self.vectors_m.iter().all(|row| row.len() == columns) && self.x_m[0] < self.x_m[1] && self.y_m[0] < self.y_m[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane bump seen with outliers: the field follows it, and the outliers do not draw it.
    #[test]
    fn a_bump_is_found_and_outliers_are_not() {
        let bump = |x: f64, y: f64| 1e-3 * (-(x * x + y * y) / (2.0 * 0.03 * 0.03)).exp();
        let points: Vec<Off> = (0..300 * 200)
            .map(|i| {
                let (x, y) = (0.06 * (f64::from(i % 300) / 149.5 - 1.0), 0.04 * (f64::from(i / 300) / 99.5 - 1.0));
                let distance = if i % 10 == 0 { 0.02 } else { bump(x, y) };
                Off { place: [x, y], distance, normal: [0.0, 0.0, 1.0] }
            })
            .collect();
        let field = Deviation::fit(&points, [0.06, 0.04]).unwrap();
        assert!(field.is_whole());
        for [x, y] in [[0.0, 0.0], [0.021, 0.013], [-0.05, 0.03]] {
            let [a, b, c] = field.at([x, y]);
            assert_eq!([a, b], [0.0, 0.0]);
            assert!((c - bump(x, y)).abs() < 3e-5, "{c} {}", bump(x, y));
        }
        // Beyond the last node it stays what it is there.
        assert_eq!(field.at([0.1, 0.0]), field.at([0.06, 0.0]));
    }
}
