//! The collector of errors, and the catalogue of what they say.
//!
//! A stage pushes everything it finds and goes on; the caller asks once, at the end, what was found.

use proc_macro2::{Delimiter, Group, Literal, Span, TokenStream, TokenTree};
use quote::quote_spanned;

pub(crate) mod catalogue;

/// Where something stands in the user's source: its first and its last token.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The first token.
    pub start: Span,
    /// The last token.
    pub end: Span,
}

impl Place {
    /// From the beginning of one place to the end of another.
    pub fn to(self, last: Place) -> Place {
        Place { start: self.start, end: last.end }
    }
}

impl From<Span> for Place {
    fn from(span: Span) -> Self {
        Place { start: span, end: span }
    }
}

/// One thing that is wrong.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Where.
    pub place: Place,
    /// What was found, what was expected, and after `= help:` what to do.
    pub message: String,
}

/// Proof that an error was pushed: whoever gets one has nothing more to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reported;

/// A result whose error has already been pushed.
pub(crate) type Checked<T> = Result<T, Reported>;

/// Collects errors. It must be asked what it holds before it is dropped; a debug build panics if it never was.
#[derive(Debug, Default)]
pub struct Errors {
    faults: Vec<Fault>,
    /// Units in base units, and as they are written: both in brackets.
    units: Vec<[String; 2]>,
    asked: std::cell::Cell<bool>,
}

impl Errors {
    /// An empty collector.
    pub fn new() -> Self {
        Self::default()
    }

    /// Notes an error at a token (a `Span`) or at several (a [`Place`]).
    pub fn push(&mut self, place: impl Into<Place>, message: impl Into<String>) {
        let mut message = message.into();
        for [base, written] in &self.units {
            // Within quoted code the unit stands alone.
            message = message.replace(&format!("{base}`"), &format!("{written}`"));
            message = message.replace(base, &format!("{written} ({base})"));
        }
        self.faults.push(Fault { place: place.into(), message });
    }

    /// Messages from here on show the unit in base units as it is written in the module, and then in base units.
    pub(crate) fn write_unit(&mut self, base: String, written: String) {
        if self.units.iter().all(|[known, _]| *known != base) {
            self.units.push([base, written]);
        }
    }

    /// As `push`, for use as `return Err(errors.report(..))`.
    pub(crate) fn report(&mut self, place: impl Into<Place>, message: impl Into<String>) -> Reported {
        self.push(place, message);
        Reported
    }

    /// True if nothing was wrong.
    pub fn is_empty(&self) -> bool {
        self.asked.set(true);
        self.faults.is_empty()
    }

    /// True if anything was wrong so far, which does not count as having asked.
    pub(crate) fn found_any(&self) -> bool {
        !self.faults.is_empty()
    }

    /// Everything noted, in order of discovery.
    pub fn faults(&self) -> &[Fault] {
        self.asked.set(true);
        &self.faults
    }

    /// One `compile_error!` for each fault, spanning the user's tokens.
    pub fn into_compile_errors(self) -> TokenStream {
        self.faults().iter().flat_map(compile_error).collect()
    }
}

impl Drop for Errors {
    fn drop(&mut self) {
        if cfg!(debug_assertions) && !self.asked.get() && !std::thread::panicking() {
            panic!("forgot to check for errors");
        }
    }
}

/// rustc underlines a macro call from its first to its last token, so the two ends carry the two spans.
fn compile_error(fault: &Fault) -> TokenStream {
    let mut literal = Literal::string(&fault.message);
    literal.set_span(fault.place.end);
    let mut group = Group::new(Delimiter::Brace, TokenTree::from(literal).into());
    group.set_span(fault.place.end);
    let mut tokens = quote_spanned!(fault.place.start=> ::core::compile_error!);
    tokens.extend([TokenTree::from(group)]);
    tokens
}
