//! Points in the user's words.

use super::Bound;
use crate::schema::Coordinate;
use crate::units::Number;

/// Numbers from here on are written without an exponent, and those below the other are rounding.
const SHORT: f64 = 0.01;
const NOTHING: f64 = 1e-12;

/// A point given in declared units: `x = 0.100 m, t = 2.000 s`.
pub(crate) fn place(coordinates: &[Coordinate], point: &[f64]) -> String {
    let words: Vec<String> = coordinates.iter().zip(point).map(|(c, x)| along(c, *x)).collect();
    words.join(", ")
}

/// One coordinate of a point, in its declared unit.
fn along(coordinate: &Coordinate, x: f64) -> String {
    let x = if x.abs() < NOTHING { 0.0 } else { x };
    let number = if x == 0.0 || x.abs() >= SHORT { format!("{x:.3}") } else { format!("{x:.2e}") };
    format!("{} = {number} {}", coordinate.name, coordinate.unit.text).trim_end().into()
}

impl Bound {
    /// A point given in the engine's units.
    pub(crate) fn place(&self, point: &[f64]) -> String {
        let coordinates = self.problem.scene().schema.coordinates;
        let outward = coordinates.iter().zip(point).map(|(c, x)| self.outward(c, *x));
        place(coordinates, &outward.collect::<Vec<_>>())
    }

    /// Some of a point's coordinates, given in the engine's units.
    pub(crate) fn place_along(&self, axes: &[usize], point: &[f64]) -> String {
        let coordinates = self.problem.scene().schema.coordinates;
        let word = |&axis: &usize| along(&coordinates[axis], self.outward(&coordinates[axis], point[axis]));
        axes.iter().map(word).collect::<Vec<_>>().join(", ")
    }

    /// A coordinate given in the engine's unit, in its declared one.
    fn outward(&self, coordinate: &Coordinate, x: f64) -> f64 {
        self.system.outward(&coordinate.unit).of(Number::engine(x)).as_declared()
    }
}
