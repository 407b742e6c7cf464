//! What is true: to score an answer, and for nothing else.

use nisp::schema::Scene;
use nisp_data::{DataError, Table};

use crate::PrepareError;

/// True values of some heads at its own points.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Points, one after the other, in declared units: rising times, or places.
    pub points: Vec<f64>,
    /// Values by head, in the declared unit, one for each point.
    pub heads: Vec<(&'static str, Vec<f64>)>,
    /// How many rows were left out, being at times of which the data say nothing.
    pub outside: usize,
}

/// Under which headers a truth's quantities stand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Headers<'a> {
    /// Names and the headers that the user chose for them; the last word on a name counts.
    pub chosen: &'a [(String, String)],
    /// Names and what they are called where a column of their own name means something else.
    pub rather: &'a [(&'a str, &'a str)],
    /// Names and what else they are called.
    pub also: &'a [(&'a str, &'a str)],
}

impl Headers<'_> {
    /// The values of a quantity in a unit.
    ///
    /// # Errors
    /// No column, or no single one, answers to the name, or a cell is no number.
    pub fn read(&self, table: &Table, name: &str, unit: &str) -> Result<Vec<f64>, DataError> {
        if let Some((_, header)) = self.chosen.iter().rev().find(|(own, _)| own == name) {
            return table.chosen(name, header, unit);
        }
        if let Some((_, rather)) = self.rather.iter().find(|(own, _)| *own == name)
            && let Ok(values) = table.quantity(rather, unit)
        {
            return Ok(values);
        }
        match (table.quantity(name, unit), self.also.iter().find(|(own, _)| *own == name)) {
            (Err(DataError::Column { .. }), Some((_, also))) => table.quantity(also, unit),
            (found, _) => found,
        }
    }
}

impl Headers<'_> {
    /// Checks that a coordinate rises strictly, under whichever header it stands.
    fn require_increasing(&self, table: &Table, name: &str) -> Result<(), DataError> {
        let chosen = self.chosen.iter().rev().find(|(own, _)| own == name).map(|(_, header)| header.as_str());
        let also = self.also.iter().find(|(own, _)| *own == name).map(|(_, also)| *also);
        let own = chosen.or(also.filter(|_| !table.has(name)));
        table.require_increasing(own.unwrap_or(name))
    }
}

impl Truth {
    /// Reads whichever heads the table has; over one coordinate, where it is within `bounds`. A coordinate on which none of them
    /// depends may be missing: they are then looked at halfway between its bounds.
    ///
    /// # Errors
    /// A table without any of them, a cell that is no number, times that do not rise or are all outside.
    pub fn read(
        table: &Table,
        scene: &Scene,
        bounds: &[[f64; 2]],
        headers: Headers<'_>,
    ) -> Result<Truth, PrepareError> {
        let heads = heads(table, scene, headers)?;
        let is_needed = |axis: &usize| heads.iter().any(|(head, _)| scene.axes(*head).contains(axis));
        let coordinates = scene.coordinates.iter().enumerate().map(|(axis, coordinate)| {
            let read = headers.read(table, coordinate.name, coordinate.unit.text);
            match (read, bounds.get(axis)) {
                (Err(DataError::Column { .. }), Some([low, high])) if !is_needed(&axis) => {
                    Ok(vec![0.5 * (low + high); table.rows()])
                }
                (read, _) => read,
            }
        });
        let coordinates = coordinates.collect::<Result<Vec<_>, _>>()?;
        let inside = |row: usize| match bounds {
            // A time that was rounded on its way into a file still counts.
            [[first, last]] => {
                let slack = 1e-6 * (last - first);
                coordinates[0][row] >= first - slack && coordinates[0][row] <= last + slack
            }
            _ => true,
        };
        let kept: Vec<usize> = (0..table.rows()).filter(|&row| inside(row)).collect();
        if let [data] = *bounds {
            headers.require_increasing(table, scene.coordinates[0].name)?;
            if kept.is_empty() {
                let truth = [coordinates[0][0], coordinates[0][table.rows() - 1]];
                return Err(PrepareError::TruthRange { path: table.path().into(), truth, data });
            }
        }
        let keep = |values: Vec<f64>| kept.iter().map(|&row| values[row]).collect();
        let heads = heads.into_iter().map(|(head, values)| (scene.heads[head].name, keep(values))).collect();
        let points = kept.iter().flat_map(|&row| coordinates.iter().map(move |values| values[row])).collect();
        Ok(Truth { outside: table.rows() - kept.len(), points, heads })
    }

    /// The true values of a head, if they are known.
    pub fn of(&self, head: &str) -> Option<&[f64]> {
        self.heads.iter().find(|(name, _)| *name == head).map(|(_, values)| values.as_slice())
    }
}

/// The heads that a table has, by their numbers, with all of their values.
fn heads(table: &Table, scene: &Scene, headers: Headers<'_>) -> Result<Vec<(usize, Vec<f64>)>, PrepareError> {
    let read =
        scene.heads.iter().enumerate().filter_map(|(at, head)| match headers.read(table, head.name, head.unit.text) {
            Ok(values) => Some(Ok((at, values))),
            Err(DataError::Column { .. }) => None,
            Err(error) => Some(Err(error.into())),
        });
    let heads = read.collect::<Result<Vec<_>, PrepareError>>()?;
    if heads.is_empty() {
        let heads = scene.heads.iter().map(|head| head.name).collect::<Vec<_>>().join(", ");
        let columns = table.headers().collect::<Vec<_>>().join(", ");
        return Err(PrepareError::TruthHeads { path: table.path().into(), heads, columns });
    }
    Ok(heads)
}
