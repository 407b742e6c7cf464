//! Cells of a record: as fine as its measurements can tell, and no finer.
//!
//! A record that is sampled much faster than it changes does not need a breakpoint at every measurement. Splines of the
//! measurements alone, on wide cells, are compared with the noise. Where they leave more than noise their cells are halved,
//! until they leave noise everywhere or every measurement has a breakpoint again. In the end all cells are divided once more,
//! because a source takes derivatives of what was measured. What equations know along the record, a drive, is looked at as well.

use super::basis::Basis;
use super::drives::Column;
use super::triangle::{Row, Triangle};
use crate::noise::Noise;
use crate::problem::Bound;

/// Cells that come first, at least.
const FEWEST: usize = 12;
/// Cells that take the place of one that leaves noise. The answer needs two of them; its error bars need more, because what
/// the measurements leave open of a source is rougher than what they say of it.
const FINER: usize = 4;
/// Degree of the splines: that of the least smooth head.
const DEGREE: usize = 5;
/// Cells that are looked at together: a wave below the noise shows in many of its periods.
const TOGETHER: [usize; 4] = [1, 8, 64, 512];
/// Deviations that chance does not make, in one of very many cells.
const CHANCE: f64 = 4.5;
/// How much larger the noise may be than its estimate from differences says, as a share of its square.
const DOUBT: f64 = 0.1;
/// Cells that a misfit may come from, on either side of where it shows.
const BESIDE: usize = 1;
/// What coefficients of cells without measurements are held to zero by, beside the weight of a measurement.
const RIDGE: f64 = 1e-7;

/// Breakpoints out of those that a record has at its measurements, for these and for what equations know along the record.
pub(super) fn breakpoints(bound: &Bound, noise: &Noise, drives: Vec<Column>, all: Vec<f64>) -> Vec<f64> {
    let mut columns = observed(bound, noise);
    columns.extend(drives);
    let last = all.len() - 1;
    let mut chosen: Vec<usize> = (0..last).step_by((last / FEWEST).max(1)).chain([last]).collect();
    loop {
        let cells: Vec<f64> = chosen.iter().map(|&at| all[at]).collect();
        let mut coarse = vec![false; cells.len() - 1];
        columns.iter().for_each(|column| mark(column, &cells, &mut coarse));
        let near =
            |cell: usize| coarse[cell.saturating_sub(BESIDE)..(cell + BESIDE + 1).min(coarse.len())].contains(&true);
        let before = chosen.len();
        chosen = divided(&chosen, |cell| if near(cell) { 2 } else { 1 });
        if chosen.len() == before {
            break;
        }
    }
    divided(&chosen, |_| FINER).into_iter().map(|at| all[at]).collect()
}

/// Divides the cells between chosen breakpoints into so many parts each, as far as there are breakpoints to choose.
fn divided(chosen: &[usize], parts: impl Fn(usize) -> usize) -> Vec<usize> {
    let inner = chosen.windows(2).enumerate().flat_map(|(cell, pair)| {
        let (first, width) = (pair[0], pair[1] - pair[0]);
        let parts = parts(cell).min(width);
        (0..parts).map(move |part| first + width * part / parts)
    });
    inner.chain(chosen.last().copied()).collect()
}

/// Columns that are observed, with their noise.
fn observed(bound: &Bound, noise: &Noise) -> Vec<Column> {
    let schema = bound.problem.scene().schema;
    let mut columns = Vec::new();
    for found in &noise.observations {
        let places = &bound.coordinates[found.group];
        for &column in schema.groups[found.group].terms[found.term].columns {
            let all = places.iter().copied().zip(bound.columns[found.group][column].iter().copied());
            let mut measured: Vec<(f64, f64)> = all.filter(|(_, value)| !value.is_nan()).collect();
            measured.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (places, values) = measured.into_iter().unzip();
            // Rounding of the splines' own sums.
            let noise = found.deviation.max(1e-12 * found.spread).max(f64::MIN_POSITIVE);
            columns.push(Column { places, values, noise });
        }
    }
    columns
}

/// Marks the cells on which a spline of a column leaves more than its noise.
fn mark(column: &Column, cells: &[f64], coarse: &mut [bool]) {
    let basis = Basis::new(DEGREE, cells);
    let Some(theta) = fitted(column, &basis) else {
        coarse.fill(true);
        return;
    };
    let mut tallies = vec![Tally::default(); coarse.len()];
    let mut before = None;
    for (&at, value) in column.places.iter().zip(&column.values) {
        let cell = basis.cell(at);
        let line = basis.line(cell, at, 0);
        let course: f64 = theta[cell..].iter().zip(&line[..=DEGREE]).map(|(c, b)| c * b).sum();
        let misfit = (value - course) / column.noise;
        tallies[cell].add(misfit, before);
        before = Some(misfit);
    }
    // Cells that are marked already explain their own misfits: the others must be noise without them.
    for together in TOGETHER {
        for (tallies, coarse) in tallies.chunks(together).zip(coarse.chunks_mut(together)) {
            let rest = tallies.iter().zip(coarse.iter()).filter(|(_, is_coarse)| !**is_coarse);
            if rest.fold(Tally::default(), |all, (own, _)| all.with(own)).is_more_than_noise() {
                coarse.fill(true);
            }
        }
    }
}

