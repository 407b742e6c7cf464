//! Where an equation itself jumps: a heater that acts on a part of a body, a drive that is switched. Values of fields are followed there by
//! no spline, since the highest derivative jumps as well.

use crate::ends::ranges;
use crate::problem::Bound;

/// Nodes of a grid that no cells ask to be finer, about.
const NODES: f64 = 4e4;
/// Pieces of the grid to a cell along a coordinate, at least: a jump that crosses a cell then crosses a line of the grid in it.
const TO_A_CELL: usize = 2;
/// How often the piece that has a jump is halved.
const HALVINGS: usize = 30;
/// Change along a piece, over the largest row, that is looked at.
const SLIGHT: f64 = 1e-3;
/// Share of a change that is left in the better half of its piece each time, at least. Of a smooth change a half is left, of a jump all;
/// and of all of it in the end.
const HALF: f64 = 0.45;
const KEPT: f64 = 0.5;
/// Halvings after which a smooth change is known for one.
const SMOOTH: i32 = 6;

/// Pieces along every coordinate of a grid for so many coordinates.
pub(crate) fn even(inputs: usize) -> Vec<usize> {
    vec![NODES.powf((inputs as f64).recip()).ceil() as usize; inputs]
}

/// Pieces where so many cells ask for more than [`even`] has; nothing where they do not.
pub(crate) fn finer(cells: &[usize]) -> Option<Vec<usize>> {
    let even = even(cells.len());
    let pieces: Vec<usize> = even.iter().zip(cells).map(|(&even, cells)| even.max(TO_A_CELL * cells)).collect();
    (pieces != even).then_some(pieces)
}

/// Points of a group's range, flat, at which one of its rows jumps where fields and sources do not: found between neighbouring nodes of a
/// grid of so many pieces along every coordinate.
pub(crate) fn jumps(bound: &Bound, group: usize, pieces: &[usize]) -> Vec<f64> {
    // Fields and sources are none of them zero and no two the same: what multiplies a difference must not vanish with it. Multiples of
    // the golden ratio, without their whole parts, are apart.
    let apart = |number: usize| 1.0 + (number as f64 * 0.618_033_988_749_895).fract();
    let jets = bound.problem.scene().schema.groups[group].jets.iter().enumerate();
    let jets: Vec<f64> = jets.map(|(at, own)| apart(at) * bound.typical(own)).collect();
    let mut scalars = bound.scalars.clone();
    // What is learned may start at nothing.
    bound.learned.iter().filter(|own| bound.scalars[own.slot] == 0.0).for_each(|own| scalars[own.slot] = 1.0);
    let rows = |points: &[f64]| bound.uniform_rows(group, (points, &[]), &jets, &scalars);
    found(&rows, &ranges([&bound.coordinates[group]], pieces.len()), pieces)
}

/// Rows, `[row][point]`, at points that are given flat.
type Rows<'a> = &'a dyn Fn(&[f64]) -> Vec<Vec<f64>>;

/// Points, flat, at which rows jump within ranges of the coordinates.
fn found(rows: Rows<'_>, ranges: &[(f64, f64)], pieces: &[usize]) -> Vec<f64> {
    let inputs = ranges.len();
    let nodes: usize = pieces.iter().map(|n| n + 1).product();
    let node = |number: usize| {
        let mut rest = number;
        let along = |(n, (low, high)): (&usize, &(f64, f64))| {
            let share = (rest % (n + 1)) as f64 / *n as f64;
            rest /= n + 1;
            low + share * (high - low)
        };
        pieces.iter().zip(ranges).map(along).collect::<Vec<f64>>()
    };
    let grid: Vec<f64> = (0..nodes).flat_map(node).collect();
    let point = |at: usize| grid[at * inputs..][..inputs].to_vec();
    let of_row = |(number, row): (usize, &Vec<f64>)| {
        let largest = row.iter().filter(|x| x.is_finite()).fold(0.0, |most: f64, x| most.max(x.abs()));
        let mut changing = Vec::new();
        let mut stride = 1;
        for n in pieces {
            let is_inner = |at: &usize| at / stride % (n + 1) < *n;
            let ends = (0..nodes).filter(is_inner).map(|at| [at, at + stride]);
            let is_change = |[from, to]: &[usize; 2]| (row[*to] - row[*from]).abs() > SLIGHT * largest;
            changing.extend(ends.filter(is_change));
            stride *= n + 1;
        }
        let piece = |[from, to]: [usize; 2]| Piece {
            ends: [point(from), point(to)],
            values: [row[from], row[to]],
            change: (row[to] - row[from]).abs(),
        };
        narrowed(rows, number, changing.into_iter().map(piece).collect())
    };
    rows(&grid).iter().enumerate().flat_map(of_row).collect()
}

