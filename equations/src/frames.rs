//! What is done to every cloud of a sensor before it is bound, however many come.

use std::path::{Path, PathBuf};

use nisp::schema::TermKind;
use nisp::units::Number;
use nisp::{BindError, Problem};
use nisp_data::{Cloud, DataError};

use crate::PrepareError;
use crate::contact::{Calibration, Pose};

/// How far beyond its box, in parts of its size, a body may bulge and noise may throw a point.
const MARGIN: f64 = 0.25;
/// Points without which a surface is anyone's guess.
const FEWEST: usize = 50;
/// Share of a cloud that must be where its body can be; the rest may be outliers.
const LEAST_INSIDE: f64 = 0.8;
/// A cloud shows what is nearer to one of its points than so many cells.
const NEAR: f64 = 2.0;

/// Points of a cloud in each cell of the answer's lattice that it passes through, in the mean, from which on more of them cost
/// more than they say: three displacements are wanted there.
pub(crate) const POINTS_OF_A_CELL: usize = 4;

/// What the clouds of a body have in common.
#[derive(Clone, Debug)]
pub struct Frames {
    /// Of the sensor that saw them.
    pub(crate) calibration: Option<Calibration>,
    /// Where the body is in their frame, unless that is its own.
    pub(crate) pose: Option<Pose>,
    /// What was observed, in words.
    pub(crate) body: &'static str,
    /// The box that it is in, in metres.
    pub(crate) within: ([f64; 3], [f64; 3]),
    /// Size of the answer's cells, in metres: where a cloud has many points in one, some of them do.
    pub(crate) cell: f64,
}

impl Frames {
    /// Takes from a cloud of `source`, in metres, what the calibration tells, and thins it.
    ///
    /// # Errors
    /// A cloud that cannot be one of the body.
    pub(crate) fn take(&self, source: &Path, cloud: &mut Cloud) -> Result<(), PrepareError> {
        if let Some(pose) = &self.pose {
            cloud.points.iter_mut().for_each(|point| *point = pose.inward(*point));
        }
        if let Some(calibration) = &self.calibration {
            calibration.deviation.correct(cloud);
        }
        self.require(source, cloud)?;
        cloud.thin(self.cell, POINTS_OF_A_CELL);
        Ok(())
    }

    /// Binds another cloud of the same body; returns it as it was bound.
    ///
    /// # Errors
    /// A cloud that cannot be one of the body; the problem is as it was.
    pub fn bind(&self, problem: &mut Problem, source: &Path, mut cloud: Cloud) -> Result<Cloud, PrepareError> {
        self.take(source, &mut cloud)?;
        bind_cloud(problem, &cloud)?;
        Ok(cloud)
    }

    /// How near to a point of the surface a cloud's must be to show it, in metres.
    pub(crate) fn near(&self) -> f64 {
        NEAR * self.cell
    }

    /// Checks that the cloud can be one of a body in the box, with a unit that makes it so.
    fn require(&self, source: &Path, cloud: &Cloud) -> Result<(), PrepareError> {
        let path = || PathBuf::from(source);
        let fault = |error: DataError| PrepareError::File { path: path(), reason: error.to_string() };
        let (count, body) = (cloud.points.len(), self.body);
        if count < FEWEST {
            let reason = format!("{count} points do not show a {body}; record {FEWEST} at least");
            return Err(PrepareError::File { path: path(), reason });
        }
        let (low, high) = self.within;
        cloud.require_near(&low, &high).map_err(fault)?;
        let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        let (from, to) = (low.map(|x| x - MARGIN * size), high.map(|x| x + MARGIN * size));
        let share = cloud.share_within(from, to);
        if share >= LEAST_INSIDE {
            return Ok(());
        }
        let span = |axis: usize| format!("{:.3} to {:.3} m", from[axis], to[axis]);
        let place = format!("x {}, y {}, z {}", span(0), span(1), span(2));
        Err(PrepareError::Elsewhere { path: path(), share: 100.0 * share, body, place })
    }
}

/// Gives every Chamfer term of a problem the cloud, in the term's unit.
pub(crate) fn bind_cloud(problem: &mut Problem, cloud: &Cloud) -> Result<(), BindError> {
    for group in problem.scene().schema.groups {
        for term in group.terms.iter().filter(|term| matches!(term.kind, TermKind::Chamfer { .. })) {
            let inward = |metres: &f64| term.unit.factor.back(Number::si(*metres)).as_declared();
            problem.set_cloud(group.name, term.name, cloud.points.iter().flatten().map(inward).collect())?;
        }
    }
    Ok(())
}
