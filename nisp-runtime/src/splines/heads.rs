//! All heads of a scene as splines over the same cells, and how their coefficients are ordered.

use super::basis::Basis;
use crate::bounds::{Limits, limits, sizes};
use crate::problem::Bound;

/// Heads as functions of one vector of coefficients, each `offset + scale * sum(coefficient * spline)`. Coefficients of all
/// heads are numbered in the order of the splines' centres, so that a place depends on neighbours only.
#[derive(Clone, Debug)]
pub(super) struct Heads {
    pub(super) bases: Vec<Basis>,
    /// By head and function: the number of its coefficient.
    numbers: Vec<Vec<usize>>,
    pub(super) offset: Vec<f64>,
    pub(super) scale: Vec<f64>,
    /// Bounds of heads that have them.
    pub(super) limits: Vec<Option<Limits>>,
    /// Numbers from the first to the last of a cell's functions, at most.
    pub(super) band: usize,
}

impl Heads {
    /// The heads of a problem, of these degrees, over the cells between breakpoints.
    pub(super) fn new(bound: &Bound, degrees: &[usize], breakpoints: &[f64]) -> Self {
        let limits = limits(bound.problem.scene().schema, &bound.system);
        let (offset, scale) = sizes(bound, &limits);
        Self::over(breakpoints, degrees, (offset, scale, limits))
    }

    /// Heads of these degrees over the cells between breakpoints, with these offsets, scales and bounds.
    pub(super) fn over(
        breakpoints: &[f64],
        degrees: &[usize],
        (offset, scale, limits): (Vec<f64>, Vec<f64>, Vec<Option<Limits>>),
    ) -> Self {
        let bases: Vec<Basis> = degrees.iter().map(|&degree| Basis::new(degree, breakpoints)).collect();
        let functions = bases.iter().enumerate();
        let mut order: Vec<(f64, usize, usize)> =
            functions.flat_map(|(head, basis)| (0..basis.len()).map(move |i| (basis.centre(i), i, head))).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut numbers: Vec<Vec<usize>> = bases.iter().map(|basis| vec![0; basis.len()]).collect();
        for (number, &(_, function, head)) in order.iter().enumerate() {
            numbers[head][function] = number;
        }
        let mut heads = Self { bases, numbers, offset, scale, limits, band: 0 };
        let all: Vec<usize> = (0..degrees.len()).collect();
        heads.band = (0..breakpoints.len() - 1).map(|cell| heads.span(&all, cell).1).max().unwrap_or(1);
        heads
    }

    /// The heads of a problem, of these degrees, over so many cells of one width. Every cell has as many numbers of its own as there are heads: a
    /// shift by a cell is a shift by so many numbers. Heads of lower degrees leave some at both ends to nobody.
    pub(super) fn uniform(bound: &Bound, degrees: &[usize], cells: usize, width: f64) -> Self {
        let limits = limits(bound.problem.scene().schema, &bound.system);
        let (offset, scale) = sizes(bound, &limits);
        let bases: Vec<Basis> = degrees.iter().map(|&degree| Basis::uniform(degree, cells, width)).collect();
        let (count, highest) = (degrees.len(), degrees.iter().copied().max().unwrap_or(0));
        let number = |head: usize, function: usize| {
            let shift = (highest - degrees[head]) / 2;
            count * (function + shift) + head
        };
        let numbers = bases.iter().enumerate().map(|(head, basis)| (0..basis.len()).map(|i| number(head, i)).collect());
        let mut heads = Self { numbers: numbers.collect(), bases, offset, scale, limits, band: 0 };
        let all: Vec<usize> = (0..count).collect();
        heads.band = heads.span(&all, 0).1;
        heads
    }

    /// Number of coefficients.
    pub(super) fn len(&self) -> usize {
        self.numbers.iter().map(Vec::len).sum()
    }

    /// A row over a head's coefficients from one on as a row of all unknowns: its first unknown and its value. `slopes` receives what the
    /// unknowns from there on are multiplied by.
    pub(super) fn row_of(
        &self,
        (head, first): (usize, usize),
        factors: &[f64],
        theta: &[f64],
        slopes: &mut Vec<f64>,
    ) -> (usize, f64) {
        let numbers = &self.numbers(head, first)[..factors.len()];
        slopes.clear();
        slopes.resize(numbers[factors.len() - 1] + 1 - numbers[0], 0.0);
        let mut value = 0.0;
        for (&number, factor) in numbers.iter().zip(factors) {
            slopes[number - numbers[0]] = *factor;
            value += factor * theta[number];
        }
        (numbers[0], value)
    }

    /// Numbers of a head's coefficients from one of its functions on; they increase.
    pub(super) fn numbers(&self, head: usize, from: usize) -> &[usize] {
        &self.numbers[head][from..]
    }

    /// First number of the functions of some heads on a cell, and how many lie from the first to the last.
    pub(super) fn span(&self, heads: &[usize], cell: usize) -> (usize, usize) {
        let first = heads.iter().map(|&head| self.numbers[head][cell]).min().unwrap_or(0);
        let last = heads.iter().map(|&head| self.numbers[head][cell + self.bases[head].degree]).max().unwrap_or(0);
        (first, last + 1 - first)
    }

    /// A derivative of a head at a place in a cell.
    pub(super) fn derivative(&self, head: usize, (cell, at): (usize, f64), order: usize, theta: &[f64]) -> f64 {
        let line = self.bases[head].line(cell, at, order);
        let sum: f64 =
            self.numbers(head, cell).iter().zip(&line[..=self.bases[head].degree]).map(|(&n, b)| theta[n] * b).sum();
        let offset = if order == 0 { self.offset[head] } else { 0.0 };
        offset + self.scale[head] * sum
    }

    /// A head's value at a place, within its bounds.
    pub(super) fn value(&self, head: usize, at: f64, theta: &[f64]) -> f64 {
        let value = self.derivative(head, (self.cell(at), at), 0, theta);
        self.limits[head].map_or(value, |limits| limits.within(value))
    }

    /// What a head's value at a place is by the coefficients: the first of them, and the value's derivatives.
    pub(super) fn value_row(&self, head: usize, at: f64) -> (usize, Vec<f64>) {
        let cell = self.cell(at);
        let (first, width) = self.span(&[head], cell);
        let basis = &self.bases[head];
        let mut slopes = vec![0.0; width];
        for (&n, value) in self.numbers(head, cell).iter().zip(&basis.line(cell, at, 0)[..=basis.degree]) {
            slopes[n - first] = self.scale[head] * value;
        }
        (first, slopes)
    }

    /// The cell of a place.
    pub(super) fn cell(&self, at: f64) -> usize {
        self.bases[0].cell(at)
    }
}
