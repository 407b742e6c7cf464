//! Given numbers, and how anything changes with one of them.

use crate::schema::{Origin, Scene};

/// Share of a number by which it is changed to see what follows it.
pub(crate) const SMALL: f64 = 1e-4;

/// The given numbers of a scene that are not zero, by their slots: zero has no share to be changed by.
pub(crate) fn given(schema: &Scene, scalars: &[f64]) -> Vec<usize> {
    let own = schema.scalars.iter().zip(scalars).enumerate();
    let given = own.filter(|(_, (own, value))| matches!(own.origin, Origin::Given(_)) && **value != 0.0);
    given.map(|(slot, _)| slot).collect()
}

/// What shares of a number are shares of: its value, or the engine's unit where that is zero.
pub(crate) fn size(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value }
}

/// A derivative by a number, in shares of its [`size`], from what is found with [`SMALL`] more and with as much less of it.
pub(crate) fn slope((more, less): (f64, f64)) -> f64 {
    (more - less) / (2.0 * SMALL)
}
