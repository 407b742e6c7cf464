//! How noisy the data are, before anything is fitted to them.

mod course;
mod differences;
mod fits;
mod given;
mod level;

use rayon::prelude::*;

pub(crate) use self::course::along;
pub(crate) use self::differences::{EIGHT, by_differences, differences, of_differences};
pub(crate) use self::given::of_given;
pub(crate) use self::level::of_answer;

use self::fits::{FEW_CLEAN, HALF, by_fits, quantile};
use crate::problem::Bound;
use crate::roughness::{directions, roughness};
use crate::schema::{self, TermKind};
pub use crate::solve::vector::deviation;
use crate::solve::vector::{root_mean_square, spread};
use crate::standing::moving;

/// Noise of what is observed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Of every observation where it can be judged.
    pub(crate) observations: Vec<ObservationNoise>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ObservationNoise {
    pub(crate) group: usize,
    pub(crate) term: usize,
    /// Standard deviation in the engine's units, and that of the data themselves; root mean squares over the columns that
    /// the observation compares with.
    pub(crate) deviation: f64,
    pub(crate) spread: f64,
}

/// Misfits that are smaller than this share of the noise are of an answer that goes through the data: what neighbours show as noise is then the
/// course of a source that changes from row to row.
const FOLLOWED: f64 = 0.05;
/// Noise below this share of the data's spread is taken for rounding: that of numbers with five digits and more.
const EXACT: f64 = 1e-5;

impl ObservationNoise {
    /// True if the data are exact but for rounding.
    pub(crate) fn is_exact(self) -> bool {
        is_exact(self.deviation, self.spread)
    }

    /// True of misfits of some size that say nothing of the noise: the answer goes through the data.
    pub(crate) fn is_followed(self, misfit: f64) -> bool {
        misfit < FOLLOWED * self.deviation
    }
}

impl Noise {
    /// True if no observation shows noise.
    pub(crate) fn is_exact(&self) -> bool {
        self.observations.iter().all(|o| is_exact(o.deviation, o.spread))
    }

    /// True if data are off by some noise, found or declared, or are too few to be judged: only then error bars say something.
    pub(crate) fn is_there(&self, schema: &schema::Scene) -> bool {
        let measured = || schema.groups.iter().flat_map(|group| group.terms).filter(|term| !term.columns.is_empty());
        let is_judged = measured().count() <= self.observations.len();
        !self.is_exact() || !is_judged || measured().any(|term| term.within.is_some())
    }

    /// Share of the data's variance that is noise, the mean over observations: 0 for exact data. One, the worst, where
    /// nothing can be judged.
    pub(crate) fn share(&self) -> f64 {
        let shares = self.observations.iter().map(|o| (o.deviation / o.spread.max(o.deviation)).powi(2));
        let sum: f64 = shares.map(|share| if share.is_nan() { 0.0 } else { share }).sum();
        if self.observations.is_empty() { 1.0 } else { sum / self.observations.len() as f64 }
    }

    /// The same with the noise of all clouds in space or in a plane, whose points then count as observations do.
    pub(crate) fn with_clouds(mut self, bound: &Bound) -> Self {
        let groups = bound.problem.scene().schema.groups.iter().enumerate();
        let terms =
            groups.flat_map(|(at, group)| group.terms.iter().enumerate().map(move |(term, own)| (at, term, own)));
        let clouds = terms.filter(|(.., own)| matches!(own.kind, TermKind::Chamfer { .. }));
        let coordinates = bound.problem.scene().schema.coordinates.len();
        self.observations.extend(clouds.filter_map(|(group, term, own)| {
            let directions = directions(coordinates, own.rows)?;
            let point = |point: &[f64]| std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0));
            let points: Vec<[f64; 3]> = bound.clouds[group][term].chunks_exact(own.rows).map(point).collect();
            let deviation = roughness(&points, &points, directions)?;
            let (_, spread) = spread(points.iter().map(|&point| point.into()));
            Some(ObservationNoise { group, term, deviation, spread })
        }));
        self
    }

    /// Noise of a term of a group, if it is an observation.
    pub(crate) fn of(&self, group: usize, term: usize) -> Option<ObservationNoise> {
        self.observations.iter().find(|o| (o.group, o.term) == (group, term)).copied()
    }
}

