//! What `nisp stream` takes.

use std::path::PathBuf;

use crate::options::{count, number, seconds};
use clap::Args;
use nisp_data::cloud::LengthUnit;

use crate::options::{pair, value};

/// What to follow, and how.
#[derive(Args)]
pub(crate) struct StreamOptions {
    /// Equation of what is seen or measured: membrane or bubble; pendulum, rlc, or a text file over one coordinate.
    #[arg(value_name = "SCENE")]
    pub(crate) equation: String,
    #[command(flatten)]
    pub(crate) from: From,
    /// One of the equation's scenes [default: its first].
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,
    /// TOML of a sample: its parameters hold for all frames.
    #[arg(long, value_name = "FILE")]
    pub(crate) sample: Option<PathBuf>,
    /// Of a bubble: calibration.toml of `nisp calibrate`, for the sensor that sees the frames.
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: Option<PathBuf>,
    /// Unit of the clouds' coordinates: m, cm, mm, um or in [default: m].
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<LengthUnit>,
    /// TOML of the camera that took depth images: fx, fy, cx, cy, and where it is.
    #[arg(long, value_name = "FILE")]
    pub(crate) camera: Option<PathBuf>,
    /// A parameter's value in its declared unit, for all frames. Repeatable.
    #[arg(long, value_name = "NAME=VALUE", value_parser = value)]
    pub(crate) set: Vec<(String, f64)>,
    /// Of a record: how long every answer waits for later rows, in the coordinate's unit [default: as long as it helps].
    #[arg(long, value_name = "LENGTH", value_parser = number, allow_negative_numbers = true)]
    pub(crate) lag: Option<f64>,
    /// Of a record: header of the column that holds a quantity, for instance q=q_m_sigma0.01. Repeatable.
    #[arg(long, value_name = "NAME=HEADER", value_parser = pair)]
    pub(crate) column: Vec<(String, String)>,
    /// Folder for a map of the source of every frame; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) maps: Option<PathBuf>,
    /// Wall time of an answer that is sought from nothing.
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) budget: f64,
    /// Threads [default: one per processor]. Answers do not depend on them.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    pub(crate) threads: Option<usize>,
}

impl StreamOptions {
    /// An option that is given and says nothing of a record.
    pub(crate) fn about_clouds(&self) -> Option<&'static str> {
        let given = [
            ("--frames", self.from.frames.is_some()),
            ("--follow", self.from.follow.is_some()),
            ("--sample", self.sample.is_some()),
            ("--calibration", self.calibration.is_some()),
            ("--unit", self.unit.is_some()),
            ("--camera", self.camera.is_some()),
            ("--maps", self.maps.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }
}

/// Where frames or rows come from.
#[derive(Args)]
#[group(required = true, multiple = false)]
pub(crate) struct From {
    /// Files that are there, by a pattern in quotes: 'run/frame_*.npy'. All are answered, in the order of their names.
    #[arg(long, value_name = "PATTERN")]
    pub(crate) frames: Option<String>,
    /// Folder in which a camera puts a file for every frame. The newest is answered.
    #[arg(long, value_name = "DIR")]
    pub(crate) follow: Option<PathBuf>,
    /// Record that is there: a CSV whose rows are answered one after the other.
    #[arg(long, value_name = "FILE")]
    pub(crate) data: Option<PathBuf>,
    /// Standard input: names of files, or clouds; a CSV of a record.
    #[arg(value_name = "-", value_parser = ["-"])]
    pub(crate) standard_input: Option<String>,
}

pub(crate) const SEE_HELP: &str =
    "Exit codes: 0 ended or interrupted, 2 bad input, 3 no answer, 4 not written. `--help` has examples.";

pub(crate) const TEACH: &str = "\
Examples:
  nisp stream membrane --frames 'run/frame_*.ply' --set p=5670 --set a=0.06 --set b=0.04
      a recording, frame by frame
  nisp stream bubble --calibration sensor/calibration.toml --follow /dev/shm/bubble --set p=5690
      a camera that writes a file for every frame
  camera | nisp stream bubble --calibration sensor/calibration.toml - > forces.jsonl
      a camera that writes to a pipe

