//! An expression as plain text, in one normal form of spaces and parentheses.

use super::tree::{Expr, ExprKind};

/// Binding power of an expression's outermost operator.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Binding {
    Sum,
    Product,
    Sign,
    Power,
    Atom,
}

pub(super) fn binding(expr: &Expr) -> Binding {
    match expr.kind {
        ExprKind::Sum(_) => Binding::Sum,
        ExprKind::Product(_) => Binding::Product,
        ExprKind::Negate(_) => Binding::Sign,
        ExprKind::Power(..) => Binding::Power,
        _ => Binding::Atom,
    }
}

/// The expression as one would type it.
pub(crate) fn print_text(expr: &Expr) -> String {
    let mut text = String::new();
    write(expr, &mut text);
    text
}

fn write(expr: &Expr, text: &mut String) {
    match &expr.kind {
        ExprKind::Number(number, None) => text.push_str(&number.text),
        ExprKind::Number(number, Some(unit)) => {
            let symbol = if unit.text.is_empty() { "1" } else { &unit.text };
            text.push_str(&format!("{} [{symbol}]", number.text));
        }
        ExprKind::Name(name) => text.push_str(name),
        ExprKind::Negate(inner) => {
            text.push('-');
            write_in(inner, Binding::Sign, text);
        }
        ExprKind::Sum(terms) => {
            for (index, (subtracted, term)) in terms.iter().enumerate() {
                text.push_str(if index == 0 {
                    ""
                } else if *subtracted {
                    " - "
                } else {
                    " + "
                });
                write_in(term, Binding::Product, text);
            }
        }
        ExprKind::Product(factors) => {
            for (index, (divided, factor)) in factors.iter().enumerate() {
                text.push_str(if index == 0 {
                    ""
                } else if *divided {
                    " / "
                } else {
                    " * "
                });
                write_in(factor, Binding::Sign, text);
            }
        }
        ExprKind::Power(base, exponent) => {
            write_in(base, Binding::Atom, text);
            text.push('^');
            write_in(exponent, Binding::Sign, text);
        }
        ExprKind::Call(name, arguments) => {
            text.push_str(&name.text);
            write_list(arguments, ["(", ")"], text);
        }
        ExprKind::List(entries) => write_list(entries, ["[", "]"], text),
        ExprKind::Index(base, indices) => {
            write_in(base, Binding::Atom, text);
            write_list(indices, ["[", "]"], text);
        }
    }
}

fn write_in(expr: &Expr, weakest: Binding, text: &mut String) {
    if binding(expr) >= weakest {
        return write(expr, text);
    }
    text.push('(');
    write(expr, text);
    text.push(')');
}

fn write_list(entries: &[Expr], brackets: [&str; 2], text: &mut String) {
    text.push_str(brackets[0]);
    for (index, entry) in entries.iter().enumerate() {
        text.push_str(if index == 0 { "" } else { ", " });
        write(entry, text);
    }
    text.push_str(brackets[1]);
}