/// Values that move, at least, where those that stand still do not count.
pub(crate) const FEWEST: usize = 4 * EIGHT;

/// True where noise of some deviation is no more than rounding, for data of some spread.
pub fn is_exact(deviation: f64, spread: f64) -> bool {
    deviation <= EXACT * spread
}

/// Estimates the noise of every observation.
pub(crate) fn estimate(bound: &Bound) -> Noise {
    let mut observations = Vec::new();
    for (at, group) in bound.problem.scene().schema.groups.iter().enumerate() {
        for (term, _) in group.terms.iter().enumerate().filter(|(_, term)| !term.columns.is_empty()) {
            let columns = measured(bound, at, term);
            let moving = moving_rows(bound, (at, term), &columns);
            let spread = root_mean_square(columns.iter().map(|column| deviation(&picked(column, &moving))));
            let found = of_columns(bound, (at, term), &evened(bound, at, term, columns), &moving);
            observations.extend(found.map(|deviation| ObservationNoise { group: at, term, deviation, spread }));
        }
    }
    Noise { observations }
}

/// The noise of an observation as a share of each value, where it may be one: no value is zero or of another sign. Also the values.
pub(crate) fn relative(bound: &Bound, group: usize, term: usize) -> Option<(f64, Vec<Vec<f64>>)> {
    let columns = measured(bound, group, term);
    let has_sign = |column: &Vec<f64>| column.iter().all(|y| *y > 0.0) || column.iter().all(|y| *y < 0.0);
    let logarithms = |column: &Vec<f64>| column.iter().map(|y| y.abs().ln()).collect();
    let shares: Vec<Vec<f64>> = columns.iter().filter(|column| has_sign(column)).map(logarithms).collect();
    (shares.len() == columns.len())
        .then(|| of_columns(bound, (group, term), &shares, &moving_rows(bound, (group, term), &columns)))
        .flatten()
        .map(|share| (share, columns))
}

/// The columns that an observation compares with, where they were measured.
fn measured(bound: &Bound, group: usize, term: usize) -> Vec<Vec<f64>> {
    let schema = &bound.problem.scene().schema.groups[group].terms[term];
    schema.columns.iter().map(|&column| bound.measured(group, schema, &bound.columns[group][column])).collect()
}

/// The same, each over how noisy it is beside the others of its row, so that the noise is alike all along.
fn evened(bound: &Bound, group: usize, term: usize, columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let schema = &bound.problem.scene().schema.groups[group].terms[term];
    let rows = schema.first..schema.first + schema.rows;
    columns.into_iter().zip(rows).map(|(column, row)| bound.evened((group, schema), row, column)).collect()
}

/// Numbers of the rows of an observation along a record in which no column of it stands still; of all rows over several coordinates.
fn moving_rows(bound: &Bound, (group, term): (usize, usize), columns: &[Vec<f64>]) -> Vec<usize> {
    let schema = bound.problem.scene().schema;
    let rows = columns.first().map_or(0, Vec::len);
    if schema.coordinates.len() > 1 {
        return (0..rows).collect();
    }
    let places = bound.measured(group, &schema.groups[group].terms[term], &bound.coordinates[group]);
    let order = order(&places);
    let mut moves = vec![0; rows];
    for column in columns {
        moving(&picked(column, &order), FEWEST).into_iter().for_each(|at| moves[order[at]] += 1);
    }
    (0..rows).filter(|&row| moves[row] == columns.len()).collect()
}

fn picked(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter().map(|&row| values[row]).collect()
}

