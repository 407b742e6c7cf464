//! The compiler behind `pde!`: from the tokens of an equation to fused derivative-propagation code.
//!
//! Stages, in the one direction in which data flows:
//!
//! 1. [`syntax`]   - Input: tokens. Output: the syntax tree, as written.
//! 2. [`model`]    - Input: the syntax tree. Output: resolved names, checked shapes and units, scalar expressions.
//! 3. [`symbolic`] - Input: scalar expressions. Output: hash-consed expressions in jets, derivatives carried out.
//! 4. [`channels`] - Input: the operators read. Output: the minimal channel set and its propagation rules.
//! 5. [`plan`]     - Input: all of the above. Output: straight-line programs for every scene and group.
//! 6. [`code`]     - Input: the plan. Output: tokens.
//!
//! Only `syntax` and `code` know of tokens' structure; the stages between them carry spans for error messages
//! and nothing else. The compiler does no input or output, never panics, and is deterministic.

pub mod channels;
pub mod code;
pub mod describe;
pub mod error;
pub mod loss;
pub mod model;
pub mod plan;
pub mod program;
pub mod symbolic;
pub mod syntax;

pub use nisp_units as unit;
pub use nisp_units::rational;

mod beliefs;
mod outputs;

use proc_macro2::TokenStream;

/// Compiles a `pde!` invocation to the module that replaces it, or to every error found in it.
pub fn compile(tokens: TokenStream) -> TokenStream {
    let text = tokens.to_string();
    match analyse(tokens) {
        Ok((model, plan)) => code::emit(&model, &plan, &text),
        Err(Failure { errors, model }) => {
            let mut tokens = errors.into_compile_errors();
            tokens.extend(model.as_deref().map(code::skeleton));
            tokens
        }
    }
}

/// Why an equation has no plan: every error found, and as much of the model as keeps its names defined.
#[derive(Debug)]
pub struct Failure {
    /// The errors.
    pub errors: error::Errors,
    /// The model, where names could be resolved.
    pub model: Option<Box<model::Model>>,
}

/// Every stage but the last: a model and its plan.
///
/// # Errors
/// Everything that is wrong with the equation.
pub fn analyse(tokens: TokenStream) -> Result<(model::Model, plan::Plan), Failure> {
    analyse_asking(tokens, None)
}

/// As [`analyse`], with expressions, separated by commas, that are read out of a scene beside its fields and sources: in the
/// plan of that scene they are rows of the last group, after those of its heads and in the order of [`model::Model::questions`].
/// Those that are heads alone have no row of their own.
///
/// # Errors
/// Everything that is wrong with the equation, or with the expressions.
pub fn analyse_asking(
    tokens: TokenStream,
    asked: Option<(&str, TokenStream)>,
) -> Result<(model::Model, plan::Plan), Failure> {
    let mut errors = error::Errors::new();
    let module = syntax::parse(tokens, &mut errors);
    let (scene, questions) = asked.unzip();
    let questions = questions.map_or(Some(Vec::new()), |tokens| syntax::parse_expressions(tokens, &mut errors));
    let checked = module.zip(questions).and_then(|(module, asked)| model::check(&module, &asked, &mut errors));
    let Some(mut model) = checked else { return Err(Failure { errors, model: None }) };
    if !errors.is_empty() {
        return Err(Failure { errors, model: Some(Box::new(model)) });
    }
    match plan_with_outputs(&mut model, scene) {
        Ok(plan) => Ok((model, plan)),
        Err(faults) => {
            for fault in faults {
                errors.push(fault.span.unwrap_or(model.name.span), fault.message);
            }
            Err(Failure { errors, model: Some(Box::new(model)) })
        }
    }
}

/// Plans a model twice, with the groups that users do not write: once to see which fields have a head, once with the group that reads them out.
fn plan_with_outputs(model: &mut model::Model, asked: Option<&str>) -> Result<plan::Plan, Vec<plan::PlanError>> {
    beliefs::append(model);
    let first = plan::build(model)?;
    outputs::append(model, &first, asked);
    plan::build(model)
}
