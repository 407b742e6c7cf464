//! What a run says of itself: a table for people, one JSON object for programs.

mod json;
mod table;

use std::path::Path;

use nisp::Settings;
use nisp_data::Written;
use nisp_equations::Prepared;

use crate::args::Options;
use crate::results::Answer;
use crate::rivals::Rivals;

pub(crate) use json::{json, learned, patch, status};
pub(crate) use table::table;

/// A run, beside its solution.
pub(crate) struct Run<'a> {
    pub(crate) options: &'a Options,
    pub(crate) settings: &'a Settings,
    pub(crate) prepared: &'a Prepared,
    pub(crate) answer: &'a Answer,
    pub(crate) written: &'a Written,
    /// All of them, one line each.
    pub(crate) warnings: Vec<String>,
    /// What classical methods find, where they were asked for.
    pub(crate) rivals: Option<Rivals>,
}

impl Run<'_> {
    /// Which files were written, and where; if they could not be written where it was asked for, why.
    fn files_in_words(&self) -> String {
        let names: Vec<_> = self.answer.files.iter().map(|(name, _)| *name).collect();
        let (last, others) = names.split_last().unwrap_or((&"", &[]));
        let names = format!("{} and {last}", others.join(", "));
        let to = |folder: &Path| format!("wrote {names} to {}", folder.display());
        match (&self.written.folder, &self.written.fault) {
            (Some(folder), None) => to(folder),
            (Some(folder), Some(fault)) => format!("{}, because {fault}", to(folder)),
            (None, Some(fault)) => format!("no folder could be written, so the tables follow: {fault}"),
            (None, None) => "no files".into(),
        }
    }

    /// The tables themselves, where no folder took them.
    fn tables(&self) -> String {
        let lost = self.written.folder.is_none();
        let tables = self.answer.files.iter().filter(|(name, _)| lost && name.ends_with(".csv"));
        tables.map(|(name, bytes)| format!("\n{name}\n{}", String::from_utf8_lossy(bytes))).collect()
    }
}
