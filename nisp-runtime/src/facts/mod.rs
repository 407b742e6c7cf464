//! What a carrier says of its answer, for the verdict.

mod known;
mod points;

use crate::shared_noise::SharedNoise;

pub(crate) use known::{Known, LARGER, Leaning, Score, by_prior};
pub(crate) use points::Facts;

/// A cloud, and how far its points are off a surface, in the engine's units.
#[derive(Clone)]
pub(crate) struct CloudFacts {
    pub(crate) group: usize,
    pub(crate) term: &'static str,
    pub(crate) points: Vec<[f64; 3]>,
    /// Where on the surface at rest each point belongs: neighbours there are neighbours whatever the noise.
    pub(crate) places: Vec<[f64; 3]>,
    /// Distance of every point to the surface; nothing where the surface has no place for it.
    pub(crate) misfits: Vec<Option<f64>>,
    /// True if distances have a sign, by the side of the surface.
    pub(crate) signed: bool,
    /// Distances that the carrier cannot resolve.
    pub(crate) resolution: f64,
}

/// How much is told of a source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Told {
    pub(crate) head: usize,
    /// Its root mean square in standard deviations of each place, over the time along which it is alike; nothing where there are no
    /// deviations.
    pub(crate) size: Option<f64>,
    /// Deviations by which the true source is nearer to it than to none, in the mean square.
    pub(crate) nearer: f64,
    /// Share that the data leave of what was not known of its mean beforehand, as a variance; zero where that is not asked.
    pub(crate) open: f64,
}

impl Told {
    /// What is told of a source that has no deviations.
    pub(crate) fn unasked(head: usize) -> Self {
        Self { head, size: None, nearer: 0.0, open: 0.0 }
    }
}

/// What a carrier says of its answer, in the engine's units.
#[derive(Clone)]
pub(crate) struct Answer {
    /// By group.
    pub(crate) facts: Vec<Facts>,
    /// Numbers of groups of equations, and their facts at places where the solver did not ask them: of lattices, and of networks where
    /// nothing is measured.
    pub(crate) between: Vec<(usize, Facts)>,
    pub(crate) clouds: Vec<CloudFacts>,
    /// Scalars that programs read, learned ones at their found values.
    pub(crate) scalars: Vec<f64>,
    /// What is known, doubted; empty where the carrier does not tell.
    pub(crate) scores: Vec<Score>,
    /// How much is told of sources; empty where the carrier does not say.
    pub(crate) told: Vec<Told>,
    /// By learned scalar; empty without sources, and where the carrier does not tell.
    pub(crate) leaning: Vec<Leaning>,
    /// The largest change of a learned scalar's parameter in one more whole Gauss-Newton step; nothing at the end of the steps, and
    /// where the carrier does not tell.
    pub(crate) ahead: Option<f64>,
    /// How far the last step moved a source, over its size, at most; nothing at the end of the steps, and where the carrier does not
    /// tell.
    pub(crate) moved: Option<f64>,
    /// By learned scalar, what is left of the equations, as a change of it in its own deviations; nothing without these. Empty where equations
    /// hold to rounding, or in the mean over cells.
    pub(crate) left_to_learned: Vec<Option<f64>>,
    /// How far the cells hold the answer back, over what may be, where the budget ended before finer ones were tried.
    pub(crate) strain: Option<f64>,
    /// The same where equations were held loosely to the end, and finer cells did not help.
    pub(crate) loose: Option<f64>,
    /// Whether more than may be is left of equations between the points that they were asked at: its cells are too coarse for them.
    pub(crate) is_coarse: bool,
    /// By group and term, the noise that neighbouring rows share; nothing where each has its own. Empty where the carrier knows no such noise.
    pub(crate) shared: Vec<Vec<Option<SharedNoise>>>,
    /// How much the last finer lattice has changed an answer without noise, as a share; nothing where there was none.
    pub(crate) refined: Option<f64>,
    /// Share of the measurements that the answer was made from.
    pub(crate) used: f64,
    /// What to do where the carrier may be too coarse.
    pub(crate) finer: &'static str,
}

impl Answer {
    /// The noise that neighbouring rows of an observation share.
    pub(crate) fn shared(&self, group: usize, term: usize) -> Option<SharedNoise> {
        *self.shared.get(group)?.get(term)?
    }
}

/// What to do where splines on a lattice may be too coarse. Cells are as fine as the points of the equations, which a user may choose where
/// they are drawn in a domain.
pub(crate) const MORE_POINTS: &str = "cells get finer with more --points of its equations";

/// What to do where splines may be too coarse, and no option makes their cells finer.
pub(crate) const OTHER_THAN_SPLINES: &str = "--carrier network tries another one";
