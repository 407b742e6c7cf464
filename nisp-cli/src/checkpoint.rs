//! `checkpoint.nisp` in a folder of results: written now and then, and read for `--resume`.

use std::path::Path;

use nisp::{Checkpoint, Report};
use nisp_data::OutDir;

/// Name of the file.
pub(crate) const NAME: &str = "checkpoint.nisp";

/// Seconds from one to the next, at least.
const INTERVAL: f64 = 5.0;
/// Share of the time that writing may take.
const SHARE: f64 = 0.02;

/// The checkpoint of a folder.
pub(crate) fn read(folder: &Path) -> Result<Checkpoint, String> {
    let path = folder.join(NAME);
    let bytes = std::fs::read(&path).map_err(|error| {
        let advice = "name the folder of a run with --checkpoint, or of one that Ctrl-C ended";
        format!("--resume {}: {NAME}: {error}; {advice}", folder.display())
    })?;
    Checkpoint::from_bytes(&bytes).map_err(|error| format!("{}: {error}", path.display()))
}

/// Writes checkpoints while a run goes on.
pub(crate) struct Keeper<'a> {
    out: &'a mut OutDir,
    /// When the next is due.
    due: f64,
    /// Why the last could not be written.
    pub(crate) failure: Option<String>,
}

impl<'a> Keeper<'a> {
    pub(crate) fn new(out: &'a mut OutDir) -> Self {
        Self { out, due: INTERVAL, failure: None }
    }

    /// Writes one if it is due. A full disk is no reason to stop the run.
    pub(crate) fn see(&mut self, report: &Report<'_>) {
        if report.elapsed_s < self.due {
            return;
        }
        let began = std::time::Instant::now();
        let written = self.out.write(&[(NAME, (report.checkpoint)().to_bytes())]);
        self.failure = written.err().map(|error| error.to_string());
        self.due = report.elapsed_s + INTERVAL.max(began.elapsed().as_secs_f64() / SHARE);
    }
}
