//! Contacts, cloud by cloud.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use crate::terminal::{BAD_INPUT, NOT_WRITTEN, note};
use crate::{interrupt, processors};
use nisp::solve::driver::Flow;
use nisp::{RecoverError, Session, Settings, Solution};
use nisp_data::Cloud;
use nisp_data::atomic::write_atomic;
use nisp_equations::Frames;
use nisp_equations::{Contact, Entry, PrepareError, Prepared, Request};
use serde_json::{Value, json};

use super::input::{self, Frame};
use super::line::{self, Head};
use crate::args::stream::StreamOptions;
use crate::options::view;
use crate::report::{learned, patch, status};
use crate::results::contact_map;

/// Cells of the lattice along the body, fewer than a single answer has: steps take a third of the time.
const CELLS: usize = 40;

/// Answers every frame.
pub(super) fn follow(entry: &Entry, options: &StreamOptions) -> Result<ExitCode, String> {
    if let Some(folder) = &options.maps {
        std::fs::create_dir_all(folder).map_err(|error| format!("--maps {}: {error}", folder.display()))?;
    }
    let start = Instant::now();
    let view = view(options.unit, options.camera.as_deref()).map_err(|error| error.to_string())?;
    let frames = input::frames(&options.from, view)?;
    let mut sensor = None;
    let (mut answered, mut refused) = (0, 0);
    while let Some((frame, dropped)) = frames.take() {
        let Frame { name, came, parameters, cloud, live } = frame;
        // What was recorded waits for its turn.
        let came = if live { came } else { Instant::now() };
        let seen = match cloud {
            Ok(cloud) => see(&mut sensor, entry, options, (&name, parameters, cloud))?,
            Err(error) => Err(error),
        };
        *(if seen.is_ok() { &mut answered } else { &mut refused }) += 1;
        let head = Head {
            frame: &name,
            t: (came - start).as_secs_f64(),
            dropped,
            latency_ms: 1e3 * came.elapsed().as_secs_f64(),
        };
        let drawn = options.maps.as_ref().filter(|_| seen.is_ok());
        let mut line = line::line(&head, seen);
        if let (Some(folder), Some(sensor)) = (drawn, &mut sensor) {
            match sensor.map(folder, &name) {
                Ok(path) => line["map"] = path.into(),
                Err(message) => return Ok(not_written(&message)),
            }
        }
        match line::print(&line) {
            Ok(true) => {}
            Ok(false) => break,
            Err(message) => return Ok(not_written(&message)),
        }
    }
    // Frames of which none is one are bad input, as a single one is.
    Ok(ExitCode::from(if answered == 0 && refused > 0 { BAD_INPUT } else { 0 }))
}

pub(super) fn not_written(message: &str) -> ExitCode {
    note(&format!("{message}\n"));
    ExitCode::from(NOT_WRITTEN)
}

/// The members of a frame's line, or what is wrong with the frame. The first good one shows what the sensor is.
///
/// # Errors
/// Options that do not fit.
fn see(
    sensor: &mut Option<Sensor>,
    entry: &Entry,
    options: &StreamOptions,
    (name, parameters, cloud): (&str, Vec<(String, f64)>, Cloud),
) -> Result<Result<Value, String>, String> {
    if sensor.is_none() {
        match Sensor::new(entry, options, (name, &parameters, &cloud)) {
            Ok(Some(found)) => *sensor = Some(found),
            Ok(None) => {
                return Err(format!("`{}` cannot be followed: every frame has data beside its cloud", entry.name));
            }
            Err(Fault::Prepare(error)) if error.is_of(Path::new(name)) => return Ok(Err(error.to_string())),
            Err(error) => return Err(error.to_string()),
        }
    }
    let Some(sensor) = sensor else { return Ok(Err("no frame has shown the sensor yet".into())) };
    Ok(sensor.see(name, &parameters, cloud))
}

