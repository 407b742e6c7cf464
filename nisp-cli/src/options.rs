//! Kinds of values that options take.

use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

use crate::terminal::BAD_INPUT;
use nisp_data::cloud::{LengthUnit, View};
use nisp_equations::{PrepareError, camera};

/// Names of all methods.
pub fn optimizers() -> PossibleValuesParser {
    nisp::Optimizer::ALL.map(nisp::Optimizer::name).into()
}

/// Names of all activations.
pub fn activations() -> PossibleValuesParser {
    nisp::network::Activation::ALL.map(nisp::network::Activation::name).into()
}

/// Names of all precisions.
pub fn precisions() -> PossibleValuesParser {
    nisp::Width::ALL.map(nisp::Width::name).into()
}

/// More of anything than this is a slip.
const MOST: usize = 1_000_000_000;

/// A whole number of at least 1.
///
/// # Errors
/// Anything else; what to give.
pub fn count(text: &str) -> Result<usize, String> {
    whole(text, MOST)
}

/// A whole number from 1 to `most`.
pub(crate) fn whole(text: &str, most: usize) -> Result<usize, String> {
    let number = text.parse::<usize>().ok().filter(|number| (1..=most).contains(number));
    number.ok_or_else(|| format!("give a whole number from 1 to {most}"))
}

/// Networks wider or deeper than this are a slip.
const WIDEST: usize = 4096;

/// A size of a network.
///
/// # Errors
/// Anything else; what to give.
pub fn size(text: &str) -> Result<usize, String> {
    whole(text, WIDEST)
}

/// Any seed.
///
/// # Errors
/// Anything else; what to give.
pub fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}

/// A time above zero.
///
/// # Errors
/// Anything else; what to give.
pub fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| *number > 0.0 && *number <= MOST as f64);
    number.ok_or_else(|| "give a positive number of seconds, for instance 10".into())
}

/// A number of zero or more.
///
/// # Errors
/// Anything else; what to give.
pub fn number(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| *number >= 0.0 && number.is_finite());
    number.ok_or_else(|| "give a number of zero or more".into())
}

/// What is wrong with a command line and how to mend it, in one line and without the usage.
pub fn one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let wanted = |line: &&str| !line.is_empty() && !line.starts_with("Usage:") && !line.starts_with("For more");
    let lines: Vec<_> = text.lines().map(str::trim).filter(wanted).collect();
    let text = lines.join(" ");
    format!("{}; see --help", text.strip_prefix("error: ").unwrap_or(&text))
}

/// Shows help or a version, and gives the exit code.
///
/// # Errors
/// Anything else is bad input.
pub fn show(error: &clap::Error) -> Result<ExitCode, String> {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // Nobody is left to tell if this fails.
            let _ = error.print();
            Ok(ExitCode::from(if error.use_stderr() { BAD_INPUT } else { 0 }))
        }
        _ => Err(one_line(error)),
    }
}

/// `NAME=HEADER`.
///
/// # Errors
/// No `=`.
pub fn pair(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=HEADER, for instance q=q_m_sigma0.01")?;
    Ok((name.trim().into(), value.trim().into()))
}

/// `NAME=VALUE`.
///
/// # Errors
/// No `=`, or no finite number behind it.
pub fn value(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, for instance m0=0.005")?;
    let number = value.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let number = number.ok_or("the value must be a finite number, in the declared unit and without it")?;
    Ok((name.trim().into(), number))
}

/// How clouds are read, as `--unit` and `--camera` say.
pub(crate) fn view(unit: Option<LengthUnit>, file: Option<&Path>) -> Result<View, PrepareError> {
    Ok(View { unit, camera: file.map(camera).transpose()?, components: Vec::new() })
}
