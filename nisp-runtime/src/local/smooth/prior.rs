//! What is believed of heads before any measurement: they bend little (the energy of a thin plate). Where answers are doubted,
//! sources are believed to change little instead (that of a membrane). Lengths and times make no distance: both are counted in cells,
//! of which there are as many along the longest length as along the longest time.

use crate::local::block::Block;
use crate::local::heads::Heads;
use crate::local::lattice::Lattice;

/// Rows of differences of a head's coefficients.
#[derive(Clone, Debug)]
pub(super) struct Prior {
    /// By row, its coefficients and what they are multiplied by.
    rows: Vec<(Vec<u32>, Vec<f64>)>,
    /// Numbers that the rows say of the coefficients.
    pub(super) rank: usize,
    /// Roughness of a head that changes by its natural size over the longest side of the lattice.
    pub(super) natural: f64,
}

impl Prior {
    /// First differences along every coordinate: the integral of the squared gradient.
    pub(super) fn flat(heads: &Heads, head: usize) -> Self {
        let lattice = &heads.lattices[head];
        let mut rows = Vec::new();
        for axis in 0..lattice.dimensions() {
            let factor = root_of_cell(lattice) / spacing(lattice);
            for (at, next) in lattice.neighbours(axis) {
                rows.push(row(heads.first[head], &[at, next], &[-factor, factor]));
            }
        }
        Self { rows, rank: lattice.len().saturating_sub(1), natural: natural(lattice) }
    }

    /// Second differences along every coordinate and across every pair of them: the integral of all squared second derivatives.
    pub(super) fn straight(heads: &Heads, head: usize) -> Self {
        let lattice = &heads.lattices[head];
        let dimensions = lattice.dimensions();
        let mut rows = Vec::new();
        for axis in 0..dimensions {
            let next = next(lattice, axis);
            let factor = root_of_cell(lattice) / spacing(lattice).powi(2);
            let line = |at: usize| next[at].and_then(|one| Some([at as u32, one, next[one as usize]?]));
            for numbers in (0..lattice.len()).filter_map(line) {
                rows.push(row(heads.first[head], &numbers, &[factor, -2.0 * factor, factor]));
            }
            for other in axis + 1..dimensions {
                let across = self::next(lattice, other);
                let factor = 2f64.sqrt() * root_of_cell(lattice) / spacing(lattice).powi(2);
                let corners = |at: usize| {
                    let (along, up) = (next[at]?, across[at]?);
                    Some([at as u32, along, up, across[along as usize]?])
                };
                for numbers in (0..lattice.len()).filter_map(corners) {
                    rows.push(row(heads.first[head], &numbers, &[factor, -factor, -factor, factor]));
                }
            }
        }
        Self { rows, rank: lattice.len().saturating_sub(dimensions + 1), natural: natural(lattice) }
    }

    /// The rows at a state, over the head's roughness.
    pub(super) fn blocks(&self, theta: &[f64], roughness: f64, learned: usize) -> Vec<Block> {
        let block = |(numbers, factors): &(Vec<u32>, Vec<f64>)| {
            let slopes: Vec<f64> = factors.iter().map(|factor| factor / roughness).collect();
            let value = numbers.iter().zip(&slopes).map(|(&at, slope)| theta[at as usize] * slope).sum();
            Block { misfits: vec![value], by_learned: vec![0.0; learned], dofs: numbers.clone(), slopes, excess: 0.0 }
        };
        self.rows.iter().map(block).collect()
    }
}

/// Variance of second differences of coefficients from a cell to the next, of a head of this roughness that bends little.
pub(super) fn bends(lattice: &Lattice, roughness: f64) -> f64 {
    (roughness * spacing(lattice).powi(2) / root_of_cell(lattice)).powi(2)
}

/// Variance of differences of coefficients from a cell to the next, of a head of this roughness that changes little.
pub(super) fn changes(lattice: &Lattice, roughness: f64) -> f64 {
    (roughness * spacing(lattice) / root_of_cell(lattice)).powi(2)
}

/// A cell along any coordinate, over the longest side.
fn spacing(lattice: &Lattice) -> f64 {
    1.0 / lattice.cells.iter().copied().max().unwrap_or(1) as f64
}

/// Root of a cell's volume.
fn root_of_cell(lattice: &Lattice) -> f64 {
    spacing(lattice).powi(lattice.dimensions() as i32).sqrt()
}

/// Root of the integral of the square of a derivative that is one over the longest side to the power of its order.
fn natural(lattice: &Lattice) -> f64 {
    lattice.cells.iter().map(|cells| *cells as f64 * spacing(lattice)).product::<f64>().sqrt()
}

/// A row over these functions of the head whose coefficients begin at `first`.
fn row(first: usize, numbers: &[u32], factors: &[f64]) -> (Vec<u32>, Vec<f64>) {
    (numbers.iter().map(|number| first as u32 + number).collect(), factors.to_vec())
}

/// By number of a function, the number of the next along a coordinate.
pub(super) fn next(lattice: &Lattice, axis: usize) -> Vec<Option<u32>> {
    let mut next = vec![None; lattice.len()];
    lattice.neighbours(axis).for_each(|(at, after)| next[at as usize] = Some(after));
    next
}
