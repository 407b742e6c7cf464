//! The rows of a step in flat memory. Rows that see the same few unknowns are merged before they are kept, so that memory goes
//! with the cells and not with the measurements.

use super::triangle::{Row, Source, Triangle};

/// Rows with their classes.
pub(super) struct Rows {
    /// Whether rows of the same few unknowns are merged.
    is_merged: bool,
    /// Unknowns that all rows share.
    shared: usize,
    kept: Vec<Kept>,
    /// Slopes of a row that are not zero, then those by the shared unknowns, row by row.
    numbers: Vec<f64>,
    /// Where in its row each of the numbers stands.
    places: Vec<u16>,
}

/// Where a row's numbers are.
struct Kept {
    first: usize,
    start: usize,
    value: f64,
    count: u32,
    /// Numbers that are kept, without the shared ones, and slopes that they stand for.
    packed: u16,
    width: u16,
    class: u16,
}

/// A kept row: the class that it counts in, and for how many of the rows that were given.
pub(super) struct Counted<'a> {
    pub(super) row: Row<'a>,
    pub(super) class: usize,
    pub(super) count: usize,
}

impl Rows {
    /// None yet.
    pub(super) fn new(shared: usize) -> Self {
        Self { is_merged: true, shared, kept: Vec::new(), numbers: Vec::new(), places: Vec::new() }
    }

    /// None yet, to be kept one by one: of two lists that are made in the same way the same number is the same row.
    pub(super) fn one_by_one(shared: usize) -> Self {
        Self { is_merged: false, ..Self::new(shared) }
    }

    /// Keeps a row.
    pub(super) fn push(&mut self, row: Row<'_>, class: usize) {
        self.keep(row, class, 1);
    }

    fn keep(&mut self, row: Row<'_>, class: usize, count: usize) {
        let start = self.numbers.len();
        for (at, slope) in row.slopes.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            self.numbers.push(*slope);
            self.places.push(at as u16);
        }
        let (packed, width) = ((self.numbers.len() - start) as u16, row.slopes.len() as u16);
        self.numbers.extend_from_slice(row.shared);
        self.places.resize(self.numbers.len(), 0);
        let (count, class) = (count as u32, class as u16);
        self.kept.push(Kept { first: row.first, start, value: row.value, count, packed, width, class });
    }

    /// Keeps rows that all have the same unknowns, from `first` on. Where they are more than the unknowns that they see, they are
    /// turned into as many, with the same sum of squares whatever the unknowns are: a constant row holds what no unknown can
    /// change.
    pub(super) fn push_all(&mut self, rows: &Bundle, class: usize) {
        let seen = (0..rows.width).filter(|&at| rows.iter().any(|row| row.slopes[at] != 0.0)).count();
        let count = rows.iter().len();
        if !self.is_merged || count <= seen + self.shared + 1 {
            rows.iter().for_each(|row| self.push(row, class));
            return;
        }
        let mut merged = Triangle::new(rows.width, rows.width, self.shared);
        let left: f64 = rows.iter().map(|row| merged.add(Row { first: 0, ..row }).powi(2)).sum();
        let none = vec![0.0; self.shared];
        self.keep(Row { first: rows.first, slopes: &[], shared: &none, value: left.sqrt() }, class, count);
        for row in merged.rows() {
            self.keep(Row { first: rows.first + row.first, ..row }, class, 0);
        }
    }

    /// What all rows are at present.
    pub(super) fn values(&self) -> Vec<f64> {
        self.kept.iter().map(|kept| kept.value).collect()
    }

    /// Orders rows by their first unknown.
    pub(super) fn sort(&mut self) {
        self.kept.sort_by_key(|kept| kept.first);
    }

    /// All rows, one after the other.
    pub(super) fn walk(&self) -> Walk<'_> {
        Walk { rows: self, at: 0, slopes: Vec::new() }
    }
}

/// A walk through rows, of which one at a time is unpacked.
pub(super) struct Walk<'a> {
    rows: &'a Rows,
    at: usize,
    slopes: Vec<f64>,
}

