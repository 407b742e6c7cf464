//! Derivatives: `d(e, x, 2)`, and the operators of vector analysis over the spatial coordinates.

use super::build;
use super::elaborate::Elaborator;
use super::jumps;
use super::scope::Meaning;
use super::value::{Dim, Extent, Reads, Scalar, Value};
use crate::error::{Checked, Place, catalogue};
use crate::syntax::{Expr, ExprKind, print_text};
use crate::unit::Dimension;

/// The highest order of derivative that anybody can want.
pub(super) const HIGHEST_ORDER: u32 = 6;

impl Elaborator<'_> {
    /// The derivative of every entry by one coordinate.
    pub(super) fn differentiate(&mut self, value: &Value, coordinate: usize, place: Place) -> Checked<Value> {
        if value.reads().any(Reads::COLUMN) {
            return Err(self.errors.report(place, catalogue::derivative_of_column()));
        }
        if value.reads().any(Reads::PARTNER) {
            return Err(self.errors.report(place, catalogue::derivative_of_partner()));
        }
        if value.entries.iter().any(|entry| jumps::jumps(&entry.expr, coordinate)) {
            self.warnings.push((catalogue::derivative_of_jump(), place.start));
        }
        let by = self.dim(&self.coordinates[coordinate].unit.dimension);
        let dim = value.dim.combine(&by, Dimension::over);
        let dim = dim.ok_or_else(|| self.errors.report(place, catalogue::absurd_unit()))?;
        let value = value.map(dim, |entry| build::derivative(entry, coordinate));
        if value.order() > HIGHEST_ORDER {
            return Err(self.errors.report(place, catalogue::order_too_high(value.order(), HIGHEST_ORDER)));
        }
        Ok(value)
    }

    /// `d(e, x)`, `d(e, x, 2)`, `d(e, x, y)`, `d(e, x, 2, y)`
    pub(super) fn derivative(&mut self, arguments: &[Expr], place: Place) -> Checked<Value> {
        let [inner, by @ ..] = arguments else {
            return Err(self.errors.report(place, catalogue::wrong_arguments("d", "an expression and coordinates", 0)));
        };
        if by.is_empty() {
            let message = catalogue::wrong_arguments("d", "an expression and coordinates", arguments.len());
            return Err(self.errors.report(place, message));
        }
        let value = self.value(inner);
        let mut steps: Vec<usize> = Vec::new();
        for (index, argument) in by.iter().enumerate() {
            match &argument.kind {
                ExprKind::Number(number, None) if index > 0 => {
                    let count =
                        self.repetitions(number.exact.map(|exact| (*exact.numer(), exact.is_integer())), argument)?;
                    let Some(&last) = steps.last() else { continue };
                    steps.extend(std::iter::repeat_n(last, count - 1));
                }
                _ => steps.push(self.coordinate(argument)?),
            }
        }
        let value = value?;
        if !value.reads().any(Reads::FIELD.and(Reads::COORDINATE).and(Reads::COLUMN)) {
            self.warnings.push((catalogue::derivative_is_zero(&print_text(inner)), place.start));
        }
        steps.into_iter().try_fold(value, |value, coordinate| self.differentiate(&value, coordinate, place))
    }

    fn repetitions(&mut self, number: Option<(i128, bool)>, argument: &Expr) -> Checked<usize> {
        let whole = number.filter(|(_, is_integer)| *is_integer).and_then(|(count, _)| u32::try_from(count).ok());
        match whole {
            Some(count @ 1..=HIGHEST_ORDER) => Ok(count as usize),
            Some(count) if count > 0 => {
                Err(self.errors.report(argument.place, catalogue::order_too_high(count, HIGHEST_ORDER)))
            }
            _ => Err(self.errors.report(argument.place, catalogue::bad_order(&print_text(argument)))),
        }
    }

    fn coordinate(&mut self, argument: &Expr) -> Checked<usize> {
        if let ExprKind::Name(name) = &argument.kind {
            if let Some(symbol) = self.scope.find(name).filter(|symbol| symbol.meaning == Meaning::Coordinate) {
                let index = symbol.index;
                self.scope.mark_used(name);
                return Ok(index);
            }
            if self.scope.broken.contains(name) {
                return Err(crate::error::Reported);
            }
        }
        let text = print_text(argument);
        let names: Vec<&str> = self.coordinates.iter().map(|coordinate| coordinate.name.text.as_str()).collect();
        let message = catalogue::not_a_coordinate(&text, &names);
        Err(self.errors.report(argument.place, message))
    }

    /// `grad`, `div`, `curl`, `laplacian`, `biharmonic`, `hessian` of the one argument.
    pub(super) fn vector_analysis(&mut self, name: &str, inner: &Expr, place: Place) -> Checked<Value> {
        let value = self.value(inner)?;
        if self.spatial.is_empty() {
            return Err(self.errors.report(place, catalogue::no_coordinates(name)));
        }
        for &coordinate in &self.spatial.clone() {
            let text = self.coordinates[coordinate].name.text.clone();
            self.scope.mark_used(&text);
        }
        match (name, value.extent) {
            ("grad", Extent::Scalar | Extent::Vector(_)) => self.gradient(&value, place),
            ("hessian", Extent::Scalar) => {
                let gradient = self.gradient(&value, place)?;
                self.gradient(&gradient, place)
            }
            ("laplacian", _) => self.laplacian(&value, place),
            ("biharmonic", _) => {
                let inner = self.laplacian(&value, place)?;
                self.laplacian(&inner, place)
            }
            ("div", Extent::Vector(length)) if length == self.spatial.len() => {
                let gradient = self.gradient(&value, place)?;
                Ok(Value::scalar(super::tensor::trace(&gradient, length), gradient.dim.clone()))
            }
            ("div", Extent::Matrix(rows, columns)) if columns == self.spatial.len() => {
                self.row_divergence(&value, rows, columns, place)
            }
            ("curl", Extent::Vector(length)) if length == self.spatial.len() && (length == 2 || length == 3) => {
                let gradient = self.gradient(&value, place)?;
                Ok(curl(&gradient, length))
            }
            _ => {
                let message =
                    catalogue::wrong_shape(name, &print_text(inner), &value.extent.to_string(), self.spatial.len());
                Err(self.errors.report(inner.place, message))
            }
        }
    }

    /// Of a scalar its vector of derivatives; of a vector the matrix with `d u_i / d x_j` in row i, column j.
    fn gradient(&mut self, value: &Value, place: Place) -> Checked<Value> {
        let parts = self.partials(value, place)?;
        let dim = parts.first().map_or(Dim::Unknown, |part| part.dim.clone());
        Ok(match value.extent {
            Extent::Vector(length) => {
                Value::matrix(length, parts.len(), dim, |row, column| parts[column].entries[row].clone())
            }
            _ => Value::vector(parts.iter().flat_map(|part| part.entries.clone()).collect(), dim),
        })
    }

    /// The derivatives by each spatial coordinate.
    fn partials(&mut self, value: &Value, place: Place) -> Checked<Vec<Value>> {
        self.spatial.clone().into_iter().map(|coordinate| self.differentiate(value, coordinate, place)).collect()
    }

    fn laplacian(&mut self, value: &Value, place: Place) -> Checked<Value> {
        let mut parts = Vec::new();
        for coordinate in self.spatial.clone() {
            let first = self.differentiate(value, coordinate, place)?;
            parts.push(self.differentiate(&first, coordinate, place)?);
        }
        let dim = parts.first().map_or(Dim::Unknown, |part| part.dim.clone());
        let entries = (0..value.entries.len()).map(|index| {
            build::sum(&parts.iter().map(|part| (false, part.entries[index].clone())).collect::<Vec<_>>())
        });
        Ok(Value { extent: value.extent, dim, entries: entries.collect() })
    }

    /// Of a matrix the vector of its rows' divergences.
    fn row_divergence(&mut self, value: &Value, rows: usize, columns: usize, place: Place) -> Checked<Value> {
        let parts = self.partials(value, place)?;
        let dim = parts.first().map_or(Dim::Unknown, |part| part.dim.clone());
        let row = |row: usize| -> Scalar {
            let terms = (0..columns).map(|column| (false, parts[column].entries[row * columns + column].clone()));
            build::sum(&terms.collect::<Vec<_>>())
        };
        Ok(Value::vector((0..rows).map(row).collect(), dim))
    }
}

/// From the gradient of a vector: a scalar in two dimensions, a vector in three.
fn curl(gradient: &Value, length: usize) -> Value {
    let by = |component: usize, coordinate: usize| &gradient.entries[component * length + coordinate];
    let difference = |a: usize, b: usize| build::subtract(by(b, a), by(a, b));
    if length == 2 {
        return Value::scalar(difference(0, 1), gradient.dim.clone());
    }
    Value::vector(vec![difference(1, 2), difference(2, 0), difference(0, 1)], gradient.dim.clone())
}
