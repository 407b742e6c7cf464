//! Blocks as the normal matrix wants them: products of their rows' slopes, column by column, and where they go.

use std::collections::HashMap;
use std::ops::Range;

use super::block::Block;
use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::Isa;
use crate::solve::dense::rows::ALIGN;

/// Rows by the coefficients that are kept, in ascending order.
pub(super) struct Sorted {
    pub(super) dofs: Vec<u32>,
    /// By coefficient: where the run of consecutive numbers that it is in ends.
    runs: Vec<u32>,
    /// `[row][coefficient]`, with zeros up to whole vectors.
    slopes: Vec<f64>,
    /// By row: its misfit, then its derivatives by the learned scalars, then zeros up to whole vectors.
    beside: Vec<f64>,
    /// Numbers of a row of these.
    each: usize,
}

/// Products of some coefficients' slopes.
#[derive(Default)]
pub(super) struct Products {
    /// The first of the coefficients.
    own: usize,
    /// The coefficient from which on their slopes are multiplied: the last before `own` that a vector begins with.
    first: usize,
    /// By coefficient, with all slopes from there on.
    with_slopes: Vec<f64>,
    /// By coefficient, with the misfits, then with the derivatives by each learned scalar.
    beside: Vec<f64>,
    /// By coefficient, its place in the column that products were added to last.
    places: Vec<usize>,
}

impl Sorted {
    /// The rows of blocks that are all over the same coefficients.
    pub(super) fn of(blocks: &[Block]) -> Self {
        let mut kept: Vec<(usize, u32)> = blocks[0].kept().collect();
        kept.sort_unstable_by_key(|&(_, dof)| dof);
        // A point and its partner may share some of them.
        let same = || kept.chunk_by(|(_, one), (_, other)| one == other);
        let dofs: Vec<u32> = same().map(|places| places[0].1).collect();
        let mut runs = vec![dofs.len() as u32; dofs.len()];
        for at in (1..dofs.len()).rev() {
            runs[at - 1] = if dofs[at - 1] + 1 == dofs[at] { runs[at] } else { at as u32 };
        }
        let rows: usize = blocks.iter().map(|block| block.misfits.len()).sum();
        let learned = blocks[0].by_learned.len() / blocks[0].misfits.len().max(1);
        let (stride, each) = (dofs.len().next_multiple_of(ALIGN), (1 + learned).next_multiple_of(ALIGN));
        let (mut slopes, mut beside) = (vec![0.0; rows * stride], vec![0.0; rows * each]);
        let mut lines = slopes.chunks_exact_mut(stride.max(1)).zip(beside.chunks_exact_mut(each));
        for block in blocks {
            for (row, (slopes, beside)) in (0..block.misfits.len()).zip(lines.by_ref()) {
                let own = &block.slopes[row * block.dofs.len()..];
                for (slope, places) in slopes.iter_mut().zip(same()) {
                    *slope = places.iter().map(|&(at, _)| own[at]).sum();
                }
                beside[0] = block.misfits[row];
                beside[1..=learned].copy_from_slice(&block.by_learned[row * learned..][..learned]);
            }
        }
        Self { dofs, runs, slopes, beside, each }
    }

    /// Numbers of a row of slopes.
    fn stride(&self) -> usize {
        self.dofs.len().next_multiple_of(ALIGN)
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

    /// Products of some coefficients' slopes with their own and those of all after them, and with what is beside them, summed over the
    /// rows.
    pub(super) fn products(&self, isa: Isa, own: Range<usize>, products: &mut Products) {
        let (stride, rows) = (self.stride(), self.beside.len() / self.each);
        let first = own.start - own.start % ALIGN;
        let Products { with_slopes, beside, .. } = products;
        let multiply = |to: &mut Vec<f64>, elements: &[f64], stride: usize, columns: usize| {
            to.resize(own.len() * columns, 0.0);
            let shape = Shape { rows: own.len(), columns, inner: rows };
            let left = Left::transposed(&self.slopes[own.start..], self.stride());
            gemm(isa, shape, left, Right::Rows { elements, stride }, to, columns, Write::Set);
        };
        multiply(with_slopes, &self.slopes[first..], stride, stride - first);
        multiply(beside, &self.beside, self.each, self.each);
        (products.own, products.first) = (own.start, first);
    }

    /// Adds a coefficient's products with misfits, and with the derivatives by each learned scalar.
    pub(super) fn add_beside<'a>(&self, at: usize, products: &Products, sums: impl Iterator<Item = &'a mut f64>) {
        sums.zip(products.beside(at, self.each)).for_each(|(sum, product)| *sum += product);
    }

