//! What an answer says at the points of a group, and what its programs make of it.

use crate::levels::without_levels;
use crate::residual::{Points, Programs};
use crate::schema;
use crate::simd::Isa;
use crate::solve::vector::{deviation, root_mean_square};

/// What is left of an equation, beside the sum of the magnitudes of its terms, where these balance each other.
const BALANCED: f64 = 0.5;

/// Values and derivatives of an answer at a group's points, in the engine's units.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    /// Number of points.
    pub(crate) points: usize,
    /// Distance between quantities: a multiple of every vector length.
    pub(crate) stride: usize,
    /// `[jet][point]`
    pub(crate) jets: Vec<f64>,
    /// `[coordinate][point]`, then those of partners.
    pub(crate) coordinates: Vec<f64>,
    /// `[column][point]`
    pub(crate) columns: Vec<f64>,
    /// Weighted means that equations are asked of instead of points; empty if of points.
    pub(crate) means: Vec<Vec<(u32, f64)>>,
}

impl Facts {
    /// Raw rows, `[row][place]`: places are points, or means over points.
    pub(crate) fn rows(&self, programs: &dyn Programs<f64>, group: &schema::Group, scalars: &[f64]) -> Vec<Vec<f64>> {
        self.rows_with(programs, group, (&self.jets, &self.columns), scalars)
    }

    /// Raw rows with other jets and columns.
    pub(crate) fn rows_with(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        (jets, columns): (&[f64], &[f64]),
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut rows = vec![0.0; group.rows * self.stride];
        programs.residual(Isa::detect(), self.inputs(jets, columns, scalars, &[]), &mut rows);
        (0..group.rows).map(|row| self.at_places(&rows[row * self.stride..][..self.stride])).collect()
    }

    /// What a program gives at all points, `[row][point]`.
    fn by_row(
        &self,
        group: &schema::Group,
        scalars: &[f64],
        program: impl FnOnce(Points<'_, f64>, &mut [f64]),
    ) -> Vec<Vec<f64>> {
        let mut rows = vec![0.0; group.rows * self.stride];
        program(self.inputs(&self.jets, &self.columns, scalars, &[]), &mut rows);
        rows.chunks_exact(self.stride).map(|row| row[..self.points].to_vec()).collect()
    }

    /// Raw rows at all points, `[row][point]`.
    pub(crate) fn plain_rows(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        self.by_row(group, scalars, |points, rows| programs.residual(Isa::detect(), points, rows))
    }

    /// Sums of the magnitudes of what the rows at all points add up, `[row][point]`.
    pub(crate) fn magnitudes(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        self.by_row(group, scalars, |points, rows| programs.magnitude(points, rows))
    }

    /// Sizes of all rows, as the sum of the magnitudes of what they add up; at least the `natural` ones of their terms where
    /// nothing balances this yet, or ever, as in a quantity that vanishes. Of terms with `within` the natural ones.
    pub(crate) fn sizes(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
        natural: &[f64],
    ) -> Vec<f64> {
        let magnitudes = self.magnitudes(programs, group, scalars);
        let varying: Vec<f64> = magnitudes.iter().map(|row| deviation(row)).collect();
        let [sizes, misfits] = [magnitudes, self.plain_rows(programs, group, scalars)]
            .map(|rows| rows.iter().map(|row| root_mean_square(row.iter().copied())).collect::<Vec<f64>>());
        let mut found = vec![0.0; group.rows];
        for (term, &natural) in group.terms.iter().zip(natural) {
            for row in term.first..term.first + term.rows {
                // A condition on values states the level itself, and lattices leave it out by themselves (`local/smooth/levels.rs`).
                let size = match group.is_of_values(term) {
                    true => sizes[row],
                    false => without_levels(sizes[row], varying[row]).max(natural.min(sizes[row])),
                };
                let is_balanced = misfits[row] < BALANCED * size;
                found[row] = match term.within {
                    None if is_balanced => size,
                    None if size.is_finite() => size.max(natural),
                    _ => natural,
                };
            }
        }
        found
    }

    /// By row, how far noise of its columns puts it off (root mean square).
    pub(crate) fn blurs(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
        noise: &[f64],
    ) -> Vec<f64> {
        let mut squares = vec![0.0; group.rows];
        if noise.iter().all(|noise| *noise == 0.0) {
            return squares;
        }
        let own = self.rows(programs, group, scalars);
        for (column, noise) in noise.iter().enumerate().filter(|(_, noise)| **noise > 0.0) {
            let mut moved = self.columns.clone();
            moved[column * self.stride..][..self.stride].iter_mut().for_each(|value| *value += noise);
            let moved = self.rows_with(programs, group, (&self.jets, &moved), scalars);
            for (square, (own, moved)) in squares.iter_mut().zip(own.iter().zip(moved)) {
                let off = root_mean_square(own.iter().zip(moved).map(|(own, moved)| moved - own));
                *square += if off.is_finite() { off * off } else { 0.0 };
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// Derivatives of a row by the jets, `[jet][point]`.
    pub(crate) fn slopes(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        row: usize,
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut seeds = vec![0.0; group.rows * self.stride];
        seeds[row * self.stride..][..self.stride].fill(1.0);
        let mut bars = vec![0.0; (group.jets.len() + scalars.len()) * self.stride];
        programs.adjoint(Isa::detect(), self.inputs(&self.jets, &self.columns, scalars, &seeds), &mut bars);
        (0..group.jets.len()).map(|jet| bars[jet * self.stride..][..self.points].to_vec()).collect()
    }

    fn inputs<'a>(
        &'a self,
        jets: &'a [f64],
        columns: &'a [f64],
        scalars: &'a [f64],
        seeds: &'a [f64],
    ) -> Points<'a, f64> {
        let Self { points, stride, ref coordinates, .. } = *self;
        Points { count: points, stride, jets, coordinates, columns, scalars, seeds }
    }

    fn at_places(&self, values: &[f64]) -> Vec<f64> {
        if self.means.is_empty() {
            return values[..self.points].to_vec();
        }
        self.means.iter().map(|mean| mean.iter().map(|&(p, share)| share * values[p as usize]).sum()).collect()
    }
}
