//! Plans of whole models: rows against jet arithmetic, adjoints against differences, what is left out.

mod middle_support;

use middle_support::check::check;
use middle_support::models;
use nisp_compiler::model::Model;
use nisp_compiler::plan::{self, Plan};

/// The plan, with its values and adjoints checked.
fn check_values(model: &Model) -> Plan {
    let plan = plan::build(model).unwrap();
    check(model, &plan).unwrap();
    plan
}

#[test]
fn pendulum() {
    let model = models::pendulum();
    let plan = check_values(&model);
    let scene = &plan.scenes[0];
    assert_eq!(scene.heads, [0, 1, 2, 3]);
    let motion = &scene.groups[0];
    assert_eq!(plan.sets[motion.hidden].set.len(), 3);
    assert_eq!(plan.sets[scene.groups[1].hidden].set.len(), 1);
    assert_eq!(motion.jets.len(), 8, "q'', three of psi, three of phi, f: q itself is not read");
}

#[test]
fn membrane() {
    let model = models::membrane();
    let plan = check_values(&model);
    let (contact, identify) = (&plan.scenes[0], &plan.scenes[1]);
    assert_eq!(contact.heads, [0, 1, 2, 3]);
    assert_eq!(identify.heads, [0, 1, 2]);
    assert_eq!(plan.sets[contact.groups[0].hidden].set.len(), 9);
    assert_eq!(plan.sets[contact.groups[1].hidden].set.len(), 1);
    assert_eq!(plan.scale_groups, [0, 0]);
    at_most(&contact.groups[0], 39, 69);
    assert!(contact.skipped.contains(&"group rim: value only (1 of 9 channels)".to_owned()));
    assert!(identify.skipped.contains(&"`f` is fixed to 0: no head".to_owned()));
    assert!(identify.skipped.contains(&"group rim: without no_contact".to_owned()));
}

#[test]
fn rlc() {
    let plan = check_values(&models::rlc());
    let circuit = &plan.scenes[0].groups[0];
    at_most(circuit, 4, 6);
    assert_eq!(plan.scenes[0].scalars.len(), 4, "7, 10, 1 and 6, each in its unit");
}

#[test]
fn elasticity() {
    let plan = check_values(&models::elasticity());
    let scene = &plan.scenes[0];
    assert_eq!(scene.groups.iter().map(|g| plan.sets[g.hidden].set.len()).collect::<Vec<_>>(), [10, 4]);
    at_most(&scene.groups[0], 21, 30);
    at_most(&scene.groups[1], 23, 48);
}

/// Bounds the operations per point of a group's rows and of their adjoint.
fn at_most(group: &plan::GroupPlan, rows: usize, adjoint: usize) {
    let counts = (group.residual.operations(), group.adjoint.operations());
    assert!(counts.0 <= rows && counts.1 <= adjoint, "{counts:?} instead of {:?}", (rows, adjoint));
}
