//! Level lines of a grid by marching squares, as short pieces (drawn together they are the line). A region that reaches the
//! grid's border is closed along it.

use super::grid::Grid;

/// Pieces of the line where the grid passes `level`. Empty nodes count as far below it.
pub(super) fn level_line(grid: &Grid, level: f64) -> Vec<[[f64; 2]; 2]> {
    let width = grid.x.len();
    let value = |row: usize, column: usize| {
        let value = grid.values[row * width + column];
        if value.is_nan() { 0f64.min(level - 1.0) } else { value }
    };
    let mut pieces = Vec::new();
    for row in 0..grid.y.len().saturating_sub(1) {
        for column in 0..width.saturating_sub(1) {
            let corner = |dr: usize, dc: usize| ([grid.x[column + dc], grid.y[row + dr]], value(row + dr, column + dc));
            let ring = [corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)];
            pieces.extend(cell(&ring, level));
        }
    }
    let (last_row, last_column) = (grid.y.len() - 1, width - 1);
    let node = |row: usize, column: usize| ([grid.x[column], grid.y[row]], value(row, column));
    for column in 0..last_column {
        pieces.extend([0, last_row].iter().filter_map(|&row| above(node(row, column), node(row, column + 1), level)));
    }
    for row in 0..last_row {
        pieces.extend([0, last_column].iter().filter_map(|&side| above(node(row, side), node(row + 1, side), level)));
    }
    pieces
}

/// The part of an edge that lies at the level or above.
fn above((p, a): ([f64; 2], f64), (q, b): ([f64; 2], f64), level: f64) -> Option<[[f64; 2]; 2]> {
    let share = (level - a) / (b - a);
    let crossing = [p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])];
    match (a >= level, b >= level) {
        (true, true) => Some([p, q]),
        (true, false) => Some([p, crossing]),
        (false, true) => Some([crossing, q]),
        (false, false) => None,
    }
}

/// Pieces inside one cell, whose corners are given in a ring.
fn cell(ring: &[([f64; 2], f64); 4], level: f64) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let crossing = |k: usize| {
        let ((p, a), (q, b)) = (ring[k], ring[(k + 1) % 4]);
        ((a < level) != (b < level)).then(|| {
            let share = (level - a) / (b - a);
            [p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]
        })
    };
    let crossings: Vec<[f64; 2]> = (0..4).filter_map(crossing).collect();
    // Two crossings are one piece; four (a saddle) are two pieces, joined as they come around the ring.
    (0..crossings.len() / 2).map(move |k| [crossings[2 * k], crossings[2 * k + 1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pieces around a region that reaches the border have the length of its edge.
    #[test]
    fn regions_are_closed_along_the_border() {
        let points: Vec<[f64; 2]> = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5)]).collect();
        let length = |of: &dyn Fn(&[f64; 2]) -> f64, level: f64| -> f64 {
            let grid = Grid::from_points(&points, &points.iter().map(of).collect::<Vec<_>>()).unwrap();
            level_line(&grid, level).iter().map(|[p, q]| (q[0] - p[0]).hypot(q[1] - p[1])).sum()
        };
        // All of a square of side 4, its part left of x = 1.25, and none of it.
        assert!((length(&|_| 1.0, 0.5) - 16.0).abs() < 1e-12);
        assert!((length(&|p| -p[0], -1.25) - 10.5).abs() < 1e-12);
        assert_eq!(length(&|_| 0.0, 0.5), 0.0);
    }
}
