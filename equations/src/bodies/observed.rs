//! What was observed: a sample's file and one of its clouds, a cloud alone, or the repository's example.

use std::path::{Path, PathBuf};

use nisp_data::input::read_text;
use nisp_data::{Cloud, Table};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::PrepareError;
use crate::entry::Entry;
use crate::request::Request;

/// A sample that is part of the program.
pub(super) struct Example {
    /// Path of its file in the repository.
    pub(super) path: &'static str,
    /// Its file.
    pub(super) sample: &'static str,
    /// Path of its cloud in the repository.
    pub(super) cloud_path: &'static str,
    /// Its cloud.
    pub(super) cloud: &'static [u8],
    /// Path of its truth in the repository.
    pub(super) truth_path: &'static str,
    /// Its truth.
    pub(super) truth: &'static [u8],
}

/// Everything that was read.
pub(super) struct Observed {
    /// The sample's file, if there is one.
    pub(super) sample: Option<Sample>,
    /// The cloud, in metres.
    pub(super) cloud: Cloud,
    /// Where the cloud came from.
    pub(super) source: PathBuf,
    /// The truth, to score against.
    pub(super) truth: Option<Table>,
}

/// A sample's file.
pub(super) struct Sample {
    pub(super) path: PathBuf,
    text: String,
}

/// The part of a sample that names its clouds.
#[derive(Deserialize)]
struct Clouds {
    observation: Observation,
}

#[derive(Deserialize)]
struct Observation {
    clouds: Vec<PathBuf>,
}

impl Sample {
    fn read(path: &Path) -> Result<Self, PrepareError> {
        Ok(Self { path: path.into(), text: read_text(path)? })
    }

    /// Those tables and keys that `T` has.
    pub(super) fn tables<T: DeserializeOwned>(&self) -> Result<T, PrepareError> {
        toml::from_str(&self.text).map_err(|error| {
            let before = error.span().map_or(0, |span| span.start);
            let line = 1 + self.text[..before.min(self.text.len())].matches('\n').count();
            let what = error.message().replace('\n', " ");
            PrepareError::File { path: self.path.clone(), reason: format!("line {line}: {what}") }
        })
    }

    /// The path of the sample's cloud number `index`.
    fn cloud(&self, index: usize) -> Result<PathBuf, PrepareError> {
        let clouds = self.tables::<Clouds>()?.observation.clouds;
        let Some(name) = clouds.get(index) else {
            let have = match clouds.len() {
                0 => format!("{} names none", self.path.display()),
                count => format!("{} has 0 to {}", self.path.display(), count - 1),
            };
            return Err(PrepareError::Cloud { index, instead: have });
        };
        Ok(self.path.parent().unwrap_or(Path::new("")).join(name))
    }
}

impl Observed {
    /// Reads all files of data as one cloud, and says how many points each has.
    pub(super) fn all(request: &Request) -> Result<(Self, Vec<usize>), PrepareError> {
        let (mut cloud, mut points) = (Cloud::default(), Vec::new());
        for (_, path) in &request.data {
            let mut one = request.view.read(path)?;
            points.push(one.points.len());
            cloud.points.append(&mut one.points);
            cloud.warnings.append(&mut one.warnings);
        }
        let source = request.data.first().map(|(_, path)| path.clone()).unwrap_or_default();
        Ok((Self { sample: None, cloud, source, truth: None }, points))
    }

    /// Reads what is asked for; without data and sample, the example.
    pub(super) fn read(entry: &Entry, request: &Request, example: &Example) -> Result<Self, PrepareError> {
        let (sample, data) = match (request.calibration.as_ref().or(request.sample.as_ref()), request.file(entry.name)?)
        {
            (None, Some(data)) => match sample_beside(data) {
                Some(path) => (Some(path), None),
                None => (None, Some(data)),
            },
            (sample, data) => (sample.cloned(), data),
        };
        let sample = sample.map(|path| Sample::read(&path)).transpose()?;
        if let Some((source, cloud)) = &request.frame {
            return Ok(Self { sample, cloud: cloud.clone(), source: source.clone(), truth: None });
        }
        let alone = |what: &str| Err(PrepareError::Cloud { index: request.cloud.unwrap_or(0), instead: what.into() });
        let (source, cloud) = match (&sample, data) {
            (_, Some(_)) if request.cloud.is_some() => return alone("--data names a cloud already"),
            (_, Some(data)) => (data.to_path_buf(), request.view.read(data)?),
            (Some(sample), None) => {
                let path = sample.cloud(request.cloud.unwrap_or(0))?;
                let cloud = request.view.read(&path)?;
                (path, cloud)
            }
            (None, None) if request.cloud.is_some() => return alone("name the sample with --sample"),
            (None, None) => {
                let path = PathBuf::from(example.cloud_path);
                let cloud = request.view.parse(&path, example.cloud)?;
                (path, cloud)
            }
        };
        let own = sample.is_none() && data.is_none();
        let truth = match &request.truth {
            Some(path) => Some(Table::read(path)?),
            None if own => Some(Table::parse(Path::new(example.truth_path), example.truth)?),
            None => None,
        };
        let example = || Sample { path: example.path.into(), text: example.sample.into() };
        Ok(Self { sample: if own { Some(example()) } else { sample }, cloud, source, truth })
    }
}

/// The sample that `--data` names, if it names one: by its file, or by the file's name without its ending.
fn sample_beside(data: &Path) -> Option<PathBuf> {
    if data.extension().is_some_and(|ending| ending == "toml") {
        return Some(data.into());
    }
    let path = data.with_added_extension("toml");
    (!data.exists() && path.exists()).then_some(path)
}
