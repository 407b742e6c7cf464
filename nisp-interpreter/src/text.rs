//! From a text to tokens, and from faults to lines and columns.

use std::fmt;

use nisp_compiler::error::{Fault, Place};
use nisp_compiler::syntax::is_name;
use proc_macro2::{Delimiter, Group, Ident, LineColumn, Span, TokenStream, TokenTree};

/// Something that is wrong with an equation, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Line, from 1; 0 if it concerns the text as a whole.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// How many characters are meant, at least one.
    pub length: usize,
    /// What was found and what was expected.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// The line as written.
    pub text: String,
}

/// As compilers show it: the message, the place, the line with carets below, and the help.
impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.message)?;
        if self.line > 0 {
            let number = self.line.to_string();
            let margin = " ".repeat(number.len());
            // Tabs stay tabs, so that the carets stand below what they mean.
            let indent: String =
                self.text.chars().take(self.column - 1).map(|c| if c == '\t' { c } else { ' ' }).collect();
            let carets = "^".repeat(self.length);
            write!(f, "\n {margin}|\n {number}| {}\n {margin}| {indent}{carets}", self.text)?;
        }
        match &self.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

impl Mistake {
    /// A fault of the compiler, in the text that it was given.
    pub(crate) fn new(fault: &Fault, text: &str) -> Self {
        let Place { start, end } = fault.place;
        let (message, help) = split(&fault.message);
        Self::at(start.start(), end.end(), start.byte_range().is_empty(), message, help, text)
    }

    /// A text that is no sequence of words, numbers and signs.
    pub(crate) fn lexical(error: &proc_macro2::LexError, text: &str) -> Self {
        let span = error.span();
        let start = span.start();
        let sign = text.lines().nth(start.line.saturating_sub(1)).and_then(|line| line.chars().nth(start.column));
        let (message, help) = match sign {
            Some('\'') => ("a quote has no meaning here", Some("a derivative is written `d(u, t)`")),
            Some('°') => ("`°` has no meaning here", Some("degrees are `deg`; temperatures are in `K`")),
            Some('×' | '·' | '⋅') => ("this sign has no meaning here", Some("a product is written with `*`")),
            Some('−' | '–') => ("this dash has no meaning here", Some("a minus is written with `-`")),
            _ => (
                "expected words, numbers and signs: a quote, a bracket or a sign here has no partner or no meaning",
                None,
            ),
        };
        Self::at(start, span.end(), false, message.into(), help.map(Into::into), text)
    }

    fn at(
        start: LineColumn,
        end: LineColumn,
        outside: bool,
        message: String,
        help: Option<String>,
        text: &str,
    ) -> Self {
        if outside {
            return Self { line: 0, column: 0, length: 1, message, help, text: String::new() };
        }
        let line = text.lines().nth(start.line - 1).unwrap_or_default();
        let rest = line.chars().count().saturating_sub(start.column);
        let length = if end.line == start.line { end.column.saturating_sub(start.column) } else { rest };
        let (line, column) = (line.to_string(), start.column + 1);
        Self { line: start.line, column, length: length.max(1), message, help, text: line }
    }
}

/// The compiler puts its advice after `= help:`, on a line of its own.
fn split(message: &str) -> (String, Option<String>) {
    match message.split_once("= help:") {
        Some((message, help)) => (message.trim().into(), Some(help.trim().into())),
        None => (message.trim().into(), None),
    }
}

/// The tokens of a text: `mod NAME { ... }` as it is, declarations alone as a module of this name, whose documentation is what
/// stands first.
pub(crate) fn tokens(text: &str, name: &str) -> Result<TokenStream, Mistake> {
    let tokens: TokenStream = text.parse().map_err(|error| Mistake::lexical(&error, text))?;
    if is_module(&tokens) {
        return Ok(tokens);
    }
    let span = Span::call_site();
    let words = [Ident::new("mod", span), Ident::new(&identifier(name), span)].map(TokenTree::from);
    let (mut docs, mut tokens) = (Vec::new(), tokens.into_iter().peekable());
    while let Some(sign) = tokens.next_if(|token| matches!(token, TokenTree::Punct(sign) if sign.as_char() == '#')) {
        docs.extend([sign].into_iter().chain(tokens.next()));
    }
    let inside = Group::new(Delimiter::Brace, tokens.collect());
    Ok(docs.into_iter().chain(words).chain([inside.into()]).collect())
}

/// True if a `mod` or `pub` comes first, after any documentation.
fn is_module(tokens: &TokenStream) -> bool {
    let mut tokens = tokens.clone().into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => {
                tokens.next();
            }
            TokenTree::Ident(word) => return word == "mod" || word == "pub",
            _ => return false,
        }
    }
    false
}

/// A name that can stand for a module: letters, digits and underscores, not beginning with a digit, and no word of Rust.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let begins = plain.chars().next().is_some_and(|c| !c.is_ascii_digit());
    match plain {
        plain if !begins || plain.trim_matches('_').is_empty() => format!("equation_{plain}"),
        plain if is_name(&plain) => plain,
        plain => format!("{plain}_"),
    }
}

/// True for two texts of equations that differ in nothing but spaces, comments and documentation.
pub fn is_same_equation(one: &str, other: &str) -> bool {
    let plain = |text: &str| text.parse::<TokenStream>().ok().map(|tokens| undocumented(tokens).to_string());
    plain(one).is_some_and(|one| Some(one) == plain(other))
}

/// Tokens without documentation, which is `#[doc = "..."]` to a lexer.
fn undocumented(tokens: TokenStream) -> TokenStream {
    let mut tokens = tokens.into_iter();
    let mut kept = Vec::new();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => drop(tokens.next()),
            TokenTree::Group(group) => kept.push(Group::new(group.delimiter(), undocumented(group.stream())).into()),
            token => kept.push(token),
        }
    }
    kept.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::is_same_equation;

    #[test]
    fn spaces_and_documentation_make_no_other_equation() {
        let one = "/// A rod.\ncoordinates: x [m];\non rod { /// It bends.\n a: d(u, x, 2) == 1; } // so be it";
        assert!(is_same_equation(one, "coordinates:x[m]; on rod {a:d(u,x,2)==1;}"));
        assert!(!is_same_equation(one, "coordinates: x [mm]; on rod { a: d(u, x, 2) == 1; }"));
        assert!(!is_same_equation("(", "("));
    }
}
