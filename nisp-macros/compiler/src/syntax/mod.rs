//! Compiler stage 1: the syntax tree, as written.
//!
//! - Input: tokens.
//! - Output: a [`Module`]. A statement that cannot be read is reported and left out; the rest is read all the same.

use proc_macro2::TokenStream;
use syn::buffer::TokenBuffer;

use crate::error::Errors;

mod limit_depth;
mod parse_declarations;
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
pub use tree::*;

/// Reads the tokens inside `pde! { ... }`. None if there is no module in them at all.
pub fn parse(tokens: TokenStream, errors: &mut Errors) -> Option<Module> {
    // Checked on the raw tokens, because syn's buffer is filled recursively.
    limit_depth::check(&tokens, errors).ok()?;
    let buffer = TokenBuffer::new2(tokens);
    let mut context = stream::Context::new(errors);
    parse_module::parse(&mut stream::Stream::new(buffer.begin()), &mut context).ok()
}
