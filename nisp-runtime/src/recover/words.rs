//! Open directions in the user's words.

use super::open::{Open, What};
use super::spread::Spread;
use crate::problem::{Bound, place};
use crate::schema::Scalar;
use crate::solve::vector;
use crate::units::{Declared, Engine, Number, Scale};

/// Part of a scalar in a direction, beside the largest, from which on it is named.
const NAMED: f64 = 0.1;

/// Names and units of a problem, and how its learned scalars stand.
pub(super) struct Words<'a> {
    pub(super) bound: &'a Bound,
    /// Values and their derivatives by their parameters, in the engine's units.
    pub(super) learned: Vec<(f64, f64)>,
}

impl Words<'_> {
    /// That a direction is open, one of all that are.
    pub(super) fn undetermined(&self, open: &Open, spread: &Spread, all: &[Open]) -> String {
        let What::Head(head) = open.what else { return self.undetermined_scalars(open, spread) };
        let along = self.along(open, spread, all);
        let head = &self.bound.problem.scene().schema.heads[head];
        let shape = &open.direction.shape;
        let peak = vector::largest(shape);
        let size = Number::engine(open.direction.deviation * shape[peak]);
        let size = self.bound.system.outward(&head.unit).of(size);
        let (name, at) = (head.name, self.place(spread, peak));
        format!(
            "the data do not determine `{name}`: {} may be added to it{along}, by about {size:.2e} {} at {at}, and only the \
             prior decides how much; a condition on `{name}` there would settle it",
            self.shape(open, spread),
            head.unit.text,
        )
    }

    /// Heads that are open too, and move along: data know what they make together.
    fn along(&self, open: &Open, spread: &Spread, all: &[Open]) -> String {
        let heads = self.bound.problem.scene().schema.heads;
        let name = |other: &Open| match other.what {
            What::Head(at) if other.what != open.what => {
                open.moved(&spread.heads[at].1).map(|_| format!("`{}`", heads[at].name))
            }
            _ => None,
        };
        let names: Vec<String> = all.iter().filter_map(name).collect();
        let verb = if names.len() == 1 { "moves" } else { "move" };
        if names.is_empty() { String::new() } else { format!(" if {} {verb} along", names.join(" and ")) }
    }

    /// That a direction would be open without a condition.
    pub(super) fn settled(&self, open: &Open, spread: &Spread, condition: &str) -> String {
        match open.what {
            What::Head(head) => {
                let name = self.bound.problem.scene().schema.heads[head].name;
                format!(
                    "`{name}` rests on {condition}: without it {} could be added to `{name}`, and the data would not tell",
                    self.shape(open, spread),
                )
            }
            What::Learned => {
                let verb = if self.named(open).len() == 1 { "rests" } else { "rest" };
                let (names, together) = (self.names(open, " and "), self.together(open, spread));
                format!("{names} {verb} on {condition}: without it {together} would fit the data as well")
            }
        }
    }

    fn undetermined_scalars(&self, open: &Open, spread: &Spread) -> String {
        let one = self.scalar(self.named(open)[0]).name;
        format!(
            "the data do not determine {}: {} fits them as well; a known value of {}, or a belief about it (`learn {one} \
             within ...`), would settle it",
            self.names(open, " and "),
            self.together(open, spread),
            self.names(open, " or "),
        )
    }

    /// What changes together, for every hundredth of the scalar that changes most: `E` + 1.00 % with `p` + 1.00 %.
    fn together(&self, open: &Open, spread: &Spread) -> String {
        let named = self.named(open);
        let (value, _) = self.learned[named[0]];
        // Standard deviations that change it by a hundredth, or by its unit where it is zero.
        let unit = self.inward(named[0]).of(Number::declared(1.0)).as_engine();
        let step = if value == 0.0 { unit } else { value.abs() / 100.0 };
        let count = step / self.change(open, named[0]);
        let scalars = named.iter().map(|&at| {
            let (change, value) = (count * self.change(open, at), self.learned[at].0);
            let Scalar { name, unit, .. } = self.scalar(at);
            if value == 0.0 {
                more(name, self.inward(at).back(Number::engine(change)).as_declared(), unit.text)
            } else {
                more(name, 100.0 * change / value.abs(), "%")
            }
        });
        let heads =
            self.bound.problem.scene().schema.heads.iter().zip(&spread.heads).filter_map(|(head, (_, rows))| {
                let moved = open.moved(rows)?;
                let peak = vector::largest(&moved);
                let change = self.bound.system.outward(&head.unit).of(Number::engine(count * moved[peak]));
                let more = more(head.name, change.as_declared(), head.unit.text);
                Some(format!("{more} at {}", self.place(spread, peak)))
            });
        scalars.chain(heads).collect::<Vec<_>>().join(" with ")
    }

    /// How a scalar changes with one standard deviation along a direction, in the engine's units.
    fn change(&self, open: &Open, scalar: usize) -> f64 {
        open.direction.deviation * open.direction.shape[scalar] * self.learned[scalar].1
    }

    /// The learned scalars that make up a direction, largest first.
    fn named(&self, open: &Open) -> Vec<usize> {
        let size = |at: &usize| open.direction.shape[*at].abs();
        let largest = size(&vector::largest(&open.direction.shape));
        let mut named: Vec<usize> = (0..self.learned.len()).filter(|at| size(at) > NAMED * largest).collect();
        named.sort_by(|a, b| size(b).total_cmp(&size(a)));
        named
    }

    /// Their names.
    fn names(&self, open: &Open, between: &str) -> String {
        let names: Vec<String> = self.named(open).into_iter().map(|at| format!("`{}`", self.scalar(at).name)).collect();
        names.join(between)
    }

    fn scalar(&self, at: usize) -> &'static Scalar {
        &self.bound.problem.scene().schema.scalars[self.bound.learned[at].slot]
    }

    /// From a scalar's unit to the engine's.
    fn inward(&self, at: usize) -> Scale<Declared, Engine> {
        self.bound.system.outward(&self.scalar(at).unit).inverse()
    }

    fn place(&self, spread: &Spread, point: usize) -> String {
        let coordinates = self.bound.problem.scene().schema.coordinates;
        place(coordinates, &spread.points[point * coordinates.len()..])
    }

    /// The direction of a head in words: a constant or an exponential where it is one.
    fn shape(&self, open: &Open, spread: &Spread) -> String {
        let share = format!("({:.1} % of its variance)", 100.0 * open.direction.share);
        if is_constant(&open.direction.shape) {
            return format!("a constant {share}");
        }
        match (self.bound.problem.scene().schema.coordinates, exponent(&spread.points, &open.direction.shape)) {
            ([c], Some(rate)) => format!("a multiple of exp({rate:.3} {}) {share}", c.name),
            _ => format!("one pattern {share}"),
        }
    }
}

