//! Steps after which no head is beyond its bounds where its functions are centred.

use super::iterate::State;
use super::rows::{Rows, Walk};
use super::solver::Solver;
use super::triangle::{Row, Source};
use crate::bounds::{Limit, WALL, each, within};

/// A row that holds a head at a bound where one of its functions is centred, positive inside: its value where all coefficients are
/// zero, and its derivatives by them from the first that it depends on.
struct Wall {
    away: f64,
    first: usize,
    slopes: Vec<f64>,
}

impl Wall {
    fn change(&self, coefficients: &[f64]) -> f64 {
        self.slopes.iter().zip(&coefficients[self.first..]).map(|(slope, x)| slope * x).sum()
    }

    fn value(&self, coefficients: &[f64]) -> f64 {
        self.away + self.change(coefficients)
    }
}

/// The rows of a step about some coefficients and the walls that are held, in the order of their first unknowns.
struct Held<'a> {
    rows: Walk<'a>,
    walls: &'a [&'a Wall],
    theta: &'a [f64],
    /// A wall's derivatives by learned parameters.
    none: &'a [f64],
}

impl Source for Held<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<Row<'_>> {
        match self.walls.split_first() {
            Some((wall, others)) if self.rows.first().is_none_or(|first| wall.first <= first) => {
                self.walls = others;
                let value = wall.value(self.theta);
                Some(Row { first: wall.first, slopes: &wall.slopes, shared: self.none, value })
            }
            _ => self.rows.next(),
        }
    }
}

impl Solver<'_> {
    /// A step of coefficients and of learned parameters within all bounds. It goes last, since the triangle is made anew. Noise,
    /// roughness and error bars are those without bounds, so that a source at its bound has bars.
    pub(super) fn within_bounds(
        &mut self,
        state: &State,
        rows: &Rows,
        step: (Vec<f64>, Vec<f64>),
    ) -> (Vec<f64>, Vec<f64>) {
        let (walls, theta) = (self.walls(), &state.theta);
        let none = vec![0.0; step.1.len()];
        let inside =
            |step: &(Vec<f64>, Vec<f64>), at: usize| (walls[at].value(theta) + walls[at].change(&step.0)) / WALL;
        let at_bound = (0..walls.len()).filter(|&at| walls[at].value(theta) <= 0.0).collect();
        within(walls.len(), step, at_bound, inside, |held| {
            let walls: Vec<&Wall> = held.iter().map(|&at| &walls[at]).collect();
            self.triangle.clear();
            self.triangle.add_all(Held { rows: rows.walk(), walls: &walls, theta, none: &none });
            self.triangle.solve()
        })
    }

    /// The walls of bounded heads, one for each of their bounds where each of their functions is centred, in the order of their first
    /// unknowns.
    fn walls(&self) -> Vec<Wall> {
        let heads = &self.heads;
        let of = |head: usize, limit: Limit| {
            let (basis, factor) = (&heads.bases[head], limit.sign * WALL / heads.scale[head]);
            (0..basis.len()).map(move |function| {
                let (first, slopes) = heads.value_row(head, basis.centre(function));
                let away = WALL * limit.inside(heads.offset[head]) / heads.scale[head];
                Wall { away, first, slopes: slopes.iter().map(|slope| factor * slope).collect() }
            })
        };
        let mut walls: Vec<Wall> = each(&heads.limits).flat_map(|(head, limit)| of(head, limit)).collect();
        walls.sort_by_key(|wall| wall.first);
        walls
    }
}
