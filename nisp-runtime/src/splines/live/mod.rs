//! Records as they come: a fixed-lag smoother over one coordinate.
//!
//! The same splines, equations and priors as for a whole record, on a window of cells that moves along with it
//! ([`window`](self)). The first rows are solved as a whole: they have their answers from there, and say how large the noise is,
//! how smooth the sources are, and after which lag a longer wait would tell little more. Later parts of the record are asked
//! again, on a thread of their own.

mod again;
mod alone;
mod begun;
mod event;
mod evidence;
mod first;
mod given;
mod grid;
mod held;
mod lag;
mod met;
mod opening;
mod record;
mod smoother;
mod strays;
mod under_way;
mod window;

use thiserror::Error;

use crate::problem::BindError;
use crate::schema::Unit;
use crate::solve::fault::Fault;
use crate::verdict::{known, leaning};

pub use smoother::FixedLagSmoother;

/// How a record is smoothed as it comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagSettings {
    /// How long every answer waits for later rows, in the coordinate's declared unit. Nothing: as long as it takes until a
    /// source's standard deviation is within a twentieth of what any wait would bring, by the first rows.
    pub lag: Option<f64>,
    /// Rows from which noise and smoothness are found before the first answer, ten at least.
    pub first_rows: usize,
}

impl Default for LagSettings {
    fn default() -> Self {
        Self { lag: None, first_rows: 200 }
    }
}

/// What is known at the place of a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// The place, in the coordinate's declared unit.
    pub at: f64,
    /// How much farther the record had come, in the same unit: the lag, or less at the end of a record.
    pub lag: f64,
    /// Values and standard deviations of all heads in their declared units, in the order of the scene. Deviations are NaN where data are
    /// exact but for rounding.
    pub heads: Vec<(f64, f64)>,
    /// Root mean square of what observations are off, over the noise that differences of neighbouring rows show: about one
    /// where equations and data agree. A running mean over a hundred values or so.
    pub misfit: f64,
    /// The same over a dozen values or so about the place: a contact that the source follows too slowly shows there alone.
    pub nearby: f64,
    /// How far sources bend about the place, over what their smoothness and the rows make likely: far beside a step, which a source
    /// that was smooth before cannot follow. A running mean of a dozen rows or so.
    pub bend: f64,
    /// Learned scalars in their declared units, and their standard deviations, in the order of the scene: as the last rows that were solved
    /// together say.
    pub learned: Vec<(f64, f64)>,
    /// How far a learned scalar moves where sources may be larger, at most, as a share of itself: little is known of one that moves far,
    /// and of the sources beside it. Zero where nothing is learned.
    pub leaning: f64,
    /// How far the rows draw a field or a source beyond its bounds, in its deviations, at most. Values are within their bounds.
    pub beyond: f64,
    /// Logarithm of the probability that another value of a given number would gain, by all rows up to here (Rao's score test): a source
    /// takes over what is given wrongly, and what it cannot take over shows the clearer the longer the record is.
    pub given: f64,
    /// What speaks against the answer beside these numbers, and what to do: which given number should rather be another, where that gains
    /// more than chance does, and what a whole record of the first rows would be doubted for.
    pub doubt: Option<String>,
    /// Whether the row is a stray: what was observed there is far from what all other rows say, and does not count.
    pub is_stray: bool,
    /// Whether a sensor stood still there, at the end of its range or because it failed: what it shows is no measurement.
    pub is_held: bool,
}

impl Smoothed {
    /// Misfit up to which equations and data agree.
    pub const MISFIT: f64 = 1.6;
    /// The same of a dozen values: chance makes more of few.
    pub const NEARBY: f64 = 2.0;

    /// How far sources may bend: chance makes two of it now and then.
    pub const BEND: f64 = 3.0;

    /// How far a learned scalar may move.
    pub const LEANING: f64 = leaning::FARTHEST;

    /// How far a bound may be passed: chance makes four deviations of it in one of many rows.
    pub const BEYOND: f64 = 4.5;

    /// What another value of a given number may gain.
    pub const GIVEN: f64 = known::GAIN_OF_DATA;

    /// True where equations and data agree, sources are as smooth as they were taken to be and within their bounds, learned scalars do not
    /// rest on how large sources are taken to be, nothing else speaks against it, and no sensor stood still.
    pub fn is_sound(&self) -> bool {
        self.is_met() && self.doubt.is_none() && !self.is_held
    }

    /// The same, whatever else speaks against it and whatever is said of sensors.
    fn is_met(&self) -> bool {
        self.misfit <= Self::MISFIT
            && self.nearby <= Self::NEARBY
            && self.bend <= Self::BEND
            && self.leaning <= Self::LEANING
            && self.beyond <= Self::BEYOND
    }
}

/// A column that every row has a number for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowColumn {
    /// Group that it belongs to.
    pub group: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its declared unit.
    pub unit: Unit,
    /// True if NaN may stand for what was not measured.
    pub may_lack: bool,
}

/// Why a record cannot be smoothed, or a row not be taken.
#[derive(Debug, Error)]
pub enum LiveError {
    /// The problem is not sensibly bound.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// What splines over one coordinate do not do.
    #[error("a record is smoothed by splines over one coordinate, which do not do {0}; solve it as a whole")]
    Scene(&'static str),
    /// No measurements to wait for.
    #[error("the scene observes nothing, so that there are no rows to wait for; solve it as a whole")]
    NoRows,
    /// Something that cannot be evaluated.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// More than the rows determine.
    #[error(
        "the first rows and the equations leave some of the unknowns open: give more conditions, more columns or more rows"
    )]
    Open,
    /// Rows without a measurement.
    #[error("none of the first {rows} rows has a measurement: their cells are empty")]
    Unmeasured {
        /// Rows there were.
        rows: usize,
    },
    /// A record that ends too soon.
    #[error("{rows} row(s) are too few to tell noise from a source; give {least} at least")]
    FewRows {
        /// Rows there were.
        rows: usize,
        /// Rows that it takes.
        least: usize,
    },
    /// A row with the wrong number of values.
    #[error("the row has {found} values where {expected} are expected")]
    Columns {
        /// How many there were.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A value that is not finite where it must be.
    #[error("`{name}` is {value}; the row is left out")]
    NotFinite {
        /// Which value.
        name: &'static str,
        /// What it is.
        value: f64,
    },
    /// A row that is not behind all others.
    #[error("{at} does not come after {last}: rows must come in order; the row is left out")]
    Backwards {
        /// Its place.
        at: f64,
        /// Place of the last row.
        last: f64,
    },
    /// A lag that takes too many cells.
    #[error("a lag of {lag} takes more than {most} rows; give a shorter one")]
    Lag {
        /// The lag.
        lag: f64,
        /// Rows that a lag may take.
        most: usize,
    },
}

impl LiveError {
    /// True of a row that was left out: the next may be taken.
    pub fn is_of_row(&self) -> bool {
        matches!(self, Self::Columns { .. } | Self::NotFinite { .. } | Self::Backwards { .. })
    }
}
