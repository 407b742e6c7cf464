//! The last cells of a record: a square-root information smoother whose unknowns are coefficients of splines.
//!
//! Cells have one width and move along the coordinate with the record. Rows of the last few cells, the tail, are made anew in
//! every step about the present state; rows of older cells have been turned into a triangle once and for all. What that
//! triangle says of cells that have left the window is in its later rows already (`triangle/lag.rs`).

mod answered;
mod bends;
mod read;
mod tail;

use std::collections::VecDeque;

use super::event::Event;
use super::evidence::Weights;
use super::grid::Grid;
use super::strays::{Strays, Suspect};
use crate::kernel::GroupKernel;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;
use crate::splines::group::Group;
use crate::splines::heads::Heads;
use crate::splines::triangle::Triangle;
use tail::{Observed, Split};

/// Largest change of a coefficient in a step, in natural sizes: rows about a state say little of what is farther off.
const FARTHEST: f64 = 3.0;

/// What a head is at a place, in the engine's units, where that is known.
pub(super) type Known<'a> = &'a dyn Fn(usize, f64) -> Option<f64>;

/// The last cells of a record, and what is known of the heads on them.
pub(super) struct Window {
    pub(super) bound: Bound,
    weights: Weights,
    /// From which place on they hold: rows of older cells had others.
    weighed_from: f64,
    grid: Grid,
    heads: Heads,
    /// Coefficients.
    theta: Vec<f64>,
    /// Where each coefficient was when it came into the window: the triangles are about these.
    reference: Vec<f64>,
    /// All rows of cells before the tail.
    settled: Triangle,
    /// These and the rows of the tail.
    all: Triangle,
    /// Groups of equations at the places of the tail, by the number of the group.
    equations: Vec<(usize, Group)>,
    /// Places of the equations, from the first cell of the window on.
    places: Vec<f64>,
    /// What is asked for in the tail, in the order of the coordinate.
    events: VecDeque<Event>,
    /// What has left the tail since it was last asked.
    gone: Vec<Event>,
    /// Whether equations hold up to the end of the newest cell. Where they come with columns they hold up to the last row, and the
    /// newest coefficients may go anywhere.
    reaches_the_end: bool,
    /// Observations of the tail as the last step saw them.
    observed: Vec<Observed>,
    /// Places of rows that may be strays, and are left out for now.
    aside: Vec<f64>,
    /// Whether a cell has left the tail since the last step.
    has_left: bool,
    kernels: Vec<GroupKernel<f64>>,
    step: Vec<f64>,
    /// By learned scalar, how the unknowns follow its parameter.
    follow: Vec<Vec<f64>>,
    scratch: Vec<f64>,
}

impl Window {
    /// Over a grid, before any row. `continuous` are the groups whose equations hold everywhere.
    pub(super) fn new(bound: Bound, weights: Weights, grid: Grid, continuous: &[usize]) -> Self {
        let schema = bound.problem.scene().schema;
        let degrees = crate::splines::cells::degrees(schema).unwrap_or_default();
        let heads = Heads::uniform(&bound, &degrees, grid.cells, grid.width);
        let highest = degrees.iter().copied().max().unwrap_or(0);
        let unknowns = degrees.len() * (grid.cells + highest);
        let places = grid.equations();
        let kernels = bound.problem.scene().double();
        let equation = |&at: &usize| (at, Group::new(&schema.groups[at], kernels[at], &heads, &places, &[]));
        let equations = continuous.iter().map(equation).collect();
        let learned = weights.learned.len();
        let triangle = Triangle::new(unknowns, heads.band, learned);
        let is_equation = |group: &schema::Group| group.terms.iter().any(|term| term.kind == TermKind::Residual);
        let reaches_the_end = schema.groups.iter().all(|group| group.columns.is_empty() || !is_equation(group));
        Self {
            weights,
            weighed_from: f64::NEG_INFINITY,
            theta: vec![0.0; unknowns],
            reference: vec![0.0; unknowns],
            settled: triangle.clone(),
            all: triangle,
            equations,
            places,
            events: VecDeque::new(),
            gone: Vec::new(),
            reaches_the_end,
            observed: Vec::new(),
            aside: Vec::new(),
            has_left: false,
            kernels,
            step: vec![0.0; unknowns],
            follow: vec![vec![0.0; unknowns]; learned],
            scratch: Vec::new(),
            bound,
            grid,
            heads,
        }
    }

    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Takes over what the evidence of a later part of the record says. Rows of older cells follow learned scalars to what they are now.
    pub(super) fn weigh(&mut self, weights: Weights) {
        let moved: Vec<f64> = weights.learned.iter().zip(&self.weights.learned).map(|(new, old)| new - old).collect();
        self.settled.move_shared(&moved);
        self.all.move_shared(&moved);
        self.weights = weights;
        self.weighed_from = self.grid.left() + self.grid.tail_start() as f64 * self.grid.width;
    }

    pub(super) fn weights(&self) -> &Weights {
        &self.weights
    }

    /// A triangle of no rows over the unknowns of three cells next to each other, beside so many that all rows share.
    pub(super) fn empty_triangle(&self, shared: usize) -> Triangle {
        Triangle::new(2 * self.heads_count() + self.heads.band, self.heads.band, shared)
    }

