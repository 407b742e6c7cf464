//! The syntax tree.

mod domain;
mod expression;

pub use domain::{Domain, FileKind, Location, Portion, Region, RegionKind};
pub use expression::{Expr, ExprKind, Number, Path};
use std::collections::BTreeSet;

use proc_macro2::{Span, TokenStream};

use crate::error::Place;
use crate::loss::Robust;
use crate::unit::Unit;

/// A name and where the user wrote it.
#[derive(Clone, Debug)]
pub struct Name {
    /// The identifier's text.
    pub text: String,
    /// The user's token.
    pub span: Span,
}

/// A whole `pde!` invocation.
#[derive(Clone, Debug)]
pub struct Module {
    /// Doc comment lines.
    pub docs: Vec<String>,
    /// `pub`, `pub(crate)` or nothing.
    pub visibility: TokenStream,
    /// The module's name.
    pub name: Name,
    /// True after `units: off;`.
    pub units_off: bool,
    /// Coordinates, fields, sources, parameters and constants, in order.
    pub declarations: Vec<Declaration>,
    /// Definitions, groups, scenes and hard conditions, in order.
    pub items: Vec<Item>,
    /// Names in statements that could not be read: using one of them is no further mistake.
    pub broken: BTreeSet<String>,
}

/// What a declaration declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Kind {
    Coordinate,
    Field,
    Source,
    Parameter,
    Constant,
    Column,
}

/// How many components a declared name has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One.
    Scalar,
    /// One for each spatial coordinate (`vector`).
    Vector,
    /// A given number (`vector(3)`).
    Numbered(usize),
    /// Not a shape: a coordinate marked `time`, which `grad` and its like leave out.
    Time,
}

/// A declared name.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// What it is.
    pub kind: Kind,
    /// Its name.
    pub name: Name,
    /// The coordinates that it depends on, where they are written: `q(x)`.
    pub depends: Option<Vec<Name>>,
    /// Its components.
    pub shape: Shape,
    /// Its unit; None if the unit could not be read.
    pub unit: Option<Unit>,
    /// `>= e` or `> e`, or the left end of `in a .. b`.
    pub lower: Option<Expr>,
    /// `<= e` or `< e`, or the right end of `in a .. b`.
    pub upper: Option<Expr>,
    /// True for `> e`: the bound itself is left out.
    pub above: bool,
    /// True for `< e`.
    pub below: bool,
    /// `= e`.
    pub value: Option<Expr>,
    /// `within e`: how far a learned parameter is believed to be from its value.
    pub spread: Option<Expr>,
    /// Doc comment lines.
    pub docs: Vec<String>,
}

/// A statement of a module other than a declaration.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub enum Item {
    Let(Let),
    Group(Group),
    Scene(Scene),
    Hard(Hard),
    Domain(Domain),
}

/// `let NAME = EXPR;`
#[derive(Clone, Debug)]
pub struct Let {
    /// The name.
    pub name: Name,
    /// Its value; None if it could not be read.
    pub value: Option<Expr>,
}

/// `hard FIELD = VALUE by DISTANCE;`
#[derive(Clone, Debug)]
pub struct Hard {
    /// The field.
    pub field: Name,
    /// The boundary value, extended inwards.
    pub value: Expr,
    /// Zero on the boundary.
    pub distance: Expr,
}

/// `on NAME { ... }`
#[derive(Clone, Debug)]
pub struct Group {
    /// Its name.
    pub name: Name,
    /// Where its points lie, if it says so.
    pub location: Option<Location>,
    /// True after `on NAME pairs`.
    pub paired: bool,
    /// Statements in order.
    pub items: Vec<GroupItem>,
    /// Doc comment lines.
    pub docs: Vec<String>,
}

/// A statement of a group.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub enum GroupItem {
    Column(Box<Declaration>),
    Let(Let),
    Term(Box<Term>),
    /// A term that could not be read: its name is taken all the same.
    Broken(Name),
}

/// A term.
#[derive(Clone, Debug)]
pub struct Term {
    /// Its name.
    pub name: Name,
    /// What it asks.
    pub body: TermBody,
    /// The robust loss after `with`.
    pub loss: Option<Robust>,
    /// The number after `weight`.
    pub weight: Option<f64>,
    /// The quantity after `within`: how far rows may be off.
    pub within: Option<Within>,
    /// Doc comment lines.
    pub docs: Vec<String>,
    /// The whole statement without its suffixes.
    pub place: Place,
}

/// What a term asks.
#[derive(Clone, Debug)]
pub enum TermBody {
    /// One or more conditions, separated by commas.
    Conditions(Vec<Condition>),
    /// `observe NAME` or `observe NAME: EXPR ~ COLUMN [unit]`
    Observe {
        /// What is measured.
        value: Expr,
        /// The column of measurements; None in the short form, where it is named like the field.
        column: Option<Name>,
        /// The unit written after the column.
        unit: Option<Box<Unit>>,
    },
    /// `chamfer EXPR`, with `symmetric` or `plane` before it
    Chamfer {
        /// The surface point.
        point: Expr,
        /// Both directions.
        symmetric: bool,
        /// Only across the surface.
        plane: bool,
    },
}

/// `within 2 [mm]`
#[derive(Clone, Debug)]
pub struct Within {
    /// The number.
    pub value: f64,
    /// Its unit, if one is written.
    pub unit: Option<Box<Unit>>,
    /// The number's place.
    pub place: Place,
}

/// One condition.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub enum Condition {
    Relation(Box<Comparison>),
    /// `0 <= a _|_ b >= 0`
    Complementarity(Box<[Comparison; 2]>),
}

/// Two expressions compared.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Left side.
    pub left: Expr,
    /// How they compare.
    pub relation: Relation,
    /// Where the relation stands.
    pub relation_place: Place,
    /// Right side.
    pub right: Expr,
}

/// A relation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Relation {
    Equal,
    AtLeast,
    AtMost,
}

/// `scene NAME { ... }`
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name.
    pub name: Name,
    /// Statements in order.
    pub items: Vec<SceneItem>,
    /// Doc comment lines.
    pub docs: Vec<String>,
}

/// A statement of a scene.
#[derive(Clone, Debug)]
pub enum SceneItem {
    /// `NAME = EXPR;`
    Fix(Name, Expr),
    /// `learn NAME;` or `learn NAME within EXPR;`
    Learn(Name, Option<Expr>),
    /// `without PATH;`
    Without(Path),
    /// `only PATH;`
    Only(Path),
    /// `weight PATH = NUMBER;`
    Weight(Path, f64),
}
