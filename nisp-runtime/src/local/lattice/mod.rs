//! A head as a sum of tensor-product B-splines on a regular lattice of cells.

mod cell;
mod neighbours;

pub(super) use cell::contracted;

/// Most coordinates of a lattice.
pub(super) const MOST_COORDINATES: usize = 4;

/// An operator's term: how often to differentiate by each coordinate.
pub(super) type Exponents = [u8; MOST_COORDINATES];

/// A number that no function has.
pub(super) const NONE: u32 = u32::MAX;

/// Splines of one degree over a box that is cut into equal cells.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    pub(super) degree: usize,
    /// The coordinates that it spans; functions do not depend on the others.
    axes: Vec<usize>,
    /// Coordinates of a point.
    inputs: usize,
    low: Vec<f64>,
    spacing: Vec<f64>,
    pub(super) cells: Vec<usize>,
    /// By full number: the number among those that are kept.
    kept: Vec<u32>,
    /// By number among those kept: the full number.
    full: Vec<usize>,
}

/// The cell of a point, and where in it the point is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub(super) cell: [usize; MOST_COORDINATES],
    pub(super) within: [f64; MOST_COORDINATES],
}

/// A box of functions: the first along each coordinate, and how many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) first: [usize; MOST_COORDINATES],
    pub(super) count: usize,
}

impl Lattice {
    /// A lattice over the box from `low`, of `cells` cells of size `spacing` along each coordinate; all functions kept.
    pub(super) fn new(degree: usize, low: Vec<f64>, spacing: Vec<f64>, cells: Vec<usize>) -> Self {
        let all: usize = cells.iter().map(|n| n + degree).product();
        let (axes, inputs) = ((0..cells.len()).collect(), cells.len());
        Self { degree, axes, inputs, low, spacing, cells, kept: (0..all as u32).collect(), full: (0..all).collect() }
    }

    /// The lattice along some of the coordinates only, with all functions kept.
    pub(super) fn along(&self, axes: Vec<usize>) -> Self {
        let of = |values: &[f64]| axes.iter().map(|&axis| values[axis]).collect();
        let cells = axes.iter().map(|&axis| self.cells[axis]).collect();
        Self::new(self.degree, of(&self.low), of(&self.spacing), cells).spanning(axes, self.inputs)
    }

    /// The lattice over these coordinates of points that have so many.
    pub(super) fn spanning(self, axes: Vec<usize>, inputs: usize) -> Self {
        Self { axes, inputs, ..self }
    }

    /// The coordinates that it spans.
    pub(super) fn axes(&self) -> &[usize] {
        &self.axes
    }

    /// Coordinates of a point.
    pub(super) fn inputs(&self) -> usize {
        self.inputs
    }

    /// A lattice of which the functions of these full numbers are kept, which must rise; nothing if there are no such functions.
    pub(super) fn keeping(mut self, full: Vec<usize>) -> Option<Self> {
        let is_sound = full.is_sorted_by(|a, b| a < b) && full.last().is_none_or(|last| *last < self.full_len());
        if !is_sound {
            return None;
        }
        self.kept = vec![NONE; self.full_len()];
        full.iter().enumerate().for_each(|(number, &at)| self.kept[at] = number as u32);
        self.full = full;
        Some(self)
    }

    /// Its lower corner, the sizes of its cells, and the full numbers of the functions that are kept.
    pub(super) fn parts(&self) -> (&[f64], &[f64], &[usize]) {
        (&self.low, &self.spacing, &self.full)
    }

    /// The same box cut `times` as fine, with functions of another degree.
    pub(super) fn refined(&self, degree: usize, times: usize) -> Self {
        let spacing = self.spacing.iter().map(|h| h / times as f64).collect();
        Self::new(degree, self.low.clone(), spacing, self.cells.iter().map(|n| n * times).collect())
    }

    /// Keeps the functions that the points see: those whose sum over them is at least `share` of the largest. Returns how much is
    /// seen of each, beside the largest.
    pub(super) fn keep(&mut self, points: impl Iterator<Item = Place>, share: f64) -> Vec<f64> {
        let mut seen = vec![0.0; self.full_len()];
        let mut values = vec![0.0; self.per_cell()];
        for place in points {
            self.values(&place, &Exponents::default(), &mut values);
            for (at, value) in self.numbers(self.cell_span(&place)).zip(&values) {
                seen[at] += value;
            }
        }
        let most = seen.iter().copied().fold(0.0, f64::max);
        self.full = (0..seen.len()).filter(|&at| seen[at] > share * most).collect();
        self.kept = vec![NONE; seen.len()];
        for (number, &at) in self.full.iter().enumerate() {
            self.kept[at] = number as u32;
        }
        self.full.iter().map(|&at| seen[at] / most).collect()
    }

