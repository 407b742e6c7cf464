//! Where a network output is taken.

/// A point or its partner, with some coordinates held in the middle of their range: a field that does not depend on them is
/// the network's output there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Site {
    /// True for the point's partner.
    pub partner: bool,
    /// A bit for each coordinate that is held.
    pub held: u32,
}

impl Site {
    /// True if a coordinate is held.
    pub fn holds(self, coordinate: usize) -> bool {
        self.held >> coordinate & 1 == 1
    }
}
