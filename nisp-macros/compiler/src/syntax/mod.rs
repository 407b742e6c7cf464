//! Compiler stage 1: the syntax tree, as written.
//!
//! - Input: tokens.
//! - Output: a [`Module`]. A statement that cannot be read is reported and left out; the rest is read all the same.
//!
//! The language, `?` for optional, `...` for repeated, `|` between alternatives:
//!
//! ```text
//! module      VIS? mod NAME { statement... }                    doc comments go before any declaration, group, term, scene
//! statement   coordinates: (NAME (: time)? UNIT?), ... ;
//!           | fields: declared, ... ;  | sources: declared, ... ;  | parameters: (declared (= EXPR)? (within EXPR)?), ... ;
//!           | constants: (NAME UNIT? = EXPR), ... ;
//!           | domains: (NAME = region (times region)...), ... ;   regions of the coordinates in order, in their units
//!           | units: off;
//!           | let NAME = EXPR;
//!           | hard FIELD = EXPR by EXPR;                        value on the boundary, distance that is zero there
//!           | on NAME (in DOMAIN | boundary of DOMAIN | start of DOMAIN | end of DOMAIN)? pairs? { item... }
//!           | scene NAME { choice... }
//! region      EXPR .. EXPR | box(EXPR .. EXPR, ...) | disc(x, y, radius) | ellipse(x, y, a, b) | polygon([x, y], ...)
//! declared    NAME (: vector | : vector(3))? UNIT? (>= EXPR | <= EXPR | in EXPR .. EXPR)?
//! item        columns: (NAME (: vector)? UNIT?), ... ;
//!           | let NAME = EXPR;
//!           | NAME: condition, ... suffix? ;
//!           | NAME: symmetric? plane? chamfer EXPR suffix? ;
//!           | observe (NAME, ... suffix?), ... ;                columns named like the fields, in their units
//!           | observe NAME: EXPR ~ COLUMN UNIT? suffix? ;       a column declared above, or declared here
//! condition   EXPR (== | >= | <=) EXPR
//!           | integral(EXPR) == EXPR
//!           | 0 <= EXPR _|_ EXPR >= 0                           `complements` for `_|_` reads as well
//! suffix      (with huber(3) | with welsch(3))? (weight 2)? (within 5 UNIT?)?
//! choice      NAME = EXPR;  | learn NAME (within EXPR)?, ... ;  | without PATH, ... ;  | only PATH, ... ;  | weight PATH = NUMBER;
//! PATH        GROUP | GROUP.TERM
//! EXPR        + - * / ^, sign, parentheses; `a^b^c` is `a^(b^c)`, `-x^2` is `-(x^2)`
//!           | NUMBER UNIT?  | NAME  | pi  | I  | [EXPR, ...]  | EXPR[INDEX, INDEX?]
//!           | d(EXPR, x)  | d(EXPR, x, 2)  | d(EXPR, x, 2, y)  | w_xxy
//!           | FUNCTION(EXPR, ...)
//! UNIT        [m/s^2]  | [kg m^-3]  | [W/(m K)]  | [m^(1/2)]  | [m^0.5]  | [1]
//! ```

use proc_macro2::TokenStream;
use syn::buffer::TokenBuffer;

use crate::error::Errors;

mod limit_depth;
mod parse_declarations;
mod parse_domain;
mod parse_expression;
mod parse_group;
mod parse_module;
mod parse_number;
mod parse_scene;
mod parse_term;
mod parse_unit;
mod print_latex;
mod print_text;
mod recover;
mod stream;
mod tree;

pub(crate) use parse_number::{exact, real};
pub(crate) use print_latex::print_latex;
pub(crate) use print_text::print_text;
pub use recover::is_name;
pub use tree::*;

/// Reads the tokens inside `pde! { ... }`. None if there is no module in them at all.
pub fn parse(tokens: TokenStream, errors: &mut Errors) -> Option<Module> {
    // Checked on the raw tokens, because syn's buffer is filled recursively.
    limit_depth::check(&tokens, errors).ok()?;
    let buffer = TokenBuffer::new2(tokens);
    let mut context = stream::Context::new(errors);
    parse_module::parse(&mut stream::Stream::new(buffer.begin()), &mut context).ok()
}

/// Reads expressions separated by commas, to the end of the tokens. None if one of them could not be read.
pub fn parse_expressions(tokens: TokenStream, errors: &mut Errors) -> Option<Vec<Expr>> {
    limit_depth::check(&tokens, errors).ok()?;
    let buffer = TokenBuffer::new2(tokens);
    let mut context = stream::Context::new(errors);
    parse_expression::list(&mut stream::Stream::new(buffer.begin()), &mut context).ok()
}
