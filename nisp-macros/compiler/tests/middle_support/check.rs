//! Programs of a plan against jet arithmetic, and their adjoints against central differences.

use nisp_compiler::model::{Expr, Function, Model, TermKind};
use nisp_compiler::plan::{self, GroupPlan, Plan, Scalar, ScenePlan};
use nisp_compiler::program::{Program, Slot};

use super::Numbers;
use super::jet::Jet;
use super::models::{self, call};
use super::oracle::World;
use super::tangent::{compare, moving, tangent};

fn world(model: &Model, numbers: &mut Numbers) -> World {
    let (coordinates, degree) = (model.coordinates.len(), 6);
    let mut site = || model.fields.iter().map(|_| Jet::random(coordinates, degree, numbers)).collect();
    let fields = [site(), site()];
    let point = numbers.take(2 * coordinates);
    let parameters = numbers.take(model.parameters.len()).iter().map(|p| p + 2.0).collect();
    World { fields, point, parameters, columns: numbers.take(8), degree }
}

/// The natural size of bounded fields in these tests.
const FIELD_SCALE: f64 = 1.5;

fn scalar(world: &World, scalar: &Scalar) -> f64 {
    match scalar {
        Scalar::Parameter(index) => world.parameters[*index],
        Scalar::Literal(value, _) => *value,
        Scalar::FieldScale(_) => FIELD_SCALE,
        Scalar::SideScale(_, _, _, side) => 2.0 + *side as f64,
    }
}

/// All inputs of a group's programs, as vectors that tests may move.
#[derive(Clone)]
struct Inputs {
    jets: Vec<f64>,
    scalars: Vec<f64>,
    point: Vec<f64>,
    columns: Vec<f64>,
    seeds: Vec<f64>,
}

impl Inputs {
    fn new(world: &World, scene: &ScenePlan, group: &GroupPlan, numbers: &mut Numbers) -> Self {
        let jet = |jet: &plan::Jet| world.fields[jet.site][scene.heads[jet.head]].apply(&jet.operator);
        Self {
            jets: group.jets.iter().map(jet).collect(),
            scalars: scene.scalars.iter().map(|s| scalar(world, s)).collect(),
            point: world.point.clone(),
            columns: group.columns.iter().map(|&column| world.columns[column]).collect(),
            seeds: numbers.take(group.residual.outputs.len()),
        }
    }

    fn run(&self, program: &Program) -> Vec<f64> {
        program.evaluate(|slot, index| match slot {
            Slot::Jet => self.jets[index],
            Slot::Coordinate => self.point[index],
            Slot::Parameter => self.scalars[index],
            Slot::Column => self.columns[index],
            Slot::Seed => self.seeds[index],
            other => panic!("a group does not read {other:?}"),
        })
    }
}

fn rows(model: &Model, scene: usize, group: &GroupPlan) -> Vec<Expr> {
    let terms = &model.groups[group.group].terms;
    let used = terms.iter().zip(&model.scenes[scene].uses[group.group]).filter(|(_, used)| **used);
    used.flat_map(|(term, _)| match &term.kind {
        TermKind::Residual(rows) | TermKind::Observation { rows, .. } => rows.clone(),
        TermKind::Chamfer { point, .. } => point.clone(),
        TermKind::Integral { integrand, .. } => integrand.clone(),
        other => panic!("no oracle for {other:?}"),
    })
    .collect()
}

/// Fields as the model means them: bounds are kept by construction.
fn physical(model: &Model, scene: usize, raw: &World) -> World {
    let mut world = raw.clone();
    for (i, field) in model.fields.iter().enumerate() {
        for site in 0..2 {
            let jet = &raw.fields[site][i];
            let constant = |c: f64| Jet::affine(&vec![0.0; jet.coordinates], c, jet.degree);
            let through = |f, jet: &Jet| {
                let mut inner = raw.clone();
                inner.fields[0] = vec![jet.clone()];
                inner.jet(&call(f, &models::field(0)), 0)
            };
            world.fields[site][i] = match (field.lower, field.upper) {
                (None, None) => jet.clone(),
                (Some(l), Some(u)) => constant(l).plus(&through(Function::Sigmoid, jet).scale(u - l)),
                (Some(l), None) => constant(l).plus(&through(Function::Softplus, jet).scale(FIELD_SCALE)),
                (None, Some(u)) => constant(u).plus(&through(Function::Softplus, jet).scale(-FIELD_SCALE)),
            };
        }
    }
    for (i, fixed) in model.scenes[scene].fixed_fields.iter().enumerate() {
        if let Some(fixed) = fixed {
            for site in 0..2 {
                world.fields[site][i] = world.jet(fixed, site);
            }
        }
    }
    world
}

/// Compares every program of a plan with its oracle; says where it fails.
pub(crate) fn check(model: &Model, plan: &Plan) -> Result<(), String> {
    check_rows(model, plan, 7)?;
    check_adjoints(model, plan)
}

