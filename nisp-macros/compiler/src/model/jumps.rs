//! Expressions that jump along a coordinate, as signs do, and kinks, whose derivatives jump. Derivatives of jumps are taken to be zero.

use std::collections::HashSet;
use std::rc::Rc;

use super::{Expr, Function, Node};

/// True where some part of an expression jumps where a coordinate, or a field, passes a value.
pub(super) fn jumps(expr: &Expr, coordinate: usize) -> bool {
    any(expr, &mut |node| match node {
        Node::Call(Function::Sign | Function::Step, inner) => varies(inner, coordinate),
        // `abs(x) / x`
        Node::Div(over, under) => varies(under, coordinate) && any(over, &mut |node| is_size_of(node, under)),
        Node::Derivative(inner, _) => any(inner, &mut |node| is_kink(node, coordinate)),
        _ => false,
    })
}

/// True of `abs(x)` beside `x`.
fn is_size_of(node: &Node, under: &Expr) -> bool {
    matches!(node, Node::Call(Function::Abs, inner) if inner == under)
}

/// True of what has a kink where a coordinate, or a field, passes a value.
fn is_kink(node: &Node, coordinate: usize) -> bool {
    match node {
        Node::Call(Function::Abs, inner) => varies(inner, coordinate),
        Node::Min(a, b) | Node::Max(a, b) => varies(a, coordinate) || varies(b, coordinate),
        _ => false,
    }
}

/// True where an expression reads a coordinate or a field.
fn varies(expr: &Expr, coordinate: usize) -> bool {
    any(expr, &mut |node| match node {
        Node::Coordinate(own) => *own == coordinate,
        Node::Field(_) => true,
        _ => false,
    })
}

/// True where some node of an expression is such, each asked once.
fn any(expr: &Expr, is_such: &mut dyn FnMut(&Node) -> bool) -> bool {
    let (mut seen, mut rest) = (HashSet::new(), vec![Rc::clone(expr)]);
    while let Some(expr) = rest.pop() {
        if !seen.insert(Rc::as_ptr(&expr)) {
            continue;
        }
        if is_such(&expr) {
            return true;
        }
        match &*expr {
            Node::Add(parts) | Node::Mul(parts) => rest.extend(parts.iter().cloned()),
            Node::Div(a, b) | Node::Power(a, b) | Node::Min(a, b) | Node::Max(a, b) => {
                rest.extend([Rc::clone(a), Rc::clone(b)]);
            }
            Node::Pow(inner, _) | Node::Call(_, inner) | Node::Derivative(inner, _) | Node::Partner(inner) => {
                rest.push(Rc::clone(inner));
            }
            _ => {}
        }
    }
    false
}
