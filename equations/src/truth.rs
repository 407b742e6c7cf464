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

impl Truth {
    /// Reads whichever heads the table has; over time, at its times within `range`.
    ///
    /// # Errors
    /// A table without any of them, a cell that is no number, times that do not rise or are all outside.
    pub fn read(
        table: &Table,
        scene: &Scene,
        range: Option<[f64; 2]>,
        headers: Headers<'_>,
    ) -> Result<Truth, PrepareError> {
        let coordinates = scene.coordinates.iter().map(|c| headers.read(table, c.name, c.unit.text));
        let coordinates = coordinates.collect::<Result<Vec<_>, _>>()?;
        let inside = |row: usize| match range {
            // A time that was rounded on its way into a file still counts.
            Some([first, last]) => {
                let slack = 1e-6 * (last - first);
                coordinates[0][row] >= first - slack && coordinates[0][row] <= last + slack
            }
            None => true,
        };
        let kept: Vec<usize> = (0..table.rows()).filter(|&row| inside(row)).collect();
        if let Some(data) = range {
            table.require_increasing(scene.coordinates[0].name)?;
            if kept.is_empty() {
                let truth = [coordinates[0][0], coordinates[0][table.rows() - 1]];
                return Err(PrepareError::TruthRange { path: table.path().into(), truth, data });
            }
        }
        let keep = |values: Vec<f64>| kept.iter().map(|&row| values[row]).collect();
        let mut heads = Vec::new();
        for head in scene.heads {
            match headers.read(table, head.name, head.unit.text) {
                Ok(values) => heads.push((head.name, keep(values))),
                Err(DataError::Column { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        if heads.is_empty() {
            let heads = scene.heads.iter().map(|head| head.name).collect::<Vec<_>>().join(", ");
            let columns = table.headers().collect::<Vec<_>>().join(", ");
            return Err(PrepareError::TruthHeads { path: table.path().into(), heads, columns });
        }
        let points = kept.iter().flat_map(|&row| coordinates.iter().map(move |values| values[row])).collect();
        Ok(Truth { outside: table.rows() - kept.len(), points, heads })
    }

    /// The true values of a head, if they are known.
    pub fn of(&self, head: &str) -> Option<&[f64]> {
        self.heads.iter().find(|(name, _)| *name == head).map(|(_, values)| values.as_slice())
    }
}
