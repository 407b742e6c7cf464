//! Clouds as they come: files of a pattern, new files of a folder, names or clouds on standard input.

use std::collections::HashMap;
use std::io::{BufRead, Read, stdin};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{Builder, sleep};
use std::time::{Duration, Instant};

use crate::interrupt;
use nisp_data::Cloud;
use nisp_data::cloud::View;
use nisp_data::input::MOST_BYTES;

use super::latest::Latest;
use crate::args::stream::From;
use crate::options::value;

/// How often a folder is looked at.
const LOOK: Duration = Duration::from_millis(5);
/// Endings of clouds in a folder; other files are not frames.
const ENDINGS: [&str; 7] = ["ply", "pcd", "npy", "npz", "csv", "xyz", "png"];

/// A cloud that came.
pub(super) struct Frame {
    /// Its file, or its number.
    pub(super) name: String,
    /// When it was there.
    pub(super) came: Instant,
    /// Parameters that it came with, in declared units.
    pub(super) parameters: Vec<(String, f64)>,
    /// The cloud, or what is wrong with it.
    pub(super) cloud: Result<Cloud, String>,
    /// Whether it is of now: of a recording every frame is wanted.
    pub(super) live: bool,
}

impl Frame {
    /// Reads a file.
    fn read((path, view): (&Path, &View), parameters: Vec<(String, f64)>, live: bool) -> Self {
        let came = Instant::now();
        let cloud = view.read(path).map_err(|error| error.to_string());
        Self { name: path.display().to_string(), came, parameters, cloud, live }
    }
}

/// Starts to bring frames.
///
/// # Errors
/// A pattern that is none or names nothing, a folder that is not there.
pub(super) fn frames(from: &From, view: View) -> Result<Arc<Latest<Frame>>, String> {
    let latest = Latest::new();
    let place = latest.clone();
    let bring: Box<dyn FnOnce() + Send> = match from {
        From { frames: Some(pattern), .. } => {
            let paths = matching(pattern)?;
            Box::new(move || {
                let _ = paths.iter().all(|path| bring(&place, Frame::read((path, &view), Vec::new(), false)));
                place.end();
            })
        }
        From { follow: Some(folder), .. } => {
            let mut folder = Folder::new(folder)?;
            Box::new(move || {
                while !interrupt::asked() {
                    for path in folder.look() {
                        bring(&place, Frame::read((&path, &view), Vec::new(), true));
                    }
                    sleep(LOOK);
                }
            })
        }
        _ => Box::new(move || {
            standard_input(&place, &view);
            place.end();
        }),
    };
    Builder::new().name("frames".into()).spawn(bring).map_err(|error| format!("cannot start a thread: {error}"))?;
    Ok(latest)
}

/// Puts a frame where it is waited for: false where nobody wants any more.
fn bring(place: &Latest<Frame>, frame: Frame) -> bool {
    let live = frame.live;
    place.put(frame, live)
}

/// The files that a pattern names, in the order of their names.
fn matching(pattern: &str) -> Result<Vec<PathBuf>, String> {
    let paths = glob::glob(pattern).map_err(|error| format!("--frames {pattern}: {error}"))?;
    let mut paths = paths.collect::<Result<Vec<_>, _>>().map_err(|error| format!("--frames {pattern}: {error}"))?;
    paths.sort();
    match paths.is_empty() {
        true => Err(format!("--frames {pattern}: there is no such file; write the pattern in quotes")),
        false => Ok(paths),
    }
}

/// A folder to which files are added.
struct Folder {
    path: PathBuf,
    /// Lengths of files when they were last looked at; nothing for those that are known.
    files: HashMap<PathBuf, Option<u64>>,
}

impl Folder {
    fn new(path: &Path) -> Result<Self, String> {
        let mut folder = Self { path: path.into(), files: HashMap::new() };
        let files = folder.list().map_err(|error| format!("--follow {}: {error}", path.display()))?;
        folder.files = files.into_iter().map(|(path, _)| (path, None)).collect();
        Ok(folder)
    }

    /// Clouds that are there, and their lengths.
    fn list(&self) -> std::io::Result<Vec<(PathBuf, u64)>> {
        let is_cloud = |path: &PathBuf| {
            let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
            let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            !is_hidden && ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
        };
        let entries = std::fs::read_dir(&self.path)?.flatten();
        let files = entries.map(|entry| (entry.path(), entry)).filter(|(path, _)| is_cloud(path));
        Ok(files.filter_map(|(path, entry)| Some((path, entry.metadata().ok()?.len()))).collect())
    }

    /// Files that are new and have stopped growing, in the order of their names.
    fn look(&mut self) -> Vec<PathBuf> {
        let mut whole = Vec::new();
        // A folder that cannot be read for a moment may be there again.
        for (path, length) in self.list().unwrap_or_default() {
            match self.files.get_mut(&path) {
                Some(None) => {}
                Some(known) if *known == Some(length) && length > 0 => {
                    *known = None;
                    whole.push(path);
                }
                Some(known) => *known = Some(length),
                None => {
                    self.files.insert(path, Some(length));
                }
            }
        }
        whole.sort();
        whole
    }
}

/// Frames on standard input. One that is a file has all its frames answered.
fn standard_input(place: &Latest<Frame>, view: &View) {
    let live = !std::fs::metadata("/dev/stdin").is_ok_and(|input| input.is_file());
    let mut input = stdin().lock();
    // The length of a cloud has zeros in its upper bytes, and no name has any.
    let are_clouds = input.fill_buf().is_ok_and(|bytes| bytes.iter().take(8).any(|byte| *byte == 0));
    if are_clouds {
        let mut number = 0;
        while let Some(frame) = block(&mut input, (number, view), live) {
            number += 1;
            if !bring(place, frame) {
                return;
            }
        }
        return;
    }
    for line in input.lines().map_while(Result::ok) {
        if let Some(frame) = named(&line, view, live)
            && !bring(place, frame)
        {
            return;
        }
    }
}

/// The frame of a line: a name, and parameters; nothing of an empty line.
fn named(line: &str, view: &View, live: bool) -> Option<Frame> {
    let mut name = line.trim();
    let mut parameters = Vec::new();
    // Names may have blanks in them, parameters have none.
    while let Some((before, word)) = name.rsplit_once(char::is_whitespace)
        && let Ok(parameter) = value(word)
    {
        parameters.insert(0, parameter);
        name = before.trim_end();
    }
    (!name.is_empty()).then(|| Frame::read((Path::new(name), view), parameters, live))
}

/// The next cloud of a stream of clouds; nothing at its end.
fn block(input: &mut impl Read, (number, view): (u64, &View), live: bool) -> Option<Frame> {
    let mut length = [0; 8];
    input.read_exact(&mut length).ok()?;
    let length = u64::from_le_bytes(length);
    let name = number.to_string();
    let mut bytes = Vec::new();
    let read = input.take(length.min(MOST_BYTES)).read_to_end(&mut bytes);
    let came = Instant::now();
    let cloud = match read {
        _ if length > MOST_BYTES => Err(format!("{length} bytes are more than a cloud may have")),
        Ok(read) if read as u64 == length => view.parse(Path::new(&name), &bytes).map_err(|error| error.to_string()),
        _ => Err("the stream ended within the cloud".into()),
    };
    Some(Frame { name, came, parameters: Vec::new(), cloud, live })
}
