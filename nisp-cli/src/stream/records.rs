//! Records, row by row.

use std::fs::File;
use std::io::{BufRead, BufReader, stdin};
use std::path::Path;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

use crate::interrupt;
use crate::terminal::{NOT_CONVERGED, note};
use nisp::schema::{Head, Origin, Scene};
use nisp::{FixedLagSmoother, LagSettings, LiveError, Smoothed};
use nisp_data::Rows;
use nisp_equations::{Entry, Record, Request};
use serde_json::{Map, Value, json};

use super::clouds::not_written;
use super::line;
use crate::args::stream::StreamOptions;

/// Rows that are read ahead of the one at hand.
const AHEAD: usize = 1024;
/// How often a signal is looked for while no row comes.
const LOOK: Duration = Duration::from_millis(50);

/// Rows that rise behind the last one, of which it is said that a clock was set back.
const SET_BACK: usize = 20;

/// A row: its place and its columns.
type Row = Result<(f64, Vec<f64>), Wrong>;

/// What is wrong with a row, and its place if it has one.
type Wrong = (String, Option<f64>);

/// Answers every row.
pub(super) fn follow(entry: &Entry, options: &StreamOptions) -> Result<ExitCode, String> {
    if let Some(option) = options.about_clouds() {
        return Err(format!("{option} is about clouds, and `{}` is measured in rows: leave it out", entry.name));
    }
    let scene = entry.scene(options.scene.as_deref()).map_err(|error| error.to_string())?.schema;
    let request = Request {
        scene: options.scene.clone(),
        columns: options.column.clone(),
        parameters: options.set.clone(),
        ..Request::default()
    };
    let (name, input): (&Path, Box<dyn BufRead + Send>) = match &options.from.data {
        None => (Path::new("standard input"), Box::new(BufReader::new(stdin()))),
        Some(path) => {
            let file = File::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
            (path, Box::new(BufReader::new(file)))
        }
    };
    let rows = Rows::read(name, input).map_err(|error| error.to_string())?;
    let record = Record::new(entry, &request, rows.first()).map_err(|error| error.to_string())?;
    for name in record.lacking() {
        say(&format!("`{name}` is not measured: no column answers to it"));
    }
    record.dated(rows.first(), rows.begin()).iter().for_each(|words| say(words));
    let (sender, came) = sync_channel(AHEAD);
    let bring = {
        let record = record.clone();
        move || bring(rows, &record, &sender)
    };
    Builder::new().name("rows".into()).spawn(bring).map_err(|error| format!("cannot start a thread: {error}"))?;
    let mut answers = Answers {
        scene,
        settings: LagSettings { lag: options.lag, ..LagSettings::default() },
        smoother: None,
        is_asked: false,
        behind: Vec::new(),
    };
    match answers.follow(&record, &came)? {
        Ended::NotWritten(message) => Ok(not_written(&message)),
        Ended::Open(message) => {
            say(&message);
            Ok(ExitCode::from(NOT_CONVERGED))
        }
        Ended::Read => Ok(ExitCode::SUCCESS),
    }
}

fn say(message: &str) {
    note(&format!("{message}\n"));
}

/// Reads rows until they end or nobody wants any more.
fn bring(mut rows: Rows<Box<dyn BufRead + Send>>, record: &Record, place: &SyncSender<(Instant, Row)>) {
    while let Some(row) = rows.next_row() {
        let came = Instant::now();
        let row = match row {
            Ok(row) => record.row(row).map_err(|error| (error.to_string(), record.place(row))),
            Err(error) => Err((error.to_string(), None)),
        };
        if place.send((came, row)).is_err() {
            return;
        }
    }
}

/// A smoother of a record whose first row is at a place.
fn begun(record: &Record, at: f64, settings: LagSettings) -> Result<FixedLagSmoother, String> {
    let problem = record.problem(at).map_err(|error| error.to_string())?;
    FixedLagSmoother::new(problem, settings).map_err(|error| error.to_string())
}

/// What is wrong with a row that was taken for one far ahead.
fn far_ahead(smoother: &mut FixedLagSmoother) -> Option<Wrong> {
    let place = smoother.left_out()?;
    Some((format!("{place} is far ahead of the rows beside it; the row is left out"), Some(place)))
}

/// How a stream ended.
enum Ended {
    /// Its rows have, or the user asked to stop, or nobody reads answers any more.
    Read,
    NotWritten(String),
    /// No answer can be given.
    Open(String),
}

/// Answers under way.
struct Answers {
    scene: &'static Scene,
    settings: LagSettings,
    /// From the first row on.
    smoother: Option<FixedLagSmoother>,
    /// Whether the units of the first rows have been looked at.
    is_asked: bool,
    /// Rows that do not come after the last one, as far as they rise.
    behind: Vec<(f64, Vec<f64>)>,
}

