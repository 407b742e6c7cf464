//! Dates in tables: all of a problem are counted from one moment.

use std::time::SystemTime;

use nisp::schema::Scene;
use nisp_data::{Table, moment};

use super::header;
use crate::request::Request;

/// From when dates and times of day are counted: the earliest beginning of the tables of measurements, if any has dates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clock {
    pub(crate) begin: Option<SystemTime>,
}

impl Clock {
    pub(crate) fn of<'a>(tables: impl IntoIterator<Item = &'a Table>) -> Self {
        Self { begin: tables.into_iter().filter_map(Table::begins).min() }
    }

    /// Makes numbers of a table's dates.
    pub(crate) fn count(self, table: &mut Table) {
        if let Some(begin) = self.begin {
            table.count_from(begin);
        }
    }

    /// What the user should know, where a coordinate of a table is given by dates.
    pub(crate) fn said(self, schema: &Scene, table: &Table, request: &Request) -> Option<String> {
        let is_dated = |name: &str| table.is_dated(header(request, name, table).unwrap_or(name));
        let axis = schema.coordinates.iter().find(|axis| is_dated(axis.name))?;
        Some(format!("`{}` is given by dates or times of day, and counted from {}", axis.name, moment(self.begin?)))
    }
}
