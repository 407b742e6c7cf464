//! Answers that are kept in files and read back without the data that they were found from.
//!
//! A file holds the equation's text, the scene's name, parameters, the scales and units that the problem was solved in, the
//! carrier with what is known of its numbers, and what was said of the answer. It is read in two steps: [`SavedAnswer`] is what
//! stands in the file, [`OpenAnswer`] is it together with the scene that gives its numbers a meaning.

mod extent;
mod kept;
mod network;
mod open;

use std::time::{Duration, SystemTime};

use thiserror::Error;

use crate::bytes::{Fnv, Reader, Writer};
use crate::schema::Scene;
use crate::solve::state::State;

pub(crate) use extent::Extent;
pub(crate) use network::{CARRIER as NETWORK, KeptNetwork};
pub use open::OpenAnswer;
pub(crate) use open::save_frame;

/// Begins every answer; the layout's number follows.
const HEADING: &[u8] = b"nisp answer ";
/// The heading with the number of the layout that is written.
const MAGIC: &[u8] = b"nisp answer 1\n";

/// What stands in the file of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedAnswer {
    /// By name; a name may be there several times.
    texts: Vec<(String, String)>,
    /// The carrier's numbers, and those of the frame.
    state: State,
}

/// A given or learned parameter of a saved answer.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedParameter {
    /// Its name.
    pub name: String,
    /// Its declared unit.
    pub unit: String,
    /// True if it was learned.
    pub learned: bool,
    /// Its value in the declared unit.
    pub value: f64,
    /// Its standard deviation, where it was learned and has one.
    pub deviation: Option<f64>,
}

/// Why an answer cannot be kept or read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SavedError {
    /// Bytes of something else.
    #[error("not a saved answer; `nisp solve` writes one, answer.nisp, into the folder of its results")]
    Foreign,
    /// Bytes of a layout that is not read.
    #[error("the answer is written in layout {found}, and this version of nisp reads layout 1: solve again")]
    Version {
        /// The layout's number, as written.
        found: String,
    },
    /// Bytes that were cut or changed.
    #[error("the answer is damaged: its checksum does not fit; take another copy, or solve again")]
    Damaged,
    /// Another scene than that of the answer.
    #[error("the answer is of `{saved}`, not of `{given}`")]
    Scene {
        /// Module and scene of the answer.
        saved: String,
        /// Those given.
        given: String,
    },
    /// The same names with other quantities.
    #[error(
        "`{0}` has other quantities, units or bounds now than when the answer was saved, so that its numbers have lost their \
         meaning: solve again"
    )]
    Changed(String),
    /// A quantity that the scene does not solve for.
    #[error("`{name}` reads `{reads}`, which the scene of the answer does not have")]
    Absent {
        /// What was asked for.
        name: String,
        /// What it reads.
        reads: String,
    },
    /// A parameter that no condition reads, so that it was never given.
    #[error("`{0}` has no value: no condition of the scene reads it, and it is declared without one")]
    NoValue(String),
    /// A derivative that the carrier does not have.
    #[error(
        "`{name}` needs a derivative of order {order} of `{head}`, and splines of degree {degree} carry it: order {} is the highest",
        .degree.saturating_sub(1)
    )]
    Order {
        /// What was asked for.
        name: String,
        /// The head.
        head: String,
        /// The order of the derivative.
        order: usize,
        /// The degree of the splines.
        degree: usize,
    },
    /// A derivative of a head that is kept within a bound by its coefficients.
    #[error("`{name}` needs a derivative of `{head}`, whose bound local functions keep with a kink: it has none there")]
    Kink {
        /// What was asked for.
        name: String,
        /// The head.
        head: String,
    },
    /// A derivative of so high an order of a field with bounds.
    #[error(
        "`{name}` needs a derivative of `{head}`, a field with bounds, of an order that splines do not give: ask for lower ones"
    )]
    Bounded {
        /// What was asked for.
        name: String,
        /// The head.
        head: String,
    },
    /// A scene without the text of its equation.
    #[error("the scene does not know the text of its equation, without which an answer cannot be read")]
    NoText,
    /// Numbers that say nothing.
    #[error("the answer has numbers that are not finite, and is not worth keeping")]
    NotFinite,
}

impl SavedAnswer {
    pub(crate) fn new(texts: Vec<(String, String)>, state: State) -> Result<Self, SavedError> {
        let is_finite = state.vectors.iter().all(|(_, vector)| crate::solve::vector::all_finite(vector));
        if is_finite { Ok(Self { texts, state }) } else { Err(SavedError::NotFinite) }
    }

