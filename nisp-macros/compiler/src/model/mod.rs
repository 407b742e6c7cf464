//! Compiler stage 2: resolved names, checked shapes and units.
//!
//! - Input: the syntax tree.
//! - Output: a [`Model`], in which every expression is scalar, every name is an index, and every unit agrees.

use proc_macro2::{Span, TokenStream};

pub use crate::syntax::{FileKind, Name, Portion};
use crate::unit::Unit;

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
mod components;
mod constant;
mod declare;
mod differentiate;
mod elaborate;
mod expr;
mod jumps;
mod lint;
mod lint_scene;
mod orders;
mod place;
mod question;
mod resolve_name;
mod scaling;
mod scope;
mod tensor;
mod term;
mod value;

pub use check::check;
pub use expr::{Expr, Function, Node};
pub use place::{Place, Region};
pub use term::{Term, TermKind};

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
