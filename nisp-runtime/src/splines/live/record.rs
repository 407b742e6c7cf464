//! Rows of a record, and stretches of them as problems of their own.

use std::marker::PhantomData;

use super::alone;
use super::event::Event;
use super::{LiveError, RowColumn};
use crate::network::Inputs;
use crate::problem::{Bound, Problem};
use crate::schema::{Group, TermKind};
use crate::units::{Declared, Engine, Number, Scale};

/// Places of an equation that stand for a whole stretch.
const ALONG: usize = 32;

/// A row of a record, in the units of a frame.
#[derive(Clone, Debug)]
pub(super) struct MeasuredRow<Frame> {
    pub(super) at: f64,
    /// All columns of all measured groups, one after the other.
    pub(super) values: Vec<f64>,
    /// Whether what is observed there does not count.
    pub(super) is_stray: bool,
    frame: PhantomData<Frame>,
}

/// How rows come to the engine.
pub(super) struct Inward {
    /// Of the coordinate.
    pub(super) at: Scale<Declared, Engine>,
    /// Of each column.
    pub(super) values: Vec<Scale<Declared, Engine>>,
}

impl MeasuredRow<Declared> {
    pub(super) fn new(at: f64, values: &[f64]) -> Self {
        Self { at, values: values.to_vec(), is_stray: false, frame: PhantomData }
    }

    pub(super) fn inward(&self, inward: &Inward) -> MeasuredRow<Engine> {
        let values = self.values.iter().zip(&inward.values);
        MeasuredRow {
            at: inward.at.of(Number::declared(self.at)).as_engine(),
            values: values.map(|(&x, inward)| inward.of(Number::declared(x)).as_engine()).collect(),
            is_stray: self.is_stray,
            frame: PhantomData,
        }
    }
}

impl MeasuredRow<Engine> {
    pub(super) fn outward(&self, inward: &Inward) -> MeasuredRow<Declared> {
        let values = self.values.iter().zip(&inward.values);
        MeasuredRow {
            at: inward.at.inverse().of(Number::engine(self.at)).as_declared(),
            values: values.map(|(&x, inward)| inward.inverse().of(Number::engine(x)).as_declared()).collect(),
            is_stray: self.is_stray,
            frame: PhantomData,
        }
    }
}

/// What of a scene's groups comes with rows, holds everywhere, or at a place.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Groups with columns, and where their columns begin in a row.
    measured: Vec<(usize, usize)>,
    /// Groups of equations that hold everywhere.
    pub(super) continuous: Vec<usize>,
    pub(super) columns: Vec<RowColumn>,
}

impl Layout {
    /// Groups without columns to which the problem has no points yet hold everywhere.
    pub(super) fn of(problem: &Problem) -> Result<Self, LiveError> {
        let schema = problem.scene().schema;
        let (mut measured, mut continuous, mut columns) = (Vec::new(), Vec::new(), Vec::new());
        for (at, group) in schema.groups.iter().enumerate().filter(|(_, group)| !group.is_beliefs()) {
            if !group.columns.is_empty() {
                measured.push((at, columns.len()));
                columns.extend(group.columns.iter().map(|column| RowColumn {
                    group: group.name,
                    name: column.name,
                    unit: column.unit,
                    may_lack: group.may_lack(column.name),
                }));
            } else if problem.group(group.name).is_none() {
                continuous.push(at);
            }
        }
        let is_observed = |group: &Group| group.terms.iter().any(|term| term.kind == TermKind::Observation);
        if !measured.iter().any(|(at, _)| is_observed(&schema.groups[*at])) {
            return Err(LiveError::NoRows);
        }
        Ok(Self { measured, continuous, columns })
    }

