//! Equations read from text and interpreted: the schemas that the macro emits, and the same numbers to rounding.

use nisp::Precision;
use nisp::network::Architecture;
use nisp::simd::Isa;

use nisp_references::each_model;
use nisp_references::models::TEXTS;
use nisp_references::reference::{Model, Reference, architectures};

/// A model's scene, interpreted: from the braces of the `pde!` that declares its module.
fn interpreted(scene: nisp::SceneRef) -> nisp::SceneRef {
    let module = format!("mod {} {{", scene.schema.module);
    let file = TEXTS.iter().find(|text| text.contains(&module)).expect("the model's file");
    let (_, text) = file.split_once("pde! {").expect("the model's text");
    let (text, _) = text.split_once("\n}\n").expect("the end of the text");
    let equation = nisp_interpreter::read(text, "unnamed").unwrap_or_else(|mistakes| panic!("{mistakes}"));
    assert_eq!(equation.name, scene.schema.module);
    equation.scenes.into_iter().find(|read| read.schema.name == scene.schema.name).expect("the model's scene")
}

fn schemas_agree<M: Model>(model: &M) {
    let compiled = model.scene();
    assert_eq!(format!("{:#?}", interpreted(compiled).schema), format!("{:#?}", compiled.schema));
}

#[test]
fn a_text_has_the_schema_that_the_macro_emits() {
    each_model!(schemas_agree);
    // Groups in every portion of domains of every kind.
    let everywhere = nisp::scene::<nisp_references::models::poisson::poisson::everywhere::Scene>();
    for compiled in [everywhere, nisp::scene::<nisp_references::models::solids::solids::solve::Scene>()] {
        assert_eq!(format!("{:#?}", interpreted(compiled).schema), format!("{:#?}", compiled.schema));
    }
}

/// Loss and gradient of both, in one precision and on one instruction set, within `tolerance`.
fn compare<E: Precision, M: Model>(model: &M, architecture: Architecture, isa: Isa, tolerance: f64) {
    let reference = Reference::new(model, architecture);
    let theta: Vec<E> = reference.theta(31).iter().map(|&x| E::from_f64(x)).collect();
    let scene = interpreted(model.scene());
    let [compiled, read] = [reference.problem.clone(), reference.problem.clone().with_scene(scene)].map(|problem| {
        let mut engine = problem.engine::<E>(isa, architecture).expect("a bound problem");
        let mut gradient = vec![E::ZERO; theta.len()];
        let loss = engine.loss_and_gradient(&theta, &mut gradient).expect("finite");
        (loss, gradient.into_iter().map(E::to_f64).collect::<Vec<f64>>())
    });
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    let apart = norm(&mut compiled.1.iter().zip(&read.1).map(|(a, b)| a - b)) / norm(&mut compiled.1.iter().copied());
    let loss = (compiled.0 - read.0).abs() / compiled.0;
    let what = format!("{} on {}, {architecture:?}", scene.schema.module, isa.name());
    assert!(apart <= tolerance && loss <= tolerance, "{what}: gradient {apart:e}, loss {loss:e} apart");
}

fn numbers_agree<M: Model>(model: &M) {
    for architecture in architectures() {
        for isa in Isa::available() {
            compare::<f64, M>(model, architecture, isa, 1e-12);
            compare::<f32, M>(model, architecture, isa, 2e-5);
        }
    }
}

#[test]
fn an_interpreted_scene_has_the_loss_and_the_gradient_of_the_compiled_one() {
    each_model!(numbers_agree);
}
