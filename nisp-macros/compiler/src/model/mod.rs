//! Compiler stage 2: resolved names, checked shapes and units.
//!
//! - Input: the syntax tree.
//! - Output: a [`Model`], in which every expression is scalar, every name is an index, and every unit agrees.

use std::rc::Rc;

use proc_macro2::{Span, TokenStream};

use crate::loss::Robust;
use crate::rational::Rational;
pub use crate::syntax::{FileKind, Name, Portion};
use crate::unit::{Dimension, Unit};

mod arithmetic;
mod build;
mod call;
mod cancel;
mod check;
mod check_domain;
mod check_group;
mod check_integral;
mod check_observation;
mod check_scene;
mod check_term;
mod compare_units;
mod constant;
mod declare;
mod differentiate;
mod elaborate;
mod jumps;
mod lint;
mod lint_scene;
mod orders;
mod question;
mod resolve_name;
mod scaling;
mod scope;
mod tensor;
mod value;

pub use check::check;

/// A whole `pde!` invocation, checked.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name of the module that is emitted.
    pub name: Name,
    /// Visibility of that module, as tokens.
    pub visibility: TokenStream,
    /// Doc comment lines of the module.
    pub docs: Vec<String>,
    /// Independent variables, in declaration order.
    pub coordinates: Vec<Coordinate>,
    /// Everything the network puts out, in declaration order: fields, then sources; vectors are split into components.
    pub fields: Vec<Field>,
    /// Scalars that are given or learned.
    pub parameters: Vec<Parameter>,
    /// Constants as declared; their values stand wherever they are read.
    pub constants: Vec<Definition>,
    /// Definitions outside of groups, as written; what they stand for stands wherever they are read.
    pub definitions: Vec<Definition>,
    /// Point groups, in order of appearance.
    pub groups: Vec<Group>,
    /// What is asked of the answer beside its fields and sources; nothing where an equation is only to be solved.
    pub questions: Vec<Question>,
    /// Scenes; a module that declares none gets one named `all` with every term.
    pub scenes: Vec<Scene>,
    /// False after `units: off;`.
    pub units_checked: bool,
    /// Lints that do not stop compilation: message and where.
    pub warnings: Vec<(String, Span)>,
}

/// An independent variable.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// Its name.
    pub name: Name,
    /// Declared unit.
    pub unit: Unit,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// Whether a network output is a state or an unknown cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Part of the state, at least partly observed or pinned.
    Field,
    /// Never observed.
    Source,
}

/// One scalar output of the network.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its name; components of a vector `u` in coordinates x, y are `u_x`, `u_y`... as the model stage names them.
    pub name: Name,
    /// Field or source.
    pub role: Role,
    /// Declared unit.
    pub unit: Unit,
    /// A bit for each coordinate that it does not depend on.
    pub held: u32,
    /// Lower bound in SI units, kept by construction.
    pub lower: Option<f64>,
    /// Upper bound in SI units, kept by construction.
    pub upper: Option<f64>,
    /// A hard Dirichlet condition: the field is `value + distance * network`.
    pub hard: Option<Hard>,
    /// The vector that it is a component of.
    pub part: Option<Part>,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// A condition that a field keeps by construction.
#[derive(Clone, Debug)]
pub struct Hard {
    /// Value and distance as plain text.
    pub text: [String; 2],
    /// Zero on the boundary, of the order of one inside, dimensionless.
    pub distance: Expr,
    /// The boundary value, extended inwards.
    pub value: Expr,
}

/// A scalar that the user gives or the solver learns.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: Name,
    /// Declared unit: values are given in it.
    pub unit: Unit,
    /// Default value in SI units, if the declaration has one (`E [Pa] = 2e9`).
    pub default: Option<f64>,
    /// Smallest sensible value in SI units.
    pub lower: Option<f64>,
    /// Largest sensible value in SI units.
    pub upper: Option<f64>,
    /// The vector that it is a component of.
    pub part: Option<Part>,
    /// Standard deviation, in SI units, of what is believed of it where it is learned: its given value, give or take this.
    pub spread: Option<f64>,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// A data column with one value for each point of a group.
