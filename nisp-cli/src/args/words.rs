//! Options that are written as words of some form: a grid, a file for a group, a number of points.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{OsStringValueParser, TypedValueParser};

use crate::options::{count, whole};

/// A grid with more points is a slip.
const MOST_POINTS: usize = 10_000_000;

/// Points along each coordinate.
#[derive(Clone, Debug)]
pub(crate) struct Grid(pub(crate) Vec<usize>);

pub(super) fn grid(text: &str) -> Result<Grid, String> {
    let counts = text.split(['x', ',']).map(|part| count(part.trim())).collect::<Result<Vec<_>, _>>();
    let counts = counts.map_err(|_| "give whole numbers with `x` between them, for instance 200x100")?;
    match counts
        .iter()
        .try_fold(1_usize, |total, count| total.checked_mul(*count))
        .filter(|total| *total <= MOST_POINTS)
    {
        Some(_) => Ok(Grid(counts)),
        None => Err(format!("at most {MOST_POINTS} points in all")),
    }
}

/// A parser of [`data`], for paths that are no text too.
pub(super) fn data_parser() -> impl TypedValueParser<Value = (Option<String>, PathBuf)> {
    OsStringValueParser::new().try_map(data)
}

/// `FILE` or `GROUP=FILE`; what is no text is a file.
pub(super) fn data(word: OsString) -> Result<(Option<String>, PathBuf), String> {
    let Some(text) = word.to_str() else { return Ok((None, word.into())) };
    let is_name =
        |name: &str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
    match text.split_once('=').map(|(group, path)| (group.trim(), path.trim())) {
        Some((group, "")) if is_name(group) => Err(format!("no file behind `{group}=`")),
        Some((group, path)) if is_name(group) => Ok((Some(group.into()), path.into())),
        _ => Ok((None, text.into())),
    }
}

pub(super) fn points(text: &str) -> Result<(String, usize), String> {
    let (group, number) = text.split_once('=').ok_or("write GROUP=N, for instance inside=4000")?;
    Ok((group.trim().into(), whole(number.trim(), MOST_POINTS)?))
}
