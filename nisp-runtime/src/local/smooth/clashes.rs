//! Where conditions contradict each other: a wall that is suddenly hot beside a body that is cold at the start, two sides of a box at different
//! values, a flux that is switched on. The fields jump there, or their derivatives do, though no equation does.

use std::num::NonZero;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::shares::width;
use crate::local::lattice::MOST_COORDINATES;
use crate::nearest::Nearest;
use crate::problem::Bound;
use crate::schema;
use crate::solve::driver::Warning;

/// Rows near a place for each number of the polynomials that are to meet them.
const ROWS: usize = 2;
/// What these polynomials leave of the rows near a place, over what constants leave, from which on the rows contradict each other. They leave
/// some of smooth conditions too.
const LEFT: f64 = 0.1;
/// How much that changes the fields, over the change of the conditions from place to place, from which on it matters.
const MATTERS: f64 = 0.02;
/// Change of a field over its size that rounding makes.
const ROUNDING: f64 = 1e-6;
/// Step for the derivatives of a row, over the size of what it reads.
const STEP: f64 = 1e-3;
/// Singular values of a fit, over the largest, that count as none.
const NONE: f64 = 1e-9;

/// A row of a condition at a point: what is left of it, and its derivatives by the jets that it reads.
pub(super) struct Row {
    place: [f64; MOST_COORDINATES],
    group: usize,
    left: f64,
    pub(super) slopes: Vec<f64>,
}

/// Where conditions contradict each other.
#[derive(Clone, Default)]
pub(super) struct Clashes {
    /// Points, flat.
    pub(super) places: Vec<f64>,
    /// The groups of these conditions, but for those that contradict only what sources were taken to be.
    pub(super) groups: Vec<usize>,
}

impl Clashes {
    /// Tells the user of them; nothing where there are none.
    pub(super) fn warning(&self, schema: &schema::Scene) -> Option<Warning> {
        let names: Vec<String> = self.groups.iter().map(|&at| format!("`{}`", schema.groups[at].name)).collect();
        (!names.is_empty()).then(|| Warning::clash(&names.join(" and ")))
    }
}

/// Where conditions contradict each other: no fields that are smooth there meet all of them. Sources are taken as something that is not zero.
pub(super) fn clashes(bound: &Bound) -> Clashes {
    let schema = bound.problem.scene().schema;
    let groups = schema.conditions();
    let Some(order) = groups.iter().map(|&at| schema.groups[at].order).max() else {
        return Clashes::default();
    };
    let smooth = Smooth {
        bound,
        widths: (0..schema.coordinates.len()).map(|axis| width(bound, &groups, axis)).collect(),
        fields: (0..schema.heads.len()).filter(|&head| !schema.heads[head].source).collect(),
        powers: powers(schema.coordinates.len(), order + 2),
    };
    let reads_source = |group: usize| schema.groups[group].jets.iter().any(|jet| schema.heads[jet.head].source);
    let rows: Vec<Row> = groups.iter().flat_map(|&at| rows(bound, at, &smooth.widths)).collect();
    let near = ROWS * smooth.fields.len() * smooth.powers.len();
    let places: Vec<[f64; MOST_COORDINATES]> = rows.iter().map(|row| row.place).collect();
    let (Some(tree), Some(near)) = (Nearest::of(&places), NonZero::new(near)) else { return Clashes::default() };
    let found = rows.par_iter().filter_map(|row| {
        let near = tree.some(&row.place, near);
        let radius = near.iter().map(|own| own.distance).fold(0.0, f64::max);
        let near: Vec<&Row> = near.iter().filter(|_| radius > 0.0).map(|own| &rows[own.index]).collect();
        let (smooth, constant) = smooth.left(&near, row.place, radius)?;
        // A jump of a derivative matters more, the farther it goes on.
        let highest = near.iter().map(|row| schema.groups[row.group].order).max()?;
        let farther = radius.powi(-(highest as i32));
        let is_free = near.iter().any(|row| reads_source(row.group));
        Some(((row, is_free), [smooth, constant, farther]))
    });
    let found: Vec<((&Row, bool), [f64; 3])> = found.collect();
    let change = found.iter().map(|(_, [_, constant, farther])| constant * farther).fold(0.0, f64::max);
    let clash = found.into_iter().filter(|(_, [smooth, constant, farther])| {
        *smooth > LEFT * constant && *smooth > ROUNDING && smooth * farther > MATTERS * change
    });
    let clash: Vec<(&Row, bool)> = clash.map(|(row, _)| row).collect();
    let place = |row: &Row| smooth.widths.iter().zip(row.place).map(|(width, x)| width * x).collect::<Vec<f64>>();
    let meets = |group: &usize| clash.iter().any(|(row, is_free)| row.group == *group && !is_free);
    Clashes {
        places: clash.iter().flat_map(|(row, _)| place(row)).collect(),
        groups: groups.iter().copied().filter(meets).collect(),
    }
}