impl Answers {
    /// Takes rows until they end.
    ///
    /// # Errors
    /// Parameters that do not fit, or rows that seem to be in another unit under a header without one.
    fn follow(&mut self, record: &Record, rows: &Receiver<(Instant, Row)>) -> Result<Ended, String> {
        loop {
            let (row, is_live) = match rows.recv_timeout(LOOK) {
                Err(RecvTimeoutError::Timeout) if !interrupt::asked() => continue,
                Ok(row) if !interrupt::asked() => (Some(row.1), true),
                _ => (None, false),
            };
            // Rows of a file wait for their turn.
            let start = Instant::now();
            let (wrong, found) = match (row, &mut self.smoother) {
                (Some(Err(wrong)), _) => (Some(wrong), Vec::new()),
                (Some(Ok((at, values))), smoother) => {
                    let smoother = match smoother {
                        Some(smoother) => smoother,
                        None => self.smoother.insert(begun(record, at, self.settings)?),
                    };
                    match smoother.push(at, &values) {
                        Ok(found) => {
                            self.behind.clear();
                            (far_ahead(smoother), found)
                        }
                        Err(error @ LiveError::Backwards { .. }) => {
                            let found = self.behind(record, (at, values))?;
                            (Some((error.to_string(), Some(at))), found)
                        }
                        Err(error) if error.is_of_row() => (Some((error.to_string(), Some(at))), Vec::new()),
                        Err(error) => return Ok(Ended::Open(error.to_string())),
                    }
                }
                (None, Some(smoother)) => match smoother.finish() {
                    Ok(found) => (far_ahead(smoother), found),
                    Err(error) => return Ok(Ended::Open(error.to_string())),
                },
                (None, None) => return Ok(Ended::Open("there was no row; give some below the header".into())),
            };
            if !found.is_empty() && !std::mem::replace(&mut self.is_asked, true) {
                let rests = self.smoother.as_mut().and_then(FixedLagSmoother::rests).unwrap_or_default();
                let doubts = record.doubts(&rests).map_err(|error| error.to_string())?;
                doubts.iter().for_each(|doubt| say(&format!("warning: {doubt}")));
            }
            let wrong = wrong.map(
                |(error, place)| json!({ "status": "error", "error": error, self.scene.coordinates[0].name: place }),
            );
            let lines = wrong.into_iter().chain(found.iter().map(|found| self.line(found)));
            let took = 1e3 * start.elapsed().as_secs_f64();
            for mut line in lines {
                line["latency_ms"] = took.into();
                match line::print(&line) {
                    Ok(true) => {}
                    Ok(false) => return Ok(Ended::Read),
                    Err(message) => return Ok(Ended::NotWritten(message)),
                }
            }
            if !is_live {
                return Ok(Ended::Read);
            }
        }
    }

    /// Keeps a row that does not come after the last one. Where so many of these rise that a clock was set back, the record begins anew with
    /// them, and the rows that still waited are answered.
    ///
    /// # Errors
    /// Parameters that do not fit, or rows that nothing can be said of.
    fn behind(&mut self, record: &Record, row: (f64, Vec<f64>)) -> Result<Vec<Smoothed>, String> {
        if self.behind.last().is_some_and(|last| last.0 >= row.0) {
            self.behind.clear();
        }
        self.behind.push(row);
        if self.behind.len() < SET_BACK {
            return Ok(Vec::new());
        }
        let rows = std::mem::take(&mut self.behind);
        let (name, first) = (self.scene.coordinates[0].name, rows[0].0);
        say(&format!(
            "{SET_BACK} rows rise from `{name}` = {first} on, behind those before: the clock was set back, and the record begins anew with them"
        ));
        let mut found = match &mut self.smoother {
            Some(before) => before.finish().map_err(|error| error.to_string())?,
            None => Vec::new(),
        };
        let new = self.smoother.insert(begun(record, first, self.settings)?);
        for (at, values) in rows {
            found.extend(new.push(at, &values).map_err(|error| error.to_string())?);
        }
        Ok(found)
    }

    /// The members of a row's line.
    fn line(&self, found: &Smoothed) -> Value {
        let of = |source: bool| -> Map<String, Value> {
            let heads = self.scene.heads.iter().zip(&found.heads).filter(|(head, _)| head.source == source);
            let member = |(head, (value, sd)): (&Head, &(f64, f64))| {
                // The bar of a row whose data are missed would assume that equations and data agree.
                let sd = found.is_sound().then_some(sd);
                (head.name.into(), json!({ "value": value, "sd": sd }))
            };
            heads.map(member).collect()
        };
        let mut line = json!({
            self.scene.coordinates[0].name: found.at,
            "lag": found.lag,
            "status": if found.is_sound() { "converged" } else { "inconsistent" },
            "sources": of(true),
            "state": of(false),
            "misfit": found.misfit,
            "nearby": found.nearby,
            "bend": found.bend,
        });
        let learned = self.scene.scalars.iter().filter(|scalar| matches!(scalar.origin, Origin::Learned { .. }));
        let learned: Map<String, Value> = learned
            .zip(&found.learned)
            .map(|(scalar, (value, sd))| {
                let sd = found.is_sound().then_some(sd);
                (scalar.name.into(), json!({ "value": value, "sd": sd }))
            })
            .collect();
        if !learned.is_empty() {
            line["learned"] = learned.into();
        }
        if found.is_stray {
            line["stray"] = json!(true);
        }
        if found.is_held {
            line["held"] = json!(true);
        }
        if found.leaning > 0.0 {
            line["leaning"] = json!(found.leaning);
        }
        if found.beyond > 0.0 {
            line["beyond"] = json!(found.beyond);
        }
        if found.given > 0.0 {
            line["given"] = json!(found.given);
        }
        if let Some(doubt) = &found.doubt {
            line["doubt"] = json!(doubt);
        }
        line
    }
}