    /// What was asked for in cells that have left the tail since this was last asked.
    pub(super) fn gone(&mut self) -> impl Iterator<Item = Event> + '_ {
        self.gone.drain(..)
    }

    /// Whether deviations say anything: data are off by some noise.
    pub(super) fn has_deviations(&self) -> bool {
        self.weights.noise.is_there(self.bound.problem.scene().schema)
    }

    pub(super) fn heads_count(&self) -> usize {
        self.heads.bases.len()
    }

    /// The first unknown of a cell.
    pub(super) fn first(&self, cell: usize) -> usize {
        self.heads_count() * cell
    }

    /// Sets all coefficients to what is known of the heads.
    pub(super) fn guess(&mut self, known: Known<'_>) {
        for head in 0..self.heads_count() {
            for function in 0..self.heads.bases[head].len() {
                self.guess_one(head, function, known);
            }
        }
        self.reference.copy_from_slice(&self.theta);
    }

    /// Sets a coefficient to what a head is at the spline's centre, or where its predecessors point to.
    fn guess_one(&mut self, head: usize, function: usize, known: Known<'_>) {
        let at = self.grid.left() + self.heads.bases[head].centre(function);
        let (number, count) = (self.heads.numbers(head, function)[0], self.heads_count());
        self.theta[number] = match known(head, at) {
            Some(value) => (value - self.heads.offset[head]) / self.heads.scale[head],
            None => 2.0 * self.theta[number - count] - self.theta[number - 2 * count],
        };
    }

    /// Puts in what is asked for at a place of the tail. Places come in order.
    pub(super) fn ask(&mut self, event: Event) {
        self.events.push_back(event);
    }

    /// Adds a cell at the end: the first of all is forgotten, and the first of the tail leaves it with the next step, which must
    /// come before the next cell. New coefficients are guessed.
    pub(super) fn advance(&mut self, known: Known<'_>) {
        let count = self.heads_count();
        self.grid.advance();
        for part in [&mut self.theta, &mut self.reference] {
            part.copy_within(count.., 0);
        }
        self.settled.shift(count);
        self.all.shift(count);
        let last = self.theta.len() - count;
        for at in last..self.theta.len() {
            self.theta[at] = 0.0;
            self.reference[at] = 0.0;
        }
        for head in 0..count {
            let function = self.heads.bases[head].len() - 1;
            let number = self.heads.numbers(head, function)[0];
            self.guess_one(head, function, known);
            self.reference[number] = self.theta[number];
        }
        self.has_left = true;
    }

    /// Turns the tail's rows in about the present state, and solves for all unknowns from a cell on. Returns the largest
    /// change of a coefficient in the tail, in units of the heads' natural sizes.
    pub(super) fn solve(&mut self, from: usize) -> Result<f64, Fault> {
        let first = self.first(self.grid.tail_start());
        let Split { mut leaving, mut staying, observed } = self.rows()?;
        self.observed = observed;
        if std::mem::take(&mut self.has_left) {
            leaving.sort();
            self.settled.add_all(leaving.walk());
            let grid = &self.grid;
            while self.events.front().is_some_and(|event| grid.cell(event.at) < grid.tail_start()) {
                self.gone.extend(self.events.pop_front());
            }
        }
        staying.sort();
        // Rows of the cell that left the tail last reach down to its first unknown.
        self.all.copy_from(&self.settled, first.saturating_sub(self.heads_count()));
        self.all.add_all(staying.walk());
        let from = self.first(from);
        if !self.all.solve_from(from, &mut self.step) {
            return Err(Fault::unsolved("the latest rows"));
        }
        self.follow.iter_mut().enumerate().for_each(|(at, follow)| self.all.follow_from(from, at, follow));
        let pinned = if self.reaches_the_end { self.theta.len() } else { self.first(self.grid.cells) };
        let mut change = 0.0_f64;
        for at in from..self.theta.len() {
            let step = self.reference[at] + self.step[at] - self.theta[at];
            if at >= first {
                change = change.max(step.abs());
            }
            let farthest = if at < pinned { FARTHEST } else { f64::INFINITY };
            self.theta[at] += step.clamp(-farthest, farthest);
        }
        Ok(change)
    }

    /// What is known of the heads.
    pub(super) fn state(&self) -> Vec<f64> {
        self.theta.clone()
    }

    /// Takes a state for what is known of the heads.
    pub(super) fn return_to(&mut self, state: &[f64]) {
        self.theta.copy_from_slice(state);
    }

    /// Leaves out the rows of the tail that are strays by the last step, or may be. The next step knows nothing of them.
    pub(super) fn leave_out_strays(&mut self) -> Strays {
        let (triangle, step) = (&self.all, &self.step);
        let suspects = self.observed.iter().map(|observed| {
            let Observed { at, what, first, slopes, value } = observed;
            let moved: f64 = slopes.iter().zip(&step[*first..]).map(|(slope, step)| slope * step).sum();
            Suspect { at: *at, what: *what, off: value + moved, root: triangle.root_beside(*first, slopes) }
        });
        let strays = Strays::among(suspects.collect());
        self.count(false, |at| strays.found.contains(&at) || strays.aside.contains(&at));
        self.aside.clone_from(&strays.aside);
        strays
    }

    /// Takes rows in again of which it was not known whether they are strays.
    pub(super) fn readmit(&mut self) {
        let aside = std::mem::take(&mut self.aside);
        self.count(true, |at| aside.contains(&at));
    }

    /// Whether what was observed at some places of the tail counts.
    fn count(&mut self, counts: bool, is_there: impl Fn(f64) -> bool) {
        for event in self.events.iter_mut().filter(|event| is_there(event.at)) {
            event.is_stray = !counts;
        }
    }

    /// Up to where it is known which rows are strays.
    pub(super) fn decided(&self) -> f64 {
        self.aside.first().copied().unwrap_or(f64::INFINITY)
    }
}