/// Compares the rows with their oracle, to rounding of the largest of their terms.
pub(crate) fn check_rows(model: &Model, plan: &Plan, seed: u64) -> Result<(), String> {
    let mut numbers = Numbers(seed);
    for (index, scene) in plan.scenes.iter().enumerate() {
        for group in &scene.groups {
            for _ in 0..3 {
                let raw = world(model, &mut numbers);
                let inputs = Inputs::new(&raw, scene, group, &mut numbers);
                let truth = physical(model, index, &raw);
                let got = inputs.run(&group.residual);
                let mut nudged = inputs.clone();
                nudged.jets.iter_mut().for_each(|jet| *jet *= 1.0 + 1e-9);
                let nudged = nudged.run(&group.residual);
                let mut positive = inputs.clone();
                positive.jets.iter_mut().for_each(|jet| *jet = jet.abs());
                let sizes = positive.run(&group.magnitude);
                for (row, &size) in positive.run(&group.residual).into_iter().zip(&sizes) {
                    // A row is no larger than its terms together.
                    if row.abs() > size * (1.0 + 1e-10) {
                        return Err(format!("magnitude {size} of a row that is {row}"));
                    }
                }
                for (row, (expected, got)) in rows(model, index, group).iter().zip(got).enumerate() {
                    let expected = truth.value(expected);
                    // What rounding of the jets in the fourteenth digit does where the equation amplifies it.
                    let rounding = 1e-5 * (nudged[row] - got).abs();
                    if (got - expected).abs() > rounding + 1e-10 * expected.abs().max(1.0).max(1e-2 * sizes[row]) {
                        return Err(format!("row {row}: {got} instead of {expected}"));
                    }
                }
            }
        }
    }
    Ok(())
}

/// Compares `u.(J v)` with `(J^T u).v` of every group, `J` being the derivative of the rows by the jets.
pub(crate) fn check_dot_products(model: &Model, plan: &Plan, seed: u64) -> Result<(), String> {
    let mut numbers = Numbers(seed);
    for scene in &plan.scenes {
        for group in &scene.groups {
            let inputs = Inputs::new(&world(model, &mut numbers), scene, group, &mut numbers);
            let direction = numbers.take(inputs.jets.len());
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
            let tangents = |inputs: &Inputs| {
                let rows = tangent(&group.residual, |slot, index| match slot {
                    Slot::Jet => moving(inputs.jets[index], direction[index]),
                    Slot::Coordinate => moving(inputs.point[index], 0.0),
                    Slot::Parameter => moving(inputs.scalars[index], 0.0),
                    Slot::Column => moving(inputs.columns[index], 0.0),
                    other => panic!("rows do not read {other:?}"),
                });
                product(&inputs.seeds, &rows)
            };
            let (products, mut nudged) = (tangents(&inputs), inputs.clone());
            nudged.jets.iter_mut().for_each(|jet| *jet *= 1.0 + 1e-9);
            let moved = products.iter().zip(tangents(&nudged)).map(|(a, b)| (a - b).abs()).sum::<f64>();
            // Rounding of the jets in the fourteenth digit, where the equation amplifies it.
            compare(&products, &product(&inputs.run(&group.adjoint), &direction), 1e-5 * moved)?;
        }
    }
    Ok(())
}

fn check_adjoints(model: &Model, plan: &Plan) -> Result<(), String> {
    let mut numbers = Numbers(11);
    for (scene, declared) in plan.scenes.iter().zip(&model.scenes) {
        for group in &scene.groups {
            let inputs = Inputs::new(&world(model, &mut numbers), scene, group, &mut numbers);
            let adjoints = inputs.run(&group.adjoint);
            let loss = |moved: &Inputs| -> f64 {
                moved.run(&group.residual).iter().zip(&moved.seeds).map(|(row, seed)| row * seed).sum()
            };
            let difference = |at: &dyn Fn(&mut Inputs) -> &mut f64| {
                let at_step = |h: f64| {
                    let mut moved = inputs.clone();
                    *at(&mut moved) += h;
                    loss(&moved)
                };
                let slope = |h: f64| (at_step(h) - at_step(-h)) / (2.0 * h);
                (4.0 * slope(1e-4) - slope(2e-4)) / 3.0
            };
            let mut expected: Vec<f64> =
                (0..inputs.jets.len()).map(|i| difference(&|moved: &mut Inputs| &mut moved.jets[i])).collect();
            for parameter in scene.learned(declared) {
                let slot = scene.scalars.iter().position(|s| *s == Scalar::Parameter(parameter));
                expected.push(slot.map_or(0.0, |i| difference(&|moved: &mut Inputs| &mut moved.scalars[i])));
            }
            assert_eq!(adjoints.len(), expected.len());
            // Differences lose the digits by which the largest of them exceeds the others.
            let size = expected.iter().fold(10.0f64, |size, x| size.max(x.abs()));
            for (got, want) in adjoints.iter().zip(&expected) {
                if (got - want).abs() > 1e-6 * size {
                    return Err(format!("adjoint {got} instead of {want}"));
                }
            }
        }
    }
    Ok(())
}
