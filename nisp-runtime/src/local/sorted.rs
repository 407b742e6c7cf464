//! A block as the normal matrix wants it: products of its rows' slopes, column by column, and where they go.

use std::collections::HashMap;

use super::block::Block;
use crate::simd::{Isa, Kernel, Simd, dispatch};

/// Rows whose products are summed up at once: a sum is read and written once for all of them.
const ROWS: usize = 8;

/// A block's rows by the coefficients that are kept, in ascending order.
pub(super) struct Sorted {
    pub(super) dofs: Vec<u32>,
    /// By coefficient: where the run of consecutive numbers that it is in ends.
    runs: Vec<u32>,
    /// `[row][coefficient]`
    slopes: Vec<f64>,
    /// By row: its misfit, then its derivatives by the learned scalars.
    beside: Vec<f64>,
}

impl Sorted {
    pub(super) fn of(block: &Block) -> Self {
        let mut kept: Vec<(usize, u32)> = block.kept().collect();
        kept.sort_unstable_by_key(|&(_, dof)| dof);
        let rows = block.slopes.chunks_exact(block.dofs.len().max(1));
        // A point and its partner may share some of them.
        let same = || kept.chunk_by(|(_, one), (_, other)| one == other);
        let slopes: Vec<f64> =
            rows.flat_map(|row| same().map(|places| places.iter().map(|&(at, _)| row[at]).sum::<f64>())).collect();
        let dofs: Vec<u32> = same().map(|places| places[0].1).collect();
        let mut runs = vec![dofs.len() as u32; dofs.len()];
        for at in (1..dofs.len()).rev() {
            runs[at - 1] = if dofs[at - 1] + 1 == dofs[at] { runs[at] } else { at as u32 };
        }
        let learned = block.by_learned.len() / block.misfits.len().max(1);
        let beside = block.misfits.iter().enumerate().flat_map(|(row, misfit)| {
            std::iter::once(misfit).chain(&block.by_learned[row * learned..(row + 1) * learned]).copied()
        });
        Self { dofs, runs, slopes, beside: beside.collect() }
    }

    /// The same rows, where those of blocks over the same coefficients stand in one block: their sums go to the matrix at once.
    pub(super) fn together(blocks: Vec<Self>) -> Vec<Self> {
        let mut places: HashMap<(u32, u32, usize), usize> = HashMap::new();
        let mut together: Vec<Self> = Vec::new();
        for block in blocks {
            let (Some(&first), Some(&last)) = (block.dofs.first(), block.dofs.last()) else { continue };
            let place = *places.entry((first, last, block.dofs.len())).or_insert(together.len());
            match together.get_mut(place) {
                Some(own) if own.dofs == block.dofs => {
                    own.slopes.extend(block.slopes);
                    own.beside.extend(block.beside);
                }
                _ => together.push(block),
            }
        }
        together
    }

    /// Adds the products of a coefficient's slopes with the rows' misfits and with their derivatives by each learned scalar.
    pub(super) fn beside<'a>(&self, at: usize, sums: impl Iterator<Item = &'a mut f64>) {
        let width = self.dofs.len();
        let rows = self.slopes.len() / width;
        let each = self.beside.len() / rows.max(1);
        for (number, sum) in sums.enumerate() {
            *sum += (0..rows).map(|row| self.slopes[row * width + at] * self.beside[row * each + number]).sum::<f64>();
        }
    }

    /// Products of a coefficient's slopes with its own and those of all after it, summed over the rows.
    pub(super) fn products(&self, isa: Isa, at: usize, line: &mut Vec<f64>) {
        line.clear();
        line.resize(self.dofs.len() - at, 0.0);
        dispatch(isa, Products { block: self, at, line });
    }

    /// Adds [`Sorted::products`] to a column of the matrix, which has entries for `indices`.
    pub(super) fn scatter(&self, at: usize, line: &[f64], indices: &[usize], values: &mut [f64]) {
        let (mut from, mut place) = (at, 0);
        while from < self.dofs.len() && place < indices.len() {
            let end = self.runs[from] as usize;
            place = first_from(indices, place, self.dofs[from] as usize);
            // Coefficients of a run that the pattern has all lie side by side there too.
            let sums = &line[from - at..end - at];
            let last = place + sums.len() - 1;
            if indices.get(last).is_some_and(|&row| row == self.dofs[end - 1] as usize) {
                values[place..=last].iter_mut().zip(sums).for_each(|(value, sum)| *value += sum);
            } else {
                for (sum, &row) in sums.iter().zip(&self.dofs[from..end]) {
                    if let Ok(place) = indices.binary_search(&(row as usize)) {
                        values[place] += sum;
                    }
                }
            }
            from = end;
        }
    }
}