/// The noise of values at an observation's places, by some of its rows; nothing where it cannot be judged.
fn of_columns(bound: &Bound, (group, term): (usize, usize), columns: &[Vec<f64>], rows: &[usize]) -> Option<f64> {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let places = bound.measured(group, &schema.groups[group].terms[term], &bound.coordinates[group]);
    if places.is_empty() {
        return None;
    }
    let places: Vec<f64> = rows.iter().flat_map(|row| &places[row * inputs..][..inputs]).copied().collect();
    let outliers = bound.losses[group][term].is_robust();
    let noise_of = |values: &Vec<f64>| of_values(&places, inputs, &picked(values, rows), outliers);
    columns.iter().map(noise_of).collect::<Option<Vec<f64>>>().map(root_mean_square)
}

/// The standard deviation of the noise of values at places, flat and point by point: what neighbours differ by beside a smooth course,
/// and rounding to steps. With `outliers` one value in ten may be far off. Nothing where there are too few to judge.
pub fn of_values(places: &[f64], inputs: usize, values: &[f64], outliers: bool) -> Option<f64> {
    let found = match (inputs, outliers) {
        (1, false) => by_differences(&in_order(places, values)),
        (1, true) => by_few_differences(&in_order(places, values)),
        _ => {
            let around = by_fits(&shares(places, inputs), inputs, values, if outliers { FEW_CLEAN } else { HALF });
            let along = (0..inputs).filter_map(|axis| by_stations(places, (inputs, axis), values));
            around.into_iter().chain(along).reduce(f64::min)
        }
    };
    Some(found?.max(steps(values)))
}

/// Places as shares of their range along each coordinate: metres and seconds make no distance, and a field varies over its domain.
fn shares(places: &[f64], inputs: usize) -> Vec<f64> {
    let width = |axis: usize| {
        let along = places.iter().skip(axis).step_by(inputs);
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)]);
        if high > low { high - low } else { 1.0 }
    };
    let widths: Vec<f64> = (0..inputs).map(width).collect();
    places.iter().zip(widths.iter().cycle()).map(|(x, width)| x / width).collect()
}

/// The standard deviation of the points of a cloud in space about smooth pieces of its surface; nothing where they are few.
pub fn of_cloud(points: &[[f64; 3]]) -> Option<f64> {
    roughness(points, points, 2)
}

/// The noise of rounding to steps: a step over the root of twelve. Values that seldom repeat have none to speak of.
fn steps(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let least = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    if 2 * sorted.len() <= values.len() && least.is_finite() { least / 12f64.sqrt() } else { 0.0 }
}

/// Values in the order of their only coordinate.
pub(crate) fn in_order(coordinates: &[f64], values: &[f64]) -> Vec<f64> {
    picked(values, &order(coordinates))
}

/// Numbers of coordinates, the least first.
fn order(coordinates: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..coordinates.len()).collect();
    order.sort_by(|&a, &b| coordinates[a].total_cmp(&coordinates[b]));
    order
}

/// The median magnitude of a standard normal number.
const MEDIAN: f64 = 0.674_489_75;

/// The same where outliers are expected: with one value of ten off, most eighth differences are. Low differences have fewer
/// values in them and more of the signal; the order that leaves least is taken.
fn by_few_differences(values: &[f64]) -> Option<f64> {
    by_records(vec![values.to_vec()])
}

