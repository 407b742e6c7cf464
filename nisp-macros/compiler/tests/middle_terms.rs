//! Kinds of terms and transformed fields: what their rows are, and that nothing about them is undefined.

mod middle_support;

use std::rc::Rc;

use middle_support::models::*;
use nisp_compiler::model::{Function, Hard, Model, Node, TermKind};
use nisp_compiler::plan::{self, Plan, RowKind, Scalar};
use nisp_compiler::program::{Program, Slot};
use nisp_compiler::rational::ratio;

fn two_fields() -> Model {
    let mut m = model(&[("x", LENGTH)]);
    m.field("a", NONE);
    m.field("b", LENGTH);
    m
}

fn plan_of(m: &mut Model, kind: TermKind) -> Plan {
    m.group("g", 1, vec![("r", kind)]);
    m.scene();
    plan::build(m).unwrap()
}

fn run(program: &Program, jets: &[f64], seed: f64) -> Vec<f64> {
    program.evaluate(|slot, index| match slot {
        Slot::Jet => jets[index],
        Slot::Parameter => [2.0, 4.0][index],
        Slot::Coordinate => [0.5, 0.25][index],
        Slot::Seed => seed,
        other => panic!("unexpected {other:?}"),
    })
}

#[test]
fn an_inequality_is_its_violation() {
    let plan = plan_of(&mut two_fields(), TermKind::Inequality(vec![field(0)]));
    let group = &plan.scenes[0].groups[0];
    assert_eq!(group.terms[0].kind, RowKind::Residual);
    for (a, row, slope) in [(-3.0, -3.0, 1.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0)] {
        assert_eq!(run(&group.residual, &[a], 1.0), [row]);
        assert_eq!(run(&group.adjoint, &[a], 1.0), [slope]);
    }
}

#[test]
fn a_complementarity_vanishes_exactly_on_its_set() {
    let kind = TermKind::Complementarity {
        a: field(0),
        b: field(1),
        a_dimension: dimension(NONE),
        b_dimension: dimension(LENGTH),
    };
    let plan = plan_of(&mut two_fields(), kind);
    let scene = &plan.scenes[0];
    let side = |exponents, side| Scalar::SideScale(dimension(exponents), 0, 0, side);
    assert_eq!(scene.scalars, [side(NONE, 0), side(LENGTH, 1)]);
    let group = &scene.groups[0];
    for (a, b) in [(0.0, 0.0), (3.0, 0.0), (0.0, 5.0)] {
        assert!(run(&group.residual, &[a, b], 1.0)[0].abs() < 1e-11);
    }
    // a / 2 = 3, b / 4 = 4: 3 + 4 - 5.
    assert!((run(&group.residual, &[6.0, 16.0], 1.0)[0] - 2.0).abs() < 1e-12);
    assert!(run(&group.residual, &[-1.0, 5.0], 1.0)[0] < 0.0);
    assert!(run(&group.adjoint, &[0.0, 0.0], 1.0).iter().all(|slope| slope.is_finite()));
}

#[test]
fn an_integral_has_integrands_and_targets() {
    let mut m = two_fields();
    let (force, gain) = (m.parameter("F", NONE), m.parameter("g", NONE));
    let target = vec![mul(&[&pow(&gain, 2), &force]), n(0)];
    m.group("g", 0, vec![("r", TermKind::Integral { integrand: vec![field(0), field(1)], target, measure: None })]);
    m.scene().learned = vec![false, true];
    let plan = plan::build(&m).unwrap();
    let term = &plan.scenes[0].groups[0].terms[0];
    let RowKind::Integral(program) = &term.kind else { panic!("not an integral") };
    assert_eq!(run(program, &[], 0.0), [32.0, 0.0]);
    assert_eq!(run(&term.target_slopes, &[], 0.0), [16.0, 0.0], "2 g F at F = 2, g = 4");
    assert_eq!(plan.scenes[0].scalars, [Scalar::Parameter(0), Scalar::Parameter(1)]);
}

#[test]
fn a_partner_is_a_second_site() {
    let partner = |e| Rc::new(Node::Partner(e));
    let slope = d(&field(0), &[0]);
    let row = sub(&slope, &mul(&[&partner(slope.clone()), &partner(coordinate(0))]));
    let plan = plan_of(&mut two_fields(), TermKind::Residual(vec![row]));
    let group = &plan.scenes[0].groups[0];
    assert_eq!(group.jets.iter().map(|jet| jet.site).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(run(&group.residual, &[7.0, 8.0], 1.0), [7.0 - 8.0 * 0.25]);
    assert_eq!(run(&group.adjoint, &[7.0, 8.0], 1.0), [1.0, -0.25]);
}

#[test]
fn a_hard_condition_is_part_of_the_field() {
    let mut m = two_fields();
    m.fields[0].hard = Some(Hard { text: Default::default(), distance: pow(&coordinate(0), 2), value: n(3) });
    let plan = plan_of(&mut m, TermKind::Residual(vec![d(&field(0), &[0])]));
    let group = &plan.scenes[0].groups[0];
    // (3 + x^2 r)' = 2 x r + x^2 r' at x = 1/2.
    assert_eq!(run(&group.residual, &[10.0, 20.0], 1.0), [10.0 + 5.0]);
}

#[test]
fn roots_and_kinks_have_finite_slopes() {
    let cases = [
        call(Function::Sqrt, &pow(&field(0), 2)),
        Rc::new(Node::Pow(pow(&field(0), 2), ratio(1, 2))),
        call(Function::Abs, &field(0)),
        call(Function::Sqrt, &add(&[&pow(&field(0), 2), &pow(&d(&field(0), &[0]), 2)])),
        Rc::new(Node::Max(field(0), n(0))),
    ];
    for case in cases {
        let plan = plan_of(&mut two_fields(), TermKind::Residual(vec![case.clone()]));
        let group = &plan.scenes[0].groups[0];
        let slopes = run(&group.adjoint, &[0.0, 0.0], 1.0);
        assert!(slopes.iter().all(|slope| *slope == 0.0), "{case:?}: {slopes:?}");
    }
}

#[test]
fn a_fixed_parameter_with_a_dimension_stays_an_input() {
    let mut m = two_fields();
    let (l, nu) = (m.parameter("l", LENGTH), m.parameter("nu", NONE));
    let row = add(&[&mul(&[&l, &nu, &field(0)]), &mul(&[&q(0.25, LENGTH), &field(0)])]);
    m.group("g", 0, vec![("r", TermKind::Residual(vec![row]))]);
    let scene = m.scene();
    scene.fixed_parameters = vec![Some(0.25), Some(0.5)];
    let plan = plan::build(&m).unwrap();
    assert_eq!(plan.scenes[0].scalars, [Scalar::Literal(0.25, dimension(LENGTH))]);
}

#[test]
fn the_magnitude_adds_what_the_row_subtracts() {
    let row = sub(&d(&field(0), &[0]), &mul(&[&n(3), &field(0)]));
    let plan = plan_of(&mut two_fields(), TermKind::Residual(vec![row]));
    let group = &plan.scenes[0].groups[0];
    assert_eq!(run(&group.residual, &[2.0, 5.0], 1.0), [5.0 - 6.0]);
    assert_eq!(run(&group.magnitude, &[2.0, 5.0], 1.0), [5.0 + 6.0]);
    // Values of fields and their derivatives have signs.
    assert_eq!(run(&group.magnitude, &[-2.0, 5.0], 1.0), [5.0 + 6.0]);
}
