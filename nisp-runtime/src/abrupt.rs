//! Where an equation itself jumps: a heater that acts on a part of a body, a drive that is switched. Values of fields are followed there by
//! no spline, since the highest derivative jumps as well.

use crate::problem::Bound;
use crate::residual::Points;
use crate::simd::Isa;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;
/// Nodes of the grid, about.
const NODES: f64 = 4e4;
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

/// Points of a group's range, flat, at which one of its rows jumps where fields and sources do not: found between neighbouring nodes of an
/// even grid.
pub(crate) fn jumps(bound: &Bound, group: usize) -> Vec<f64> {
    let inputs = bound.problem.scene().schema.coordinates.len();
    let steps = vec![NODES.powf((inputs as f64).recip()).ceil() as usize; inputs];
    let range = |axis: usize| {
        let values = bound.coordinates[group].iter().skip(axis).step_by(inputs);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
    };
    let ranges: Vec<(f64, f64)> = (0..inputs).map(range).collect();
    let nodes: usize = steps.iter().map(|n| n + 1).product();
    let node = |number: usize| {
        let mut rest = number;
        let along = |(n, (low, high)): (&usize, &(f64, f64))| {
            let share = (rest % (n + 1)) as f64 / *n as f64;
            rest /= n + 1;
            low + share * (high - low)
        };
        steps.iter().zip(&ranges).map(along).collect::<Vec<f64>>()
    };
    let grid: Vec<f64> = (0..nodes).flat_map(node).collect();
    let values = rows(bound, group, &grid);
    let mut found = Vec::new();
    for row in &values {
        let largest = row.iter().filter(|x| x.is_finite()).fold(0.0, |most: f64, x| most.max(x.abs()));
        let mut pieces = Vec::new();
        let mut stride = 1;
        for n in &steps {
            let is_inner = |at: &usize| at / stride % (n + 1) < *n;
            let ends = (0..nodes).filter(is_inner).map(|at| [at, at + stride]);
            let is_change = |[from, to]: &[usize; 2]| (row[*to] - row[*from]).abs() > SLIGHT * largest;
            pieces.extend(ends.filter(is_change));
            stride *= n + 1;
        }
        let point = |at: usize| grid[at * inputs..][..inputs].to_vec();
        let piece = |[from, to]: [usize; 2]| Piece {
            ends: [point(from), point(to)],
            values: [row[from], row[to]],
            change: (row[to] - row[from]).abs(),
        };
        found.push(pieces.into_iter().map(piece).collect::<Vec<Piece>>());
    }
    (found.into_iter().enumerate()).flat_map(|(row, pieces)| narrowed(bound, group, row, pieces)).collect()
}

/// A straight piece, and a row at its ends.
struct Piece {
    ends: [Vec<f64>; 2],
    values: [f64; 2],
    /// The row's change along it at first.
    change: f64,
}

/// The places of jumps in pieces.
fn narrowed(bound: &Bound, group: usize, row: usize, mut pieces: Vec<Piece>) -> Vec<f64> {
    for halving in 1..=HALVINGS as i32 {
        let middle = |piece: &Piece| {
            let [from, to] = &piece.ends;
            from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<f64>>()
        };
        let middles: Vec<Vec<f64>> = pieces.iter().map(middle).collect();
        if middles.is_empty() {
            break;
        }
        let values = rows(bound, group, &middles.concat()).swap_remove(row);
        for (piece, (middle, value)) in pieces.iter_mut().zip(middles.into_iter().zip(values)) {
            let end = usize::from((value - piece.values[0]).abs() >= (piece.values[1] - value).abs());
            (piece.ends[end], piece.values[end]) = (middle, value);
        }
        let least = if halving < SMOOTH { HALF.powi(halving) } else { KEPT };
        pieces.retain(|piece| (piece.values[1] - piece.values[0]).abs() > least * piece.change);
    }
    pieces.into_iter().flat_map(|piece| piece.ends.into_iter().next_back()).flatten().collect()
}

/// Rows of a group at points, given flat, with the same fields and sources everywhere, none of them zero and no two the same: what multiplies a
/// difference must not vanish with it.
fn rows(bound: &Bound, group: usize, points: &[f64]) -> Vec<Vec<f64>> {
    let schema = bound.problem.scene().schema;
    let (own, inputs) = (&schema.groups[group], schema.coordinates.len());
    let kernels = bound.problem.scene().double();
    let count = points.len() / inputs;
    let stride = count.next_multiple_of(LANES);
    let jet = |jet: &crate::schema::Jet| {
        let over = jet.degree.iter().zip(&bound.scaling.half).map(|(&n, half)| half.powi(i32::from(n)));
        bound.head_scale(jet.head) / over.product::<f64>()
    };
    // Multiples of the golden ratio, without their whole parts.
    let apart = |number: usize| 1.0 + (number as f64 * 0.618_033_988_749_895).fract();
    let jets = own.jets.iter().enumerate();
    let jets: Vec<f64> = jets.flat_map(|(at, own)| std::iter::repeat_n(apart(at) * jet(own), stride)).collect();
    let along = |axis: usize| (0..stride).map(move |p| points[p.min(count - 1) * inputs + axis]);
    let coordinates: Vec<f64> = (0..inputs).flat_map(along).collect();
    let mut scalars = bound.scalars.clone();
    // What is learned may start at nothing.
    bound.learned.iter().filter(|own| bound.scalars[own.slot] == 0.0).for_each(|own| scalars[own.slot] = 1.0);
    let mut values = vec![0.0; own.rows * stride];
    let points =
        Points { count, stride, jets: &jets, coordinates: &coordinates, columns: &[], scalars: &scalars, seeds: &[] };
    kernels[group].programs.residual(Isa::detect(), points, &mut values);
    values.chunks_exact(stride).map(|row| row[..count].to_vec()).collect()
}
