//! Steps after which no head is beyond its bounds where its functions are centred.

use super::iterate::State;
use super::rows::{Rows, Walk};
use super::solver::Solver;
use super::triangle::{Row, Source};
use crate::bounds::{Bounded, Limit, Spring, WALL, each};

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

/// The rows of a step about some coefficients and springs that pull at walls, in the order of their first unknowns.
struct Pulled<'a> {
    rows: Walk<'a>,
    springs: &'a [Spring],
    walls: &'a [Wall],
    theta: &'a [f64],
    /// The derivatives of the spring at hand.
    slopes: Vec<f64>,
    /// A wall's derivatives by learned parameters.
    none: &'a [f64],
}

impl Source for Pulled<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<Row<'_>> {
        match self.springs.split_first() {
            Some((spring, others)) if self.rows.first().is_none_or(|first| self.walls[spring.at].first <= first) => {
                self.springs = others;
                let (wall, share) = (&self.walls[spring.at], spring.stiffness / WALL);
                self.slopes.clear();
                self.slopes.extend(wall.slopes.iter().map(|slope| slope * share));
                let value = wall.value(self.theta) * share - spring.stiffness * spring.target;
                Some(Row { first: wall.first, slopes: &self.slopes, shared: self.none, value })
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
        let pulled = &mut |springs: &[Spring]| {
            self.triangle.clear();
            let rows = rows.walk();
            self.triangle.add_all(Pulled { rows, springs, walls: &walls, theta, none: &none, slopes: Vec::new() });
            self.triangle.solve()
        };
        Bounded { count: walls.len(), inside: &inside, pulled }.within(step, at_bound)
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
