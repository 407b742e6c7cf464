//! The noise of values over several coordinates, from fits to those around some of the places.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Places that are looked at where there are several coordinates.
const PLACES: usize = 300;

/// A share of fits, and the standard normal number that has this share below it.
pub(super) type Quantile = (f64, f64);

/// The median.
pub(super) const HALF: Quantile = (0.5, 0.0);
/// Where outliers are expected, few fits have none among their values.
pub(super) const FEW_CLEAN: Quantile = (0.1, -1.281_551_57);

/// From quadratic fits to the values around some of the places: what the fit at a quantile leaves over.
pub(super) fn by_fits(coordinates: &[f64], inputs: usize, values: &[f64], (share, deviate): Quantile) -> Option<f64> {
    let unknowns = (inputs + 1) * (inputs + 2) / 2;
    // As many left over as fitted.
    let neighbours = 2 * unknowns;
    if values.len() < neighbours {
        return None;
    }
    let point = |at: usize| &coordinates[at * inputs..][..inputs];
    let along = Along::new(coordinates, inputs);
    let centres: Vec<usize> = (0..values.len()).step_by(values.len().div_ceil(PLACES)).collect();
    let left = centres.into_par_iter().filter_map(|centre| {
        let near = along.nearest(centre, neighbours);
        let reach = near.iter().map(|(square, _)| square.sqrt()).fold(f64::MIN_POSITIVE, f64::max);
        let rows = near.iter().flat_map(|&(_, at)| {
            let away: Vec<f64> = point(at).iter().zip(point(centre)).map(|(a, b)| (a - b) / reach).collect();
            monomials(&away)
        });
        let design = DMatrix::from_row_iterator(neighbours, unknowns, rows);
        let data = DVector::from_iterator(neighbours, near.iter().map(|&(_, at)| values[at]));
        let fit = design.clone().svd(true, true).solve(&data, 1e-10).ok()?;
        Some((data - design * fit).norm_squared() / unknowns as f64)
    });
    // The quantile of chi^2 over its degrees of freedom (Wilson and Hilferty 1931).
    let part = 2.0 / (9.0 * unknowns as f64);
    let expected = (1.0 - part + deviate * part.sqrt()).powi(3);
    Some((quantile(left.collect(), share)? / expected).sqrt())
}

/// Places in the order of the coordinate that has most values of its own, so that the nearest ones are found near in that order.
struct Along<'a> {
    coordinates: &'a [f64],
    inputs: usize,
    axis: usize,
    order: Vec<usize>,
}

impl<'a> Along<'a> {
    fn new(coordinates: &'a [f64], inputs: usize) -> Self {
        let ordered = |axis: usize| {
            let value = |at: usize| coordinates[at * inputs + axis];
            let mut order: Vec<usize> = (0..coordinates.len() / inputs).collect();
            order.par_sort_by(|&a, &b| value(a).total_cmp(&value(b)));
            let own = order.chunk_by(|&a, &b| value(a) == value(b)).count();
            (own, axis, order)
        };
        // Of coordinates that have as many, the first.
        let most = |a: (usize, usize, Vec<usize>), b: (usize, usize, Vec<usize>)| if b.0 > a.0 { b } else { a };
        let (_, axis, order) = (0..inputs).map(ordered).reduce(most).unwrap_or_default();
        Self { coordinates, inputs, axis, order }
    }

    fn point(&self, at: usize) -> &[f64] {
        &self.coordinates[at * self.inputs..][..self.inputs]
    }

    /// Squared distances and numbers of so many places nearest to one of them, itself among them, the nearest first.
    fn nearest(&self, centre: usize, count: usize) -> Vec<(f64, usize)> {
        let middle = self.point(centre);
        let value = |at: usize| self.point(at)[self.axis];
        let mut near: Vec<(f64, usize)> = Vec::with_capacity(count + 1);
        let mut add = |at: usize| {
            if near.len() == count && (value(at) - middle[self.axis]).powi(2) > near[count - 1].0 {
                return false;
            }
            let square = self.point(at).iter().zip(middle).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            let place = near.partition_point(|(other, _)| *other <= square);
            near.insert(place, (square, at));
            near.truncate(count);
            true
        };
        let from = self.order.partition_point(|&at| value(at) < middle[self.axis]);
        let (before, after) = self.order.split_at(from);
        let (mut before, mut after) = (before.iter().rev(), after.iter());
        let (mut is_below, mut is_above) = (true, true);
        while is_below || is_above {
            is_above = is_above && after.next().is_some_and(|&at| add(at));
            is_below = is_below && before.next().is_some_and(|&at| add(at));
        }
        near
    }
}

/// Products of at most two of the numbers.
fn monomials(x: &[f64]) -> Vec<f64> {
    let linear = std::iter::once(1.0).chain(x.iter().copied());
    let squares = (0..x.len()).flat_map(|i| (i..x.len()).map(move |j| x[i] * x[j]));
    linear.chain(squares).collect()
}

/// Nothing where there are too few to mean anything.
pub(super) fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    const FEW: usize = 8;
    values.sort_by(f64::total_cmp);
    (values.len() >= FEW).then(|| values[(share * values.len() as f64) as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    #[test]
    fn fits_see_the_noise_and_not_the_slope() {
        let mut random = StdRng::seed_from_u64(1);
        let mut uniform = || random.random::<f64>();
        let coordinates: Vec<f64> = (0..4000).map(|_| uniform()).collect();
        let smooth: Vec<f64> = coordinates.chunks_exact(2).map(|p| 3.0 * p[0] + (2.0 * p[1]).sin()).collect();
        assert!(by_fits(&coordinates, 2, &smooth, HALF).unwrap() < 1e-4);
        let noisy: Vec<f64> = smooth.iter().map(|y| y + 0.03 * normal(&mut random)).collect();
        for quantile in [HALF, FEW_CLEAN] {
            let found = by_fits(&coordinates, 2, &noisy, quantile).unwrap();
            assert!((found / 0.03 - 1.0).abs() < 0.1, "{found}");
        }
        let dirty: Vec<f64> = noisy.iter().enumerate().map(|(i, y)| if i % 10 == 3 { y + 2.0 } else { *y }).collect();
        let found = by_fits(&coordinates, 2, &dirty, FEW_CLEAN).unwrap();
        assert!((0.7..1.6).contains(&(found / 0.03)), "{found}");
    }

    /// Random places, and a grid with many that are equally far away, by looking at every place.
    #[test]
    fn the_nearest_places_are_those_that_a_look_at_all_of_them_finds() {
        let mut random = StdRng::seed_from_u64(3);
        let mut coordinates: Vec<f64> = (0..900).map(|_| random.random()).collect();
        for _ in 0..2 {
            let along = Along::new(&coordinates, 3);
            for centre in (0..300).step_by(7) {
                let square = |at: usize| {
                    along.point(at).iter().zip(along.point(centre)).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
                };
                let mut all: Vec<f64> = (0..300).map(square).collect();
                all.sort_by(f64::total_cmp);
                let near = along.nearest(centre, 20);
                assert!(near.iter().map(|(square, _)| *square).eq(all[..20].iter().copied()));
                assert!(near.iter().all(|&(found, at)| found == square(at)));
            }
            coordinates.iter_mut().for_each(|x| *x = (*x * 4.0).round() / 4.0);
        }
    }
}
