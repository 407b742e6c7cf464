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
    for group in &contact.groups {
        println!("{} rows {} adjoint {}", group.group, group.residual.operations(), group.adjoint.operations());
    }
    println!("{:?} {:?}", contact.skipped, identify.skipped);
}