/// Sums `slopes[row][at] * slopes[row][at..]` over the rows into a line.
struct Products<'a> {
    block: &'a Sorted,
    at: usize,
    line: &'a mut [f64],
}

impl Kernel<f64> for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = f64>>(self) {
        let Self { block, at, line } = self;
        let width = block.dofs.len();
        let mut together = block.slopes.chunks_exact(ROWS * width);
        for rows in &mut together {
            add::<V, ROWS>(rows, at, line);
        }
        for row in together.remainder().chunks_exact(width) {
            add::<V, 1>(row, at, line);
        }
    }
}

/// Adds `row[at] * row[at..]` of so many rows to a line, one row after the other. No closures: they would not have the vectors'
/// instructions.
#[inline(always)]
fn add<V: Simd<Elem = f64>, const COUNT: usize>(rows: &[f64], at: usize, line: &mut [f64]) {
    let width = rows.len() / COUNT;
    let rows: [&[f64]; COUNT] = std::array::from_fn(|row| &rows[row * width + at..][..line.len()]);
    let own = rows.map(|row| row[0]);
    if own.iter().all(|own| *own == 0.0) {
        return;
    }
    let mut factors = [V::splat(0.0); COUNT];
    for row in 0..COUNT {
        factors[row] = V::splat(own[row]);
    }
    let whole = line.len() - line.len() % V::LANES;
    for from in (0..whole).step_by(V::LANES) {
        // SAFETY: the line and the rows have LANES elements from there on.
        unsafe {
            let mut sum = V::load(line.as_ptr().add(from));
            for row in 0..COUNT {
                sum = V::load(rows[row].as_ptr().add(from)).mul_add(factors[row], sum);
            }
            sum.store(line.as_mut_ptr().add(from));
        }
    }
    for (at, sum) in line.iter_mut().enumerate().skip(whole) {
        rows.iter().zip(own).for_each(|(row, own)| *sum += own * row[at]);
    }
}

/// The first place at or after `from` whose index is not below `row`; usually near.
fn first_from(indices: &[usize], from: usize, row: usize) -> usize {
    if indices.get(from).is_none_or(|&index| index >= row) {
        return from;
    }
    let (mut low, mut step) = (from, 1);
    while low + step < indices.len() && indices[low + step] < row {
        low += step;
        step *= 2;
    }
    let high = (low + step).min(indices.len());
    low + indices[low..high].partition_point(|&index| index < row)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of five coefficients, one of them not kept, into a column that lacks one of the products.
    #[test]
    fn products_land_where_the_pattern_has_them() {
        let block = Block {
            misfits: vec![0.0; 2],
            by_learned: Vec::new(),
            dofs: vec![7, 3, crate::local::lattice::NONE, 4, 5],
            slopes: vec![1.0, 2.0, 9.0, 3.0, 0.5, -1.0, 4.0, 9.0, 0.0, 2.0],
            excess: 0.0,
        };
        let sorted = Sorted::of(&block);
        assert_eq!(
            (sorted.dofs.as_slice(), sorted.runs.as_slice()),
            ([3, 4, 5, 7].as_slice(), [3, 3, 3, 4].as_slice())
        );
        let mut line = Vec::new();
        sorted.products(Isa::detect(), 0, &mut line);
        assert_eq!(line, [20.0, 6.0, 9.0, -2.0]);
        let mut values = [1.0; 4];
        sorted.scatter(0, &line, &[3, 4, 5, 9], &mut values);
        assert_eq!(values, [21.0, 7.0, 10.0, 1.0]);
        let mut values = [1.0; 4];
        sorted.scatter(0, &line, &[3, 5, 6, 7], &mut values);
        assert_eq!(values, [21.0, 10.0, 1.0, -1.0]);
    }

    /// More rows than are summed up at once, and more coefficients than a vector has lanes: small whole numbers, whose sums are exact.
    #[test]
    fn products_of_many_rows_are_their_sums() {
        let (rows, width) = (2 * ROWS + 3, 21);
        let slope = |row: usize, at: usize| ((7 * row + 5 * at) % 11) as f64 - 5.0;
        let block = Block {
            misfits: vec![0.0; rows],
            by_learned: Vec::new(),
            dofs: (0..width as u32).collect(),
            slopes: (0..rows * width).map(|number| slope(number / width, number % width)).collect(),
            excess: 0.0,
        };
        let (sorted, mut line) = (Sorted::of(&block), Vec::new());
        for at in 0..width {
            sorted.products(Isa::detect(), at, &mut line);
            let sum = |other: usize| (0..rows).map(|row| slope(row, at) * slope(row, other)).sum::<f64>();
            assert_eq!(line, (at..width).map(sum).collect::<Vec<f64>>());
        }
    }
}
