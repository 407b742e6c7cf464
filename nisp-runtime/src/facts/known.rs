//! What would come of it if something were otherwise that a problem takes for known.

/// Something that a problem takes for known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Known {
    /// The value of a given scalar, by its slot.
    Scalar(usize),
    /// That a column of a record is measured without an offset.
    Offset { group: usize, column: usize },
    /// That a given column of a record is right in the rows where it stands still.
    Standing { group: usize, column: usize },
    /// Where a cloud is, along an axis.
    Place { cloud: usize, axis: usize },
    /// How a cloud is turned about an axis through its middle.
    Direction { cloud: usize, axis: usize },
    /// How large a cloud is.
    Size { cloud: usize },
}

/// What would come of it if something known were unknown, by Rao's score test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    pub(crate) known: Known,
    /// Whether a prior for few sources has a part in it.
    pub(crate) by_prior: bool,
    /// Slope of the loss by it, and the curvature, where all unknowns follow.
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
    /// What the loss would be less.
    pub(crate) gain: f64,
    /// By how much it would be otherwise: a share of a value, of how much a column varies, of a cloud's size or of its radius, or an angle.
    pub(crate) change: f64,
}

impl Score {
    /// From the slope of the loss by a number, and its curvature, where all unknowns follow; nothing where they take all. Steps are no longer
    /// than the model may be trusted.
    pub(crate) fn by((known, by_prior): (Known, bool), slope: f64, curvature: f64) -> Option<Self> {
        /// The longest step: a share of a number or of a cloud's radius, or an angle.
        const FARTHEST: f64 = 0.3;
        let change = (-slope / curvature).clamp(-FARTHEST, FARTHEST);
        let gain = -change * (slope + 0.5 * curvature * change);
        (curvature > 0.0 && gain.is_finite()).then_some(Self { known, by_prior, slope, curvature, gain, change })
    }
}

/// How much larger a source may be than the evidence says, for what learned scalars would be then.
pub(crate) const LARGER: f64 = 3.0;

/// What is known of a scalar that is learned beside sources, of its parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaning {
    /// How far it moves where sources may be [`LARGER`] times as large; nothing where there was no time.
    pub(crate) moved: Option<f64>,
    /// Its deviation; nothing without error bars.
    pub(crate) deviation: Option<f64>,
    /// Share of what is known of it that the sources' prior says; nothing where that was not asked.
    pub(crate) by_prior: Option<f64>,
    /// Whether it was found by the whole evidence, that of the smoothest sources included, so that its deviation says how far it may move.
    /// Where only sums of squares were, it is the one whose sources are smallest, and more sure than it should be.
    pub(crate) is_weighed: bool,
}

/// Share of what is known of a scalar that the prior of sources says, from its variances with sources as they are and [`LARGER`].
pub(crate) fn by_prior(own: f64, larger: f64) -> f64 {
    ((larger / own).ln() / (2.0 * LARGER.ln())).clamp(0.0, 1.0)
}