impl Walk<'_> {
    /// First unknown of the next row.
    #[inline(always)]
    pub(super) fn first(&self) -> Option<usize> {
        self.rows.kept.get(self.at).map(|kept| kept.first)
    }

    /// The next row.
    #[inline(always)]
    pub(super) fn step(&mut self) -> Option<Counted<'_>> {
        let kept = self.rows.kept.get(self.at)?;
        self.at += 1;
        let packed = kept.start..kept.start + usize::from(kept.packed);
        self.slopes.clear();
        self.slopes.resize(kept.width.into(), 0.0);
        for (slope, &at) in self.rows.numbers[packed.clone()].iter().zip(&self.rows.places[packed.clone()]) {
            self.slopes[usize::from(at)] = *slope;
        }
        let shared = &self.rows.numbers[packed.end..][..self.rows.shared];
        let row = Row { first: kept.first, slopes: &self.slopes, shared, value: kept.value };
        Some(Counted { row, class: kept.class.into(), count: kept.count as usize })
    }
}

impl Source for Walk<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<Row<'_>> {
        self.step().map(|counted| counted.row)
    }
}

/// Rows with the same unknowns.
pub(super) struct Bundle {
    first: usize,
    width: usize,
    shared: usize,
    /// Slopes, those by the shared unknowns, and the value, row by row.
    numbers: Vec<f64>,
}

impl Bundle {
    /// None yet, over `width` unknowns from `first` on, and the shared ones.
    pub(super) fn new(first: usize, width: usize, shared: usize) -> Self {
        Self { first, width, shared, numbers: Vec::new() }
    }

    /// Adds a row of zeros and gives its slopes, its slopes by the shared unknowns, and its value, to be filled.
    pub(super) fn add(&mut self) -> (&mut [f64], &mut [f64], &mut f64) {
        let start = self.numbers.len();
        self.numbers.resize(start + self.width + self.shared + 1, 0.0);
        let (slopes, rest) = self.numbers[start..].split_at_mut(self.width);
        let (shared, value) = rest.split_at_mut(self.shared);
        (slopes, shared, &mut value[0])
    }

    /// The rows.
    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = Row<'_>> {
        self.numbers.chunks_exact(self.width + self.shared + 1).map(|numbers| {
            let (slopes, rest) = numbers.split_at(self.width);
            Row { first: self.first, slopes, shared: &rest[..self.shared], value: rest[self.shared] }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of squares of rows at some unknowns, how many they are and for how many they count, all in class 3.
    fn summed(rows: &Rows, x: &[f64], shared: &[f64]) -> (f64, usize, usize) {
        let (mut square, mut kept, mut given) = (0.0, 0, 0);
        let mut walk = rows.walk();
        while let Some(Counted { row, class, count }) = walk.step() {
            assert_eq!(class, 3);
            let own: f64 = row.slopes.iter().zip(&x[row.first..]).map(|(a, x)| a * x).sum();
            square += (own + row.shared.iter().zip(shared).map(|(a, x)| a * x).sum::<f64>() + row.value).powi(2);
            (kept, given) = (kept + 1, given + count);
        }
        (square, kept, given)
    }

    #[test]
    fn merged_rows_have_the_same_sum_of_squares_and_count_for_as_many() {
        let number = |at: usize| ((at * 7919 + 13) % 101) as f64 / 101.0 - 0.4;
        let mut bundle = Bundle::new(2, 4, 1);
        let mut plain = Rows::new(1);
        for at in 0..50 {
            let (slopes, shared, value) = bundle.add();
            // The second of the unknowns is seen by no row.
            slopes.iter_mut().enumerate().for_each(|(k, slope)| *slope = if k == 1 { 0.0 } else { number(5 * at + k) });
            (shared[0], *value) = (number(11 * at), number(17 * at));
        }
        bundle.iter().for_each(|row| plain.push(row, 3));
        let mut merged = Rows::new(1);
        merged.push_all(&bundle, 3);
        for (x, shared) in [([0.0; 6], [0.0]), ([0.0, 0.0, 1.5, 2.0, -0.3, 0.9], [-2.0])] {
            let (found, kept, given) = summed(&merged, &x, &shared);
            let (exact, all, _) = summed(&plain, &x, &shared);
            assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
            // Three unknowns, the shared one, and what is left.
            assert_eq!((kept, all, given), (5, 50, 50));
        }
    }
}