  rig | nisp stream pendulum - --set m0=0.05 > force.jsonl
      a rig that writes a CSV, header first and then a row for every sample
  nisp stream heat.pde --data run.csv --lag 0.5
      a recording, row by row, with answers half a unit of time behind

Frames:
  Clouds as for `nisp solve`: PLY, PCD, NPY, NPZ, CSV or XYZ, all of the same body in the same frame.
  Standard input has a name on every line, with parameters of that frame behind it if there are any:
      /dev/shm/f_0017.npy p=5702
  or clouds: for each, the number of its bytes in eight bytes (little-endian), and then the bytes of a file.
  Frames that come faster than they can be answered are left out, so that the newest is always next: `dropped` counts
  them. Files that a pattern names are all answered, and so are those of a list on standard input that is a file itself.
  In a folder that is followed, files count when they have stopped growing; those that were there before do not.

Rows of a record:
  CSV as for `nisp solve`: titles, names and units in the header or below it, dates, empty or nan cells where nothing was
  measured, times that rise. The first three rows side by side tell the separator, where the header is, and whether days
  or months come first in dates.
  The first 200 rows say how large the noise is, how smooth the sources are, and which lag is worth waiting for; then
  they are all answered, and every later row when the record is a lag farther. Later rows may say that a longer lag is
  worth waiting for, twice the first one at most; one that is given stays. Where the record ends the last rows are
  answered at shorter lags. After a gap longer than the lag it begins anew with the next 200 rows. Where answers no longer
  fit the rows (a source sets in after quiet ones, 50 rows are inconsistent) the last 400 are solved as the first ones
  were. A row that cannot be taken (time that goes back, a word for a number) gets a line that says so, and the next one
  is waited for; so does a time far ahead that the next row's time is not. Where 20 rows rise behind the last one, the
  clock was set back, and the record begins anew with them. A value that stands alone, far off, is left out. First rows
  that tell nothing (a sensor at rest, empty cells) wait for others: 1600 at most.
  The first rows are judged as `nisp solve` judges a record. A column that seems to be in another unit ends the stream where its
  header says none.

Answers to rows, one JSON object a line:
  t           where the answer holds: the row's own place (under the coordinate's own name)
  lag         how much farther the record had come
  sources     by name: value and sd, its standard deviation (null where rows are inconsistent, or exact but for rounding)
  state       the same of what is described, measured or not
  learned     the same of learned parameters, as the rows that were last solved together say
  misfit      what observations are off, over the noise that neighbouring rows show; about 1 where the equation is right
  nearby      the same of a dozen values about the row
  bend        how far sources bend about the row, over what their smoothness makes likely: far beside a step
  stray       true where a value of the row stands alone and was left out; the answer is what the other rows say
  held        true where a measured value has stood still while noise says that it moves: a sensor at the end of its range, or
              one that failed
  leaning     how far a learned parameter moves where sources may be larger, as a share of itself
  beyond      how far the rows draw a field or a source beyond its bounds, in its deviations; values are within them
  given       logarithm of the probability that another value of a given number would gain, by all rows so far
  doubt       what speaks against the answer and what to do: a given number that should rather be another, what the first rows
              would be doubted for; all along, sources that nothing tells apart, and rows that are not as they were measured
  status      converged, inconsistent (misfit above 1.6 or nearby above 2: equation or parameters do not fit; bend above 3:
              a source is rougher than it was; leaning above .1: little is known of what is learned; beyond above 4.5:
              rows contradict a bound; given above 10: a given number is wrong, or its equation; held; doubt), or error
              (`error` says why)
  latency_ms  work of the row that brought the answer

Answers to frames, one JSON object a line:
  frame       name of the file, or number of the cloud
  t           when it came, in seconds from the stream's beginning
  status      converged, inconsistent (`failed` says why), budget, not_converged, or error (`error` says what is wrong)
  force_N     net force on the body, force_sd_N the standard deviation of its magnitude: null where the answer does not pass,
              and where it goes on from another and the cloud leaves more than a tenth of the surface unseen
  patches     touched parts, the largest first: centre_m, area_m2 and force_N, each also at rest
  learned     learned parameters: value, deviation, unit
  seen        share of the surface that the cloud shows
  dropped     frames that were left out so far
  latency_ms  from when the frame was there, or in a recording its turn came, to its answer
  map         file of the map, with --maps

Ctrl-C or SIGTERM ends the stream after the frame or row at hand; of a record the rows that wait are answered.

Exit codes:
  0  frames or rows have ended, or the stream was interrupted
  2  bad options, or no frame was a cloud of the sensor
  3  the rows do not determine an answer
  4  answers or maps could not be written";
