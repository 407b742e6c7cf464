//! Groups of points: what their programs read, and what is asked there.

use super::{Place, Term, TermKind, Unit};

/// A point group within a scene.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Its name.
    pub name: &'static str,
    /// The user's documentation.
    pub docs: &'static str,
    /// Channels of the hidden layers, as people write them: `w_xx`, `lap w`.
    pub channels: &'static [&'static str],
    /// Highest order of a channel.
    pub order: usize,
    /// Number of channels of a dense jet of the same order: what is saved is the difference.
    pub dense: usize,
    /// What the programs read of the heads.
    pub jets: &'static [Jet],
    /// Per-point data.
    pub columns: &'static [Column],
    /// Conditions and their rows.
    pub terms: &'static [Term],
    /// Rows of all terms.
    pub rows: usize,
    /// Where its points lie, if a domain says so.
    pub place: Option<Place>,
    /// True if every point has a partner.
    pub paired: bool,
    /// Where the heads are read beside the points and their partners: heads that depend on some of the coordinates only.
    pub held: &'static [Held],
    /// Floating-point operations per point of the residual program and its adjoint.
    pub flops: [usize; 2],
    /// Floating-point operations per point and unit of the network's rules.
    pub rule_flops: RuleFlops,
}

impl Group {
    /// Places at which the heads are read for each point.
    pub fn sites(&self) -> usize {
        1 + usize::from(self.paired) + self.held.len()
    }

    /// True for what is read at the points' partners.
    pub fn is_partner(&self, jet: &Jet) -> bool {
        match jet.site.checked_sub(1 + usize::from(self.paired)) {
            Some(held) => self.held[held].of == 1,
            None => jet.site == 1,
        }
    }

    /// True for the group of what is believed of learned parameters, which the compiler adds and which is bound by itself.
    pub fn is_beliefs(&self) -> bool {
        self.name == "(beliefs)"
    }

    /// True for a term that is asked for between the places of equations, too: in a group with bounds, what has a value there and
    /// is stated of values. Where a bound sets in or lets go a field has a kink, and a spline that keeps to its bound at the places
    /// goes to and fro between them from there on.
    pub(crate) fn asks_between(&self, term: &Term) -> bool {
        let has_bounds = self.terms.iter().any(|term| term.bound);
        let is_equation = term.kind == TermKind::Residual && term.within.is_none() && !term.known;
        is_equation && has_bounds && (term.bound || self.is_of_values(term))
    }

    /// True for a term that reads no derivatives.
    pub(crate) fn is_of_values(&self, term: &Term) -> bool {
        term.jets.iter().all(|&jet| self.jets[jet].is_value())
    }

    /// True for a condition on what groups of such an order state: it is of a lower order, and has nothing but residuals.
    pub(crate) fn is_condition_of(&self, order: usize) -> bool {
        self.order < order && self.terms.iter().all(|term| term.kind == TermKind::Residual)
    }

    /// True for a column that one observation compares with alone: where it is NaN, nothing was measured, and the observation
    /// does not count.
    pub fn may_lack(&self, column: &str) -> bool {
        let Some(at) = self.columns.iter().position(|own| own.name == column) else { return false };
        let mut readers = self.terms.iter().filter(|term| term.columns.contains(&at));
        let alone = readers.next().is_some_and(|term| term.columns == [at] && term.rows == 1);
        alone && readers.next().is_none() && self.terms.iter().all(|term| term.kind == TermKind::Observation)
    }
}

/// Floating-point operations of propagation rules on all channels, forward and on the way back (which computes a layer
/// anew instead of storing it). The activation and its derivatives are not counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleFlops {
    /// The activation of a hidden layer.
    pub compose: [usize; 2],
    /// The activation of an affine map of the coordinates.
    pub affine: [usize; 2],
    /// The product of a layer and its gate.
    pub product: [usize; 2],
}

/// A point or its partner with some coordinates held in the middle of their range, whatever the point's are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// 0 for the point itself, 1 for its partner.
    pub of: usize,
    /// The coordinates that are held.
    pub coordinates: &'static [usize],
}

/// A network output or a derivative of it.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// Index of the head in [`Scene::heads`](super::Scene::heads).
    pub head: usize,
    /// The derivative as people write it.
    pub name: &'static str,
    /// Degree of the operator in each scale group's coordinates, one entry per coordinate (collapsed operators put
    /// their whole degree on one coordinate of the group).
    pub degree: &'static [u8],
    /// The operator in channels: (channel, coefficient).
    pub combination: &'static [(usize, f64)],
    /// The operator in derivatives: (order by each coordinate, coefficient).
    pub operator: &'static [(&'static [u8], f64)],
    /// 0 for the point itself, then its partner if the group is paired, then [`Group::held`].
    pub site: usize,
}

impl Jet {
    /// True for what is no derivative.
    pub fn is_value(&self) -> bool {
        self.degree.iter().all(|&degree| degree == 0)
    }
}

/// Per-point data of a group.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
}