    /// The columns that are observed.
    pub(super) fn observed(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.columns.len()).filter(|&column| self.columns[column].may_lack)
    }

    /// Whether what is observed in a column is a state.
    pub(super) fn is_state(&self, problem: &Problem, column: usize) -> bool {
        let schema = problem.scene().schema;
        let Some((group, own)) = self.place_of(column) else { return false };
        let mut readers = schema.groups[group].terms.iter().filter(|term| term.columns.contains(&own));
        readers.all(|term| schema.reads_states(group, term))
    }

    /// The group of a column, and its number there.
    pub(super) fn place_of(&self, column: usize) -> Option<(usize, usize)> {
        let (group, first) = self.measured.iter().rfind(|(_, first)| *first <= column)?;
        Some((*group, column - first))
    }

    /// The events of a row: one for every group of which something was measured.
    pub(super) fn events<'a, Frame>(&'a self, row: &'a MeasuredRow<Frame>) -> impl Iterator<Item = Event> + 'a {
        let ends = self.measured.iter().skip(1).map(|(_, first)| *first).chain([self.columns.len()]);
        self.measured.iter().zip(ends).filter_map(|(&(group, first), end)| {
            let columns = &row.values[first..end];
            let is_there = columns.iter().any(|x| !x.is_nan());
            is_there.then(|| Event { group, at: row.at, columns: columns.to_vec(), is_stray: row.is_stray })
        })
    }

    /// Finds the rows that are strays by their neighbours alone. Columns that equations read are what they are.
    pub(super) fn mark_strays(&self, rows: &mut [MeasuredRow<Declared>]) {
        rows.iter_mut().for_each(|row| row.is_stray = false);
        for column in self.observed() {
            let there: Vec<usize> = (0..rows.len()).filter(|&row| !rows[row].values[column].is_nan()).collect();
            let values: Vec<(f64, f64)> = there.iter().map(|&row| (rows[row].at, rows[row].values[column])).collect();
            alone::strays(&values).into_iter().for_each(|stray| rows[there[stray]].is_stray = true);
        }
    }

    /// A row without what was observed at a stray.
    fn counted<Frame>(&self, row: &MeasuredRow<Frame>) -> MeasuredRow<Frame> {
        let counts =
            |(value, column): (&f64, &RowColumn)| if row.is_stray && column.may_lack { f64::NAN } else { *value };
        MeasuredRow { values: row.values.iter().zip(&self.columns).map(counts).collect(), ..*row }
    }

    /// The problem of the first rows, bound.
    pub(super) fn bound(&self, problem: &Problem, rows: &[MeasuredRow<Declared>]) -> Result<Bound, LiveError> {
        Ok(self.problem(problem, rows)?.bound(Inputs::Automatic)?)
    }

    /// The problem of the first rows.
    pub(super) fn problem(&self, problem: &Problem, rows: &[MeasuredRow<Declared>]) -> Result<Problem, LiveError> {
        let schema = problem.scene().schema;
        let mut problem = problem.clone();
        for &group in &self.continuous {
            problem.set_group(schema.groups[group].name, along(rows).into(), Vec::new())?;
        }
        for &(group, _) in &self.measured {
            let (places, columns) = self.table(group, rows);
            problem.set_group(schema.groups[group].name, places.into(), columns)?;
        }
        Ok(problem)
    }

    /// A later stretch of a record whose first rows are bound, in the same units and with the same scales.
    pub(super) fn stretch(&self, first: &Bound, rows: &[MeasuredRow<Engine>]) -> Bound {
        let (low, high) = (rows[0].at, rows[rows.len() - 1].at);
        let mut bound = first.between(low, high);
        for &group in &self.continuous {
            bound.coordinates[group] = along(rows);
        }
        for &(group, _) in &self.measured {
            (bound.coordinates[group], bound.columns[group]) = self.table(group, rows);
        }
        bound
    }

    /// Every group of observations, with the numbers of the rows that its table has.
    pub(super) fn rows_of_groups<Frame>(&self, rows: &[MeasuredRow<Frame>]) -> Vec<(usize, Vec<usize>)> {
        let counted: Vec<MeasuredRow<Frame>> = rows.iter().map(|row| self.counted(row)).collect();
        let has = |row: usize, group: usize| self.events(&counted[row]).any(|event| event.group == group);
        let own = |group| (0..rows.len()).filter(|&row| has(row, group)).collect();
        self.measured.iter().map(|&(group, _)| (group, own(group))).collect()
    }

    /// Places and columns of a group, of the rows in which something of it was measured and counts.
    fn table<Frame>(&self, group: usize, rows: &[MeasuredRow<Frame>]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let rows: Vec<MeasuredRow<Frame>> = rows.iter().map(|row| self.counted(row)).collect();
        let own: Vec<Event> = rows.iter().flat_map(|row| self.events(row)).filter(|e| e.group == group).collect();
        let count = own.first().map_or(0, |event| event.columns.len());
        let column = |column: usize| own.iter().map(|event| event.columns[column]).collect();
        (own.iter().map(|event| event.at).collect(), (0..count).map(column).collect())
    }
}

fn along<Frame>(rows: &[MeasuredRow<Frame>]) -> Vec<f64> {
    let (low, high) = (rows[0].at, rows[rows.len() - 1].at);
    (0..ALONG).map(|i| low + (high - low) * i as f64 / (ALONG - 1) as f64).collect()
}