/// A straight piece, and a row at its ends.
struct Piece {
    ends: [Vec<f64>; 2],
    values: [f64; 2],
    /// The row's change along it at first.
    change: f64,
}

/// The places of jumps in pieces.
fn narrowed(rows: Rows<'_>, row: usize, mut pieces: Vec<Piece>) -> Vec<f64> {
    for halving in 1..=HALVINGS as i32 {
        let middle = |piece: &Piece| {
            let [from, to] = &piece.ends;
            from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<f64>>()
        };
        let middles: Vec<Vec<f64>> = pieces.iter().map(middle).collect();
        if middles.is_empty() {
            break;
        }
        let values = rows(&middles.concat()).swap_remove(row);
        for (piece, (middle, value)) in pieces.iter_mut().zip(middles.into_iter().zip(values)) {
            let end = usize::from((value - piece.values[0]).abs() >= (piece.values[1] - value).abs());
            (piece.ends[end], piece.values[end]) = (middle, value);
        }
        let least = if halving < SMOOTH { HALF.powi(halving) } else { KEPT };
        pieces.retain(|piece| (piece.values[1] - piece.values[0]).abs() > least * piece.change);
    }
    pieces.into_iter().flat_map(|piece| piece.ends.into_iter().next_back()).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places at which a function of two coordinates jumps in a box, on a grid of 24 by 10 pieces.
    fn places(of: impl Fn(f64, f64) -> f64) -> Vec<[f64; 2]> {
        let rows = |points: &[f64]| vec![points.as_chunks::<2>().0.iter().map(|&[x, y]| of(x, y)).collect()];
        let found = found(&rows, &[(-1.0, 2.0), (0.0, 5.0)], &[24, 10]);
        found.as_chunks::<2>().0.to_vec()
    }

    #[test]
    fn a_wall_of_a_step_is_found_on_every_line_that_crosses_it() {
        let found = places(|x, y| 3.0 + y + if x < 0.3 { 0.0 } else { 2.0 });
        assert_eq!(found.len(), 11);
        assert!(found.iter().all(|[x, _]| (x - 0.3).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn oblique_steps_and_rims_are_found_where_they_are() {
        let line = places(|x, y| if x + 0.5 * y < 1.7 { 1.0 } else { -1.0 });
        assert!(line.len() > 24 && line.iter().all(|[x, y]| (x + 0.5 * y - 1.7).abs() < 1e-8));
        // Rows of two values, of which the one jumps on a circle and the other nowhere.
        let rows = |points: &[f64]| {
            let points = points.as_chunks::<2>().0;
            let heated = |&[x, y]: &[f64; 2]| f64::from(u8::from((x - 0.4).powi(2) + (y - 2.1).powi(2) < 0.81));
            vec![points.iter().map(|[x, y]| x * y).collect(), points.iter().map(heated).collect()]
        };
        let rim = found(&rows, &[(-1.0, 2.0), (0.0, 5.0)], &[30, 50]);
        let off = |[x, y]: &[f64; 2]| ((x - 0.4).hypot(y - 2.1) - 0.9).abs();
        assert!(rim.len() > 40 && rim.as_chunks::<2>().0.iter().all(|place| off(place) < 1e-8));
    }

    #[test]
    fn what_is_smooth_or_has_a_kink_does_not_jump() {
        assert!(places(|x, y| (2.0 * x).sin() * y.exp()).is_empty());
        assert!(places(|x, y| (x - 0.3).abs() + y).is_empty());
        assert!(places(|x, _| (x - 0.3).max(0.0)).is_empty());
        // As steep as a hundredth of a piece.
        assert!(places(|x, _| ((x - 0.3) / 1.25e-3).tanh()).is_empty());
    }

    #[test]
    fn grids_are_as_fine_as_cells_ask() {
        assert_eq!(even(2), [200, 200]);
        assert_eq!(finer(&[40, 100]), None);
        assert_eq!(finer(&[40, 160]), Some(vec![200, 320]));
        assert_eq!(finer(&[30, 10, 30]).map(|pieces| pieces[0]), Some(60));
    }
}