    /// As bytes, for a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::new(MAGIC);
        writer.texts(&self.texts);
        writer.state(&self.state);
        writer.sealed()
    }

    /// From the bytes of [`SavedAnswer::to_bytes`].
    ///
    /// # Errors
    /// Bytes of something else, of another layout, or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedError> {
        let Some(rest) = bytes.strip_prefix(HEADING) else { return Err(SavedError::Foreign) };
        if !bytes.starts_with(MAGIC) {
            let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).map(|&digit| char::from(digit)).collect();
            let is_number = rest.iter().find(|byte| !byte.is_ascii_digit()) == Some(&b'\n') && rest[0] != b'\n';
            return Err(if is_number { SavedError::Version { found: digits } } else { SavedError::Damaged });
        }
        let mut reader = Reader::of(bytes, MAGIC).ok_or(SavedError::Damaged)?;
        let read = |reader: &mut Reader<'_>| Some(Self { texts: reader.texts()?, state: reader.state()? });
        read(&mut reader).filter(|_| reader.is_at_end()).ok_or(SavedError::Damaged)
    }

    /// With the moment from which its time is counted. Moments before 1970 are not kept.
    pub fn counted_from(mut self, begin: SystemTime) -> Self {
        if let Ok(since) = begin.duration_since(SystemTime::UNIX_EPOCH) {
            self.texts.push(("begin".into(), format!("{}.{:09}", since.as_secs(), since.subsec_nanos())));
        }
        self
    }

    /// The moment from which its time is counted, where its data were given by dates.
    pub fn begin(&self) -> Option<SystemTime> {
        let (seconds, nanoseconds) = self.text("begin").split_once('.')?;
        let seconds = SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs(seconds.parse().ok()?))?;
        seconds.checked_add(Duration::from_nanos(nanoseconds.parse().ok()?))
    }

    /// The text of the equation, as [`crate::kernel::SceneRef::text`].
    pub fn equation(&self) -> &str {
        self.text("equation")
    }

    /// Name of the equation's module.
    pub fn module(&self) -> &str {
        self.text("module")
    }

    /// Name of the scene.
    pub fn scene(&self) -> &str {
        self.text("scene")
    }

    /// How the run ended: `converged`, `inconsistent`, `budget`, `not_converged` or `interrupted`.
    pub fn status(&self) -> &str {
        self.text("status")
    }

    /// What carries the heads: `network`, `splines` or `local functions`.
    pub fn carrier(&self) -> &str {
        &self.state.method
    }

    /// The version of nisp that wrote it.
    pub fn version(&self) -> &str {
        self.text("version")
    }

    /// The checks that the answer did not pass, in words. It may be relied on where there are none.
    pub fn failed(&self) -> impl Iterator<Item = &str> {
        self.all("failed")
    }

    /// What its user was told.
    pub fn warnings(&self) -> impl Iterator<Item = &str> {
        self.all("warning")
    }

    /// Parameters, given and learned.
    pub fn parameters(&self) -> Vec<SavedParameter> {
        let parameter = |(key, unit): &(String, String)| {
            let (kind, name) = key.split_once(' ').filter(|(kind, _)| ["given", "learned"].contains(kind))?;
            let numbers = self.state.vector(key).ok()?;
            Some(SavedParameter {
                name: name.into(),
                unit: unit.clone(),
                learned: kind == "learned",
                value: *numbers.first()?,
                deviation: numbers.get(1).copied(),
            })
        };
        self.texts.iter().filter_map(parameter).collect()
    }

    fn text(&self, name: &str) -> &str {
        self.texts.iter().find(|(key, _)| key == name).map_or("", |(_, text)| text)
    }

    fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        self.texts.iter().filter(move |(key, _)| key == name).map(|(_, text)| text.as_str())
    }
}

/// A number that two scenes share only if saved numbers mean the same in both: their coordinates, heads and scalars agree in
/// names, units, bounds and where they come from.
pub(crate) fn fingerprint(schema: &Scene) -> u64 {
    use std::fmt::Write;
    let mut hash = Fnv::new();
    // The text of a float has all of its bits. Hashing cannot fail.
    for coordinate in schema.coordinates {
        let _ = write!(hash, "{:?}{:?}", coordinate.name, coordinate.unit);
    }
    for head in schema.heads {
        let bounds = (head.lower, head.upper, head.transformed, head.hard);
        let _ = write!(hash, "{:?}{:?}{:?}{bounds:?}", head.name, head.unit, head.source);
    }
    for scalar in schema.scalars {
        let _ = write!(hash, "{scalar:?}");
    }
    hash.value()
}
