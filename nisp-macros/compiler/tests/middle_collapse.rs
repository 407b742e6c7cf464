//! What becomes one operator, and what must not.

mod middle_support;

use middle_support::models::*;
use middle_support::{laplacian, partial};
use nisp_compiler::channels::Operator;
use nisp_compiler::model::{Expr, Model, TermKind};
use nisp_compiler::plan::{self, Plan};

/// The plan of one residual in x, y, z [m], t [s] of u, with a field k, a parameter c and a column.
fn plan(residual: impl Fn(&Expr) -> Expr) -> Plan {
    plan_of(&mut space(), &residual)
}

fn space() -> Model {
    let mut m = model(&[("x", LENGTH), ("y", LENGTH), ("z", LENGTH), ("t", TIME)]);
    m.field("u", NONE);
    m.field("k", NONE);
    m.parameter("c", NONE);
    m
}

fn plan_of(m: &mut Model, residual: &dyn Fn(&Expr) -> Expr) -> Plan {
    m.group("g", 1, vec![("r", TermKind::Residual(vec![residual(&field(0))]))]);
    m.scene();
    plan::build(m).unwrap()
}

fn operators(plan: &Plan) -> Vec<Operator> {
    plan.scenes[0].groups[0].jets.iter().map(|jet| jet.operator.clone()).collect()
}

fn channels(plan: &Plan) -> usize {
    plan.sets[plan.scenes[0].groups[0].hidden].set.len()
}

const XX: [usize; 2] = [0, 0];
const YY: [usize; 2] = [1, 1];
const ZZ: [usize; 2] = [2, 2];
const TT: [usize; 2] = [3, 3];

fn laplace(u: &Expr) -> Expr {
    add(&[&d(u, &XX), &d(u, &YY), &d(u, &ZZ)])
}

#[test]
fn a_laplacian_is_one_operator() {
    let plan = plan(laplace);
    assert_eq!(operators(&plan), [laplacian(3, 4)]);
    assert_eq!(channels(&plan), 5);
    assert_eq!(plan.scale_groups, [0, 0, 0, 1], "x, y, z share a scale; t does not");
}

#[test]
fn a_common_cofactor_is_collected() {
    let c = parameter(0);
    let forms: [fn(&Expr, &Expr) -> Expr; 3] = [
        |u, c| mul(&[c, &laplace(u)]),
        |u, c| add(&[&mul(&[c, &d(u, &XX)]), &mul(&[&d(u, &YY), c]), &mul(&[c, &d(u, &ZZ)])]),
        |u, c| add(&[&mul(&[c, &add(&[&d(u, &XX), &d(u, &YY)])]), &mul(&[c, &add(&[&d(u, &ZZ), &n(1)])])]),
    ];
    for form in forms {
        assert_eq!(operators(&plan(|u| form(u, &c))), [laplacian(3, 4)]);
    }
}

#[test]
fn a_bounded_field_collapses_inside() {
    let mut m = space();
    m.fields[0].lower = Some(0.0);
    let plan = plan_of(&mut m, &|u| laplace(u));
    assert_eq!(channels(&plan), 5);
}

#[test]
fn a_run_time_speed_separates_space_from_time() {
    let plan = plan(|u| sub(&d(u, &TT), &mul(&[&parameter(0), &laplace(u)])));
    assert_eq!(channels(&plan), 7);
}

#[test]
fn unlike_dimensions_do_not_mix() {
    let plan = plan(|u| sub(&d(u, &TT), &laplace(u)));
    assert_eq!(operators(&plan), [partial(&[0, 0, 0, 2]), laplacian(3, 4)]);
    assert_eq!(plan.scale_groups, [0, 0, 0, 1]);
}

#[test]
fn without_units_coordinates_may_be_tied() {
    let mut m = space();
    m.units_checked = false;
    for coordinate in &mut m.coordinates {
        coordinate.unit = unit(NONE);
    }
    let plan = plan_of(&mut m, &|u| sub(&d(u, &TT), &laplace(u)));
    assert_eq!(channels(&plan), 6);
    assert_eq!(plan.scale_groups, [0, 0, 0, 0]);
}

#[test]
fn different_orders_do_not_mix() {
    let mut m = model(&[("x", NONE)]);
    m.field("u", NONE);
    let plan = plan_of(&mut m, &|u| add(&[&d(u, &[0, 0]), u, &d(u, &[0])]));
    assert!(operators(&plan).iter().all(Operator::is_monomial));
    assert_eq!(plan.scale_groups, [0]);
}

#[test]
fn nothing_collapses_across_a_field_a_parameter_or_a_column() {
    for outside in [field(1), parameter(0), column(0)] {
        let plan = plan(|u| add(&[&d(u, &XX), &mul(&[&outside, &d(u, &YY)])]));
        assert!(operators(&plan).iter().all(Operator::is_monomial), "{outside:?}");
        assert_eq!(channels(&plan), 5, "1, x, y, xx, yy");
        assert_eq!(plan.scale_groups, [0, 1, 2, 3], "nothing ties the coordinates");
    }
}

#[test]
fn parts_that_are_needed_anyway_are_read_as_parts() {
    let plan = plan(|u| add(&[&laplace(u), &mul(&[&d(u, &XX), &d(u, &YY)])]));
    assert!(operators(&plan).iter().all(Operator::is_monomial));
    assert_eq!(operators(&plan).len(), 3);
    assert_eq!(plan.scale_groups, [0, 1, 2, 3]);
}
