//! Values on a regular grid, from points that stand on one or anywhere.

use crate::DataError;
use crate::export::triangulate;

/// Nodes along the longer side when scattered points are interpolated.
const NODES: usize = 160;

/// Ratio of two spans from which on they are of quantities that share no scale, like metres and seconds.
const ALIKE: f64 = 8.0;

/// Whether spans of this ratio have a scale each.
pub(super) fn is_stretched(wide: f64, tall: f64) -> bool {
    wide.max(tall) > ALIKE * wide.min(tall)
}

/// Values on a regular grid. NaN where there is nothing.
#[derive(Debug, Clone)]
pub struct Grid {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// Row by row from the lowest y: `values[row * x.len() + column]`.
    pub(super) values: Vec<f64>,
}

impl Grid {
    /// From points. If they stand on a regular grid it is taken as it is; otherwise values are interpolated linearly.
    pub fn from_points(points: &[[f64; 2]], values: &[f64]) -> Result<Grid, DataError> {
        if points.len() != values.len() || points.len() < 4 {
            return Err(DataError::invalid(format!(
                "a map needs four points or more and a value for each, not {} and {}",
                points.len(),
                values.len()
            )));
        }
        if points.iter().flatten().any(|value| !value.is_finite()) {
            return Err(DataError::invalid("a map needs finite points"));
        }
        let (x, y) = (levels(points, 0), levels(points, 1));
        // A region cut from a grid fills at least a third of its box.
        if x.len() > 1 && y.len() > 1 && x.len() * y.len() <= 3 * points.len() {
            return Ok(Grid::regular(x, y, points, values));
        }
        Grid::interpolated(points, values)
    }

    /// A mask as a grid of zeros and ones.
    pub fn from_mask(points: &[[f64; 2]], mask: &[bool]) -> Result<Grid, DataError> {
        Grid::from_points(points, &mask.iter().map(|&inside| f64::from(u8::from(inside))).collect::<Vec<_>>())
    }

    fn regular(x: Vec<f64>, y: Vec<f64>, points: &[[f64; 2]], values: &[f64]) -> Grid {
        let mut grid = Grid { values: vec![f64::NAN; x.len() * y.len()], x, y };
        for (point, value) in points.iter().zip(values) {
            let at = nearest_level(&grid.y, point[1]) * grid.x.len() + nearest_level(&grid.x, point[0]);
            grid.values[at] = *value;
        }
        grid
    }

