//! Saved answers, read with the text of the equation that they hold.

use nisp_compiler::{Failure, analyse_asking};
use nisp_runtime::saved::{OpenAnswer, SavedAnswer, SavedError};
use thiserror::Error;

use crate::{Mistake, Mistakes, interpret, read, text};

/// Why a saved answer cannot be read, or does not have what it is asked for.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum OpenError {
    /// The equation, as it was when the answer was saved, is none to this version of the language.
    #[error("the equation that stands in the answer is not read by this version of nisp, so solve again:\n{0}")]
    Equation(Mistakes),
    /// The equation has no such scene.
    #[error("the equation that stands in the answer has no scene `{0}`")]
    Scene(String),
    /// Something is wrong with what is asked for.
    #[error("{0}")]
    Question(Mistakes),
    /// The answer does not fit its equation, or does not have what is asked for.
    #[error(transparent)]
    Saved(#[from] SavedError),
}

/// A saved answer that can be read at any point.
///
/// # Errors
/// The equation in it is not understood, or does not fit its numbers.
pub fn open(saved: &SavedAnswer) -> Result<OpenAnswer, OpenError> {
    let equation = read(saved.equation(), saved.module()).map_err(OpenError::Equation)?;
    let scene = equation.scenes.into_iter().find(|scene| scene.schema.name == saved.scene());
    Ok(saved.open(scene.ok_or_else(|| OpenError::Scene(saved.scene().into()))?)?)
}

/// A saved answer that can be read at any point, asked for expressions separated by commas in the names of its equation:
/// heads, parameters, what `let` has named outside of groups, and derivatives of all of it. Gives the names of what was asked
/// for, vectors and matrices by component, among those of the answer's values.
///
/// # Errors
/// As [`open`]; expressions that are wrong, or that need what the answer does not have.
pub fn ask(saved: &SavedAnswer, expressions: &str) -> Result<(OpenAnswer, Vec<String>), OpenError> {
    let answer = open(saved)?;
    let wrong = |mistake| OpenError::Question(Mistakes(vec![mistake]));
    let asked = expressions.parse().map_err(|error| wrong(Mistake::lexical(&error, expressions)))?;
    let tokens = text::tokens(saved.equation(), saved.module()).map_err(wrong)?;
    // The equation alone was understood above: what is wrong is what is asked for.
    let analysed = analyse_asking(tokens, Some((saved.scene(), asked)));
    let (model, plan) = analysed.map_err(|Failure { errors, .. }| {
        let mistakes = errors.faults().iter().map(|fault| Mistake::new(fault, expressions));
        OpenError::Question(Mistakes(mistakes.collect()))
    })?;
    let scenes = || plan.scenes.iter().zip(&model.scenes);
    let (scene, declared) = scenes()
        .find(|(_, declared)| declared.name.text == saved.scene())
        .ok_or_else(|| OpenError::Scene(saved.scene().into()))?;
    let names = model.questions.iter().map(|question| question.name.clone()).collect();
    let scene = interpret((&model, answer.text()), &plan, scene, declared);
    Ok((answer.asked(scene)?, names))
}
