//! Sums, products, powers and components, of scalars, vectors and matrices.

use num_traits::{Signed, Zero};

use super::elaborate::Elaborator;
use super::value::{Dim, Extent, Scalar, Value};
use super::{Node, build};
use crate::error::{Checked, Place, catalogue};
use crate::syntax::{Expr, ExprKind, print_text};
use crate::unit::Dimension;

/// Exponents past this are a slip of the finger.
const LARGEST_EXPONENT: i128 = 1000;

impl Elaborator<'_> {
    pub(super) fn sum(&mut self, terms: &[(bool, Expr)]) -> Checked<Value> {
        let values: Vec<Checked<Value>> = terms.iter().map(|(_, term)| self.value(term)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Checked<_>>()?;
        let extent = self.common_extent(&terms.iter().map(|(_, term)| term).zip(&values).collect::<Vec<_>>())?;
        let parts: Vec<(&Expr, &Dim)> =
            terms.iter().zip(&values).map(|((_, term), value)| (term, &value.dim)).collect();
        let dim = self.agree(&parts, "terms of one sum");
        let count = values.iter().map(|value| value.entries.len()).max().unwrap_or(0);
        let entries = (0..count).map(|index| {
            let terms: Vec<(bool, Scalar)> = terms
                .iter()
                .zip(&values)
                .filter_map(|((subtracted, _), value)| Some((*subtracted, value.entries.get(index)?.clone())))
                .collect();
            build::sum(&terms)
        });
        Ok(Value { extent, dim, entries: entries.collect() })
    }

    /// The one extent of all that are no literal zero, which fits any.
    pub(super) fn common_extent(&mut self, parts: &[(&Expr, &Value)]) -> Checked<Extent> {
        let mut shaped = parts.iter().filter(|(_, value)| !value.is_zero());
        let Some((first, reference)) = shaped.next() else { return Ok(Extent::Scalar) };
        match shaped.find(|(_, value)| value.extent != reference.extent) {
            None => Ok(reference.extent),
            Some((odd, value)) => {
                let message = catalogue::shapes_differ(
                    (&print_text(odd), &value.extent.to_string()),
                    (&print_text(first), &reference.extent.to_string()),
                );
                Err(self.errors.report(odd.place, message))
            }
        }
    }

    pub(super) fn product(&mut self, factors: &[(bool, Expr)], place: Place) -> Checked<Value> {
        let values: Vec<Checked<Value>> = factors.iter().map(|(_, factor)| self.value(factor)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Checked<_>>()?;
        let mut tensor: Option<Value> = None;
        // Scalars become one flat quotient, so that long chains nest no deeper than short ones.
        let (mut above, mut below): (Vec<Scalar>, Vec<Scalar>) = (Vec::new(), Vec::new());
        let mut dim = if self.units_checked { Dim::none() } else { Dim::Unknown };
        for ((divided, factor), value) in factors.iter().zip(values) {
            let combined = if *divided {
                self.refuse_division(factor, &value)?;
                dim.combine(&value.dim, Dimension::over)
            } else {
                dim.combine(&value.dim, Dimension::times)
            };
            dim = combined.ok_or_else(|| self.errors.report(place, catalogue::absurd_unit()))?;
            match (value.as_scalar(), tensor.take()) {
                (Some(scalar), kept) => {
                    if *divided { &mut below } else { &mut above }.push(scalar.clone());
                    tensor = kept;
                }
                (None, None) => tensor = Some(value),
                (None, Some(left)) => tensor = Some(self.matrix_product(&left, &value, factor)?),
            }
        }
        let scale = build::divide(&build::product(&above), &build::product(&below));
        Ok(match tensor {
            Some(tensor) => tensor.map(dim, |entry| build::multiply(&scale, entry)),
            None => Value::scalar(scale, dim),
        })
    }

    fn refuse_division(&mut self, factor: &Expr, value: &Value) -> Checked<()> {
        if value.as_scalar().is_none() {
            let message = catalogue::expected_scalar("a divisor", &print_text(factor), &value.extent.to_string());
            return Err(self.errors.report(factor.place, message));
        }
        if value.is_zero() {
            return Err(self.errors.report(factor.place, catalogue::division_by_zero()));
        }
        Ok(())
    }

    fn matrix_product(&mut self, left: &Value, right: &Value, expr: &Expr) -> Checked<Value> {
        let entry = |row: usize, column: usize, inner: usize, columns: usize| {
            let terms = (0..inner).map(|k| {
                let product = build::multiply(&left.entries[row * inner + k], &right.entries[k * columns + column]);
                (false, product)
            });
            build::sum(&terms.collect::<Vec<_>>())
        };
        match (left.extent, right.extent) {
            (Extent::Matrix(rows, inner), Extent::Vector(length)) if inner == length => {
                Ok(Value::vector((0..rows).map(|row| entry(row, 0, inner, 1)).collect(), Dim::Unknown))
            }
            (Extent::Matrix(rows, inner), Extent::Matrix(length, columns)) if inner == length => {
                Ok(Value::matrix(rows, columns, Dim::Unknown, |row, column| entry(row, column, inner, columns)))
            }
            _ => {
                let message =
                    catalogue::cannot_multiply(&left.extent.to_string(), &right.extent.to_string(), &print_text(expr));
                Err(self.errors.report(expr.place, message))
            }
        }
    }

    pub(super) fn power(&mut self, base: &Expr, exponent: &Expr, place: Place) -> Checked<Value> {
        let below = self.scalar(base, "the base of a power");
        let above = self.pure(exponent, "an exponent");
        let ((below, dim), above) = (below?, above?);
        let is_too_large = matches!(*above.expr, Node::Real(value) if value.abs() > LARGEST_EXPONENT as f64);
        if is_too_large {
            return Err(self.errors.report(exponent.place, catalogue::exponent_too_large(LARGEST_EXPONENT)));
        }
        let Some(literal) = above.as_number() else {
            self.require_pure(base, &dim, "the base of a power whose exponent is no literal number")?;
            return Ok(Value::scalar(build::general_power(&below, &above), dim));
        };
        if literal.numer().abs() > LARGEST_EXPONENT || *literal.denom() > LARGEST_EXPONENT {
            return Err(self.errors.report(exponent.place, catalogue::exponent_too_large(LARGEST_EXPONENT)));
        }
        if below.is_zero() && literal.is_negative() {
            return Err(self.errors.report(place, catalogue::division_by_zero()));
        }
        let dim = match &dim {
            Dim::Known(dimension) => match dimension.power(literal) {
                Some(power) => Dim::Known(power),
                None => return Err(self.errors.report(place, catalogue::absurd_unit())),
            },
            Dim::Any if literal.is_zero() => Dim::none(),
            other => other.clone(),
        };
        Ok(Value::scalar(build::power(&below, literal), dim))
    }

    /// `u[x]`, `u[0]`, `sigma[x, y]`
    pub(super) fn index(&mut self, base: &Expr, indices: &[Expr], place: Place) -> Checked<Value> {
        let value = self.value(base)?;
        let sides = match value.extent {
            Extent::Scalar => vec![],
            Extent::Vector(length) => vec![length],
            Extent::Matrix(rows, columns) => vec![rows, columns],
        };
        if sides.is_empty() || indices.is_empty() || indices.len() > sides.len() {
            let message = catalogue::cannot_index(&print_text(base), &value.extent.to_string(), indices.len());
            return Err(self.errors.report(place, message));
        }
        let numbers: Vec<Checked<usize>> =
            indices.iter().zip(&sides).map(|(index, side)| self.component(index, *side)).collect();
        let numbers: Vec<usize> = numbers.into_iter().collect::<Checked<_>>()?;
        Ok(match (numbers.as_slice(), sides.as_slice()) {
            ([row], [_, columns]) => {
                Value::vector(value.entries[row * columns..(row + 1) * columns].to_vec(), value.dim)
            }
            ([row, column], [_, columns]) => Value::scalar(value.entries[row * columns + column].clone(), value.dim),
            ([row], _) => Value::scalar(value.entries[*row].clone(), value.dim),
            _ => value,
        })
    }

    /// An index: a spatial coordinate's name, or a number from 0.
    fn component(&mut self, index: &Expr, side: usize) -> Checked<usize> {
        let number = match &index.kind {
            ExprKind::Name(name) if side == self.spatial.len() => {
                self.spatial.iter().position(|&coordinate| self.coordinates[coordinate].name.text == *name)
            }
            ExprKind::Number(number, None) => number
                .exact
                .filter(|value| value.is_integer())
                .and_then(|value| usize::try_from(*value.numer()).ok())
                .filter(|&value| value < side),
            _ => None,
        };
        number.ok_or_else(|| self.errors.report(index.place, catalogue::bad_index(&print_text(index), side)))
    }
}