/// By how much a quantity is changed: `` `E` + 1.00 % ``.
fn more(name: &str, change: f64, unit: &str) -> String {
    format!("`{name}` {} {} {unit}", if change < 0.0 { "-" } else { "+" }, figures(change.abs())).trim_end().into()
}

/// Three figures, without an exponent where that is short.
fn figures(value: f64) -> String {
    if (0.01..100.0).contains(&value) { format!("{value:.2}") } else { format!("{value:.2e}") }
}

/// Deviations from a shape that may be overlooked, as a share of the largest value.
const CLOSE: f64 = 0.03;

/// True if the values are the same to within a few per cent.
fn is_constant(y: &[f64]) -> bool {
    let Some(&peak) = y.get(vector::largest(y)) else { return false };
    y.iter().all(|y| (y / peak - 1.0).abs() < CLOSE)
}

/// The rate of an exponential through the values, if they are one to within a few per cent of the largest.
fn exponent(x: &[f64], y: &[f64]) -> Option<f64> {
    let peak = *y.get(vector::largest(y))?;
    // Where it has decayed, what is left may have any sign.
    let high = x.iter().zip(y).filter(|(_, y)| **y / peak > 10.0 * CLOSE).map(|(x, y)| (*x, (*y / peak).ln()));
    let high: Vec<(f64, f64)> = high.collect();
    let count = high.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| high.iter().map(of).sum::<f64>() / count;
    let (mean_x, mean_y) = (mean(&|p| p.0), mean(&|p| p.1));
    let rate = mean(&|p| (p.0 - mean_x) * (p.1 - mean_y)) / mean(&|p| (p.0 - mean_x).powi(2));
    let fit = |x: f64| (mean_y + rate * (x - mean_x)).exp();
    let close = x.len() == y.len() && x.iter().zip(y).all(|(x, y)| (fit(*x) - y / peak).abs() < CLOSE);
    (rate.is_finite() && close).then_some(rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_told_from_other_shapes() {
        let x: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
        let decay: Vec<f64> = x.iter().map(|x| -0.3 * (-2.0 * x).exp() + 0.001 * (9.0 * x).sin()).collect();
        assert!((exponent(&x, &decay).unwrap() + 2.0).abs() < 0.05);
        let wave: Vec<f64> = x.iter().map(|x| 1.5 + x.sin()).collect();
        assert_eq!(exponent(&x, &wave), None);
        assert_eq!(exponent(&x, &x), None);
        assert!(is_constant(&[-0.500, -0.501]) && !is_constant(&decay));
    }
}
