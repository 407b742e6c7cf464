//! Refuses tokens nested so deeply that a recursive reader would run out of stack.

use proc_macro2::{TokenStream, TokenTree};

use crate::error::{Checked, Errors, catalogue};

/// Deeper than any equation, and far from any stack's end.
const DEEPEST: usize = 120;

/// Walks with a stack of its own.
pub(super) fn check(tokens: &TokenStream, errors: &mut Errors) -> Checked<()> {
    let mut open = vec![tokens.clone().into_iter()];
    while let Some(level) = open.last_mut() {
        match level.next() {
            Some(TokenTree::Group(group)) => {
                if open.len() > DEEPEST {
                    return Err(errors.report(group.span_open(), catalogue::nested_too_deeply(DEEPEST)));
                }
                open.push(group.stream().into_iter());
            }
            Some(_) => {}
            None => {
                open.pop();
            }
        }
    }
    Ok(())
}
