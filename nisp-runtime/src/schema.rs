//! What the compiler knows of a scene, as static data: names, units, channels, equations.
//!
//! The macro emits one [`Scene`] per scene. The engine reads shapes from it, error messages read names, and
//! `explain` prints it.

pub use crate::loss::Loss;

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

impl Scene {
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
        let is_value = |jet: &usize| self.jets[*jet].degree.iter().all(|&degree| degree == 0);
        let has_bounds = self.terms.iter().any(|term| term.bound);
        let is_equation = term.kind == TermKind::Residual && term.within.is_none() && !term.known;
        is_equation && has_bounds && (term.bound || term.jets.iter().all(is_value))
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

/// Where a group's points lie, in the declared units of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Which part of the domain.
    pub portion: Portion,
    /// The domain: a product of regions over the coordinates in their order.
    pub domain: &'static [Region],
    /// About how many points the group shall have, if it says so.
    pub points: Option<usize>,
}

/// A part of a domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Portion {
    /// Everywhere in it.
    Inside,
    /// On the edge of its first region.
    Boundary,
    /// Where its last region, an interval, begins.
    Start,
    /// Where its last region ends.
    End,
}

/// A region over some coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Lower and upper end for each coordinate.
    Box(&'static [[f64; 2]]),
    /// An ellipse with its axes along the coordinates; a disc.
    Ellipse {
        /// Its centre.
        centre: [f64; 2],
        /// Half its diameters.
        semi_axes: [f64; 2],
    },
    /// The corners of a polygon.
    Polygon(&'static [[f64; 2]]),
    /// A ball.
    Ball {
        /// Its centre.
        centre: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A cylinder along the third coordinate.
    Cylinder {
        /// Its axis.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Where it begins and ends.
        ends: [f64; 2],
    },
    /// What a file holds.
    File {
        /// Its kind.
        kind: FileKind,
        /// Its path as written.
        path: &'static str,
        /// One of the file's unit in the coordinates' own; 1 of a table, whose headers have units.
        scale: f64,
    },
    /// What is in either.
    Plus(&'static [Region; 2]),
    /// What is in the first and not in the second.
    Minus(&'static [Region; 2]),
}

/// What a file holds that a region is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// The corners of a polygon, as a table of two columns.
    Polygon,
    /// A closed surface of triangles, as STL.
    Solid,
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
    /// Index of the head in [`Scene::heads`].
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

/// Per-point data of a group.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
}

/// One condition of a group.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// Its name.
    pub name: &'static str,
    /// The condition as plain text.
    pub equation: &'static str,
    /// The condition as LaTeX.
    pub latex: &'static str,
    /// Unit of its rows.
    pub unit: Unit,
    /// How its rows are meant.
    pub kind: TermKind,
    /// How a row's misfit counts.
    pub loss: Loss,
    /// The user's weight.
    pub weight: f64,
    /// How far rows may be off, if the user says so: the noise of data, the tolerance of a condition, the spread of a prior.
    pub within: Option<Number<Si>>,
    /// Of an integral, the unit of the points' weights.
    pub measure: Option<Unit>,
    /// First row.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// What its rows read of the heads, by index in [`Group::jets`].
    pub jets: &'static [usize],
    /// Of an observation, the column that each row compares with, by index in [`Group::columns`].
    pub columns: &'static [usize],
    /// True where its rows read columns: they have a value at the points of the group alone.
    pub known: bool,
    /// True for `a >= b` and for `0 <= a _|_ b >= 0`, which turn from one side to the other where they may.
    pub bound: bool,
}

/// How a term's rows are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TermKind {
    /// Wanted zero at every point.
    Residual,
    /// Wanted zero up to measurement noise.
    Observation,
    /// The weighted sum over the group is wanted to equal a target.
    Integral,
    /// Rows are coordinates of a surface that passes through a cloud.
    Chamfer {
        /// Both directions, not only cloud to surface.
        symmetric: bool,
        /// Only the distance across the surface, not that along it.
        plane: bool,
        /// What the coordinates of its points are called, as people write the rows; none where they do not write them one by one.
        components: &'static [&'static str],
    },
}
