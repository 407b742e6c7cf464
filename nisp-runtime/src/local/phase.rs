//! What the rows of a step are: first the data, then everything under a convex prior, then everything.

/// Steps before the penalty of small sources ends at their level.
pub(super) const CONVEX_STEPS: u64 = 6;
/// How many of them are left to a state from a coarser lattice.
pub(super) const WARM_STEPS: u64 = 3;

/// What the rows of a step are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// Data and pointwise conditions.
    Regress,
    /// Everything, with a penalty of small sources that does not end at their level; learned scalars may be held.
    Convex { held: bool },
    /// Everything.
    Concave,
}

impl Phase {
    pub(super) fn of(iteration: u64, coarse: bool) -> Self {
        match iteration {
            0 => Self::Regress,
            1..CONVEX_STEPS => Self::Convex { held: true },
            _ if coarse || iteration == CONVEX_STEPS => Self::Convex { held: false },
            _ => Self::Concave,
        }
    }
}
