//! `checkpoint.nisp` in a folder of results: written now and then, and read for `--resume`.

use std::path::Path;
use std::time::Instant;

use crate::interrupt;
use nisp::{Checkpoint, Report};
use nisp_data::OutDir;
use nisp_data::input::read_bytes;

/// Name of the file.
pub(crate) const NAME: &str = "checkpoint.nisp";

/// Bytes of one at most: the largest networks that fit into memory stay below.
const MOST_BYTES: u64 = 4 << 30;
/// Seconds from one to the next, at least.
const INTERVAL: f64 = 5.0;
/// Share of the time that keeping may take.
const SHARE: f64 = 0.02;

/// The checkpoint of a folder.
pub(crate) fn read(folder: &Path) -> Result<Checkpoint, String> {
    let path = folder.join(NAME);
    let bytes = read_bytes(&path, MOST_BYTES).map_err(|error| {
        format!("--resume: {error}; name the folder of a run with --checkpoint, or of one that Ctrl-C ended")
    })?;
    Checkpoint::from_bytes(&bytes).map_err(|error| format!("{}: {error}", path.display()))
}

/// Keeps checkpoints while a run goes on: in memory, for a run that must end early, and in the folder if that was asked for.
pub(crate) struct Keeper<'a> {
    out: &'a OutDir,
    /// Whether to write them.
    write: bool,
    /// When the next is due.
    due: f64,
    /// Why the last could not be written.
    pub(crate) failure: Option<String>,
}

impl<'a> Keeper<'a> {
    pub(crate) fn new(out: &'a OutDir, write: bool) -> Self {
        Self { out, write, due: 0.0, failure: None }
    }

    /// Keeps one if it is due. A full disk is no reason to stop the run.
    pub(crate) fn see(&mut self, report: &Report<'_>) {
        if report.elapsed_s < self.due {
            return;
        }
        let began = Instant::now();
        let checkpoint = (report.checkpoint)();
        if self.write && report.elapsed_s >= INTERVAL {
            let files = [(NAME, checkpoint.to_bytes())];
            let written = interrupt::placing(|| self.out.write(&files));
            self.failure = written.err().map(|error| error.to_string());
        }
        interrupt::keep(self.out.file(NAME), checkpoint);
        self.due = report.elapsed_s + INTERVAL.max(began.elapsed().as_secs_f64() / SHARE);
    }
}