/// Why there is no sensor.
#[derive(Debug, thiserror::Error)]
enum Fault {
    /// Options or a frame that do not fit.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A session that cannot begin.
    #[error(transparent)]
    Session(#[from] RecoverError),
}

/// A body whose clouds are answered one after the other.
struct Sensor {
    prepared: Prepared,
    frames: Frames,
    contact: Contact,
    session: Session,
}

impl Sensor {
    /// A sensor as options and a frame describe it; nothing where clouds alone are not enough.
    fn new(
        entry: &Entry,
        options: &StreamOptions,
        (name, parameters, cloud): (&str, &[(String, f64)], &Cloud),
    ) -> Result<Option<Self>, Fault> {
        let request = Request {
            scene: options.scene.clone(),
            frame: Some((PathBuf::from(name), cloud.clone())),
            sample: options.sample.clone(),
            calibration: options.calibration.clone(),
            cells: Some(CELLS),
            parameters: [&options.set, parameters].concat(),
            ..Request::default()
        };
        let mut prepared = entry.prepare(&request)?;
        let settings = prepared.suited(Settings {
            budget: Some(Duration::from_secs_f64(options.budget)),
            threads: options.threads.unwrap_or_else(processors),
            ..Settings::default()
        });
        let (Some(frames), Some(contact)) = (prepared.frames.take(), prepared.contact.take()) else { return Ok(None) };
        let session = Session::new(prepared.problem.clone(), settings)?;
        Ok(Some(Self { prepared, frames, contact, session }))
    }

    /// Answers a frame. Parameters hold until a later frame has others.
    fn see(&mut self, name: &str, parameters: &[(String, f64)], cloud: Cloud) -> Result<Value, String> {
        self.prepared.source = name.into();
        for (parameter, value) in parameters {
            self.session.problem().set_parameter(parameter, *value).map_err(|error| error.to_string())?;
        }
        let cloud = self.frames.bind(self.session.problem(), Path::new(name), cloud);
        let cloud = cloud.map_err(|error| error.to_string())?;
        let stop = || if interrupt::asked() { Flow::Stop } else { Flow::Continue };
        let solution = self.session.update(&mut |_| stop()).map_err(|error| error.to_string())?;
        self.contact.cloud = cloud.points;
        Ok(members(solution, &self.contact))
    }

    /// Draws the last answer.
    fn map(&mut self, folder: &Path, name: &str) -> Result<String, String> {
        let Some(solution) = self.session.solution() else { return Ok(String::new()) };
        let stem = Path::new(name).file_stem().unwrap_or_default();
        let path = folder.join(stem).with_added_extension("svg");
        let picture = contact_map(&self.prepared, &self.contact, solution).map_err(|error| error.to_string())?;
        let written = write_atomic(&path, |out| out.write_all(picture.svg().as_bytes()));
        written.map_err(|error| error.to_string())?;
        Ok(path.display().to_string())
    }
}

/// What is said of an answer.
fn members(solution: &mut Solution, contact: &Contact) -> Value {
    let mut members = json!({ "status": status(solution) });
    let failed: Vec<_> = solution.verdict.failed().map(|check| check.message.clone()).collect();
    if !failed.is_empty() {
        members["failed"] = failed.into();
    }
    let found = solution.learned();
    if !found.is_empty() {
        members["learned"] = found.iter().map(learned).collect();
    }
    let values = |name: &str, points: &[f64]| {
        let estimate = solution.evaluate(points).into_iter().find(|estimate| estimate.name == name);
        estimate.map(|estimate| estimate.values)
    };
    if let Some(score) = contact.score(&values, None) {
        let deviation = contact
            .pressure
            .and_then(|pressure| solution.deviation_of_sum(pressure, &contact.face.points, &score.per_pascal));
        members["force_N"] = json!(score.force);
        members["force_sd_N"] = json!(deviation);
        members["patches"] = score.patches.iter().map(patch).collect();
    }
    members["seen"] = json!(contact.seen(&values));
    members
}