/// Coefficients of the spline that is nearest to a column.
fn fitted(column: &Column, basis: &Basis) -> Option<Vec<f64>> {
    let mut triangle = Triangle::new(basis.len(), DEGREE + 1, 0);
    let mut ridged = 0;
    let ridge = |triangle: &mut Triangle, at: usize| {
        triangle.add(Row { first: at, slopes: &[RIDGE], shared: &[], value: 0.0 });
    };
    for (&at, &value) in column.places.iter().zip(&column.values) {
        let cell = basis.cell(at);
        (ridged..cell).for_each(|at| ridge(&mut triangle, at));
        ridged = ridged.max(cell);
        let line = basis.line(cell, at, 0);
        triangle.add(Row { first: cell, slopes: &line[..=DEGREE], shared: &[], value: -value });
    }
    (ridged..basis.len()).for_each(|at| ridge(&mut triangle, at));
    Some(triangle.solve()?.0)
}

/// Misfits over the noise on some cells.
#[derive(Clone, Copy, Default)]
struct Tally {
    count: f64,
    /// Sum of squares.
    squares: f64,
    /// Sum of products of neighbours, and their number.
    products: f64,
    pairs: f64,
}

impl Tally {
    fn add(&mut self, misfit: f64, before: Option<f64>) {
        self.count += 1.0;
        self.squares += misfit * misfit;
        if let Some(before) = before {
            self.products += misfit * before;
            self.pairs += 1.0;
        }
    }

    fn with(self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            squares: self.squares + other.squares,
            products: self.products + other.products,
            pairs: self.pairs + other.pairs,
        }
    }

    /// Squares larger than chance makes of noise (chi squared by Wilson and Hilferty 1931), or neighbours alike (their
    /// correlation has the deviation `1 / sqrt(pairs)`).
    fn is_more_than_noise(&self) -> bool {
        if self.count == 0.0 {
            return false;
        }
        let part = 2.0 / (9.0 * self.count);
        let most = (1.0 + DOUBT) * (1.0 - part + CHANCE * part.sqrt()).powi(3);
        let is_large = self.squares > most * self.count;
        is_large || self.products * self.pairs.sqrt() > CHANCE * self.squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};

    const COUNT: usize = 6400;

    /// Values of a course at a thousandth's distance, with noise of deviation one.
    fn column(course: impl Fn(f64) -> f64) -> Column {
        let mut random = StdRng::seed_from_u64(5);
        let places: Vec<f64> = (0..COUNT).map(|at| at as f64 * 1e-3).collect();
        let values = places.iter().map(|&at| course(at) + normal(&mut random)).collect();
        Column { places, values, noise: 1.0 }
    }

    fn marked(column: &Column, cells: usize) -> Vec<bool> {
        let (low, high) = (column.places[0], column.places[COUNT - 1]);
        let cells: Vec<f64> = (0..=cells).map(|at| low + (high - low) * at as f64 / cells as f64).collect();
        let mut coarse = vec![false; cells.len() - 1];
        mark(column, &cells, &mut coarse);
        coarse
    }

    #[test]
    fn noise_about_a_smooth_course_asks_for_no_finer_cells() {
        assert!(!marked(&column(|t| 30.0 * (0.8 * t).sin()), 100).contains(&true));
    }

    /// Two waves in each cell of a hundred, of half the noise: no cell shows them alone, all together do.
    #[test]
    fn a_wave_below_the_noise_asks_for_finer_cells() {
        let wave = column(|t| 0.7 * (200.0 * t).sin());
        assert!(marked(&wave, 100).iter().all(|&coarse| coarse));
        assert!(!marked(&wave, 1600).contains(&true));
    }

    /// A bump of a twentieth of a cell's length asks where it is, and nowhere else.
    #[test]
    fn a_bump_asks_where_it_is() {
        let found = marked(&column(|t| 20.0 * (-((t - 3.21) / 0.005).powi(2)).exp()), 100);
        let places: Vec<usize> = (0..100).filter(|&cell| found[cell]).collect();
        assert!(places.contains(&50) && places.iter().all(|&cell| cell.abs_diff(50) <= 2), "{places:?}");
    }

    #[test]
    fn cells_are_divided_as_far_as_there_are_breakpoints() {
        assert_eq!(divided(&[0, 8, 11], |_| 2), [0, 4, 8, 9, 11]);
        assert_eq!(divided(&[0, 8, 11], |cell| if cell == 0 { 4 } else { 1 }), [0, 2, 4, 6, 8, 11]);
        assert_eq!(divided(&[0, 1, 3], |_| 4), [0, 1, 2, 3]);
    }
}
