//! What equations are tested with: splines of a low degree on the base lattice, each a weighted mean over the points that it
//! sees.

use std::collections::BTreeMap;

use super::lattice::{Exponents, Lattice, MOST_COORDINATES};

/// A test: the points around a node with their shares, which add up to one.
pub(super) struct Test {
    pub(super) points: Vec<(u32, f64)>,
    /// First of the cells around it.
    pub(super) cell: [usize; MOST_COORDINATES],
    pub(super) weight: f64,
}

/// The tests of degree `degree` that see weighted points, given flat; those that see less than a share of the fullest one's weight are left
/// out.
pub(super) fn tests(base: &Lattice, (degree, least): (usize, f64), flat: &[f64], weights: &[f64]) -> Vec<Test> {
    let splines = base.refined(degree, 1);
    let mut found: BTreeMap<usize, Test> = BTreeMap::new();
    let mut values = vec![0.0; splines.per_cell()];
    for (p, point) in flat.chunks_exact(splines.dimensions()).enumerate() {
        let place = splines.place(point);
        splines.values(&place, &Exponents::default(), &mut values);
        let span = splines.cell_span(&place);
        for ((number, value), cell) in splines.numbers(span).zip(&values).zip(base.around(&place, degree)) {
            let test = found.entry(number).or_insert_with(|| Test { points: Vec::new(), cell, weight: 0.0 });
            test.points.push((p as u32, weights[p] * value));
            test.weight += weights[p] * value;
        }
    }
    let most = found.values().map(|test| test.weight).fold(0.0, f64::max);
    let mut tests: Vec<Test> = found.into_values().filter(|test| test.weight > least * most).collect();
    for test in &mut tests {
        test.points.iter_mut().for_each(|(_, share)| *share /= test.weight);
        test.weight = (test.weight / most).sqrt();
    }
    tests
}
