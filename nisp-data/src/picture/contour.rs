//! Level lines of a grid by marching squares, as short pieces (drawn together they are the line).

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
    pieces
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
