//! The engine's own system of units, in which coordinates, data and parameters are of the order of one.
//!
//! Equations are unit-checked, so they hold in any system of units. One in which the numbers at hand are moderate keeps
//! every intermediate result inside the range of single precision, from nanometres to gigapascals.
//!
//! Arrays of the engine are plain numbers: they are in its units, all of them. Numbers come to them and leave them by the scales
//! of this system alone.

use nalgebra::{SMatrix, SVector};

use crate::schema::Unit;
use crate::units::{Declared, Engine, Number, Scale, Si};

/// Sizes of the engine's base units in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitSystem {
    /// Natural logarithms of the base units' sizes in SI.
    logs: [f64; 7],
}

impl UnitSystem {
    /// SI itself.
    pub const SI: Self = Self { logs: [0.0; 7] };

    /// The system in which quantities of the given sizes, with their units, come closest to one, by least squares over
    /// their logarithms. Sizes that are zero or not finite say nothing.
    pub fn fitting(quantities: impl IntoIterator<Item = (Unit, Number<Si>)>) -> Self {
        let mut normal = SMatrix::<f64, 7, 7>::identity() * 1e-9;
        let mut right = SVector::<f64, 7>::zeros();
        for (unit, size) in quantities {
            let size = size.as_si().abs();
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

    /// From the engine's units of this dimension to SI.
    pub fn size(&self, unit: &Unit) -> Scale<Engine, Si> {
        Scale::new(self.logs.iter().zip(&unit.exponents).map(|(log, exponent)| log * exponent).sum::<f64>().exp())
    }

    /// From the declared unit to the engine's.
    pub fn inward(&self, unit: &Unit) -> Scale<Declared, Engine> {
        unit.factor.over(&self.size(unit))
    }

    /// From the engine's unit to the declared one.
    pub fn outward(&self, unit: &Unit) -> Scale<Engine, Declared> {
        self.size(unit).over(&unit.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn unit(exponents: [f64; 7]) -> Unit {
        Unit { exponents, factor: Scale::new(1.0), text: "" }
    }

    #[test]
    fn nanometres_and_gigapascals_become_ones() {
        let length = unit([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let pressure = unit([-1.0, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0]);
        let system = UnitSystem::fitting([(length, Number::si(1e-9)), (pressure, Number::si(1e9))]);
        assert!((system.size(&length).factor() / 1e-9 - 1.0).abs() < 1e-5);
        assert!((system.size(&pressure).factor() / 1e9 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_dimension_that_nothing_speaks_of_stays_si() {
        let length = unit([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let current = unit([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        let system = UnitSystem::fitting([0.0, f64::NAN, 3.0].map(|size| (length, Number::si(size))));
        assert_eq!(system.size(&current), Scale::new(1.0));
    }

    #[test]
    fn a_system_that_was_saved_takes_new_numbers_to_the_same_bits() {
        let length = Unit { factor: Scale::new(1e-3), ..unit([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]) };
        let system = UnitSystem::fitting([(length, Number::si(0.37))]);
        let restored = UnitSystem::of_logs(*system.logs());
        for new in [0.1, -7.0, 3e5] {
            let inward = |system: &UnitSystem| system.inward(&length).of(Number::declared(new));
            assert_eq!(inward(&restored), inward(&system));
            let outward = restored.outward(&length).of(inward(&system)).as_declared();
            assert!((outward / new - 1.0).abs() < 1e-15, "{outward} of {new}");
        }
    }
}
