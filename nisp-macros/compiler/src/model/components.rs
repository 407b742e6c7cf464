//! Components of declared vectors and matrices, and their names.

use super::elaborate::Elaborator;
use super::scope::{Meaning, Symbol};
use super::value::{Dim, Extent, Scalar, Value};
use super::{Name, Part};
use crate::error::Checked;
use crate::syntax::{Declaration, Shape};

/// The names of a declaration's components: `u_x, u_y`, or `u_1, u_2, u_3` of a `vector(3)`.
pub(super) fn components(declaration: &Declaration, elaborator: &Elaborator<'_>) -> Vec<Name> {
    let named =
        |suffix: &str| Name { text: format!("{}_{suffix}", declaration.name.text), span: declaration.name.span };
    match declaration.shape {
        Shape::Scalar | Shape::Time => vec![declaration.name.clone()],
        Shape::Numbered(count) => (1..=count).map(|number| named(&number.to_string())).collect(),
        Shape::Vector => {
            elaborator.spatial.iter().map(|&index| named(&elaborator.coordinates[index].name.text)).collect()
        }
    }
}

/// Where a component stands in its vector.
pub(super) fn part(declaration: &Declaration, index: usize, count: usize) -> Option<Part> {
    let of = || declaration.name.clone();
    matches!(declaration.shape, Shape::Vector | Shape::Numbered(_)).then(|| Part { of: of(), index, count })
}

/// The value of a declared name, of the shape declared.
pub(super) fn shaped(declaration: &Declaration, entries: Vec<Scalar>, dim: Dim) -> Value {
    let extent = match declaration.shape {
        Shape::Scalar | Shape::Time => Extent::Scalar,
        Shape::Vector | Shape::Numbered(_) => Extent::Vector(entries.len()),
    };
    Value { extent, dim, entries }
}

/// Declares a name and, of a vector, its components.
pub(super) fn add_components(
    elaborator: &mut Elaborator<'_>,
    declaration: &Declaration,
    meaning: Meaning,
    first: usize,
    names: &[Name],
    value: Value,
) -> Checked<()> {
    add_symbol(elaborator, &declaration.name, meaning, first, value.clone())?;
    if value.extent == Extent::Scalar {
        return Ok(());
    }
    for (k, (name, entry)) in names.iter().zip(&value.entries).enumerate() {
        let symbol = Symbol {
            meaning,
            value: Some(Value::scalar(entry.clone(), value.dim.clone())),
            span: name.span,
            index: first + k,
            parent: Some(declaration.name.text.clone()),
            used: false,
        };
        elaborator.scope.declare(name, symbol, elaborator.errors)?;
    }
    Ok(())
}

pub(super) fn add_symbol(
    elaborator: &mut Elaborator<'_>,
    name: &Name,
    meaning: Meaning,
    index: usize,
    value: Value,
) -> Checked<()> {
    let symbol = Symbol { meaning, value: Some(value), span: name.span, index, parent: None, used: false };
    elaborator.scope.declare(name, symbol, elaborator.errors)
}