    fn interpolated(points: &[[f64; 2]], values: &[f64]) -> Result<Grid, DataError> {
        let span = |axis: usize| {
            let low = points.iter().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
            let high = points.iter().map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max);
            (low, high)
        };
        let ((left, right), (bottom, top)) = (span(0), span(1));
        let (wide, tall) = (right - left, top - bottom);
        if wide.max(tall) <= 0.0 {
            return Err(DataError::invalid("all points of the map coincide"));
        }
        // Neighbours are near on the picture.
        let [by_x, by_y] = if wide.min(tall) > 0.0 && is_stretched(wide, tall) { [wide, tall] } else { [1.0; 2] };
        let points: Vec<[f64; 2]> = points.iter().map(|[x, y]| [(x - left) / by_x, (y - bottom) / by_y]).collect();
        let (wide, tall) = (wide / by_x, tall / by_y);
        let step = wide.max(tall) / (NODES - 1) as f64;
        let along = |length: f64| (0..=(length / step).round() as usize).map(|index| step * index as f64).collect();
        let (x, y): (Vec<f64>, Vec<f64>) = (along(wide), along(tall));
        let mut grid = Grid { values: vec![f64::NAN; x.len() * y.len()], x, y };
        for corners in triangulate(&points, None)? {
            grid.fill_triangle(corners.map(|index| points[index]), corners.map(|index| values[index]));
        }
        grid.x.iter_mut().for_each(|x| *x = left + by_x * *x);
        grid.y.iter_mut().for_each(|y| *y = bottom + by_y * *y);
        Ok(grid)
    }

    /// Sets the nodes inside a triangle by linear interpolation.
    fn fill_triangle(&mut self, [a, b, c]: [[f64; 2]; 3], values: [f64; 3]) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 {
            return;
        }
        let range = |nodes: &[f64], axis: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]);
            let high = a[axis].max(b[axis]).max(c[axis]);
            nodes.partition_point(|&node| node < low - 1e-12)..nodes.partition_point(|&node| node <= high + 1e-12)
        };
        let (columns, rows) = (range(&self.x, 0), range(&self.y, 1));
        for row in rows {
            for column in columns.clone() {
                let (x, y) = (self.x[column], self.y[row]);
                let second = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
                let third = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                let shares = [1.0 - second - third, second, third];
                if shares.iter().all(|&share| share >= -1e-9) {
                    let value = shares.iter().zip(values).map(|(share, value)| share * value).sum();
                    self.values[row * self.x.len() + column] = value;
                }
            }
        }
    }

    /// The same grid with every empty node given the value of a filled neighbour, so that colours reach the outline.
    pub(super) fn spread(&self) -> Grid {
        let mut grid = self.clone();
        let (width, height) = (grid.x.len(), grid.y.len());
        let mut front: Vec<usize> = (0..grid.values.len()).filter(|&at| !grid.values[at].is_nan()).collect();
        while !front.is_empty() {
            let mut next = Vec::new();
            for at in front {
                let (row, column) = (at / width, at % width);
                let sides = [
                    (column > 0).then(|| at - 1),
                    (column + 1 < width).then(|| at + 1),
                    (row > 0).then(|| at - width),
                    (row + 1 < height).then(|| at + width),
                ];
                for side in sides.into_iter().flatten().filter(|&side| grid.values[side].is_nan()).collect::<Vec<_>>() {
                    grid.values[side] = grid.values[at];
                    next.push(side);
                }
            }
            front = next;
        }
        grid
    }

    /// Bilinear value at a place; the border's value beyond it.
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let ((left, right, u), (low, high, v)) = (bracket(&self.x, x), bracket(&self.y, y));
        let value = |row: usize, column: usize| self.values[row * self.x.len() + column];
        let below = value(low, left) * (1.0 - u) + value(low, right) * u;
        let above = value(high, left) * (1.0 - u) + value(high, right) * u;
        below * (1.0 - v) + above * v
    }

    /// Whether the node nearest to a place is filled.
    pub(super) fn covers(&self, x: f64, y: f64) -> bool {
        !self.values[nearest_level(&self.y, y) * self.x.len() + nearest_level(&self.x, x)].is_nan()
    }
}

/// The two nodes around a coordinate and the share of the way between them.
fn bracket(nodes: &[f64], value: f64) -> (usize, usize, f64) {
    let last = nodes.len() - 1;
    let high = nodes.partition_point(|&node| node < value).clamp(1, last.max(1)).min(last);
    let low = high.saturating_sub(1);
    if low == high {
        return (low, high, 0.0);
    }
    (low, high, ((value - nodes[low]) / (nodes[high] - nodes[low])).clamp(0.0, 1.0))
}

fn nearest_level(nodes: &[f64], value: f64) -> usize {
    let (low, high, share) = bracket(nodes, value);
    if share < 0.5 { low } else { high }
}

/// The distinct coordinates along an axis.
fn levels(points: &[[f64; 2]], axis: usize) -> Vec<f64> {
    let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
    values.sort_by(f64::total_cmp);
    let tolerance = 1e-7 * (values[values.len() - 1] - values[0]);
    values.dedup_by(|next, kept| *next - *kept <= tolerance);
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattered_points_give_their_plane_back() {
        let points: Vec<[f64; 2]> =
            (0..400).map(|i| [(f64::from(i) * 0.618).fract(), (f64::from(i) * 0.7548).fract()]).collect();
        let values: Vec<f64> = points.iter().map(|p| 2.0 * p[0] - p[1]).collect();
        let grid = Grid::from_points(&points, &values).unwrap();
        assert!((grid.at(0.4, 0.5) - 0.3).abs() < 1e-9);
        let tiles: Vec<[f64; 2]> = (0..20).map(|i| [f64::from(i % 5), f64::from(i / 5)]).collect();
        let grid = Grid::from_points(&tiles, &(0..20).map(f64::from).collect::<Vec<_>>()).unwrap();
        assert_eq!((grid.x.len(), grid.y.len(), grid.at(1.0, 1.0)), (5, 4, 6.0));
        assert!(Grid::from_points(&[[0.0, 0.0]; 5], &[0.0; 5]).is_err());
    }
}
