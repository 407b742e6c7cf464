//! A scene over one coordinate, bound to rows as they come.

use std::time::SystemTime;

use nisp::schema::{Place, Portion};
use nisp::{FixedLagSmoother, LagSettings, Problem, Rest, RowColumn, SceneRef};
use nisp_data::Table;

use crate::entry::Entry;
use crate::error::PrepareError;
use crate::request::Request;
use crate::tables::{Clock, doubts, header, read};

/// How rows of a table become those of a scene.
#[derive(Clone)]
pub struct Record {
    scene: SceneRef,
    request: Request,
    /// What a row has, and whether the table has it.
    columns: Vec<(RowColumn, bool)>,
    /// Columns whose headers say no unit.
    unlabelled: Vec<&'static str>,
}

impl Record {
    /// For rows like those of a table, which may have none.
    ///
    /// # Errors
    /// A scene that cannot be followed, or a column, a scene or a parameter that does not fit.
    pub fn new(entry: &Entry, request: &Request, table: &Table) -> Result<Self, PrepareError> {
        let scene = entry.scene(request.scene.as_deref())?;
        crate::tables::check_columns(scene.schema, request)?;
        let record = Self { scene, request: request.clone(), columns: Vec::new(), unlabelled: Vec::new() };
        let smoother = FixedLagSmoother::new(record.problem(0.0)?, LagSettings::default())?;
        let is_there = |column: &RowColumn| {
            !column.may_lack
                || header(request, column.name, table).is_some()
                || !table.lacks(column.name, smoother.columns().iter().map(|own| own.name))
        };
        let mut columns: Vec<_> = smoother.columns().iter().map(|column| (*column, is_there(column))).collect();
        if columns.iter().all(|(_, is_there)| !is_there) {
            columns.iter_mut().for_each(|(_, is_there)| *is_there = true);
        }
        let is_unlabelled =
            |column: &&RowColumn| !table.says_unit(column.name, header(request, column.name, table), column.unit.text);
        let there = columns.iter().filter(|(_, is_there)| *is_there).map(|(column, _)| column);
        let unlabelled = there.filter(is_unlabelled).map(|column| column.name).collect();
        let record = Self { columns, unlabelled, ..record };
        record.cells(table)?;
        Ok(record)
    }

    /// What the rows measure nothing of.
    pub fn lacking(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.columns.iter().filter(|(_, is_there)| !is_there).map(|(column, _)| column.name)
    }

    /// What is to be asked about the units of rows, by where they would rest.
    ///
    /// # Errors
    /// The question of a column whose header says no unit.
    pub fn doubts(&self, rests: &[Rest]) -> Result<Vec<String>, PrepareError> {
        doubts(rests, &self.unlabelled)
    }

    /// What the user should know where places are given by dates, which are counted from a moment.
    pub fn dated(&self, table: &Table, begin: Option<SystemTime>) -> Option<String> {
        Clock { begin }.said(self.scene.schema, table, &self.request)
    }

    /// The place of a row, and its columns in declared units, NaN where nothing was measured.
    ///
    /// # Errors
    /// A cell that is no number.
    pub fn row(&self, table: &Table) -> Result<(f64, Vec<f64>), PrepareError> {
        let (places, columns) = self.cells(table)?;
        let first = |cells: Vec<f64>| cells.first().copied().unwrap_or(f64::NAN);
        Ok((first(places), columns.into_iter().map(first).collect()))
    }

    /// The place of a row, if it has one, whatever else is wrong with it.
    pub fn place(&self, table: &Table) -> Option<f64> {
        self.places(table).ok()?.first().copied()
    }

    fn places(&self, table: &Table) -> Result<Vec<f64>, PrepareError> {
        let axis = &self.scene.schema.coordinates[0];
        read(table, (axis.name, axis.unit.text), false, &self.request)
    }

    fn cells(&self, table: &Table) -> Result<(Vec<f64>, Vec<Vec<f64>>), PrepareError> {
        let places = self.places(table)?;
        let cells = self.columns.iter().map(|(column, is_there)| match is_there {
            true => read(table, (column.name, column.unit.text), column.may_lack, &self.request),
            false => Ok(Vec::new()),
        });
        Ok((places, cells.collect::<Result<_, _>>()?))
    }

    /// The problem of a record that begins at a place: its conditions of the start hold there.
    ///
    /// # Errors
    /// A parameter that does not fit, or a condition at the end.
    pub fn problem(&self, first: f64) -> Result<Problem, PrepareError> {
        let mut problem = Problem::new(self.scene);
        for (name, value) in &self.request.parameters {
            problem.set_parameter(name, *value)?;
        }
        for group in self.scene.schema.groups.iter().filter(|g| g.columns.is_empty() && !g.is_beliefs()) {
            match (group.name, group.place) {
                ("start", None) => problem.set_group(group.name, vec![first].into(), Vec::new())?,
                ("end", None) => return Err(PrepareError::Endless { group: group.name }),
                (_, None | Some(Place { portion: Portion::Inside, .. })) => {}
                (_, Some(_)) => return Err(PrepareError::Endless { group: group.name }),
            }
        }
        Ok(problem)
    }
}