#[derive(Clone, Debug)]
pub struct Column {
    /// Its name.
    pub name: Name,
    /// Declared unit.
    pub unit: Unit,
    /// The vector or matrix that it is an entry of.
    pub part: Option<Part>,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// A name for an expression, for people to read: `let` or a constant.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Its name.
    pub name: Name,
    /// The expression as plain text.
    pub text: String,
    /// The definition as LaTeX.
    pub latex: String,
    /// The unit of what it stands for.
    pub unit: Unit,
    /// Its shape in words; empty for a scalar.
    pub shape: String,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// A quantity that is asked of an answer; vectors are split into components.
#[derive(Clone, Debug)]
pub struct Question {
    /// The expression as plain text, with its component.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// What it reads.
    pub expr: Expr,
    /// Where it was asked.
    pub span: Span,
}

/// Where an entry stands in what was declared.
#[derive(Clone, Debug)]
pub struct Part {
    /// The declared name.
    pub of: Name,
    /// The entry's number.
    pub index: usize,
    /// How many entries there are.
    pub count: usize,
}

/// A set of points and what must hold there.
#[derive(Clone, Debug)]
pub struct Group {
    /// Its name.
    pub name: Name,
    /// Definitions in the group, as written.
    pub definitions: Vec<Definition>,
    /// Per-point data, declared in the group or implied by observations; indices of [`Node::Column`].
    pub columns: Vec<Column>,
    /// What must hold.
    pub terms: Vec<Term>,
    /// Where its points lie, if a domain says so.
    pub place: Option<Place>,
    /// True if every point has a partner (periodic pairs): [`Node::Partner`] may occur.
    pub paired: bool,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// Where a group's points lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Which part of the domain.
    pub portion: Portion,
    /// The domain's factors.
    pub domain: Vec<Region>,
    /// About how many points it shall have, if the group says so.
    pub points: Option<usize>,
}

/// A region over some coordinates, in their declared units.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// Lower and upper end for each coordinate.
    Box(Vec<[f64; 2]>),
    /// An ellipse with its axes along the coordinates; a disc.
    Ellipse {
        /// Its centre.
        centre: [f64; 2],
        /// Half its diameters.
        semi_axes: [f64; 2],
    },
    /// The corners of a polygon.
    Polygon(Vec<[f64; 2]>),
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
        path: String,
        /// One of the file's unit in the coordinates' own; 1 of a table, whose headers have units.
        scale: f64,
    },
    /// What is in either.
    Plus(Box<[Region; 2]>),
    /// What is in the first and not in the second.
    Minus(Box<[Region; 2]>),
}

impl Group {
    /// Groups that the compiler adds have names in parentheses, which people cannot write.
    pub fn is_internal(&self) -> bool {
        self.name.text.starts_with('(')
    }

    /// Its name as a type's: that of `soft_bubble` is `SoftBubble`.
    pub(crate) fn camel_name(&self) -> String {
        let word = |word: &str| {
            let mut letters = word.chars();
            letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
        };
        self.name.text.split(|c: char| !c.is_alphanumeric()).map(word).collect()
    }

    /// Name of the struct of what belongs to its points: that of `soft_bubble` is `SoftBubbleData`.
    pub(crate) fn data_name(&self) -> String {
        format!("{}Data", self.camel_name())
    }
}