    pub(super) fn dimensions(&self) -> usize {
        self.cells.len()
    }

    /// Functions that are kept.
    pub(super) fn len(&self) -> usize {
        self.full.len()
    }

    fn full_len(&self) -> usize {
        self.cells.iter().map(|n| n + self.degree).product()
    }

    /// Middle of a kept function's support, in three coordinates.
    pub(super) fn middle(&self, number: usize) -> [f64; 3] {
        let mut full = self.full[number];
        let mut middle = [0.0; 3];
        for (axis, x) in middle.iter_mut().enumerate().take(self.dimensions()) {
            let count = self.cells[axis] + self.degree;
            // The first function is spread over `degree` cells before the box and one in it.
            let cells = (full % count) as f64 + 0.5 * (1.0 - self.degree as f64);
            *x = self.low[axis] + self.spacing[axis] * cells;
            full /= count;
        }
        middle
    }

    /// A point of the box for a kept function, within its support: as many evenly spaced ones along each coordinate as there are
    /// functions.
    pub(super) fn site(&self, number: usize) -> Vec<f64> {
        let mut full = self.full[number];
        let mut site = vec![0.0; self.inputs];
        for (axis, &coordinate) in self.axes.iter().enumerate() {
            let count = self.cells[axis] + self.degree;
            let share = (full % count) as f64 / (count - 1).max(1) as f64;
            site[coordinate] = self.low[axis] + share * self.spacing[axis] * self.cells[axis] as f64;
            full /= count;
        }
        site
    }

    /// Size of a cell along a coordinate.
    pub(super) fn spacing(&self, axis: usize) -> f64 {
        self.spacing[axis]
    }

    /// Where a point is; points outside count to the nearest cell.
    pub(super) fn place(&self, point: &[f64]) -> Place {
        let mut place = Place::default();
        for (axis, &coordinate) in self.axes.iter().enumerate() {
            let along = (point[coordinate] - self.low[axis]) / self.spacing[axis];
            let cell = along.floor().clamp(0.0, (self.cells[axis] - 1) as f64);
            place.cell[axis] = cell as usize;
            place.within[axis] = along - cell;
        }
        place
    }

    /// For each spline of a degree on this lattice that does not vanish at a place: the first of the cells that it is spread
    /// over.
    pub(super) fn around(&self, place: &Place, degree: usize) -> impl Iterator<Item = [usize; MOST_COORDINATES]> + '_ {
        let place = *place;
        (0..(degree + 1).pow(self.dimensions() as u32)).map(move |mut at| {
            let mut cell = [0; MOST_COORDINATES];
            for (axis, cell) in cell.iter_mut().enumerate().take(self.dimensions()) {
                let last = place.cell[axis] + at % (degree + 1);
                at /= degree + 1;
                *cell = last.saturating_sub(degree).min(self.cells[axis].saturating_sub(degree + 1));
            }
            cell
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(degree: usize) -> Lattice {
        Lattice::new(degree, vec![-1.0, 2.0], vec![0.5, 0.25], vec![4, 6])
    }

    #[test]
    fn functions_add_up_to_one_everywhere() {
        let lattice = lattice(3);
        let mut values = vec![0.0; lattice.per_cell()];
        lattice.values(&lattice.place(&[0.3, 3.1]), &Exponents::default(), &mut values);
        assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn derivatives_are_those_of_the_function() {
        let lattice = lattice(4);
        let coefficient = |at: usize| ((at * 7919) % 101) as f64 / 101.0;
        let at = |x: f64, y: f64, exponents: Exponents| {
            let place = lattice.place(&[x, y]);
            let mut values = vec![0.0; lattice.per_cell()];
            lattice.values(&place, &exponents, &mut values);
            let numbers = lattice.numbers(lattice.cell_span(&place));
            numbers.zip(&values).map(|(at, value)| coefficient(at) * value).sum::<f64>()
        };
        let (x, y, h) = (0.21, 2.6, 1e-4);
        let numeric = (at(x + h, y, [0, 1, 0, 0]) - at(x - h, y, [0, 1, 0, 0])) / (2.0 * h);
        let exact = at(x, y, [1, 1, 0, 0]);
        assert!((numeric - exact).abs() < 1e-6 * exact.abs().max(1.0), "{numeric} {exact}");
    }

    #[test]
    fn functions_that_no_point_sees_are_dropped() {
        let mut lattice = lattice(1);
        let places: Vec<_> = [[-1.0, 2.0], [-0.8, 2.1]].iter().map(|point| lattice.place(point)).collect();
        lattice.keep(places.into_iter(), 1e-3);
        assert_eq!(lattice.len(), 4);
        assert_eq!(lattice.neighbours(0).count(), 2);
        assert_eq!(lattice.neighbours(1).count(), 2);
    }
}
