//! The engine's own system of units, in which coordinates, data and parameters are of the order of one.
//!
//! Equations are unit-checked, so they hold in any system of units. One in which the numbers at hand are moderate keeps
//! every intermediate result inside the range of single precision, from nanometres to gigapascals.

use nalgebra::{SMatrix, SVector};

use crate::schema::Unit;

/// Sizes of the engine's base units in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitSystem {
    /// Natural logarithms of the base units' sizes in SI.
    logs: [f64; 7],
}

impl UnitSystem {
    /// SI itself.
    pub const SI: Self = Self { logs: [0.0; 7] };

    /// The system in which quantities of the given sizes (in SI, with their units) come closest to one, by least
    /// squares over their logarithms. Sizes that are zero or not finite say nothing.
    pub fn fitting(quantities: impl IntoIterator<Item = (Unit, f64)>) -> Self {
        let mut normal = SMatrix::<f64, 7, 7>::identity() * 1e-9;
        let mut right = SVector::<f64, 7>::zeros();
        for (unit, size) in quantities {
            let size = size.abs();
            if size > 0.0 && size.is_finite() {
                let row = SVector::from(unit.exponents);
                normal += row * row.transpose();
                right += row * size.ln();
            }
        }
        match normal.cholesky() {
            Some(factor) => Self { logs: factor.solve(&right).into() },
            None => Self::SI,
        }
    }

    /// The system of these [`UnitSystem::logs`].
    pub(crate) fn of_logs(logs: [f64; 7]) -> Self {
        Self { logs }
    }

    /// Natural logarithms of the base units' sizes in SI.
    pub(crate) fn logs(&self) -> &[f64; 7] {
        &self.logs
    }

    /// One of the engine's units of this dimension, in SI units.
    pub fn size(&self, unit: &Unit) -> f64 {
        self.logs.iter().zip(&unit.exponents).map(|(log, exponent)| log * exponent).sum::<f64>().exp()
    }

    /// From a number in the declared unit to the engine's.
    pub fn inward(&self, unit: &Unit) -> f64 {
        unit.factor / self.size(unit)
    }

    /// From a number in the engine's unit to the declared one.
    pub fn outward(&self, unit: &Unit) -> f64 {
        self.size(unit) / unit.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn unit(exponents: [f64; 7]) -> Unit {
        Unit { exponents, factor: 1.0, text: "" }
    }

    #[test]
    fn nanometres_and_gigapascals_become_ones() {
        let length = unit([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let pressure = unit([-1.0, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0]);
        let system = UnitSystem::fitting([(length, 1e-9), (pressure, 1e9)]);
        assert!((system.size(&length) / 1e-9 - 1.0).abs() < 1e-5);
        assert!((system.size(&pressure) / 1e9 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_dimension_that_nothing_speaks_of_stays_si() {
        let length = unit([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let current = unit([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        let system = UnitSystem::fitting([(length, 0.0), (length, f64::NAN), (length, 3.0)]);
        assert_eq!(system.size(&current), 1.0);
    }
}
