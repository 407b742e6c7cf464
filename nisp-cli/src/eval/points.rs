//! Where a saved answer is wanted.

use std::time::SystemTime;

use nisp::OpenAnswer;
use nisp_data::Table;

use crate::args::EvalOptions;

/// The points of a table, whose dates are counted from `begin`, or of a grid as far as the answer holds there; point by point, in
/// declared units.
pub(super) fn wanted(
    answer: &OpenAnswer,
    begin: Option<SystemTime>,
    options: &EvalOptions,
) -> Result<Vec<f64>, String> {
    let coordinates = answer.scene().coordinates;
    if let Some((name, _)) = options.column.iter().find(|(name, _)| coordinates.iter().all(|c| c.name != name)) {
        return Err(format!("--column: there is no coordinate `{name}`; there are: {}", names(answer)));
    }
    if let Some(path) = &options.place.at {
        let mut table = Table::read_places(path).map_err(|error| error.to_string())?;
        let header =
            |name: &str| options.column.iter().rev().find(|(own, _)| own == name).map(|(_, header)| header.as_str());
        if let Some(begin) = begin {
            table.count_from(begin);
        }
        let is_dated = |name: &str| table.is_dated(header(name).unwrap_or(name));
        if let Some(axis) = coordinates.iter().find(|axis| begin.is_none() && is_dated(axis.name)) {
            let (path, name, unit) = (path.display(), axis.name, axis.unit.text);
            return Err(format!(
                "{path}: `{name}` is given by dates, and the answer does not know from when it was counted: write {unit} as in its data"
            ));
        }
        let axis = |name: &str, unit: &str| match header(name) {
            Some(header) => table.chosen(name, header, unit),
            None => table.quantity(name, unit),
        };
        let axes = coordinates.iter().map(|c| axis(c.name, c.unit.text)).collect::<Result<Vec<_>, _>>();
        let axes = axes.map_err(|error| error.to_string())?;
        return Ok((0..table.rows()).flat_map(|row| axes.iter().map(move |axis| axis[row])).collect());
    }
    let counts = options.place.grid.as_ref().map_or(&[][..], |grid| &grid.0);
    if counts.len() != coordinates.len() {
        let (given, names) = (counts.len(), names(answer));
        return Err(format!("--grid has {given} numbers; give one for each of the coordinates {names}"));
    }
    Ok(grid(answer, counts))
}

/// The names of the coordinates.
fn names(answer: &OpenAnswer) -> String {
    answer.scene().coordinates.iter().map(|c| c.name).collect::<Vec<_>>().join(", ")
}

/// A grid over the ranges of the answer, the first coordinate running fastest; a single point along a coordinate lies in the
/// middle of its range.
fn grid(answer: &OpenAnswer, counts: &[usize]) -> Vec<f64> {
    let point = |index: usize| -> Vec<f64> {
        let mut rest = index;
        let along = counts.iter().zip(answer.ranges()).map(|(count, [low, high])| {
            let at = rest % count;
            rest /= count;
            let (before, after) = if *count > 1 { (at, count - 1 - at) } else { (1, 1) };
            // Exact at both ends.
            (after as f64 * low + before as f64 * high) / (before + after) as f64
        });
        along.collect()
    };
    (0..counts.iter().product()).map(point).filter(|point| answer.contains(point)).flatten().collect()
}

/// The ranges in which an answer holds, in words.
pub(super) fn ranges(answer: &OpenAnswer) -> String {
    let coordinates = answer.scene().coordinates.iter().zip(answer.ranges());
    let range = |(c, [low, high]): (&nisp::schema::Coordinate, &[f64; 2])| {
        format!("{} = {} to {} {}", c.name, short(*low), short(*high), c.unit.text).trim_end().to_string()
    };
    coordinates.map(range).collect::<Vec<_>>().join(", ")
}

/// Six digits at most.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