/// One condition of a group.
#[derive(Clone, Debug)]
pub struct Term {
    /// Its name.
    pub name: Name,
    /// What it asks.
    pub kind: TermKind,
    /// How a row's misfit counts.
    pub loss: Option<Robust>,
    /// The user's weight (1 if none is written).
    pub weight: f64,
    /// How far rows may be off, in SI units: the noise of data, the tolerance of a condition, the spread of a prior.
    pub within: Option<f64>,
    /// The unit shared by all rows; dimension and text of both sides.
    pub unit: Unit,
    /// The condition as plain text.
    pub equation: String,
    /// The condition as LaTeX.
    pub latex: String,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// What a term asks of the expressions in it; each entry of a vector is one scalar row per point.
#[derive(Clone, Debug)]
// There are a handful of terms; plain variants read better than boxes.
#[allow(clippy::large_enum_variant)]
pub enum TermKind {
    /// `a == b`, as `a - b`.
    Residual(Vec<Expr>),
    /// `observe a ~ column`: like a residual, but the misfit is measurement noise.
    Observation {
        /// `a - column`
        rows: Vec<Expr>,
        /// The column of each row, by index in the group.
        columns: Vec<usize>,
    },
    /// `a >= b`, as `a - b`, wanted non-negative.
    Inequality(Vec<Expr>),
    /// `0 <= a _|_ b >= 0`: both non-negative and one of them zero; each with its own dimension.
    Complementarity {
        /// One side.
        a: Expr,
        /// The other side.
        b: Expr,
        /// Dimension of `a`.
        a_dimension: Dimension,
        /// Dimension of `b`.
        b_dimension: Dimension,
    },
    /// `integral(e) == target`: a sum over the group with the points' quadrature weights.
    Integral {
        /// Integrand, one entry per row.
        integrand: Vec<Expr>,
        /// Target value; contains parameters and numbers only.
        target: Vec<Expr>,
        /// Unit of the points' weights: a length, an area, a volume or an extent of coordinates, as declared; absent
        /// where units are off or nothing tells.
        measure: Option<Unit>,
    },
    /// The surface `point` passes through a measured cloud.
    Chamfer {
        /// Deformed position, one entry per dimension of the cloud.
        point: Vec<Expr>,
        /// The entries as people write them, where they are written one by one.
        names: Vec<String>,
        /// Both directions, not only cloud to surface.
        symmetric: bool,
        /// Only the distance across the surface, not that along it.
        plane: bool,
    },
}

/// A specialisation: which terms are used, what is fixed, what is learned.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name.
    pub name: Name,
    /// For each group, which of its terms are used.
    pub uses: Vec<Vec<bool>>,
    /// For each field, the expression it is fixed to (`f = 0`).
    pub fixed_fields: Vec<Option<Expr>>,
    /// For each parameter, the value in SI units it is fixed to.
    pub fixed_parameters: Vec<Option<f64>>,
    /// For each parameter, whether it is learned.
    pub learned: Vec<bool>,
    /// For each parameter, the standard deviation of what is believed of it, in SI units, if it is learned and something is.
    pub spreads: Vec<Option<f64>>,
    /// Weight overrides: for each group, for each term.
    pub weights: Vec<Vec<f64>>,
    /// What its terms leave open: fields and sources that no condition pins down.
    pub warnings: Vec<String>,
    /// Doc comment.
    pub docs: Vec<String>,
}

/// A scalar expression, shared where the user shared it (`let`).
pub type Expr = Rc<Node>;

/// The node of a scalar expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A dimensionless literal, exact.
    Number(Rational),
    /// A dimensionless real that is not rational (`pi`), or a literal too long to be exact.
    Real(f64),
    /// A literal with a unit: its value in SI units and its dimension.
    Quantity(f64, Dimension),
    /// A coordinate, by index.
    Coordinate(usize),
    /// A field or source, by index.
    Field(usize),
    /// A parameter, by index.
    Parameter(usize),
    /// A data column of the group at hand, by index.
    Column(usize),
    /// A sum.
    Add(Vec<Expr>),
    /// A product.
    Mul(Vec<Expr>),
    /// A quotient.
    Div(Expr, Expr),
    /// A rational power with a literal exponent.
    Pow(Expr, Rational),
    /// A general power; base and exponent dimensionless.
    Power(Expr, Expr),
    /// An elementary function.
    Call(Function, Expr),
    /// The smaller of two.
    Min(Expr, Expr),
    /// The larger of two.
    Max(Expr, Expr),
    /// The derivative of an expression by a coordinate.
    Derivative(Expr, usize),
    /// The expression at the point's partner (periodic pairs).
    Partner(Expr),
}

/// Elementary functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
    /// Derivative of `Abs`, zero at zero.
    Sign,
    /// One for positive arguments, zero otherwise: derivative of `max(x, 0)`.
    Step,
    /// `ln(1 + exp x)`.
    Softplus,
    /// `1 / (1 + exp(-x))`.
    Sigmoid,
}
