//! Points in the user's words.

use crate::schema::Coordinate;

/// A point given in declared units: `x = 0.100 m, t = 2.000 s`.
pub(super) fn place(coordinates: &[Coordinate], point: &[f64]) -> String {
    let named = coordinates.iter().zip(point);
    let words: Vec<String> =
        named.map(|(c, x)| format!("{} = {x:.3} {}", c.name, c.unit.text).trim_end().into()).collect();
    words.join(", ")
}