    /// Adds a coefficient's products to its column of the matrix, which has entries for `indices`.
    pub(super) fn scatter(&self, at: usize, products: &mut Products, indices: &[usize], values: &mut [f64]) {
        let mut places = std::mem::take(&mut products.places);
        places.resize(self.dofs.len(), 0);
        let line = products.with_slopes(at, self.stride());
        let (mut from, mut place) = (at, 0);
        while from < self.dofs.len() && place < indices.len() {
            let (end, row) = (self.runs[from] as usize, self.dofs[from] as usize);
            // Columns that follow each other have nearly the same entries, each a place earlier.
            let likely = places[from].wrapping_sub(1);
            let is_there = indices.get(likely) == Some(&row);
            place = if is_there { likely } else { first_from(indices, place, row) };
            places[from] = place;
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
        products.places = places;
    }
}

impl Products {
    /// Those of a coefficient with its own slopes and those of all after it, where rows have so many numbers.
    fn with_slopes(&self, at: usize, stride: usize) -> &[f64] {
        let columns = stride - self.first;
        &self.with_slopes[(at - self.own) * columns..][at - self.first..columns]
    }

    /// Those of a coefficient with the misfits and with the derivatives by each learned scalar, in rows of so many numbers.
    fn beside(&self, at: usize, each: usize) -> &[f64] {
        &self.beside[(at - self.own) * each..][..each]
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

    fn block(dofs: Vec<u32>, slopes: Vec<f64>, misfits: Vec<f64>) -> Block {
        Block { misfits, by_learned: Vec::new(), dofs, slopes, excess: 0.0 }
    }

    /// Two rows of five coefficients, one of them not kept, into a column that lacks one of the products.
    #[test]
    fn products_land_where_the_pattern_has_them() {
        let dofs = vec![7, 3, crate::local::lattice::NONE, 4, 5];
        let one = block(dofs.clone(), vec![1.0, 2.0, 9.0, 3.0, 0.5], vec![4.0]);
        let other = block(dofs, vec![-1.0, 4.0, 9.0, 0.0, 2.0], vec![-1.0]);
        let sorted = Sorted::of(&[one, other]);
        assert_eq!(
            (sorted.dofs.as_slice(), sorted.runs.as_slice()),
            ([3, 4, 5, 7].as_slice(), [3, 3, 3, 4].as_slice())
        );
        let mut products = Products::default();
        sorted.products(Isa::detect(), 0..2, &mut products);
        assert_eq!(products.with_slopes(0, 8)[..4], [20.0, 6.0, 9.0, -2.0]);
        assert_eq!(products.with_slopes(1, 8)[..3], [9.0, 1.5, 3.0]);
        let mut sum = 1.0;
        sorted.add_beside(0, &products, std::iter::once(&mut sum));
        assert_eq!(sum, 5.0);
        let mut values = [1.0; 4];
        sorted.scatter(0, &mut products, &[3, 4, 5, 9], &mut values);
        assert_eq!(values, [21.0, 7.0, 10.0, 1.0]);
        let mut values = [1.0; 4];
        sorted.scatter(0, &mut products, &[3, 5, 6, 7], &mut values);
        assert_eq!(values, [21.0, 10.0, 1.0, -1.0]);
    }

    /// More coefficients than a vector has lanes, from one that no vector begins with: small whole numbers, whose sums are exact.
    #[test]
    fn products_of_many_rows_are_their_sums() {
        let (rows, width) = (19, 21);
        let slope = |row: usize, at: usize| ((7 * row + 5 * at) % 11) as f64 - 5.0;
        let slopes = (0..rows * width).map(|number| slope(number / width, number % width)).collect();
        let sorted = Sorted::of(&[block((0..width as u32).collect(), slopes, vec![0.0; rows])]);
        let mut products = Products::default();
        for own in [0..21, 3..9, 10..11] {
            sorted.products(Isa::detect(), own.clone(), &mut products);
            for at in own {
                let sum = |other: usize| (0..rows).map(|row| slope(row, at) * slope(row, other)).sum::<f64>();
                let expected: Vec<f64> = (at..width).map(sum).collect();
                assert_eq!(products.with_slopes(at, 24)[..width - at], expected);
            }
        }
    }
}
