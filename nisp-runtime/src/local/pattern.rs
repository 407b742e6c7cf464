//! Where a sparse symmetric matrix has entries, of all unknowns or of some, and its Cholesky factors.

use std::sync::Arc;

use super::cholesky::Cholesky;
use super::entries::Entries;
use super::fill::Fill;
use super::spare::Spare;

/// Entries of the lower triangle, and how factors fill it.
pub(super) struct Pattern {
    entries: Entries,
    fill: Arc<Fill>,
}

/// The unknowns that are free, while the others stay where they are.
pub(super) struct Part {
    /// By unknown.
    pub(super) free: Vec<bool>,
    /// Numbers of the free ones.
    numbers: Vec<usize>,
    pattern: Pattern,
    /// Where its entries are among those of the whole.
    places: Vec<usize>,
}

impl Pattern {
    /// The pattern of a matrix with these entries; nothing where no order of elimination is found.
    pub(super) fn new(entries: Entries) -> Option<Self> {
        Self::with(entries, Arc::default())
    }

    /// The same, with memory that others have left.
    fn with(entries: Entries, spare: Arc<Spare>) -> Option<Self> {
        let fill = Arc::new(Fill::of(&entries, spare)?);
        Some(Self { entries, fill })
    }

    /// Where every column begins, and the end of the last.
    pub(super) fn starts(&self) -> &[usize] {
        &self.entries.starts
    }

    /// Rows of all entries, column by column.
    pub(super) fn rows(&self) -> &[usize] {
        &self.entries.rows
    }

    /// The part of the free unknowns; nothing where no order of elimination is found.
    pub(super) fn part(&self, free: &[bool]) -> Option<Part> {
        let numbers: Vec<usize> = (0..free.len()).filter(|&at| free[at]).collect();
        let mut own = vec![usize::MAX; free.len()];
        numbers.iter().enumerate().for_each(|(at, &number)| own[number] = at);
        let (mut places, mut entries) = (Vec::new(), Entries::default());
        for &number in &numbers {
            let column = self.starts()[number]..self.starts()[number + 1];
            places.extend(column.filter(|&place| free[self.rows()[place]]));
            let begun = entries.rows.len();
            entries.push(places[begun..].iter().map(|&place| own[self.rows()[place]]));
        }
        Some(Part { free: free.to_vec(), pattern: Self::with(entries, self.fill.spare.clone())?, numbers, places })
    }

    /// Cholesky factors of a matrix with these entries; where rounding spoils that it is positive definite, of one with some more
    /// on its diagonal.
    pub(super) fn factor(&self, values: &[f64]) -> Option<Cholesky> {
        let try_with = |values: &[f64]| Cholesky::of(&self.fill, values);
        if !values.iter().all(|value| value.is_finite()) {
            return None;
        }
        try_with(values).or_else(|| {
            (-12..=-4).step_by(2).map(|exponent| 10f64.powi(exponent)).find_map(|lift| {
                let mut values = values.to_vec();
                // The diagonal is the first entry of every column of a lower triangle.
                let columns = self.starts().len() - 1;
                self.starts()[..columns].iter().for_each(|&diagonal| values[diagonal] *= 1.0 + lift);
                let mut found = try_with(&values)?;
                found.lift = lift;
                Some(found)
            })
        })
    }

    /// The matrix with these entries times a vector.
    pub(super) fn times(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; vector.len()];
        for column in 0..vector.len() {
            let range = self.starts()[column]..self.starts()[column + 1];
            for (&row, value) in self.rows()[range.clone()].iter().zip(&values[range]) {
                product[row] += value * vector[column];
                if row != column {
                    product[column] += value * vector[row];
                }
            }
        }
        product
    }
}

impl Part {
    /// Cholesky factors of its part of the whole matrix.
    pub(super) fn factor(&self, values: &[f64]) -> Option<Cholesky> {
        let own: Vec<f64> = self.places.iter().map(|&place| values[place]).collect();
        self.pattern.factor(&own)
    }

    /// Solutions by its factors for right-hand sides of all unknowns; zero for those that are not free.
    pub(super) fn solve(&self, factor: &Cholesky, right: &[impl AsRef<[f64]>]) -> Option<Vec<Vec<f64>>> {
        let own = |right: &[f64]| self.numbers.iter().map(|&number| right[number]).collect();
        let own: Vec<Vec<f64>> = right.iter().map(|right| own(right.as_ref())).collect();
        let all = |own: Vec<f64>| {
            let mut all = vec![0.0; self.free.len()];
            self.numbers.iter().zip(own).for_each(|(&number, x)| all[number] = x);
            all
        };
        Some(factor.solve(&own)?.into_iter().map(all).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [[4, 1, 0], [1, 3, 1], [0, 1, 2]] without its second unknown is diag(4, 2).
    #[test]
    fn a_part_leaves_the_others_at_zero() {
        let pattern = Pattern::new(Entries::of([vec![0, 1], vec![1, 2], vec![2]])).unwrap();
        let values = [4.0, 1.0, 3.0, 1.0, 2.0];
        assert_eq!(pattern.times(&values, &[1.0, 2.0, 3.0]), [6.0, 10.0, 8.0]);
        let part = pattern.part(&[true, false, true]).unwrap();
        let solution = part.solve(&part.factor(&values).unwrap(), &[[8.0, 5.0, 3.0]]).unwrap();
        for (x, expected) in solution[0].iter().zip([2.0, 0.0, 1.5]) {
            assert!((x - expected).abs() < 1e-15, "{solution:?}");
        }
    }

    /// A chain of `n` twos beside minus ones has the determinant `n + 1`; ones plus a diagonal of `n` have `2 n^n`.
    #[test]
    fn determinants_are_those_of_closed_forms() {
        let n = 60;
        let chain: Vec<Vec<usize>> = (0..n).map(|at| (at..n.min(at + 2)).collect()).collect();
        let values: Vec<f64> = (0..n).flat_map(|at| [2.0, -1.0].into_iter().take(n.min(at + 2) - at)).collect();
        let found = Pattern::new(Entries::of(chain)).unwrap().factor(&values).unwrap().log_determinant().unwrap();
        assert!((found - (n as f64 + 1.0).ln()).abs() < 1e-12, "{found}");
        let full: Vec<Vec<usize>> = (0..n).map(|at| (at..n).collect()).collect();
        let entry = |(at, row): (usize, usize)| if row == at { 1.0 + n as f64 } else { 1.0 };
        let values: Vec<f64> = (0..n).flat_map(|at| (at..n).map(move |row| entry((at, row)))).collect();
        let found = Pattern::new(Entries::of(full)).unwrap().factor(&values).unwrap().log_determinant().unwrap();
        assert!((found - (2.0f64.ln() + n as f64 * (n as f64).ln())).abs() < 1e-10, "{found}");
        // Two equal rows: rounding, or a diagonal that was raised, hide that there is none.
        let same = Pattern::new(Entries::of([vec![0, 1], vec![1]])).unwrap().factor(&[1.0, 1.0, 1.0]).unwrap();
        assert!(same.lift > 0.0 && same.log_determinant().is_none());
    }
}
