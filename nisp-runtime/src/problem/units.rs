//! The system of units of a problem: what is bound comes to the order of one, and derivatives into the range of single
//! precision.

use super::{Binding, Bound, Problem, UnitSystem};
use crate::ends::ranges;
use crate::schema::{Jet, Unit};
use crate::units::{Number, Scale, Si};

/// A derivative this many times larger or smaller than one is too near the ends of single precision (1e38) for what
/// becomes of it: it is multiplied with parameters, and its adjoint with weights.
const FAR: f64 = 1e12;

impl Problem {
    /// A system of units in which what is bound is of the order of one.
    pub(super) fn system(&self, bindings: &[&Binding]) -> UnitSystem {
        UnitSystem::fitting(self.quantities(bindings))
    }

    /// Typical sizes of what is bound, with their units.
    fn quantities(&self, bindings: &[&Binding]) -> Vec<(Unit, Number<Si>)> {
        let schema = self.scene.schema;
        let inputs = schema.coordinates.len();
        let ranges = ranges(bindings.iter().map(|b| &b.points.coordinates), inputs);
        let mut quantities = Vec::new();
        for (i, coordinate) in schema.coordinates.iter().enumerate() {
            let (low, high) = ranges[i];
            let half = Number::declared((high - low) / 2.0);
            quantities.push((coordinate.unit, coordinate.unit.factor.of(half)));
        }
        for (scalar, value) in schema.scalars.iter().zip(&self.scalars) {
            quantities.push((scalar.unit, value.unwrap_or(Number::si(0.0))));
        }
        for (group, binding) in schema.groups.iter().zip(bindings) {
            for (column, values) in group.columns.iter().zip(&binding.columns) {
                // Cells that were not measured are NaN.
                let measured: Vec<f64> = values.iter().copied().filter(|x| !x.is_nan()).collect();
                let square = measured.iter().map(|x| x * x).sum::<f64>() / measured.len().max(1) as f64;
                quantities.push((column.unit, column.unit.factor.of(Number::declared(square.sqrt()))));
            }
        }
        quantities
    }
}

impl Bound {
    /// A system of units that suits derivatives too, where this one leaves some of them far from one: those of a field
    /// that is very much longer or shorter than the body it lives on.
    pub(super) fn wider_system(&self) -> Option<UnitSystem> {
        let schema = self.problem.scene.schema;
        let jets = || schema.groups.iter().flat_map(|group| group.jets);
        let is_far = |jet: &Jet| !(1.0 / FAR..=FAR).contains(&self.typical(jet));
        if !jets().any(is_far) {
            return None;
        }
        let mut quantities = self.problem.quantities(&self.problem.bindings().ok()?);
        quantities.extend(jets().map(|jet| {
            let unit = self.unit(jet);
            (unit, self.system.size(&unit).of(Number::engine(self.typical(jet))))
        }));
        Some(UnitSystem::fitting(quantities))
    }

    /// Natural size of a derivative in the engine's units: its head's over the extents of its coordinates.
    pub(crate) fn typical(&self, jet: &Jet) -> f64 {
        let degrees = jet.degree.iter().zip(&self.scaling.half);
        self.head_scale(jet.head) / degrees.map(|(&degree, half)| half.powi(i32::from(degree))).product::<f64>()
    }

    /// The unit of a derivative in SI.
    fn unit(&self, jet: &Jet) -> Unit {
        let schema = self.problem.scene.schema;
        let mut exponents = schema.heads[jet.head].unit.exponents;
        for (&degree, coordinate) in jet.degree.iter().zip(schema.coordinates) {
            for (exponent, by) in exponents.iter_mut().zip(coordinate.unit.exponents) {
                *exponent -= f64::from(degree) * by;
            }
        }
        Unit { exponents, factor: Scale::new(1.0), text: "" }
    }
}
