//! Faulty and excessive models: a clear error, never a panic, never a long wait.

mod middle_support;

use std::rc::Rc;

use middle_support::models::*;
use nisp_compiler::model::{Expr, Function, Model, Node, TermKind};
use nisp_compiler::plan;
use nisp_compiler::rational::ratio;

fn messages(residual: impl Fn(&Expr) -> Expr) -> String {
    let mut m = one_field();
    m.group("g", 1, vec![("r", TermKind::Residual(vec![residual(&field(0))]))]);
    m.scene();
    errors(&m)
}

fn one_field() -> Model {
    let mut m = model(&[("x", NONE), ("y", NONE)]);
    m.field("u", NONE);
    m
}

fn errors(m: &Model) -> String {
    plan::build(m).unwrap_err().into_iter().map(|error| error.message + "\n").collect()
}

#[test]
fn too_high_an_order() {
    let text = messages(|u| d(u, &[0, 0, 0, 0, 1, 1, 1]));
    assert!(text.contains("order 7 of `u`"), "{text}");
    assert!(text.contains("`r`"), "{text}");
}

#[test]
fn a_column_cannot_be_differentiated() {
    let text = messages(|u| mul(&[u, &d(&column(0), &[0])]));
    assert!(text.contains("data column"), "{text}");
}

#[test]
fn division_by_zero() {
    let text = messages(|u| div(u, &sub(&n(1), &n(1))));
    assert!(text.contains("division by zero"), "{text}");
}

#[test]
fn a_field_fixed_to_itself() {
    let mut m = one_field();
    m.group("g", 0, vec![("r", TermKind::Residual(vec![field(0)]))]);
    m.scene().fixed_fields[0] = Some(add(&[&field(0), &n(1)]));
    assert!(errors(&m).contains("contains the field itself"));
}

#[test]
fn growth_ends_in_an_error() {
    // Nested quotients: every derivative multiplies the size.
    let mut e = add(&[&field(0), &n(2)]);
    for i in 0..40 {
        let top = call(Function::Sin, &mul(&[&e, &coordinate(i % 2)]));
        e = div(&add(&[&top, &e, &mul(&[&e, &e])]), &add(&[&pow(&e, 3), &n(2 + i as i128), &d(&e, &[i % 2])]));
    }
    let text = messages(|_| e.clone());
    assert!(text.contains("200000") || text.contains("order"), "{text}");
}

#[test]
fn deep_nesting_ends() {
    let mut e = field(0);
    for _ in 0..5000 {
        e = call(Function::Tanh, &e);
    }
    assert!(!messages(|_| e.clone()).is_empty());
    // Tests run on small stacks; so does this drop.
    while let Node::Call(_, inner) = &*e.clone() {
        e = inner.clone();
    }
}

#[test]
fn coefficients_that_outgrow_exact_arithmetic() {
    let huge: Expr = Rc::new(Node::Number(ratio(i128::MAX / 2, 1)));
    let text = messages(|u| add(&[u, &huge, &huge, &huge]));
    assert!(text.contains("outgrows"), "{text}");
}

#[test]
fn every_faulty_group_is_reported() {
    let mut m = one_field();
    let high = || TermKind::Residual(vec![d(&field(0), &[0; 7])]);
    m.group("g", 0, vec![("first", high())]);
    m.group("h", 0, vec![("second", high())]);
    m.scene();
    let text = errors(&m);
    assert!(text.contains("`first`") && text.contains("`second`"), "{text}");
}

#[test]
fn the_same_model_gives_the_same_plan() {
    for m in [pendulum(), membrane()] {
        let text = || format!("{:?}", plan::build(&m).unwrap());
        assert_eq!(text(), text());
    }
}

#[test]
fn literals_too_long_for_one_operator_are_read_apart() {
    let mut m = one_field();
    let long = |n: i128| Rc::new(Node::Number(ratio(n, 10i128.pow(30) + 57)));
    let u = field(0);
    let term = |n: i128, by: &[usize]| mul(&[&long(n), &d(&u, by)]);
    let big = 10i128.pow(30);
    let row = add(&[&term(big + 1, &[0, 0, 0, 0]), &term(big + 3, &[0, 0, 1, 1]), &term(big + 7, &[1, 1, 1, 1])]);
    m.group("g", 0, vec![("r", TermKind::Residual(vec![row]))]);
    m.scene();
    assert!(plan::build(&m).is_ok());
}
