//! Tensor algebra in components.

use std::rc::Rc;

use super::build;
use super::value::{Dim, Extent, Scalar, Value};
use super::{Function, Node};
use crate::rational::ratio;
use crate::unit::Dimension;

/// Functions of two tensors; None if the shapes do not fit.
pub(super) fn of_two(name: &str, a: &Value, b: &Value) -> Option<Value> {
    let dim = a.dim.combine(&b.dim, Dimension::times)?;
    match (name, a.extent, b.extent) {
        ("dot", left, right) if left == right && left != Extent::Scalar => {
            Some(Value::scalar(contract(&a.entries, &b.entries), dim))
        }
        ("cross", Extent::Vector(3), Extent::Vector(3)) => {
            let minor = |i: usize, j: usize| {
                let first = build::multiply(&a.entries[i], &b.entries[j]);
                build::subtract(&first, &build::multiply(&a.entries[j], &b.entries[i]))
            };
            Some(Value::vector(vec![minor(1, 2), minor(2, 0), minor(0, 1)], dim))
        }
        ("cross", Extent::Vector(2), Extent::Vector(2)) => {
            let first = build::multiply(&a.entries[0], &b.entries[1]);
            let second = build::multiply(&a.entries[1], &b.entries[0]);
            Some(Value::scalar(build::subtract(&first, &second), dim))
        }
        ("outer", Extent::Vector(rows), Extent::Vector(columns)) => {
            Some(Value::matrix(rows, columns, dim, |i, j| build::multiply(&a.entries[i], &b.entries[j])))
        }
        _ => None,
    }
}

/// Functions of one tensor; None if the shape does not fit.
pub(super) fn of_one(name: &str, a: &Value) -> Option<Value> {
    let dim = a.dim.clone();
    match (name, a.extent) {
        ("norm", Extent::Vector(_) | Extent::Matrix(..)) => {
            let square = contract(&a.entries, &a.entries);
            Some(Value::scalar(build::call(Function::Sqrt, &square), dim))
        }
        ("transpose", Extent::Matrix(rows, columns)) => {
            Some(Value::matrix(columns, rows, dim, |i, j| a.entries[j * columns + i].clone()))
        }
        ("tr", Extent::Matrix(rows, columns)) if rows == columns => Some(Value::scalar(trace(a, rows), dim)),
        ("sym", Extent::Matrix(rows, columns)) if rows == columns => {
            let half = Scalar::number(ratio(1, 2));
            Some(Value::matrix(rows, rows, dim, |i, j| {
                // The diagonal stays as it is, and both halves share one form.
                let (low, high) = (i.min(j), i.max(j));
                if i == j {
                    return a.entries[i * rows + i].clone();
                }
                build::multiply(&half, &build::add(&a.entries[low * rows + high], &a.entries[high * rows + low]))
            }))
        }
        ("det", Extent::Matrix(rows, columns)) if rows == columns && rows <= 4 => {
            let dim = power(&dim, rows)?;
            Some(Value::scalar(determinant(&a.entries, rows), dim))
        }
        ("inverse", Extent::Matrix(rows, columns)) if rows == columns && rows <= 3 => inverse(a, rows),
        _ => None,
    }
}

/// The sum of the diagonal.
pub(super) fn trace(a: &Value, size: usize) -> Scalar {
    build::sum(&(0..size).map(|i| (false, a.entries[i * size + i].clone())).collect::<Vec<_>>())
}

fn contract(a: &[Scalar], b: &[Scalar]) -> Scalar {
    build::sum(&a.iter().zip(b).map(|(a, b)| (false, product_or_square(a, b))).collect::<Vec<_>>())
}

fn product_or_square(a: &Scalar, b: &Scalar) -> Scalar {
    if Rc::ptr_eq(&a.expr, &b.expr) { build::power(a, ratio(2, 1)) } else { build::multiply(a, b) }
}

fn power(dim: &Dim, exponent: usize) -> Option<Dim> {
    Some(match dim {
        Dim::Known(dimension) => Dim::Known(dimension.power(ratio(exponent as i128, 1))?),
        other => other.clone(),
    })
}

/// Expansion along the first row.
fn determinant(entries: &[Scalar], size: usize) -> Scalar {
    if size == 1 {
        return entries[0].clone();
    }
    let terms = (0..size).map(|column| {
        let minor = determinant(&without(entries, size, 0, column), size - 1);
        (column % 2 == 1, build::multiply(&entries[column], &minor))
    });
    build::sum(&terms.collect::<Vec<_>>())
}

/// The matrix without one row and one column.
fn without(entries: &[Scalar], size: usize, row: usize, column: usize) -> Vec<Scalar> {
    let kept = (0..size * size).filter(|index| index / size != row && index % size != column);
    kept.map(|index| entries[index].clone()).collect()
}

/// The adjugate over the determinant.
fn inverse(a: &Value, size: usize) -> Option<Value> {
    let det = determinant(&a.entries, size);
    if matches!(*det.expr, Node::Number(_)) && det.is_zero() {
        return None;
    }
    let dim = Dim::none().combine(&a.dim, Dimension::over)?;
    Some(Value::matrix(size, size, dim, |i, j| {
        let minor = match size {
            1 => build::one(),
            _ => determinant(&without(&a.entries, size, j, i), size - 1),
        };
        let cofactor = if (i + j) % 2 == 1 { build::negate(&minor) } else { minor };
        build::divide(&cofactor, &det)
    }))
}
