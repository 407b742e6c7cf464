//! Random expressions: differentiation, simplification, sharing and scheduling against plain jet arithmetic.

mod middle_support;

use middle_support::check::check;
use middle_support::models::*;
use nisp_compiler::model::{Expr, Function, TermKind};
use nisp_compiler::plan;
use proptest::prelude::*;

/// Smooth expressions in two coordinates, two fields, two parameters and a column, of moderate size and order.
fn expression() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        3 => (0usize..2).prop_map(field),
        2 => (0usize..2, 0usize..2).prop_map(|(f, i)| d(&field(f), &[i, i])),
        1 => (0usize..2).prop_map(coordinate),
        1 => (0usize..2).prop_map(parameter),
        1 => (-3i128..=3).prop_map(n),
        1 => Just(q(0.75, LENGTH)),
    ];
    leaf.prop_recursive(4, 40, 3, |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            3 => prop::collection::vec(inner.clone(), 2..4).prop_map(|v| add(&v.iter().collect::<Vec<_>>())),
            3 => prop::collection::vec(inner.clone(), 2..4).prop_map(|v| mul(&v.iter().collect::<Vec<_>>())),
            2 => pair.clone().prop_map(|(a, b)| sub(&a, &b)),
            1 => pair.prop_map(|(a, b)| div(&a, &add(&[&n(2), &pow(&call(Function::Sin, &b), 2)]))),
            1 => (inner.clone(), 2i128..4).prop_map(|(a, e)| pow(&call(Function::Tanh, &a), e)),
            1 => inner.clone().prop_map(|a| call(Function::Cos, &neg(&a))),
            1 => inner.clone().prop_map(|a| call(Function::Sqrt, &add(&[&n(1), &pow(&call(Function::Sin, &a), 2)]))),
            1 => inner.clone().prop_map(|a| call(Function::Softplus, &call(Function::Tanh, &a))),
            2 => (inner, 0usize..2).prop_map(|(a, i)| d(&a, &[i])),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn programs_compute_what_was_written(
        rows in prop::collection::vec(expression(), 1..4),
        observed in expression(),
        bounded: bool,
        fixed: bool,
    ) {
        let mut m = model(&[("x", LENGTH), ("y", LENGTH)]);
        m.field("u", NONE);
        m.bounded("k", NONE, bounded.then_some(0.5), None);
        m.parameter("c", LENGTH);
        m.parameter("e", NONE);
        m.group("g", 1, vec![
            ("r", TermKind::Residual(rows)),
            ("o", TermKind::Observation { rows: vec![sub(&observed, &column(0))], columns: vec![0] }),
        ]);
        let scene = m.scene();
        scene.learned = vec![true, true];
        if fixed {
            scene.fixed_fields[1] = Some(mul(&[&coordinate(0), &coordinate(1), &field(0)]));
        }
        match plan::build(&m) {
            Ok(plan) => {
                prop_assert_eq!(format!("{:?}", plan), format!("{:?}", plan::build(&m).unwrap()));
                check(&m, &plan).map_err(TestCaseError::fail)?;
            }
            Err(errors) => prop_assert!(errors.iter().all(|e| e.message.contains("order")), "{:?}", errors),
        }
    }
}
