//! The functions of a cell: their numbers and their values.

use super::{Exponents, Lattice, MOST_COORDINATES, Place, Span};
use crate::local::bspline::on_cell;

impl Lattice {
    /// Functions that do not vanish on a cell.
    pub(in crate::local) fn per_cell(&self) -> usize {
        (self.degree + 1).pow(self.dimensions() as u32)
    }

    /// The functions that do not vanish on a place's cell.
    pub(in crate::local) fn cell_span(&self, place: &Place) -> Span {
        Span { first: place.cell, count: self.degree + 1 }
    }

    /// Full numbers of a box's functions, the first coordinate fastest.
    pub(in crate::local) fn numbers(&self, span: Span) -> impl Iterator<Item = usize> + '_ {
        let dimensions = self.dimensions();
        (0..span.count.pow(dimensions as u32)).map(move |mut at| {
            let (mut number, mut stride) = (0, 1);
            for axis in 0..dimensions {
                number += (span.first[axis] + at % span.count) * stride;
                at /= span.count;
                stride *= self.cells[axis] + self.degree;
            }
            number
        })
    }

    /// Numbers of a box's functions among those kept.
    pub(in crate::local) fn kept(&self, span: Span) -> impl Iterator<Item = u32> + '_ {
        self.numbers(span).map(|at| self.kept[at])
    }

    /// Values by the numbers of the functions that are kept, as values by full numbers; zero for the others.
    pub(in crate::local) fn spread(&self, values: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.full_len()];
        self.full.iter().zip(values).for_each(|(&at, &value)| all[at] = value);
        all
    }

    /// Full number of the first function that does not vanish on a place's cell.
    pub(in crate::local) fn first(&self, place: &Place) -> usize {
        self.numbers(Span { first: place.cell, count: 1 }).next().unwrap_or(0)
    }

    /// Where the lines of a cell's functions along the first coordinate begin, as full numbers from the cell's first.
    pub(in crate::local) fn lines(&self) -> Vec<usize> {
        let cell = Span { first: [0; MOST_COORDINATES], count: self.degree + 1 };
        self.numbers(cell).step_by(self.degree + 1).collect()
    }

    /// A derivative of the functions of a cell, in the order of [`Lattice::numbers`].
    pub(in crate::local) fn values(&self, place: &Place, exponents: &Exponents, out: &mut [f64]) {
        let count = self.degree + 1;
        let mut line = [0.0; 16];
        out[0] = 1.0;
        let mut filled = 1;
        for (axis, &coordinate) in self.axes.iter().enumerate() {
            let order = usize::from(exponents[coordinate]);
            on_cell(self.degree, order, place.within[axis], &mut line);
            let scale = self.spacing[axis].powi(-(order as i32));
            for j in (0..count).rev() {
                let factor = line[j] * scale;
                for i in (0..filled).rev() {
                    out[j * filled + i] = out[i] * factor;
                }
            }
            filled *= count;
        }
    }

    /// Standard deviation in the middle of a cell, where all coefficients are off by one independently.
    pub(in crate::local) fn smoothing(&self) -> f64 {
        let middle = Place { cell: [0; MOST_COORDINATES], within: [0.5; MOST_COORDINATES] };
        let mut values = vec![0.0; self.per_cell()];
        self.values(&middle, &Exponents::default(), &mut values);
        values.iter().map(|value| value * value).sum::<f64>().sqrt()
    }
}

/// Sum of a cell's coefficients, of which `lines` says where each line begins, times splines along and across the lines.
pub(in crate::local) fn contracted(cell: &[f64], lines: &[usize], across: &[f64], along: &[f64]) -> f64 {
    let line = |(&first, across): (&usize, &f64)| {
        across * cell[first..first + along.len()].iter().zip(along).map(|(c, value)| c * value).sum::<f64>()
    };
    lines.iter().zip(across).map(line).sum()
}