/// Rows of a condition at all its points, linear in what they read about the sizes of it.
pub(super) fn rows(bound: &Bound, group: usize, widths: &[f64]) -> Vec<Row> {
    let schema = bound.problem.scene().schema;
    let (own, inputs) = (&schema.groups[group], schema.coordinates.len());
    let count = bound.coordinates[group].len() / inputs;
    let sizes: Vec<f64> = own.jets.iter().map(|jet| bound.typical(jet)).collect();
    let columns = bound.filled_columns(group);
    let evaluated =
        |jets: &[f64]| bound.uniform_rows(group, (&bound.coordinates[group], &columns), jets, &bound.scalars);
    let base = evaluated(&sizes);
    let slope = |jet: usize| {
        let mut moved = sizes.clone();
        moved[jet] += STEP * sizes[jet];
        evaluated(&moved)
    };
    let moved: Vec<Vec<Vec<f64>>> = (0..sizes.len()).map(slope).collect();
    let place = |p: usize| {
        let mut place = [0.0; MOST_COORDINATES];
        let along = bound.coordinates[group][p * inputs..][..inputs].iter().zip(widths);
        place.iter_mut().zip(along).for_each(|(own, (x, width))| *own = x / width);
        place
    };
    let row = |(row, p): (usize, usize)| {
        let slopes: Vec<f64> =
            (0..sizes.len()).map(|j| (moved[j][row][p] - base[row][p]) / (STEP * sizes[j])).collect();
        // Fields are counted from nothing, sources from what they are taken to be.
        let fields = own.jets.iter().zip(slopes.iter().zip(&sizes)).filter(|(jet, _)| !schema.heads[jet.head].source);
        let left = base[row][p] - fields.map(|(_, (slope, size))| slope * size).sum::<f64>();
        Row { place: place(p), group, left, slopes }
    };
    (0..own.rows).flat_map(|at| (0..count).map(move |p| (at, p))).map(row).collect()
}

/// Powers of the coordinates up to a degree, the constant first.
fn powers(inputs: usize, degree: usize) -> Vec<Vec<u8>> {
    let all = (degree + 1).pow(inputs as u32);
    let power = |number: usize, axis: usize| (number / (degree + 1).pow(axis as u32) % (degree + 1)) as u8;
    let all = (0..all).map(|number| (0..inputs).map(|axis| power(number, axis)).collect::<Vec<u8>>());
    all.filter(|own| own.iter().map(|&n| usize::from(n)).sum::<usize>() <= degree).collect()
}

/// Polynomials of all fields.
struct Smooth<'a> {
    bound: &'a Bound,
    widths: Vec<f64>,
    fields: Vec<usize>,
    powers: Vec<Vec<u8>>,
}

impl Smooth<'_> {
    /// What polynomials and constants leave of rows within a radius of a place, each over its derivatives by their coefficients: in sizes of
    /// the fields. Nothing where no row reads a field.
    fn left(&self, near: &[&Row], place: [f64; MOST_COORDINATES], radius: f64) -> Option<(f64, f64)> {
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for row in near {
            let own = self.slopes(row, place, radius);
            let length = own.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.0 {
                rows.extend(own.iter().map(|x| x / length));
                values.push(-row.left / length);
            }
        }
        if values.is_empty() {
            return None;
        }
        let all = DMatrix::from_row_slice(values.len(), self.fields.len() * self.powers.len(), &rows);
        let values = DVector::from_vec(values);
        let constants: Vec<usize> = (0..self.fields.len()).map(|field| field * self.powers.len()).collect();
        let constant = all.select_columns(&constants);
        let left = |matrix: DMatrix<f64>| {
            let svd = matrix.clone().svd(true, true);
            let fit = svd.solve(&values, NONE * svd.singular_values.max()).ok()?;
            Some((matrix * fit - &values).norm() / (values.len() as f64).sqrt())
        };
        Some((left(all)?, left(constant)?))
    }

    /// Derivatives of a row by all coefficients of polynomials about a place.
    fn slopes(&self, row: &Row, place: [f64; MOST_COORDINATES], radius: f64) -> Vec<f64> {
        let schema = self.bound.problem.scene().schema;
        let at: Vec<f64> = row.place.iter().zip(place).map(|(x, middle)| (x - middle) / radius).collect();
        let derivative = |index: &[u8], power: &[u8]| {
            let along = index.iter().zip(power).zip(at.iter().zip(&self.widths));
            let along =
                along.map(|((&n, &power), (x, width))| monomial(n, power, *x) / (radius * width).powi(i32::from(n)));
            along.product::<f64>()
        };
        let by = |head: usize, power: &[u8]| {
            let jets = schema.groups[row.group].jets.iter().zip(&row.slopes).filter(|(jet, _)| jet.head == head);
            let of_jet = |(jet, slope): (&schema::Jet, &f64)| {
                slope * jet.operator.iter().map(|(index, times)| times * derivative(index, power)).sum::<f64>()
            };
            self.bound.head_scale(head) * jets.map(of_jet).sum::<f64>()
        };
        self.fields.iter().flat_map(|&head| self.powers.iter().map(move |power| by(head, power))).collect()
    }
}

/// A derivative of a power.
fn monomial(order: u8, power: u8, x: f64) -> f64 {
    let factor = (0..order).map(|n| f64::from(power) - f64::from(n)).product::<f64>();
    if order > power { 0.0 } else { factor * x.powi(i32::from(power - order)) }
}
