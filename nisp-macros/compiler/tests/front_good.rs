//! Programs that must pass the front end, and what it makes of some of them.

use nisp_compiler::error::Errors;
use nisp_compiler::model::{Model, Node, Role, TermKind, check};
use nisp_compiler::syntax::parse;

fn model_of(file: &str) -> Model {
    let path = format!("{}/tests/fixtures/good/{file}.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut errors = Errors::new();
    let module = parse(text.parse().unwrap(), &mut errors);
    let model = module.and_then(|module| check(&module, &[], &mut errors));
    let messages: Vec<String> = errors
        .faults()
        .iter()
        .map(|fault| {
            let start = fault.place.start.start();
            format!("{file}:{}:{}: {}", start.line, start.column + 1, fault.message)
        })
        .collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
    model.unwrap()
}

fn warnings(model: &Model) -> Vec<&str> {
    model.warnings.iter().map(|(message, _)| message.lines().next().unwrap_or_default()).collect()
}

#[test]
fn the_double_pendulum() {
    let model = model_of("pendulum");
    assert_eq!(model.name.text, "pendulum");
    assert_eq!(model.docs, ["A double pendulum on a cart."]);
    assert_eq!(model.coordinates[0].docs, ["Time."]);
    assert_eq!(model.fields.iter().map(|field| field.name.text.as_str()).collect::<Vec<_>>(), ["q", "psi", "phi", "f"]);
    assert_eq!(model.fields[3].role, Role::Source);
    assert_eq!(model.parameters[5].default, Some(9.81));
    assert_eq!(model.parameters[1].default, None);
    let columns: Vec<_> =
        model.groups[1].columns.iter().map(|column| (&*column.name.text, &*column.unit.text)).collect();
    assert_eq!(columns, [("q", "m"), ("psi", "rad"), ("phi", "rad")]);
    let identify = &model.scenes[1];
    assert_eq!(identify.uses, [vec![true; 3], vec![true; 3], vec![false]]);
    assert_eq!(identify.weights[0], [2.0, 1.0, 1.0]);
    assert_eq!(identify.learned, [true, false, false, false, false, false, false]);
    assert!(matches!(identify.fixed_fields[3].as_deref(), Some(Node::Number(_))));
    assert_eq!(model.groups[0].terms[0].unit.text, "N");
    assert_eq!(warnings(&model), Vec::<&str>::new());
}

#[test]
fn equations_are_printed_as_written_and_as_latex() {
    let model = model_of("pendulum");
    let link = &model.groups[0].terms[1];
    assert_eq!(
        link.equation,
        "h2 * d(q, t, 2) * cos(psi) + h4 * d(psi, t, 2) + h5 * (d(phi, t, 2) * cos(psi - phi) + d(phi, t)^2 * \
         sin(psi - phi)) - h7 * sin(psi) == 0"
    );
    assert!(link.latex.starts_with(
        r"h_{2} \, \frac{\mathrm{d}^{2} q}{\mathrm{d} t^{2}} \, \cos\left(\psi\right) + h_{4} \, \frac{\mathrm{d}^{2} \psi}"
    ));
}

#[test]
fn the_rlc_circuit() {
    let model = model_of("rlc");
    assert_eq!(warnings(&model), Vec::<&str>::new());
    assert_eq!(model.scenes.len(), 1);
    assert_eq!(model.scenes[0].name.text, "all");
}

#[test]
fn a_value_with_a_unit_declares_it() {
    let model = model_of("spring");
    let units: Vec<&str> = model.parameters.iter().map(|parameter| parameter.unit.text.as_str()).collect();
    assert_eq!(units, ["N/m", "kg", "m/s^2"]);
    let values: Vec<_> = model.parameters.iter().map(|parameter| parameter.default).collect();
    assert_eq!(values, [Some(5.0), Some(0.2), Some(-9.81)]);
    assert_eq!(model.constants[0].unit.text, "mm");
}

#[test]
fn the_sponge() {
    let model = model_of("sponge");
    assert_eq!(model.fields[2].name.text, "u_z");
    assert_eq!(model.fields[3].lower, Some(0.0));
    assert_eq!(model.parameters[5].name.text, "g_z");
    assert_eq!(model.parameters[5].default, Some(-9.81));
    assert!(matches!(&model.groups[0].terms[0].kind, TermKind::Residual(rows) if rows.len() == 3));
    assert!(matches!(&model.groups[1].terms[1].kind, TermKind::Complementarity { .. }));
    assert!(matches!(&model.groups[1].terms[3].kind, TermKind::Integral { integrand, .. } if integrand.len() == 3));
    assert_eq!(warnings(&model), Vec::<&str>::new());
}

#[test]
fn the_membrane() {
    let model = model_of("membrane");
    assert_eq!(model.parameters[2].default, Some(0.45 * 1e-3));
    assert_eq!((model.parameters[3].lower, model.parameters[3].upper), (Some(0.0), Some(0.1 * 1e5)));
    assert_eq!(model.groups[1].terms[0].equation, "u == 0, v == 0, w == 0");
    assert_eq!(model.groups[0].terms[3].weight, 10.0);
    assert_eq!(model.scenes[2].fixed_parameters[0], Some(2e9));
    assert_eq!(model.scenes[2].uses, [vec![true, false, false, false], vec![true, true]]);
}

#[test]
fn the_clamped_plate_and_heat_and_all_operators() {
    assert_eq!(warnings(&model_of("plate")), Vec::<&str>::new());
    let heat = model_of("heat");
    assert_eq!(heat.fields[1].upper, Some(50e6));
    assert_eq!(warnings(&heat), Vec::<&str>::new());
    let operators = model_of("operators");
    assert!(operators.fields[6].hard.is_some());
    assert!(operators.groups[1].paired);
    assert!(!model_of("unitless").units_checked);
}
