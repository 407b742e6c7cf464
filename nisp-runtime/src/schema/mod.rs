//! What the compiler knows of a scene, as static data: names, units, channels, equations.
//!
//! The macro emits one [`Scene`] per scene. The engine reads shapes from it, error messages read names, and
//! `explain` prints it.

mod group;
mod place;
mod term;

pub use crate::loss::Loss;
pub use group::{Column, Group, Held, Jet, RuleFlops};
pub use place::{FileKind, Place, Portion, Region};
pub use term::{Term, TermKind};

use crate::units::{Declared, Number, Scale, Si};

/// A physical unit: exponents of m, kg, s, A, K, mol, cd, the scale to SI, and the text the user wrote.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Exponents over the SI base units.
    pub exponents: [f64; 7],
    /// From numbers in this unit to SI.
    pub factor: Scale<Declared, Si>,
    /// The unit as written; empty if dimensionless.
    pub text: &'static str,
}

impl Unit {
    /// True for seconds, hours and the like.
    pub(crate) fn is_time(&self) -> bool {
        self.exponents == [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    }

    /// The unit as it stands behind a number, with a space; nothing if dimensionless.
    pub(crate) fn behind(&self) -> String {
        if self.text.is_empty() { String::new() } else { format!(" {}", self.text) }
    }
}

/// A scene of a `pde!` module: one specialisation of its equations.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Name of the module.
    pub module: &'static str,
    /// Name of the scene.
    pub name: &'static str,
    /// The user's documentation.
    pub docs: &'static str,
    /// Independent variables.
    pub coordinates: &'static [Coordinate],
    /// Network outputs, fields first.
    pub heads: &'static [Head],
    /// Scalars that group programs read, in slot order.
    pub scalars: &'static [Scalar],
    /// Point groups.
    pub groups: &'static [Group],
    /// The group that reads out the network: one term per head, its value after transformations.
    pub outputs: Group,
    /// What was left out and why.
    pub skipped: &'static [&'static str],
    /// What the terms leave open: fields and sources that no condition pins down.
    pub warnings: &'static [&'static str],
}

/// An independent variable.
#[derive(Clone, Copy, Debug)]
pub struct Coordinate {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Coordinates with the same number share one length scale.
    pub scale_group: usize,
}

/// A network output.
#[derive(Clone, Copy, Debug)]
pub struct Head {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// True for an unknown cause, false for a part of the state.
    pub source: bool,
    /// Lower bound, kept by construction.
    pub lower: Option<Number<Si>>,
    /// Upper bound, kept by construction.
    pub upper: Option<Number<Si>>,
    /// True if the network's output enters through a bound, so that it is dimensionless and neither shifted nor scaled.
    pub transformed: bool,
    /// True if a condition holds by construction: the quantity is a given value plus a distance times the network's output.
    pub hard: bool,
    /// The user's documentation.
    pub docs: &'static str,
}

/// A scalar that group programs read.
#[derive(Clone, Copy, Debug)]
pub struct Scalar {
    /// Its name; empty for literals.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Least value that makes sense, if it was declared.
    pub lower: Option<Number<Si>>,
    /// Greatest value that makes sense, if it was declared.
    pub upper: Option<Number<Si>>,
    /// Where its value comes from.
    pub origin: Origin,
}

/// Where a scalar's value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// The user gives it; the value is the declared default.
    Given(Option<Number<Si>>),
    /// It is learned, within its bounds.
    Learned {
        /// The declared default: where learning starts.
        start: Option<Number<Si>>,
    },
    /// A literal of the equations.
    Literal(Number<Si>),
    /// The natural size of a head.
    HeadScale(usize),
    /// The natural size of one side of a complementarity.
    SideScale {
        /// Group of the term.
        group: usize,
        /// Term within the group.
        term: usize,
        /// Which side.
        side: usize,
    },
}

impl Scene {
    /// The groups that are conditions: of lower order than the equations, with nothing but residuals at single points.
    pub(crate) fn conditions(&self) -> Vec<usize> {
        let order = self.groups.iter().map(|group| group.order).max().unwrap_or(0);
        let is_condition = |at: &usize| self.groups[*at].is_condition_of(order) && !self.groups[*at].paired;
        (0..self.groups.len()).filter(is_condition).collect()
    }

    /// The coordinates that a head depends on.
    pub fn axes(&self, head: usize) -> Vec<usize> {
        let groups = || self.groups.iter().chain([&self.outputs]);
        let is_held = |axis: &usize| {
            groups().any(|group| {
                let jets = group.jets.iter().filter(|jet| jet.head == head);
                jets.filter_map(|jet| jet.site.checked_sub(1 + usize::from(group.paired)))
                    .any(|held| group.held[held].coordinates.contains(axis))
            })
        };
        (0..self.coordinates.len()).filter(|axis| !is_held(axis)).collect()
    }

    /// Whether a term reads values of states alone: fields with derivatives in an equation, which do not leap.
    pub(crate) fn reads_states(&self, group: usize, term: &Term) -> bool {
        let equations = || self.groups.iter().filter(|group| !group.is_beliefs());
        let is_state = |head: usize| {
            let mut own = equations().flat_map(|group| group.jets).filter(|jet| jet.head == head);
            !self.heads[head].source && own.any(|jet| !jet.is_value())
        };
        let jets = term.jets.iter().map(|&jet| &self.groups[group].jets[jet]);
        !term.jets.is_empty() && jets.into_iter().all(|jet| jet.is_value() && is_state(jet.head))
    }

    /// The heads that observations and clouds read.
    pub(crate) fn observed(&self) -> Vec<usize> {
        let is_data = |term: &&Term| matches!(term.kind, TermKind::Observation | TermKind::Chamfer { .. });
        let jets = self.groups.iter().flat_map(|group| {
            let terms = group.terms.iter().filter(is_data);
            terms.flat_map(|term| term.jets).map(|&jet| group.jets[jet].head)
        });
        jets.collect()
    }
}
