//! What a user asks of an equation.

use std::path::{Path, PathBuf};

use nisp_data::Cloud;
use nisp_data::cloud::View;

use crate::error::PrepareError;

/// What a user asks for.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Scene of the entry, or its default.
    pub scene: Option<String>,
    /// Tables or a cloud of measurements, or else the example's: each for a group or, without a name, for all that want data.
    pub data: Vec<(Option<String>, PathBuf)>,
    /// A cloud that was read already, instead of `data`, and where it came from.
    pub frame: Option<(PathBuf, Cloud)>,
    /// Where the answer is wanted, if not where it was measured.
    pub wanted: Option<Wanted>,
    /// File with a sample's parameters and the names of its clouds.
    pub sample: Option<PathBuf>,
    /// Which of the sample's clouds, counted from zero.
    pub cloud: Option<usize>,
    /// Calibration of the sensor that saw the cloud.
    pub calibration: Option<PathBuf>,
    /// How clouds are to be read.
    pub view: View,
    /// Truth to score against.
    pub truth: Option<PathBuf>,
    /// A network even where local functions suit the scene better.
    pub network: bool,
    /// Cells of local functions along the longest coordinate, if not as many as a single answer has.
    pub cells: Option<usize>,
    /// Names and the headers that hold them; the last word on a name counts.
    pub columns: Vec<(String, String)>,
    /// About how many points groups shall have that lie in domains; the last word on a name counts.
    pub points: Vec<(String, usize)>,
    /// Parameters in their declared units; the last word on a name counts.
    pub parameters: Vec<(String, f64)>,
}

impl Request {
    /// The only file of data, for entries that take one.
    ///
    /// # Errors
    /// Several files, or one for a group.
    pub(crate) fn file(&self, entry: &'static str) -> Result<Option<&Path>, PrepareError> {
        match self.data.as_slice() {
            [] => Ok(None),
            [(None, path)] => Ok(Some(path)),
            _ => {
                let instead = "it takes one file: --data FILE";
                Err(PrepareError::Option { entry, option: "data GROUP=FILE", instead })
            }
        }
    }
}

/// Where an answer is wanted.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// At the rows of a table with a column for each coordinate.
    At(PathBuf),
    /// On a grid over the domain, so many points along each coordinate.
    Grid(Vec<usize>),
}