/// The same from several records together.
fn by_records(mut records: Vec<Vec<f64>>) -> Option<f64> {
    // Sum of the squares of binomial coefficients: C(2 order, order).
    let mut squares = 1.0;
    let mut least: Option<f64> = None;
    for order in 1..=8 {
        for record in &mut records {
            *record = record.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        let count = f64::from(order);
        squares *= 2.0 * (2.0 * count - 1.0) / count;
        let found = median(records.iter().flatten().map(|x| x.abs()).collect())? / (MEDIAN * f64::sqrt(squares));
        least = Some(least.map_or(found, |least| least.min(found)));
    }
    least
}

/// Values of a record that says something of its noise, at least.
const RECORD: usize = 12;

/// From records along a coordinate: measurements at places that share all the others.
fn by_stations(coordinates: &[f64], (inputs, axis): (usize, usize), values: &[f64]) -> Option<f64> {
    let place = |at: usize| &coordinates[at * inputs..][..inputs];
    let others = |at: usize| place(at).iter().enumerate().filter(|&(other, _)| other != axis).map(|(_, x)| x.to_bits());
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.par_sort_by(|&a, &b| others(a).cmp(others(b)).then(place(a)[axis].total_cmp(&place(b)[axis])));
    let long = order.chunk_by(|&a, &b| others(a).eq(others(b))).filter(|record| record.len() >= RECORD);
    let records = long.map(|record| record.iter().map(|&at| values[at]).collect()).collect();
    by_records(records)
}

pub(crate) fn median(values: Vec<f64>) -> Option<f64> {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    #[test]
    fn differences_see_the_noise_and_not_the_signal() {
        let mut random = StdRng::seed_from_u64(1);
        let noisy: Vec<f64> = (0..2000).map(|i| (i as f64 * 0.01).sin() + 0.03 * normal(&mut random)).collect();
        let found = by_differences(&noisy).unwrap();
        assert!((found / 0.03 - 1.0).abs() < 0.1, "{found}");
        let smooth: Vec<f64> = (0..200).map(|i| (i as f64 * 0.2).sin()).collect();
        assert!(by_differences(&smooth).unwrap() < 1e-7);
    }

    #[test]
    fn few_differences_see_the_noise_among_outliers() {
        let mut random = StdRng::seed_from_u64(2);
        let clean: Vec<f64> = (0..400).map(|i| (i as f64 * 0.02).sin() + 0.03 * normal(&mut random)).collect();
        for share in [0.0, 0.05, 0.1, 0.2] {
            let mut off = |y: &f64| if random.random::<f64>() < share { y + 2.0 * normal(&mut random) } else { *y };
            let dirty: Vec<f64> = clean.iter().map(&mut off).collect();
            let found = by_few_differences(&dirty).unwrap();
            assert!((0.7..2.2).contains(&(found / 0.03)), "{share}: {found}");
        }
    }

    /// Metres and seconds: places that are far apart in seconds may be neighbours.
    #[test]
    fn noise_does_not_depend_on_units_of_coordinates() {
        let mut random = StdRng::seed_from_u64(7);
        let mut places = Vec::new();
        let mut values = Vec::new();
        for _ in 0..600 {
            let [x, y]: [f64; 2] = [random.random(), random.random()];
            places.extend([1e-3 * x, 1e3 * y]);
            values.push((4.0 * x).sin() * (3.0 * y).cos() + 0.03 * normal(&mut random));
        }
        let found = of_values(&places, 2, &values, false).unwrap();
        assert!((found / 0.03 - 1.0).abs() < 0.2, "{found}");
    }

    /// Three stations far apart, and what passes them.
    #[test]
    fn records_of_stations_see_the_noise_and_not_what_lies_between_them() {
        let mut random = StdRng::seed_from_u64(5);
        let rows: Vec<[f64; 3]> = (0..3)
            .flat_map(|station| (0..60).map(move |at| [f64::from(station), 0.05 * f64::from(at)]))
            .map(|[x, t]| [x, t, (-(t - x).powi(2) / 0.08).exp() + 0.01 * normal(&mut random)])
            .collect();
        let places: Vec<f64> = rows.iter().flat_map(|row| [row[0], row[1]]).collect();
        let values: Vec<f64> = rows.iter().map(|row| row[2]).collect();
        let found = by_stations(&places, (2, 1), &values).unwrap();
        assert!((found / 0.01).ln().abs() < 0.3, "{found}");
        assert_eq!(by_stations(&places, (2, 0), &values), None);
    }

    /// Values to the nearest tenth are off by a twentieth at most, evenly.
    #[test]
    fn steps_are_noise() {
        let values: Vec<f64> = (0..500).map(|at| (10.0 * (0.02 * f64::from(at)).sin()).round() / 10.0).collect();
        assert!((steps(&values) - 0.1 / 12f64.sqrt()).abs() < 1e-9);
        assert_eq!(steps(&[1.0, 2.0, 3.0, 4.0]), 0.0);
    }

    #[test]
    fn few_values_say_nothing() {
        assert_eq!(by_differences(&[1.0, 2.0, 3.0, 2.0, 1.0]), None);
    }
}
